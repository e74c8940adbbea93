//! `outmerge explain --state`: golden texts whose numbers can be added up by hand.

use super::{fails, golden, outmerge};

#[test]
fn fade_at_one_half_over_mid_grey() {
    golden::printed(
        "fade-half-over-grey.txt",
        &["explain", "--state", "fade", "--src", "0,0,0,0.5", "--dst", "#7f7f7fff"],
    );
}

#[test]
fn premultiplied_over_half_floats() {
    let state = "Blend One OneMinusSrcAlpha";
    golden::printed(
        "premultiplied-on-half.txt",
        &["explain", "--state", state, "-f", "rgba16float", "--src", "0.3,0.9,1.5,0.4", "--dst", "0.2,0.5,0.7,0.5"],
    );
}

#[test]
fn fade_on_srgb_in_fixed_point() {
    golden::printed(
        "fade-on-srgb-fixed.txt",
        &[
            "explain",
            "--state",
            "fade",
            "-f",
            "rgba8unorm-srgb",
            "-m",
            "fixed:8",
            "--src",
            "0.2,0.2,0.2,0.25",
            "--dst",
            "#bcbcbcff",
        ],
    );
}

#[test]
fn write_masks_and_separate_equations() {
    let state = "Blend SrcAlpha One, Zero One BlendOp RevSub, Max ColorMask RA";
    golden::printed(
        "masked-reverse-subtract.txt",
        &["explain", "--state", state, "-m", "exact", "--src", "0.5,0.5,0.5,0.5", "--dst", "1,1,1,0.25"],
    );
}

#[test]
fn json_carries_numbers_and_accounts() {
    let output = outmerge(&["explain", "--state", "fade", "--src", "0,0,0,0.5", "--dst", "#7f7f7fff", "--json"])
        .output()
        .expect("runs");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["exact"]["stored"][0], 64, "the tie goes to the even code");
    let fixed = json["models"].as_array().expect("a list").iter().find(|m| m["model"] == "fixed:8").expect("there");
    assert_eq!(fixed["stored"][0], 63, "half a code is lost");
    let account = &fixed["accounts"][0];
    let parts: f64 = account["parts"].as_array().expect("six").iter().map(|x| x.as_f64().expect("a number")).sum();
    let exact = account["exact"].as_f64().expect("a number");
    assert!((exact + parts - 63.0).abs() < 1e-6, "exact and parts add up to the code: {account}");
}

#[test]
fn wrong_arguments_are_explained() {
    let with = |state: &str, src: &str, dst: &str, expected: &str| {
        fails(&["explain", "--state", state, "--src", src, "--dst", dst], expected);
    };
    with("Blend SrcAlhpa One", "0,0,0,1", "0,0,0,1", "SrcAlhpa");
    with("fade", "0,0,0", "0,0,0,1", "--src 0,0,0: write four numbers");
    with("fade", "0,0,0,1", "#12", "8 hex digits");
    fails(&["explain", "--state", "fade", "--src", "0,0,0,1", "--dst", "0,0,0,1", "-f", "rgba9"], "rgba8unorm");
    fails(&["explain", "--state", "fade", "--src", "0,0,0,1", "--dst", "0,0,0,1", "-m", "f33"], "fixed:8");
    fails(
        &["explain", "--state", "fade", "--src", "0,0,0,1", "--dst", "0,0,0,1", "-f", "r16float", "-m", "fixed"],
        "unsigned normalised",
    );
}
