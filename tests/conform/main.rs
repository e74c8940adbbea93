//! `outmerge conform` as a program: sweeps of a real device, shards, resuming, exit status.

use std::io::Write as _;
use std::path::Path;

use assert_cmd::Command;
use predicates::prelude::*;
use serde_json::Value;

/// The program, on the required adapter.
fn conform() -> Command {
    let mut command = Command::cargo_bin("outmerge").expect("the program");
    command.arg("conform");
    command
}

fn adapter() -> Vec<String> {
    std::env::var("OUTMERGE_REQUIRE_ADAPTER").map_or_else(|_| Vec::new(), |name| vec!["--adapter".to_owned(), name])
}

/// Whether there is llvmpipe to sweep; a missing one that is required fails, any other is said on stderr.
fn has_llvmpipe(test: &str) -> bool {
    let output = conform().arg("adapters").output().expect("runs");
    let adapters = String::from_utf8(output.stdout).expect("text");
    let found = adapters.contains("llvmpipe");
    let required = std::env::var_os("OUTMERGE_REQUIRE_ADAPTER").is_some();
    assert!(found || !required, "the required adapter is missing; there are:\n{adapters}");
    if !found {
        let _ = writeln!(std::io::stderr(), "{test}: skipped: no llvmpipe");
    }
    found
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("the file")).expect("JSON")
}

/// The units of a result file without their run times, and the checksums that these are part of.
fn units(results: &Value) -> Vec<Value> {
    let mut units = results["units"].as_array().expect("units").clone();
    for unit in &mut units {
        unit.as_object_mut().expect("a unit").retain(|name, _| name != "seconds" && name != "checksum");
    }
    units
}

