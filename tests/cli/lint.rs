//! `outmerge lint`.

use super::{fails, outmerge};

#[test]
fn findings_are_exit_status_1_with_pixel_bytes_and_repair() {
    let output = outmerge(&["lint", "overlap-zwrite-on"]).output().expect("runs");
    assert_eq!(output.status.code(), Some(1), "a finding");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for wanted in [
        "depth-write: draw 1 (near red",
        "pixel 47,47",
        "outmerge explain overlap-zwrite-on --pixel 47,47",
        "fix: ZWrite Off",
    ] {
        assert!(text.contains(wanted), "`{wanted}` in\n{text}");
    }
}

#[test]
fn a_clean_scene_and_a_clean_state_are_exit_status_0() {
    outmerge(&["lint", "fade-over-opaque"]).assert().success();
    outmerge(&["lint", "alpha-blending"]).assert().success();
}

#[test]
fn states_are_linted_with_what_the_options_add() {
    outmerge(&["lint", "Blend SrcAlpha OneMinusSrcAlpha"]).assert().code(1);
    outmerge(&["lint", "One Zero", "-f", "rgba16float"]).assert().code(1);
    outmerge(&["lint", "One Zero", "-f", "rgba8unorm"]).assert().success();
    outmerge(&["lint", "alpha-blending", "--source", "premultiplied"]).assert().code(1);
    outmerge(&["lint", "alpha-blending", "--source", "straight"]).assert().success();
    let factors = "Constant OneMinusConstant One Zero";
    outmerge(&["lint", factors]).assert().code(1);
    outmerge(&["lint", factors, "--constant", "0.5,0.5,0.5,1"]).assert().success();
}

#[test]
fn json_lists_findings() {
    let output = outmerge(&["lint", "overlap-zwrite-on", "--json"]).output().expect("runs");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["verdict"], "fails", "a finding");
    let first = &json["findings"][0];
    assert_eq!(first["rule"], "depth-write");
    assert_eq!(first["example"]["pixel"], serde_json::json!([47, 47]));
    assert_ne!(first["example"]["stored"], first["example"]["repaired"], "the pixel differs");
}

#[test]
fn wrong_input_is_exit_status_2() {
    fails(&["lint", "no-such-thing"], "no bundled scene");
    fails(&["lint", "missing.toml"], "missing.toml");
    fails(&["lint", "fade", "-f", "rgba9"], "rgba9");
    fails(&["lint", "fade", "--constant", "1,2"], "--constant 1,2");
}

#[test]
fn the_rules_are_listed() {
    let output = outmerge(&["lint", "--rules"]).output().expect("runs");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for rule in outmerge::lint::RULES {
        assert!(text.contains(rule.name), "{}: {text}", rule.name);
    }
}
