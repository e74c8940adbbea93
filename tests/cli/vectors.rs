//! `outmerge vectors`: findings, errors, generated files.

use super::{fails, file, files, outmerge};
use assert_cmd::Command;
use predicates::prelude::{PredicateBooleanExt, predicate};
use tempfile::TempDir;

const LINE: &str = concat!(
    r#"{"format":"rgba8unorm","blend":{"color":{"src":"src-alpha","dst":"one-minus-src-alpha","op":"add"},"#,
    r#""alpha":{"src":"one","dst":"zero","op":"add"}},"mask":15,"constant":"00000000000000000000000000000000","#,
    r#""dual":false,"src":"0000803f0000003f000000000000003f","src1":null,"dst":"7f7f7fff","out":"bf7f4080"}"#
);

const DEPTH: &str = concat!(
    r#"{"kind":"depth","state":{"format":"depth24plus-stencil8","depthCompare":"less","depthWriteEnabled":true,"#,
    r#""stencilFront":{"depthFailOp":"increment-clamp","passOp":"replace"}},"reference":7,"#,
    r#""z":"0000803e0000403f","dst":"0000800003000080000a","out":"0000400007000080000b","passed":"0100"}"#
);

const LAYERS: &str = concat!(
    r#"{"kind":"layers","format":"r8unorm","layers":[{"src":"0000803f000000000000000000000000"},"#,
    r#"{"blend":{"color":{"src":"src-alpha","dst":"one-minus-src-alpha","op":"add"},"#,
    r#""alpha":{"src":"one","dst":"zero","op":"add"}},"src":"0000000000000000000000000000003f"}],"#,
    r#""dst":"00","out":"80"}"#
);

fn check(content: &str) -> Command {
    let mut command = outmerge(&["vectors", "check", "--model", "exact", "-"]);
    command.write_stdin(content.to_owned());
    command
}

#[test]
fn a_line_that_holds_passes_and_one_that_does_not_is_a_finding() {
    check(LINE).assert().code(0);
    check(&LINE.replace("bf7f4080", "be7f4080"))
        .assert()
        .code(1)
        .stdout(predicate::str::contains("line 1").and(predicate::str::contains("expected 0xbf 0x7f 0x40 0x80")));
}

#[test]
fn malformed_lines_are_named() {
    for (wrong, expected) in [
        (LINE.replace("src-alpha\",\"dst", "src-alhpa\",\"dst"), "src-alhpa"),
        (LINE.replace("rgba8unorm", "rgba8foo"), "rgba8foo"),
        (LINE.replace("\"mask\":15", "\"mask\":16"), "mask"),
        (LINE.replace("7f7f7fff", "7f7f7f"), "dst"),
        (LINE.replace("7f7f7fff", "7f7f7fxy"), "dst"),
        (LINE.replace("\"dual\":false", "\"dual\":true"), "src1"),
        (LINE.replace("\"mask\"", "\"musk\""), "musk"),
        (LINE[..100].to_owned(), "line 2"),
        ("[]".to_owned(), "line 2"),
    ] {
        let output = check(&format!("{LINE}\n{wrong}\n")).output().expect("runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{wrong}: {stderr}");
        assert!(stderr.contains("line 2") && stderr.contains(expected), "{wrong}: {stderr}");
    }
}

#[test]
fn a_bad_line_leaves_no_partial_file() {
    let (folder, path) = file("in.jsonl", format!("{LINE}\nnonsense\n"));
    let out = folder.path().join("out.jsonl");
    let (path, out) = (path.to_str().expect("UTF-8"), out.to_str().expect("UTF-8"));
    fails(&["vectors", "apply", "--model", "f32", path, "-o", out], "line 2");
    assert_eq!(files(folder.path()), ["in.jsonl"], "no partial file");
}