#[test]
fn shards_list_each_unit_of_a_level_once() {
    let list = |arguments: &[&str]| {
        let output = conform().args(["--list", "--level", "full"]).args(arguments).output().expect("runs");
        String::from_utf8(output.stdout).expect("text").lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let mut parts: Vec<String> = ["1/3", "2/3", "3/3"].iter().flat_map(|shard| list(&["--shard", shard])).collect();
    let mut whole = list(&[]);
    assert!(whole.len() > 100, "a level of many units");
    parts.sort();
    whole.sort();
    assert_eq!(parts, whole, "three shards make the level");
}

#[test]
fn an_adapter_that_is_not_there_is_an_error() {
    conform()
        .args(["--adapter", "no such adapter"])
        .assert()
        .code(2)
        .stderr(predicate::str::contains("no such adapter").and(predicate::str::contains("panicked").not()));
}

#[test]
fn merged_shards_equal_the_whole_and_junit_has_every_unit() {
    if !has_llvmpipe("merged_shards_equal_the_whole_and_junit_has_every_unit") {
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name);
    let sweep = |shard: &str, name: &str| {
        conform()
            .args(adapter())
            .args(["--model", "llvmpipe", "--only", "/r8unorm/", "--shard", shard, "--json-file"])
            .arg(path(name))
            .assert()
            .code(0);
    };
    sweep("1/1", "whole.json");
    sweep("1/2", "a.json");
    sweep("2/2", "b.json");
    conform()
        .args(["merge", "--output"])
        .arg(path("merged.json"))
        .arg("--junit")
        .arg(path("junit.xml"))
        .arg("--markdown")
        .arg(path("table.md"))
        // In any order.
        .args([path("b.json"), path("a.json")])
        .assert()
        .code(0)
        .stdout(predicate::str::contains("holds: 25 states"));
    assert_eq!(units(&json(&path("merged.json"))), units(&json(&path("whole.json"))), "merged shards");

    let junit = std::fs::read_to_string(path("junit.xml")).expect("JUnit");
    for unit in units(&json(&path("whole.json"))) {
        let name = unit["unit"].as_str().expect("a name");
        assert!(junit.contains(&format!("name=\"{name}\"")), "{name} in {junit}");
    }
    let table = std::fs::read_to_string(path("table.md")).expect("Markdown");
    assert!(table.contains("| r8unorm | 360448 | 25/25 |"), "{table}");

    conform()
        .arg("merge")
        .args([path("a.json"), path("a.json")])
        .assert()
        .code(2)
        .stderr(predicate::str::contains("more than one of the results"));
}

#[test]
fn an_interrupted_run_goes_on_after_its_last_finished_unit() {
    if !has_llvmpipe("an_interrupted_run_goes_on_after_its_last_finished_unit") {
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name);
    let sweep = |result: &str, level: &str| {
        conform()
            .args(adapter())
            .args(["--model", "llvmpipe", "--only", "/r8unorm/", "--level", level, "--log"])
            .arg(path("log"))
            .arg("--json-file")
            .arg(path(result))
            .assert()
    };
    sweep("first.json", "quick").code(0);
    let log = std::fs::read_to_string(path("log")).expect("a log");
    let lines: Vec<&str> = log.lines().collect();
    assert_eq!(lines.len(), 3, "a header and two units");
    // Interrupted while writing the second unit.
    std::fs::write(path("log"), format!("{}\n{}\n{}", lines[0], lines[1], &lines[2][..20])).expect("written");

    sweep("second.json", "quick").code(0);
    let (first, second) = (json(&path("first.json")), json(&path("second.json")));
    assert_eq!(units(&second), units(&first), "the same results");
    // A log holds a unit once: the finished one was taken from there, run time and all, and the other one was run.
    assert_eq!(second["units"][0]["seconds"], first["units"][0]["seconds"], "taken from the log");
    let again = std::fs::read_to_string(path("log")).expect("a log");
    assert_eq!(again.lines().take(2).collect::<Vec<_>>(), lines[..2], "nothing finished was run again");
    assert_eq!(again.lines().count(), 3, "the other unit was added");

    sweep("third.json", "full")
        .code(2)
        .stderr(predicate::str::contains("another adapter, driver, processor, level, models or specifications"));
}

#[cfg(feature = "gl")]
#[test]
fn mesas_opengl_blends_as_its_vulkan_does() {
    let run = |gallium: &str, name: &str| {
        conform()
            .env("EGL_PLATFORM", "surfaceless")
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .env("GALLIUM_DRIVER", gallium)
            .args(["--adapter", name, "--model", "llvmpipe", "--only", "blend/rgba8unorm/src-alpha/"])
            .output()
            .expect("runs")
    };
    let output = run("llvmpipe", "gl:llvmpipe");
    let errors = String::from_utf8(output.stderr).expect("text");
    if errors.contains("no OpenGL adapter") {
        // EGL is no part of the Vulkan driver's package.
        let _ = writeln!(std::io::stderr(), "mesas_opengl_blends_as_its_vulkan_does: skipped: no llvmpipe through EGL");
        return;
    }
    let table = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success() && table.contains("holds: 51 states"), "{table}{errors}");

    let missing = run("llvmpipe", "gl:no such adapter");
    assert_eq!(missing.status.code(), Some(2), "a name that OpenGL does not have");
    let errors = String::from_utf8(missing.stderr).expect("text");
    assert!(errors.contains("no OpenGL adapter whose name"), "{errors}");
}

#[cfg(not(feature = "gl"))]
#[test]
fn opengl_is_refused_by_a_build_without_it() {
    conform()
        .args(["--adapter", "gl:"])
        .assert()
        .code(2)
        .stderr(predicate::str::contains("build with the feature `gl`"));
}

