//! The command line from outside: what it prints, what it writes, and how it fails.
//!
//! Golden texts are in `tests/golden`; after a wanted change, run once with `OUTMERGE_BLESS=1` and read the diff.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use predicates::prelude::{PredicateBooleanExt, predicate};
use tempfile::TempDir;

/// The command, ready to take arguments.
fn outmerge(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("outmerge").expect("the binary is built with the tests");
    command.args(arguments);
    command
}

/// A new folder with one file in it.
fn file(name: &str, content: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("writable");
    (folder, path)
}

/// Names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("readable");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Exit status 2, nothing on stdout, one paragraph on stderr that says `expected`, no panic.
fn fails(arguments: &[&str], expected: &str) {
    let output = outmerge(arguments).output().expect("runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: status; stderr: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments:?}: nothing on stdout");
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    assert!(stderr.contains(expected), "{arguments:?}: `{expected}` in: {stderr}");
    assert!(stderr.lines().count() <= 8 && stderr.len() <= 2000, "{arguments:?}: one paragraph: {stderr}");
}

mod explain {
    use super::*;

    fn golden(name: &str, arguments: &[&str]) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
        let output = outmerge(arguments).output().expect("runs");
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{name}: lines fit 120 columns");
        if std::env::var_os("OUTMERGE_BLESS").is_some() {
            std::fs::write(&path, &text).expect("writable");
        }
        let wanted = std::fs::read_to_string(&path).expect("the golden file is committed");
        assert!(text == wanted, "{name} differs from the golden text; now:\n{text}");
    }

    #[test]
    fn fade_at_one_half_over_mid_grey() {
        golden("fade-half-over-grey.txt", &["explain", "--state", "fade", "--src", "0,0,0,0.5", "--dst", "#7f7f7fff"]);
    }

    #[test]
    fn premultiplied_over_half_floats() {
        let state = "Blend One OneMinusSrcAlpha";
        golden(
            "premultiplied-on-half.txt",
            &["explain", "--state", state, "-f", "rgba16float", "--src", "0.3,0.9,1.5,0.4", "--dst", "0.2,0.5,0.7,0.5"],
        );
    }

    #[test]
    fn fade_on_srgb_in_fixed_point() {
        golden(
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
        golden(
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
}

mod scenes {
    use super::*;

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
}

mod vectors {
    use super::*;

    const LINE: &str = concat!(
        r#"{"format":"rgba8unorm","blend":{"color":{"src":"src-alpha","dst":"one-minus-src-alpha","op":"add"},"#,
        r#""alpha":{"src":"one","dst":"zero","op":"add"}},"mask":15,"constant":"00000000000000000000000000000000","#,
        r#""dual":false,"src":"0000803f0000003f000000000000003f","src1":null,"dst":"7f7f7fff","out":"bf7f4080"}"#
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
}

#[test]
fn a_closed_pipe_is_no_error() {
    use std::process::{Command, Stdio};
    let binary = assert_cmd::cargo::cargo_bin("outmerge");
    let mut child = Command::new(binary)
        .args(["vectors", "generate", "--model", "f32", "-o", "-", "--lines", "400"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("ends");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.is_empty(), "no complaint: {stderr}");
}

#[test]
fn lists_name_what_there_is() {
    for (list, known) in
        [("models", "llvmpipe"), ("formats", "rg11b10ufloat"), ("presets", "fade"), ("scenes", "cutout-quad")]
    {
        outmerge(&[list]).assert().success().stdout(predicate::str::contains(known));
        let output = outmerge(&[list, "--json"]).output().expect("runs");
        serde_json::from_slice::<Vec<serde_json::Value>>(&output.stdout).expect("a JSON list");
    }
}
