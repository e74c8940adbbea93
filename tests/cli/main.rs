//! The command line from outside: what it prints, what it writes, and how it fails.
//!
//! Golden texts are in `tests/golden`; see [`golden`].

mod analysis;
mod explain;
mod golden;
mod identify;
mod lint;
mod plan;
mod robust;
mod scenes;
mod schemas;

mod vectors;
mod verdicts;

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use predicates::prelude::predicate;
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
    let paragraph = !stderr.trim_end().contains("\n\n") && stderr.lines().count() <= 8 && stderr.len() <= 2000;
    assert!(paragraph, "{arguments:?}: one paragraph: {stderr}");
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
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(json["of"], list, "what is listed");
        assert!(json["entries"].as_array().is_some_and(|entries| entries.len() > 5), "{json}");
    }
}
