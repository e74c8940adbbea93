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
fn the_history_of_a_pixel_with_its_equations_and_shares() {
    golden::printed("pixel-fade-over-opaque.txt", &["explain", "fade-over-opaque", "--pixel", "64,64", "--stack"]);
}

#[test]
fn the_history_of_a_pixel_names_the_stage_that_ended_a_fragment() {
    golden::printed("pixel-depth-failed.txt", &["explain", "overlap-zwrite-on", "--pixel", "64,64"]);
    golden::printed(
        "pixel-vegetation.txt",
        &["explain", "vegetation-three-trees", "--pixel", "40,64", "-m", "llvmpipe"],
    );
}

#[test]
fn the_history_as_json_has_events_stages_and_stacks() {
    let output =
        outmerge(&["explain", "fade-over-opaque", "--pixel", "64,64", "--stack", "--json"]).output().expect("runs");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["events"].as_array().map(Vec::len), Some(2), "two fragments");
    assert_eq!(json["events"][1]["fate"], "merged");
    assert_eq!(json["events"][1]["after"], json["last"], "the last fragment left what the pixel holds");
    assert_eq!(json["stacks"][0]["shares"].as_array().map(Vec::len), Some(3), "cleared target and two layers");
    assert!(json["others"].as_array().is_some_and(|others| others.len() >= 4), "the other models' ends");
}

#[test]
fn a_wrong_pixel_is_explained() {
    fails(&["explain", "fade-over-opaque", "--pixel", "12"], "--pixel 12: write column and row");
    fails(&["explain", "fade-over-opaque", "--pixel", "12,4096"], "outside the 128 x 128 target");
    fails(&["explain", "no-such-scene", "--pixel", "1,1"], "no bundled scene `no-such-scene`");
    let usage: [&[&str]; 3] = [
        &["explain", "fade-over-opaque"],
        &["explain", "fade-over-opaque", "--pixel", "1,1", "--state", "fade"],
        &["explain", "--state", "fade"],
    ];
    for arguments in usage {
        outmerge(arguments).assert().code(2);
    }
}

#[test]
fn the_history_names_the_triangle_and_the_light() {
    golden::printed("pixel-light-passes.txt", &["explain", "light-passes", "--pixel", "115,45", "-m", "llvmpipe"]);
    golden::printed("pixel-cube-inside.txt", &["explain", "cube-cull-front-back", "--pixel", "64,64", "-m", "exact"]);
}

#[test]
fn both_forms_stand_in_the_usage_message() {
    for arguments in [&["explain"][..], &["explain", "fade-over-opaque"], &["explain", "--state", "fade"]] {
        let output = outmerge(arguments).output().expect("runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: status");
        for form in ["explain <SCENE> --pixel <X,Y>", "explain --state <STATE> --src <R,G,B,A> --dst <R,G,B,A>"] {
            assert!(message.contains(form), "{arguments:?}: `{form}` in: {message}");
        }
    }
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
    with("fade", "0,0,0,1", "300,0,0,0", "red is 300, and rgba8unorm holds numbers from 0 to 1");
    with("fade", "0,0,0,1", "0,0,0,nan", "alpha is NaN");
    let on = |format: &str, dst: &str, expected: &str| {
        fails(&["explain", "--state", "fade", "-f", format, "--src", "0,0,0,1", &format!("--dst={dst}")], expected);
    };
    on("rgba8snorm", "0,-1.5,0,0", "green is -1.5, and rgba8snorm holds numbers from -1 to 1");
    on("rgba16float", "0,0,1e5,0", "blue is 100000, and rgba16float holds numbers from -65504 to 65504");
    on("rg11b10ufloat", "-0.5,0,0,0", "red is -0.5");
    for (format, dst) in [("rgba16float", "inf,-inf,nan,-65504"), ("rg8unorm", "1,0,7,7"), ("rgba8snorm", "-1,1,0,0")] {
        let dst = format!("--dst={dst}");
        outmerge(&["explain", "--state", "fade", "-f", format, "--src", "0,0,0,1", &dst]).assert().success();
    }
    fails(&["explain", "--state", "fade", "--src", "0,0,0,1", "--dst", "0,0,0,1", "-f", "rgba9"], "rgba8unorm");
    fails(&["explain", "--state", "fade", "--src", "0,0,0,1", "--dst", "0,0,0,1", "-m", "f33"], "fixed:8");
    fails(
        &["explain", "--state", "fade", "--src", "0,0,0,1", "--dst", "0,0,0,1", "-f", "r16float", "-m", "fixed"],
        "unsigned normalised",
    );
}

/// The README's first example is what the command prints.
#[test]
fn the_example_of_the_readme_is_what_is_printed() {
    let readme = include_str!("../../README.md");
    let example: Vec<&str> =
        readme.lines().skip_while(|line| *line != "```text").skip(1).take_while(|line| *line != "```").collect();
    let (command, lines) = example.split_first().expect("an example");
    let arguments =
        ["explain", "--state", "fade", "--format", "rgba8unorm", "--src", "0,0,0,0.5", "--dst", "#7f7f7fff"];
    assert_eq!(command.replace('\'', ""), format!("$ outmerge {}", arguments.join(" ")), "the command");
    let output = outmerge(&arguments).output().expect("runs");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for line in lines.iter().filter(|line| **line != "...") {
        assert!(text.lines().any(|printed| printed == *line), "`{line}` is not in:\n{text}");
    }
    assert!(lines.len() > 8, "a whole example: {lines:?}");
}

/// A code that passes through under directed rounding stands on its own, irrational, threshold.
#[test]
fn an_srgb_code_that_passes_through_is_kept() {
    for model in ["exact", "exact:toward-zero"] {
        for code in ["00", "7f", "80", "fe", "ff"] {
            let dst = format!("#{code}{code}{code}{code}");
            let arguments = ["explain", "--state", "zero one", "-f", "rgba8unorm-srgb", "--src", "0.2,0.2,0.2,0.5"];
            let output = outmerge(&arguments).args(["--dst", &dst, "--model", model]).output().expect("runs");
            let text = String::from_utf8(output.stdout).expect("UTF-8");
            assert_eq!(output.status.code(), Some(0), "{model}, {code}: {text}");
            let stored = format!("{code} {code} {code} {code}");
            let line = text
                .lines()
                .find(|line| line.trim_start().starts_with(&format!("{model} ")) && line.ends_with(&stored));
            assert!(line.is_some(), "{model} stores {stored}: {text}");
        }
    }
}
