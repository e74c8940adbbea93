//! What may go wrong around the command: closed pipes, full disks, interrupts, inputs beyond the limits.
#![cfg(unix)]

use std::os::unix::fs::FileTypeExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::{fails, file, files, outmerge};
use tempfile::TempDir;

/// The command as a process of its own.
fn process(arguments: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("outmerge"));
    command.args(arguments);
    command
}

const EVERY_PRINTER: [&[&str]; 12] = [
    &["models"],
    &["formats", "--json"],
    &["presets"],
    &["scenes"],
    &["explain", "--state", "fade", "--format", "rgba8unorm", "--src", "0,0,0,0.5", "--dst", "#7f7f7fff"],
    &["fixpoint", "--alpha", "0.5", "--source", "0"],
    &["bound", "--layers", "8", "--alpha", "0.5", "--format", "rgba8unorm"],
    &["plan", "cutout-quad", "--json"],
    &["render", "cutout-quad", "-o", "-"],
    &["completions", "bash"],
    &["man"],
    &["--help"],
];

#[test]
fn a_closed_pipe_ends_every_printing_command_quietly() {
    for arguments in EVERY_PRINTER {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let child = process(arguments).stdout(writer).stderr(Stdio::piped()).spawn().expect("runs");
        let output = child.wait_with_output().expect("ends");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {stderr}");
        assert!(stderr.is_empty(), "{arguments:?}: no complaint: {stderr}");
    }
}

