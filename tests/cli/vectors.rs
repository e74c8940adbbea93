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