#[test]
fn generated_vectors_pass_their_own_model_and_fail_another() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("v.jsonl");
    let path = path.to_str().expect("UTF-8");
    outmerge(&["vectors", "generate", "--model", "llvmpipe", "-o", path, "--lines", "8", "--texels", "32"])
        .assert()
        .success();
    outmerge(&["vectors", "check", "--model", "llvmpipe", path]).assert().code(0);
    let output = outmerge(&["vectors", "check", "--model", "exact", "--report", path]).output().expect("runs");
    assert_eq!(output.status.code(), Some(1), "the driver is not exact");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(json["formats"]["rgba8unorm"]["failed_texels"].as_u64() > Some(0), "8-bit codes differ: {json}");
}

#[test]
fn lines_of_every_kind_hold_and_say_what_differs() {
    check(&format!("{LINE}\n{DEPTH}\n{LAYERS}\n"))
        .assert()
        .code(0)
        .stdout(predicate::str::contains("depth24plus-stencil8").and(predicate::str::contains("layers r8unorm")));
    for (wrong, expected) in [
        (DEPTH.replace("0000400007", "0000400008"), "expected depth 0x400000 stencil 7 passed, got"),
        (DEPTH.replace(r#""passed":"0100""#, r#""passed":"0101""#), "failed, got depth 0x800000 stencil 11 passed"),
        (LAYERS.replace(r#""out":"80""#, r#""out":"7f""#), "expected 0x80 0x0 0x0 0x0, got 0x7f"),
    ] {
        let output = check(&wrong).output().expect("runs");
        let stdout = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{wrong}: {stdout}");
        assert!(stdout.contains("line 1") && stdout.contains(expected), "{wrong}: {stdout}");
    }
}

#[test]
fn malformed_depth_and_layers_lines_are_named() {
    for (wrong, expected) in [
        (DEPTH.replace("\"depth\"", "\"dept\""), "dept"),
        (DEPTH.replace("depth24plus-stencil8", "rgba8unorm"), "depth/stencil"),
        (DEPTH.replace("\"less\"", "\"lesser\""), "lesser"),
        (DEPTH.replace("\"reference\":7", "\"reference\":700"), "u8"),
        (DEPTH.replace("\"depthWriteEnabled\":true", "\"depthBias\":1"), "bias"),
        (DEPTH.replace("0000803e0000403f", "0000803e0000403f00"), "z"),
        (DEPTH.replace("0000800003000080000a", "0000800103000080000a"), "24 bits"),
        (DEPTH.replace("\"z\"", "\"range\":\"0000803f00000000\",\"z\""), "range"),
        (DEPTH.replace("\"passed\":\"0100\"", "\"passed\":\"0200\""), "passed"),
        (DEPTH.replace(",\"out\":\"0000400007000080000b\"", ""), "out"),
        (LAYERS.replace("one-minus-src-alpha", "one-minus-alpha"), "layer 1"),
        (LAYERS.replace("0000000000000000000000000000003f", ""), "layer 1"),
        (LAYERS.replace("\"dst\":\"00\"", "\"dst\":\"0000\""), "dst"),
        (r#"{"kind":"layers","format":"r8unorm","layers":[],"dst":""}"#.to_owned(), "layers"),
    ] {
        let output = check(&format!("{LINE}\n{wrong}\n")).output().expect("runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{wrong}: {stderr}");
        assert!(stderr.contains("line 2") && stderr.contains(expected), "{wrong}: {stderr}");
    }
}

#[test]
fn every_kind_is_generated_applied_and_checked() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (made, again) = (path("made.jsonl"), path("again.jsonl"));
    let generate =
        ["vectors", "generate", "-m", "llvmpipe", "--kind", "depth,layers", "--lines", "4", "--texels", "64"];
    outmerge(&generate).args(["-o", &made]).assert().success();
    outmerge(&["vectors", "check", "-m", "llvmpipe", &made]).assert().code(0);
    outmerge(&["vectors", "apply", "-m", "exact", &made, "-o", &again]).assert().success();
    outmerge(&["vectors", "check", "-m", "exact", &again]).assert().code(0);
    let output = outmerge(&["vectors", "check", "-m", "llvmpipe", "--report", &again]).output().expect("runs");
    assert_eq!(output.status.code(), Some(1), "the models differ in depth and in layers");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for group in ["depth16unorm", "depth32float", "layers rgba8unorm"] {
        assert!(json["formats"][group]["failed_texels"].as_u64() > Some(0), "{group}: {json}");
    }
    let depth = ["vectors", "generate", "-m", "exact", "--kind", "depth", "--format", "rgba8unorm", "-o", "-"];
    fails(&depth, "depth format");
}

#[test]
fn the_pages_examples_hold() {
    let page = include_str!("../../docs/vectors.md");
    let examples: Vec<String> = page
        .split("```")
        .skip(1)
        .step_by(2)
        .filter_map(|block| block.strip_prefix("json\n"))
        .map(|block| block.lines().map(str::trim).collect())
        .collect();
    assert_eq!(examples.len(), 3, "one example a kind");
    for (example, kind) in examples.iter().zip(["\"format\"", "\"kind\":\"depth\"", "\"kind\":\"layers\""]) {
        assert!(example.contains(kind), "{kind}: {example}");
        for model in ["exact", "llvmpipe"] {
            let mut command = outmerge(&["vectors", "check", "--model", model, "-"]);
            command.write_stdin(example.clone()).assert().code(0);
        }
    }
}

/// Straight over on codes 127: 0.5 * 1 + 0.5 * 127/255 is 190.998 codes. Vulkan admits the neighbours of all that a blender
/// in codes may make of it, D3D's coarsest blender reaches as far, and two codes further nobody does.
#[test]
fn judged_results_are_outside_only_beyond_the_widest_class() {
    let judge = |content: String, arguments: &[&str]| {
        let mut command = outmerge(&[&["vectors", "judge"], arguments, &["-"]].concat());
        command.write_stdin(content).output().expect("runs")
    };
    let text = |output: &std::process::Output| String::from_utf8_lossy(&output.stdout).into_owned();
    for spec in ["vulkan", "d3d", "webgpu"] {
        let exact = judge(LINE.to_owned(), &["--spec", spec]);
        assert_eq!(exact.status.code(), Some(0), "{spec}: {exact:?}");
        assert!(text(&exact).contains(&format!("{spec}: holds, class exact")), "{}", text(&exact));
        let coarse = judge(LINE.replace("bf7f4080", "be7f4080"), &["--spec", spec]);
        assert_eq!(coarse.status.code(), Some(0), "{spec}, a neighbour: {}", text(&coarse));
        assert!(!text(&coarse).contains("class exact"), "{}", text(&coarse));
        let wrong = judge(LINE.replace("bf7f4080", "b97f4080"), &["--spec", spec]);
        assert_eq!(wrong.status.code(), Some(1), "{spec}, six codes away: {}", text(&wrong));
        assert!(text(&wrong).contains("got 185") && text(&wrong).contains("line 1"), "{}", text(&wrong));
    }
    // Every specification unless one is named, and layers are not judged.
    let all = judge(format!("{LINE}\n{DEPTH}\n{LAYERS}\n"), &["--json"]);
    let report: serde_json::Value = serde_json::from_slice(&all.stdout).expect("JSON");
    assert_eq!((&report["verdict"], all.status.code()), (&"holds".into(), Some(0)), "{report}");
    let reports = &report["specifications"];
    let names: Vec<&str> = reports.as_array().expect("a list").iter().filter_map(|r| r["spec"].as_str()).collect();
    assert_eq!(names, ["vulkan", "d3d", "webgpu"], "each");
    assert_eq!(reports[0]["total"]["not_judged"], 1, "layers");
    assert_eq!(reports[0]["formats"]["depth24plus-stencil8"]["texels"]["exact"], 2, "depth and stencil");
    // A stencil value that no text admits.
    let stencil =
        judge(DEPTH.replace("0000800000b", "0000800000c").replace("00400007000080000b", "00400007000080000c"), &[]);
    assert_eq!(stencil.status.code(), Some(1), "{}", text(&stencil));
    let unknown = judge(LINE.to_owned(), &["--spec", "opengl"]);
    let message = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert!(unknown.status.code() == Some(2) && message.contains("vulkan, d3d or webgpu"), "{message}");
}

/// Recorded from Mesa 22.3.6 on an AMD EPYC (Zen 5): the sRGB formats, whose stores depend on the processor.
const RECORDED_ON_AMD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/llvmpipe-22.3.6-amd-zen5-srgb.jsonl");

#[test]
fn what_an_amd_processor_stored_is_the_model_with_its_estimate_and_not_another_s() {
    let check = |model: &str| outmerge(&["vectors", "check", "--model", model, RECORDED_ON_AMD]).assert();
    check("llvmpipe:mesa=22.3,rsqrt=amd-zen5").code(0).stdout(predicate::str::contains(" 0 texels differ in 0 lines"));
    check("llvmpipe:rsqrt=intel-xeon,mesa=22.3").code(1);
}

/// Random lines of every format; the rules were fitted to others, but for a few of signed formats.
#[test]
fn what_nvidia_gpus_stored_is_their_model() {
    for file in ["nvidia-h100", "nvidia-h100-depth", "nvidia-h100-layers", "nvidia-h200"] {
        let path = format!("{}/tests/data/{file}.jsonl", env!("CARGO_MANIFEST_DIR"));
        let check = |model: &str| outmerge(&["vectors", "check", "--model", model, &path]).assert();
        check("nvidia").code(0).stdout(predicate::str::contains(" 0 texels differ in 0 lines"));
        check("exact").code(1);
    }
}

#[test]
fn undecided_texels_count_neither_way() {
    // One Zero over an infinite blue: from 25.0 on the driver stores 1 or NaN there, by what it did before.
    let line = |blue: &str| {
        let one = "0000803f".repeat(4);
        let blend = r#"{"src":"one","dst":"zero","op":"add"}"#;
        let out = u32::from_str_radix(blue, 16).expect("hex") << 22 | 0x3c0 << 11 | 0x3c0;
        let dst = 0x3e0_u32 << 22 | 0x3c0 << 11 | 0x3c0;
        let hex = |texel: u32| texel.to_le_bytes().map(|byte| format!("{byte:02x}")).concat();
        format!(
            r#"{{"format":"rg11b10ufloat","blend":{{"color":{blend},"alpha":{blend}}},"src":"{one}","dst":"{}","out":"{}"}}"#,
            hex(dst),
            hex(out)
        ) + "\n"
    };
    let text = line("1e0") + &line("3f0") + &line("1e1");
    let (_dir, path) = file("undecided.jsonl", text.as_bytes());
    let path = path.to_str().expect("a plain path");
    let check = |model: &str| outmerge(&["vectors", "check", "--model", model, path]).assert().code(1);
    let newer = "1 texels differ in 1 lines; 2 undecided: the driver's result depends on its history";
    check("llvmpipe:mesa=25.0").stdout(predicate::str::contains(newer));
    check("llvmpipe:mesa=22.3").stdout(predicate::str::contains("2 texels differ in 2 lines\n"));
}

#[test]
fn a_line_that_names_the_driver_is_read_past_and_told() {
    let driver = r#"{"kind":"driver","driver":{"adapter":"a","driver":"llvmpipe","version":"Mesa 22.3.6","processor":{"vendor":"AuthenticAMD","family":26,"model":2,"name":""}}}"#;
    let vector = r#"{"format":"r8unorm","blend":null,"src":"0000803f000000000000000000000000","dst":"00","out":"ff"}"#;
    let (_dir, path) = file("recorded.jsonl", format!("{driver}\n{vector}\n").as_bytes());
    let path = path.to_str().expect("a plain path");
    outmerge(&["vectors", "check", "--model", "exact", path])
        .assert()
        .code(0)
        .stdout(predicate::str::contains("recorded by llvmpipe Mesa 22.3.6, on AuthenticAMD family 26 model 2"));
    outmerge(&["vectors", "apply", "--model", "exact", path, "-o", "-"])
        .assert()
        .code(0)
        .stdout(predicate::str::contains("r8unorm").and(predicate::str::contains("driver").not()));
    let wrong = driver.replace("\"version\"", "\"vintage\"");
    let (_dir, path) = file("wrong.jsonl", format!("{wrong}\n").as_bytes());
    fails(
        &["vectors", "check", "--model", "exact", path.to_str().expect("plain")],
        "line 1: not a vector object: unknown field `vintage`",
    );
}
