//! The analyses: texture, bound, stability, tradeoff, and render's traps.

use predicates::prelude::{PredicateBooleanExt as _, predicate};
use serde_json::Value;
use tempfile::TempDir;

use super::{fails, file, files, outmerge};

const LEAF: &str = "examples/scenes/leaf.png";

/// What the command prints, as JSON.
fn json(arguments: &[&str]) -> Value {
    let output = outmerge(arguments).output().expect("runs");
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{arguments:?}: {error}"))
}

#[test]
fn texture_reads_folders_writes_heat_maps_and_sums_up() {
    let folder = TempDir::new().expect("a temporary folder");
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).expect("writable");
    for path in [folder.path().join("b.png"), inner.join("a.PNG")] {
        std::fs::copy(LEAF, path).expect("writable");
    }
    std::fs::write(folder.path().join("notes.txt"), "no picture").expect("writable");
    let maps = TempDir::new().expect("a temporary folder");
    let [images, maps_path] = [folder.path(), maps.path()].map(|path| path.to_str().expect("UTF-8"));
    let said = predicate::str::contains("Summary of 2 images").and(predicate::str::contains("unpremultiplying loses"));
    outmerge(&["texture", images, "--models", "exact", "--heat-maps", maps_path]).assert().success().stdout(said);
    assert_eq!(files(maps.path()), ["000-b.png", "001-a.png"], "one heat map an image");
}

#[test]
fn texture_finds_errors_beyond_the_limit() {
    outmerge(&["texture", LEAF, "--models", "exact", "--max-error", "0"]).assert().code(1);
    outmerge(&["texture", LEAF, "--models", "exact", "--max-error", "255"]).assert().code(0);
}

#[test]
fn texture_names_what_is_wrong_with_an_image() {
    let (_folder, path) = file("broken.png", b"\x89PNG\r\n\x1a\n and no more");
    fails(&["texture", path.to_str().expect("UTF-8")], "broken.png");
    fails(&["texture", "missing.png"], "missing.png");
    fails(&["texture", LEAF, "--cutoff", "2"], "--cutoff");
    let empty = TempDir::new().expect("a temporary folder");
    fails(&["texture", empty.path().to_str().expect("UTF-8")], "no .png file");
}

#[test]
fn bound_prints_the_geometric_sum_and_what_a_search_reaches() {
    let found = json(&["bound", "-n", "50", "--alpha", "0.25", "--format", "rgba8unorm", "--search", "--json"]);
    let row = &found["bounds"][0];
    let (codes, found) = (row["codes"].as_f64().expect("a number"), row["found"].as_f64().expect("a number"));
    let sum = 0.5 * (1.0 - 0.75_f64.powi(50)) / 0.25;
    assert!((codes - sum).abs() < 1e-9, "{codes} codes, by hand {sum}");
    assert!(found <= codes && found > 0.9 * codes, "a search reaches {found}");
}

#[test]
fn bound_refuses_what_it_cannot_prove() {
    fails(&["bound", "--alpha", "1.5"], "outside [0, 1]");
    fails(&["bound", "--model", "llvmpipe", "--format", "rgba16float"], "no bound is proven");
    fails(&["bound", "--layers", "4000000000"], "hardly grows");
    fails(&["bound", "--format", "rgba9"], "unknown texture format");
}

#[test]
fn stability_runs_the_parts_asked_for_and_draws() {
    let folder = TempDir::new().expect("a temporary folder");
    let plot = folder.path().join("stacks.svg");
    let plot_path = plot.to_str().expect("UTF-8");
    let found =
        json(&["stability", "--parts", "stacks", "-n", "20", "--models", "exact,f32", "--plot", plot_path, "--json"]);
    assert_eq!(found["models"], serde_json::json!(["exact", "f32"]), "the models asked for");
    assert!(found["stacks"].is_array() && found["order"].is_null(), "stacks alone");
    let svg = std::fs::read_to_string(&plot).expect("written");
    assert!(svg.starts_with("<svg") && svg.contains("rgba16float"), "a chart with a line a format");
    fails(&["stability", "--parts", "order", "--scenes", "cornell"], "no bundled scene `cornell`");
    fails(&["stability", "--parts", "order", "--plot", "x.svg"], "--plot draws stacks");
}

#[test]
fn tradeoff_measures_every_model_asked_for() {
    let arguments =
        ["tradeoff", "--formats", "rgba8unorm", "--models", "exact,f32", "-n", "1", "--no-adapter", "--json"];
    let measured = json(&arguments);
    let points = measured["points"].as_array().expect("points");
    assert_eq!(points.len(), 2, "a point a model");
    assert_eq!(points[0]["mean"], 0.0, "exact has no error");
    assert!(points.iter().all(|point| point["ns_per_fragment"].as_f64() > Some(0.0)), "times: {points:?}");
    assert!(points.iter().all(|point| point["kernel_ns_per_fragment"].as_f64() > Some(0.0)), "kernels: {points:?}");
    assert_eq!(measured["fixed"].as_array().map(Vec::len), Some(66), "11 widths, 6 roundings");
    fails(&["tradeoff", "--layers", "7"], "use 1, 10, 100 or 1000");
}

#[test]
fn render_traps_the_first_value_out_of_range() {
    outmerge(&["render", "fade-over-opaque", "--trap", "nan,inf,clamp"])
        .assert()
        .code(0)
        .stdout("nothing was trapped\n");
    // Lights that add up beyond 1 on a target of 8 bits.
    let output = outmerge(&["render", "light-passes", "--trap", "clamp"]).output().expect("runs");
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.starts_with("a value out of range at pixel (") && text.contains("before"), "{text}");
}
