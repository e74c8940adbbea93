//! Scenes from files: pictures, reports, and what cannot be drawn.

use super::{fails, file, files, outmerge};
use predicates::prelude::{PredicateBooleanExt, predicate};
use tempfile::TempDir;

const SCENE: &str = r#"version = 1
title = "One quad"
explanation = "A quad."
technique = "test"

[target]
width = 16
height = 16

[camera]
height = 2.0

[[material]]
name = "plain"
mode = "fade"
tint = [1.0, 0.5, 0.25, 0.5]

[[object]]
name = "quad"
mesh = "quad"
material = "plain"
"#;

/// Renders a scene that cannot be; no picture may appear.
fn scene_fails(scene: &str, expected: &str) {
    let (folder, path) = file("scene.toml", scene);
    let out = folder.path().join("out.png");
    fails(&["render", path.to_str().expect("UTF-8"), "-o", out.to_str().expect("UTF-8")], expected);
    assert_eq!(files(folder.path()), ["scene.toml"], "no partial file");
}

#[test]
fn a_scene_becomes_a_picture() {
    let (folder, path) = file("scene.toml", SCENE);
    let out = folder.path().join("out.png");
    outmerge(&["render", path.to_str().expect("UTF-8"), "-o", out.to_str().expect("UTF-8")]).assert().success();
    assert_eq!(files(folder.path()), ["out.png", "scene.toml"], "nothing but the picture");
    let picture = image::open(&out).expect("a PNG");
    assert_eq!((picture.width(), picture.height()), (16, 16), "the target's size");
}

#[test]
fn the_reference_makes_the_planned_picture() {
    for scene in ["vegetation-three-trees", "target-half"] {
        let picture = |more: &[&str]| {
            let arguments = [["render", scene, "-m", "llvmpipe", "-o", "-"].as_slice(), more].concat();
            let output = outmerge(&arguments).output().expect("runs");
            assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
            output.stdout
        };
        let planned = picture(&[]);
        assert!(planned.starts_with(b"\x89PNG"), "{scene}: a picture on stdout");
        assert!(planned == picture(&["--reference"]), "{scene}: planned and reference pictures differ");
    }
}

#[test]
fn malformed_scenes_name_file_and_line() {
    scene_fails(&SCENE.replace("width = 16", "width = = 16"), "scene.toml:7");
    scene_fails(&SCENE.replace("mode = \"fade\"", "mode = \"fude\""), "scene.toml:15");
    scene_fails(&SCENE.replace("title", "titel"), "titel");
    scene_fails(&SCENE.replace("version = 1", "version = 9"), "version");
    scene_fails("", "version");
}

#[test]
fn impossible_targets_are_refused() {
    scene_fails(&SCENE.replace("= 16", "= 0"), "it must be 1 to 8192");
    scene_fails(&SCENE.replace("= 16", "= 100000"), "100000");
}

#[test]
fn numbers_must_be_finite() {
    scene_fails(&SCENE.replace("0.25", "nan"), "tint");
    scene_fails(&SCENE.replace("height = 2.0", "height = inf"), "height");
}

#[test]
fn unknown_factors_are_named() {
    let pass = "\n[[material.pass]]\nstate = \"Blend SrcAlpha OneMinusSrcAlhpa\"\n\n[[object]]";
    scene_fails(&SCENE.replace("\n[[object]]", pass), "OneMinusSrcAlhpa");
}

#[test]
fn truncated_pictures_are_refused() {
    let textured = SCENE.replace(
        "[[material]]\nname = \"plain\"",
        "[[texture]]\nname = \"cut\"\nfile = \"cut.png\"\nspace = \"srgb\"\n\n[[material]]\nname = \"plain\"\ntexture = \"cut\"",
    );
    let (folder, path) = file("scene.toml", textured);
    let whole = folder.path().join("cut.png");
    image::RgbaImage::from_pixel(32, 32, image::Rgba([1, 2, 3, 4])).save(&whole).expect("a PNG is written");
    let bytes = std::fs::read(&whole).expect("readable");
    let out = folder.path().join("out.png");
    let arguments = ["render", path.to_str().expect("UTF-8"), "-o", out.to_str().expect("UTF-8")];
    outmerge(&arguments).assert().success();
    std::fs::remove_file(&out).expect("the whole picture was fine");
    for length in [0, 7, 20, bytes.len() / 2, bytes.len() - 13] {
        std::fs::write(&whole, &bytes[..length]).expect("writable");
        fails(&arguments, "cut.png");
        assert_eq!(files(folder.path()), ["cut.png", "scene.toml"], "no partial file at {length} bytes");
    }
}

#[test]
fn unknown_scenes_list_the_bundled_ones() {
    fails(&["render", "no-such-scene", "-o", "out.png"], "fade-over-opaque");
    fails(&["render", "no-such-file.toml", "-o", "out.png"], "no-such-file.toml");
}

