//! The directory runner of the test kit, as another crate would use it (`harness = false`), and tests of itself: it lists
//! as libtest does, which is what cargo-nextest reads, and a wrong file fails under its name.

use std::process::{Command, ExitCode};

use outmerge::model::registry;
use outmerge::testkit::{Actual, Runner};

/// Another folder of vectors, for the runs of ourselves below.
const FOLDER: &str = "OUTMERGE_TEST_FOLDER";

fn main() -> ExitCode {
    if let Some(folder) = std::env::var_os(FOLDER) {
        return Runner::new().vectors(folder, "f32").main();
    }
    Runner::new()
        .vectors("examples/vectors", "f32")
        .scenes("examples/scenes", "f32", |scene| {
            // A renderer under test would draw the scene here and read its target back.
            let model = registry::by_name("f32")?;
            let mut rendered = scene.render(model.as_ref())?;
            Ok(Actual::from(rendered.framebuffer.colors[0].take().ok_or("no color target")?))
        })
        .test("lists_as_libtest_does", lists_as_libtest_does)
        .test("a_wrong_file_fails_under_its_name", a_wrong_file_fails_under_its_name)
        .test("a_folder_without_files_fails", a_folder_without_files_fails)
        .main()
}

/// Status and stdout of ourselves.
fn ourselves(arguments: &[&str], folder: Option<&std::path::Path>) -> Result<(Option<i32>, String), String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new(program);
    command.args(arguments);
    if let Some(folder) = folder {
        command.env(FOLDER, folder);
    }
    let output = command.output().map_err(|error| error.to_string())?;
    Ok((output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned()))
}

fn check(holds: bool, what: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what.to_owned()) }
}

fn lists_as_libtest_does() -> Result<(), String> {
    let (status, text) = ourselves(&["--list", "--format", "terse"], None)?;
    check(status == Some(0), "listing succeeds")?;
    check(text.lines().all(|line| line.ends_with(": test")), &format!("`name: test` on every line: {text}"))?;
    for name in ["fade.jsonl: test", "png-leaf.toml: test", "lists_as_libtest_does: test"] {
        check(text.lines().any(|line| line == name), &format!("`{name}` in {text}"))?;
    }
    let (_, ignored) = ourselves(&["--list", "--format", "terse", "--ignored"], None)?;
    check(ignored.is_empty(), &format!("nothing is ignored: {ignored}"))?;
    let (status, text) = ourselves(&["--exact", "fade.jsonl", "--nocapture"], None)?;
    check(status == Some(0) && text.contains("1 passed"), &format!("one test by its name: {text}"))
}

fn a_wrong_file_fails_under_its_name() -> Result<(), String> {
    let folder = tempfile::TempDir::new().map_err(|error| error.to_string())?;
    let right = std::fs::read_to_string("examples/vectors/fade.jsonl").map_err(|error| error.to_string())?;
    std::fs::write(folder.path().join("right.jsonl"), &right).map_err(|error| error.to_string())?;
    let mut line =
        outmerge::vectors::VectorLine::parse(right.lines().next().ok_or("a line")?).map_err(|e| e.to_string())?;
    line.out.as_mut().ok_or("has results")?[0] ^= 1;
    std::fs::write(folder.path().join("wrong.jsonl"), line.to_json()).map_err(|error| error.to_string())?;
    std::fs::write(folder.path().join("broken.jsonl"), "{}").map_err(|error| error.to_string())?;
    std::fs::write(folder.path().join("empty.jsonl"), "").map_err(|error| error.to_string())?;
    let (status, text) = ourselves(&[], Some(folder.path()))?;
    check(status == Some(101), &format!("status 101 as libtest: {status:?}"))?;
    for part in ["1 passed; 3 failed", "line 1, texel 0", "not run: nothing was compared"] {
        check(text.contains(part), &format!("`{part}` in {text}"))?;
    }
    check(text.lines().any(|line| line.contains("right.jsonl") && line.ends_with("ok")), &text)
}

fn a_folder_without_files_fails() -> Result<(), String> {
    let folder = tempfile::TempDir::new().map_err(|error| error.to_string())?;
    let (status, text) = ourselves(&[], Some(folder.path()))?;
    check(status == Some(101) && text.contains("no file ends in .jsonl"), &format!("{status:?}: {text}"))?;
    let (status, _) = ourselves(&[], Some(&folder.path().join("missing")))?;
    check(status == Some(101), "a missing folder fails too")
}