#[test]
fn a_full_stdout_is_an_error_and_a_full_stderr_is_none() {
    let full = || std::fs::File::options().write(true).open("/dev/full").expect("Linux has it");
    for arguments in EVERY_PRINTER.iter().filter(|arguments| arguments[0] != "--help") {
        let output = process(arguments).stdout(full()).output().expect("runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains("No space left"), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    }
    let output = process(&["render", "no-such-scene", "-o", "x.png"]).stderr(full()).output().expect("runs");
    assert_eq!(output.status.code(), Some(2), "the status tells when nobody can hear the reason");
}

#[test]
fn a_device_is_written_to_and_not_replaced() {
    fails(&["render", "cutout-quad", "-o", "/dev/full"], "cannot write /dev/full");
    let kind = std::fs::metadata("/dev/full").expect("still there").file_type();
    assert!(kind.is_char_device(), "/dev/full is still a device");
    outmerge(&["render", "cutout-quad", "-o", "/dev/null"]).assert().success();
    let folder = TempDir::new().expect("a temporary folder");
    fails(&["render", "cutout-quad", "-o", folder.path().to_str().expect("UTF-8")], "it is a folder");
}

#[test]
fn a_link_is_followed() {
    let (folder, target) = file("target.png", "old");
    let link = folder.path().join("link.png");
    std::os::unix::fs::symlink(&target, &link).expect("links are possible");
    outmerge(&["render", "cutout-quad", "-o", link.to_str().expect("UTF-8")]).assert().success();
    assert!(link.is_symlink(), "still a link");
    let bytes = std::fs::read(&target).expect("readable");
    assert!(bytes.starts_with(b"\x89PNG"), "the linked file holds the picture");
    assert_eq!(files(folder.path()), ["link.png", "target.png"], "and nothing else");
}

#[test]
fn a_full_disk_leaves_the_old_file_and_no_partial_one() {
    let (folder, path) = file("out.jsonl", "old\n");
    // A limit on file sizes fails writes as a full disk does.
    let script = format!(
        "trap '' XFSZ; ulimit -f 8; exec '{}' vectors generate --model f32 --lines 200 -o '{}'",
        assert_cmd::cargo::cargo_bin("outmerge").display(),
        path.display()
    );
    let output = Command::new("bash").args(["-c", &script]).output().expect("bash runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("cannot write") && stderr.contains("out.jsonl"), "{stderr}");
    assert_eq!(files(folder.path()), ["out.jsonl"], "no partial file");
    assert_eq!(std::fs::read_to_string(&path).expect("readable"), "old\n", "the old file is whole");
}

#[test]
fn an_interrupted_run_leaves_no_partial_file() {
    let folder = TempDir::new().expect("a temporary folder");
    let out = folder.path().join("out.jsonl");
    let endless = ["--model", "exact", "--lines", "1000000", "--texels", "1024", "-o", out.to_str().expect("UTF-8")];
    for signal in ["-INT", "-TERM"] {
        let mut child = process(&["vectors", "generate"]).args(endless).stderr(Stdio::null()).spawn().expect("runs");
        let started = Instant::now();
        while files(folder.path()).is_empty() {
            assert!(started.elapsed() < Duration::from_secs(60), "the run starts to write");
            std::thread::sleep(Duration::from_millis(20));
        }
        let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill runs");
        assert!(killed.success(), "{signal} is sent");
        let status = child.wait().expect("ends");
        assert_eq!(status.code(), Some(130), "{signal}");
        assert!(files(folder.path()).is_empty(), "{signal}: {:?}", files(folder.path()));
    }
}

const SCENE: &str = r#"version = 1
title = "Limits"
[target]
width = 16
height = 16
depth = "none"
[[texture]]
name = "a"
pattern = "checker"
size = [64, 64]
space = "linear"
[[texture]]
name = "b"
pattern = "checker"
size = [64, 64]
space = "linear"
[[mesh]]
name = "ball"
sphere-segments = 16
[[material]]
name = "plain"
[[object]]
mesh = "ball"
material = "plain"
"#;

#[test]
fn every_limit_can_be_lowered_and_raised() {
    let (_scene_folder, scene) = file("scene.toml", SCENE);
    let (_image_folder, image) = file("image.png", "");
    outmerge(&["render", "cutout-quad", "-o", image.to_str().expect("UTF-8")]).assert().success();
    let (_vector_folder, vectors) = file("v.jsonl", "");
    outmerge(&["vectors", "generate", "--model", "f32", "--lines", "1", "-o", vectors.to_str().expect("UTF-8")])
        .assert()
        .success();
    let (obj_folder, obj) = file("scene.toml", SCENE.replace("sphere-segments = 16", "file = \"m.obj\""));
    std::fs::write(obj_folder.path().join("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("writable");

    let text = |path: &std::path::Path| path.to_str().expect("UTF-8").to_owned();
    let render = |scene: &str| ["render", scene, "-o", "/dev/null"].map(str::to_owned).to_vec();
    let texture = ["texture".to_owned(), text(&image)].to_vec();
    let check = ["vectors".to_owned(), "check".to_owned(), "--model".to_owned(), "f32".to_owned(), text(&vectors)];
    let bound = ["bound", "--layers", "100", "--alpha", "0.5", "--format", "rgba8unorm"];
    for (limit, low, arguments, place) in [
        ("scene-bytes", "100", render(&text(&scene)), "scene.toml"),
        ("target-bytes", "1023", render(&text(&scene)), "`target`"),
        ("texture-bytes", "65K", render(&text(&scene)), "`texture[1]`"),
        ("vertices", "1300", render(&text(&scene)), "`mesh[0]`"),
        ("import-bytes", "20", render(&text(&obj)), "m.obj"),
        ("image-bytes", "60", texture.clone(), "image.png"),
        ("image-texels", "100", texture, "image.png"),
        ("line-bytes", "1K", check.to_vec(), "line 1"),
        ("objects", "0", render(&text(&scene)), "`object`"),
        ("entries", "0", render(&text(&scene)), "`texture`"),
        (
            "passes",
            "1",
            render(concat!(env!("CARGO_MANIFEST_DIR"), "/src/scene/bundled/vegetation-three-trees.toml")),
            "`material[",
        ),
        ("layers", "99", bound.map(str::to_owned).to_vec(), "100 layers"),
    ] {
        let with = |value: &str| {
            let setting = format!("--limit={limit}={value}");
            arguments.iter().cloned().chain([setting]).collect::<Vec<_>>()
        };
        let lowered = with(low);
        let lowered: Vec<&str> = lowered.iter().map(String::as_str).collect();
        fails(&lowered, limit);
        fails(&lowered, place);
        let raised = with("8G");
        outmerge(&raised.iter().map(String::as_str).collect::<Vec<_>>()).assert().success();
    }
    fails(&["models", "--limit", "textures=1"], "there is no limit `textures`");
    fails(&["models", "--limit", "vertices=many"], "whole number");
}

#[test]
fn deep_nesting_is_an_error_and_no_stack_overflow() {
    let deep = 200_000;
    for (name, text) in [
        ("deep.toml", format!("version = 1\ntitle = {}", "[".repeat(deep))),
        ("tables.toml", format!("version = 1\nx = {}", "{ a = ".repeat(deep))),
        ("deep.json", format!("{{\"version\": 1, \"x\": {}", "[".repeat(deep))),
        ("closed.json", format!("{{\"version\": 1, \"x\": {}{}}}", "[".repeat(deep), "]".repeat(deep))),
    ] {
        let (_folder, path) = file(name, text);
        fails(&["render", path.to_str().expect("UTF-8"), "-o", "/dev/null"], name);
    }
    let braces = "Category { ".repeat(deep / 20);
    fails(
        &["explain", "--state", &braces, "--format", "rgba8unorm", "--src", "0,0,0,0", "--dst", "#00000000"],
        "line 1",
    );
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let listed = outmerge(&["--help"]).output().expect("runs");
    let help = String::from_utf8_lossy(&listed.stdout).into_owned();
    let commands: Vec<&str> = help
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"))
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.len() >= 15, "the help lists the commands: {commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = outmerge(&["completions", shell]).output().expect("runs");
        let script = String::from_utf8_lossy(&output.stdout);
        for command in &commands {
            assert!(script.contains(command), "{shell}: {command}");
        }
    }
    let (_folder, script) = file("outmerge.bash", outmerge(&["completions", "bash"]).output().expect("runs").stdout);
    assert!(
        Command::new("bash").arg("-n").arg(&script).status().expect("bash runs").success(),
        "bash reads the script"
    );
    let folder = TempDir::new().expect("a temporary folder");
    outmerge(&["man", "-o", folder.path().to_str().expect("UTF-8")]).assert().success();
    let pages = files(folder.path());
    for command in &commands {
        assert!(pages.contains(&format!("outmerge-{command}.1")), "{command}: {pages:?}");
    }
    assert!(pages.contains(&"outmerge-vectors-check.1".to_owned()), "subcommands of subcommands: {pages:?}");
    for page in &pages {
        let text = std::fs::read_to_string(folder.path().join(page)).expect("readable");
        assert!(text.contains(".TH") && text.contains("SYNOPSIS"), "{page} is a manual page");
    }
}
