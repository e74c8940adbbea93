//! `outmerge identify`: samples from files, models asked as if unknown, proposals, errors.

use super::{fails, file, outmerge};
use tempfile::TempDir;

/// A path as an argument.
fn argument(path: &std::path::Path) -> String {
    path.to_str().expect("a plain path").to_owned()
}

/// Standard output and status.
fn run(arguments: &[&str]) -> (String, Option<i32>) {
    let output = outmerge(arguments).output().expect("runs");
    let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    (text, output.status.code())
}

#[test]
fn vectors_of_a_model_lead_back_to_it() {
    let dir = TempDir::new().expect("a folder");
    for model in ["llvmpipe", "f16", "fixed:source=9,factor=7,product=11,rounding=stretch"] {
        let path = dir.path().join("samples.jsonl");
        let path = path.to_str().expect("a plain path");
        let generated =
            outmerge(&["vectors", "generate", "--model", model, "--format", "rgba8unorm", "--lines", "64", "-o", path]);
        { generated }.assert().code(0);
        let (text, status) = run(&["identify", path]);
        assert_eq!(status, Some(0), "{model}: {text}");
        assert!(text.contains(model), "{model}: {text}");
    }
}

#[test]
fn csv_samples_name_the_rounding_they_show() {
    // 1/2 of 255 is 127.5 codes, which only truncation stores as 127; 101 x 1/2 and so on likewise.
    let header = "state,src,dst,out\n";
    let rows = [
        "Blend Off,0.5 0.5 0.5 0.5,0 0 0 0,127 127 127 127",
        "Blend SrcAlpha OneMinusSrcAlpha,1 0 0 0.5,0 0 0 0,127 0 0 64",
        "\"Blend One One\",\"0.2, 0.4, 0.6, 0.8\",\"1, 2, 3, 4\",#3468 9cd0",
    ];
    let text = format!("{header}{}\n", rows.join("\n")).replace("#3468 9cd0", "#34689cd0");
    let (_dir, path) = file("samples.csv", text.as_bytes());
    let (text, status) = run(&["identify", &argument(&path)]);
    assert!(status == Some(0) && text.contains("candidates reproduce every sample"), "{text}");
    assert!(!text.contains("  exact\n"), "exact stores 128: {text}");
}

#[test]
fn a_blender_that_nothing_reproduces_is_called_none_and_the_best_fits_are_ranked() {
    // Over cannot give 9 from nothing, but the other row is plain.
    let text = "state,src,dst,out\nBlend One One,0 0 0 0,0 0 0 0,9 0 0 0\nBlend Off,1 1 1 1,0 0 0 0,255 255 255 255\n";
    let (_dir, path) = file("samples.csv", text.as_bytes());
    let (text, status) = run(&["identify", &argument(&path)]);
    assert_eq!(status, Some(1), "a finding: {text}");
    assert!(text.contains("none: no candidate reproduces every sample"), "{text}");
    assert!(text.contains("1 of 2 differ (50.000 %)"), "{text}");
}

#[test]
fn questions_for_the_next_round_tell_the_remaining_candidates_apart() {
    let (dir, path) = file("samples.csv", b"state,src,dst,out\nBlend Off,1 1 1 1,0 0 0 0,255 255 255 255\n");
    let next = dir.path().join("next.jsonl");
    let next = next.to_str().expect("a plain path");
    let (text, status) = run(&["identify", &argument(&path), "--next", next]);
    assert!(status == Some(0) && text.contains("64 questions for the next round"), "{text}");
    // Answered by a hidden model, they are samples.
    let answered = dir.path().join("answered.jsonl");
    let answered = answered.to_str().expect("a plain path");
    outmerge(&["vectors", "apply", "--model", "exact", next, "-o", answered]).assert().code(0);
    let (text, status) = run(&["identify", answered, "--json"]);
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((status, found["samples"].as_u64()), (Some(0), Some(64)), "{text}");
    let names: Vec<&str> =
        found["reproduced_by"].as_array().expect("names").iter().filter_map(|n| n.as_str()).collect();
    assert!(names.contains(&"exact") && names.len() < 20, "64 chosen questions leave few: {names:?}");
}

#[test]
fn models_asked_as_if_unknown_are_found() {
    let (text, status) =
        run(&["identify", "--of", "fixed:source=12,factor=9,product=11,rounding=stretch,take-in=truncate"]);
    assert!(status == Some(0) && text.contains("rounding=stretch,take-in=truncate reproduces every sample"), "{text}");
    let (text, status) = run(&["identify", "--of", "f32", "--format", "rgba16float"]);
    assert!(status == Some(0) && text.contains("f32"), "{text}");
}

#[test]
fn samples_that_cannot_be_read_are_named() {
    let wrong = |text: &str, expected: &str| {
        let (_dir, path) = file("samples.csv", text.as_bytes());
        fails(&["identify", &argument(&path)], expected);
    };
    wrong("state,src,dst\nBlend Off,1 1 1 1,0 0 0 0\n", "line 2, `out`: missing");
    wrong("state,src,dst,out,hue\n", "unknown column `hue`");
    wrong("state,src,dst,out\nBlend Off,1 1 1,0 0 0 0,0 0 0 0\n", "`1 1 1` has 3 values; four are wanted");
    wrong("state,src,dst,out\nBlend Of One,1 1 1 1,0 0 0 0,0 0 0 0\n", "line 2, `state`");
    wrong("state,src,dst,out\nBlend Off,1 1 1 1,0 0 0 0,0 0 0 256\n", "`256` is no code of rgba8unorm");
    wrong("state,src,dst,out\nBlend Off,1 1 1 1,#00,0 0 0 0\n", "hex of 4 bytes");
    wrong("state,src,dst,out\n", "no samples");
    wrong("{\"format\":\"rgba8unorm\"}\n", "line 1");
    fails(&["identify", "--of", "f64"], "unknown numeric model `f64`");
}