#[test]
fn a_model_that_does_not_fit_fails_when_it_was_named() {
    if !has_llvmpipe("a_model_that_does_not_fit_fails_when_it_was_named") {
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let junit = dir.path().join("junit.xml");
    let unit = ["--only", "blend/rgba8unorm/src-alpha/"];
    conform()
        .args(adapter())
        .args(unit)
        .args(["--model", "exact", "--junit"])
        .arg(&junit)
        .assert()
        .code(1)
        .stdout(predicate::str::contains("fails: ").and(predicate::str::contains("expected")));
    let xml = std::fs::read_to_string(junit).expect("JUnit");
    assert!(xml.contains("failures=\"1\"") && xml.contains("texels differ"), "{xml}");
    // Without a name the question is which model fits, and any answer is one.
    let output = conform().args(adapter()).args(unit).arg("--json").output().expect("runs");
    assert_eq!(output.status.code(), Some(0), "a survey");
    let results: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let models = results["units"][0]["models"].as_object().expect("by model");
    let mismatches = |model: &str| {
        let (_, outcome) = models.iter().find(|(name, _)| name.starts_with(model))?;
        outcome["mismatches"].as_u64()
    };
    assert_eq!(mismatches("llvmpipe"), Some(0), "the model of this device");
    assert!(mismatches("exact") > Some(0), "another model");
    assert_eq!(results["version"], 2, "the schema's version");
}

#[test]
fn a_specification_that_admits_every_result_passes_and_one_that_does_not_is_a_finding() {
    if !has_llvmpipe("a_specification_that_admits_every_result_passes_and_one_that_does_not_is_a_finding") {
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let junit = dir.path().join("junit.xml");
    let judge = |unit: &str| {
        let mut command = conform();
        command.args(adapter()).args(["--spec", "vulkan", "--only", unit]).arg("--junit").arg(&junit);
        command.assert()
    };
    judge("store/rgba16unorm/").code(0).stdout(predicate::str::contains("vulkan         holds: 1 states"));
    let xml = std::fs::read_to_string(&junit).expect("JUnit");
    assert!(xml.contains("vulkan on llvmpipe") && xml.contains("failures=\"0\""), "{xml}");
    // The driver stores -1.1 as -128, which reads as -1; Vulkan clamps first and stores -127.
    judge("store/rgba8snorm/")
        .code(1)
        .stdout(predicate::str::contains("fails: 1 of 1 states").and(predicate::str::contains("admits exact")));
    let xml = std::fs::read_to_string(&junit).expect("JUnit");
    assert!(xml.contains("failures=\"1\"") && xml.contains("outside what vulkan admits"), "{xml}");
}

#[test]
fn the_driver_is_identified_from_its_own_answers() {
    if !has_llvmpipe("the_driver_is_identified_from_its_own_answers") {
        return;
    }
    let mut command = Command::cargo_bin("outmerge").expect("the program");
    let output = command.args(["identify", "--adapter", "llvmpipe", "--json"]).output().expect("runs");
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(output.status.code(), Some(0), "{found}");
    let names = found["reproduced_by"].as_array().expect("names");
    assert!(names.len() == 1 && names[0].as_str().is_some_and(|name| name.starts_with("llvmpipe:mesa=")), "{names:?}");
    assert_eq!(found["settled"], true, "{names:?}");
    let formats = found["rests_on"].as_array().expect("formats");
    assert!(formats.len() > 20, "every format the driver renders to: {formats:?}");
    // On one format fewer drivers may be told apart, and the answer says what it rests on.
    let mut command = Command::cargo_bin("outmerge").expect("the program");
    let one = ["identify", "--format", "rgba16float", "--adapter", "llvmpipe", "--json"];
    let output = command.args(one).output().expect("runs");
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let formats = found["rests_on"].as_array().expect("formats");
    assert_eq!(formats.len(), 1, "{formats:?}");
    assert!(
        found["reproduced_by"].as_array().is_some_and(|names| names.len() > 1),
        "widths and processors do not show"
    );
}

#[test]
fn the_driver_is_a_point_of_the_tradeoff_with_the_errors_of_its_model() {
    if !has_llvmpipe("the_driver_is_a_point_of_the_tradeoff_with_the_errors_of_its_model") {
        return;
    }
    let mut command = Command::cargo_bin("outmerge").expect("the program");
    command.args(["tradeoff", "--formats", "rgba8unorm", "--models", "llvmpipe", "-n", "1", "--json"]);
    let output = command.args(["--adapter", "llvmpipe"]).output().expect("runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let measured: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let points = measured["points"].as_array().expect("points");
    let of = |driver: bool| points.iter().filter(move |p| (p["model"] == "driver llvmpipe") == driver);
    assert_eq!((of(true).count(), of(false).count()), (1, 1), "both: {points:?}");
    for (driver, model) in of(true).zip(of(false)) {
        for figure in ["format", "layers", "max", "mean", "rms", "bias", "pixels_off"] {
            assert_eq!(driver[figure], model[figure], "{figure}: {driver} and {model}");
        }
        assert!(driver["ns_per_fragment"].as_f64() > Some(0.0), "timed: {driver}");
    }
}