#[test]
fn an_unwritable_place_is_an_error() {
    fails(&["render", "cutout-quad", "-o", "/no/such/folder/out.png"], "/no/such/folder/out.png");
}

#[test]
fn the_main_job_reports_every_scene_and_every_section() {
    let folder = TempDir::new().expect("a temporary folder");
    let out = folder.path().join("report");
    outmerge(&["report", "-o", out.to_str().expect("UTF-8")]).assert().success();
    let json = std::fs::read(out.join("report.json")).expect("readable");
    let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    let scenes = outmerge::scene::Scene::bundled().len();
    assert_eq!(json["scenes"].as_array().map(Vec::len), Some(scenes), "every bundled scene");
    let page = std::fs::read_to_string(out.join("index.html")).expect("readable");
    for command in ["outmerge tradeoff", "outmerge stability", "outmerge fixpoint", "outmerge texture", "outmerge plan"]
    {
        assert!(page.contains(command), "the section made by `{command}`");
    }
}

#[test]
fn a_report_is_one_page_that_needs_nothing_else() {
    let folder = TempDir::new().expect("a temporary folder");
    let out = folder.path().join("report");
    outmerge(&["report", "-o", out.to_str().expect("UTF-8"), "fade-over-opaque", "overlap-zwrite-on"])
        .assert()
        .success()
        .stdout(predicate::str::contains("fixed:8").and(predicate::str::contains("exact")));
    assert_eq!(files(&out), ["index.html", "report.json"], "the page and its numbers");
    let page = std::fs::read_to_string(out.join("index.html")).expect("readable");
    for foreign in ["http://", "https://", "<script", "src=\"/", "url(/"] {
        assert!(!page.contains(foreign), "the page must not refer to `{foreign}`");
    }
    assert!(page.contains("data:image/png;base64,"), "pictures are inside");
    let json = std::fs::read(out.join("report.json")).expect("readable");
    let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(json["scenes"].as_array().map(Vec::len), Some(2), "both scenes");
}

/// The figures of a scene's table, from the two pictures that `render` writes, alpha kept: the codes of an 8-bit target.
#[test]
fn figures_of_the_report_are_those_of_the_pictures() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let scene = "fade-over-opaque";
    let picture = |model: &str| {
        let out = path(&format!("{}.png", model.replace(':', "-")));
        outmerge(&["render", scene, "--model", model, "--alpha", "-o", &out]).assert().success();
        image::open(out).expect("a PNG file").into_rgba8()
    };
    let (exact, fixed) = (picture("exact"), picture("fixed:8"));
    let mut arguments = vec!["report", scene, "--models", "fixed:8", "--json", "-o"];
    let out = path("report");
    arguments.push(&out);
    if cfg!(feature = "gpu") {
        arguments.push("--no-device");
    }
    let output = outmerge(&arguments).output().expect("runs");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let (mut sum, mut most, mut differing) = (0_u64, 0_u64, 0_u64);
    for (a, b) in exact.pixels().zip(fixed.pixels()) {
        let codes: Vec<u64> = a.0.iter().zip(b.0).map(|(a, b)| u64::from(a.abs_diff(b))).collect();
        sum += codes.iter().sum::<u64>();
        most = most.max(codes.into_iter().max().unwrap_or(0));
        differing += u64::from(a != b);
    }
    assert!(differing > 0, "the models differ somewhere");
    let pixels = u64::from(exact.width()) * u64::from(exact.height());
    let expected = serde_json::json!({
        "max_codes": most, "sum_codes": sum, "channels": 4 * pixels, "pixels_differing": differing, "pixels": pixels,
    });
    let of = |models: &serde_json::Value| {
        let models = models.as_array().expect("models");
        models.iter().find(|row| row["model"] == "fixed:8").expect("the model asked for")["difference"].clone()
    };
    assert_eq!(of(&json["scenes"][0]["models"]), expected, "the scene");
    assert_eq!(of(&json["models"]), expected, "the sum over its one scene");
    // The table has the same in words.
    let output = outmerge(&[&["report", scene, "--models", "fixed:8", "-o", &out], &arguments[7..]].concat()).output();
    let text = String::from_utf8(output.expect("runs").stdout).expect("text");
    let row = text.lines().find(|line| line.starts_with("fixed:8")).expect("a row");
    let number = |n: u64| f64::from(u32::try_from(n).expect("small"));
    let (mean, percent) = (number(sum) / number(4 * pixels), 100.0 * number(differing) / number(pixels));
    for figure in [most.to_string(), format!("{mean:.5}"), format!("{percent:.3}%")] {
        assert!(row.split_whitespace().any(|cell| cell == figure), "{figure} in {row}");
    }
}
