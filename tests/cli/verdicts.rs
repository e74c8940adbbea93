//! Every command that compares, judges, merges or searches, with nothing to do, with parts that are lost, and with parts
//! that were tampered with: none of it passes.

use std::fmt::Write as _;

use tempfile::TempDir;

use super::{fails, file, files, outmerge};

/// A scene that draws nothing.
const EMPTY_SCENE: &str = "version = 1\ntitle = \"empty\"\n[target]\nwidth = 4\nheight = 4\n";

/// A scene whose only object lies outside the picture.
const UNSEEN: &str = "version = 1\ntitle = \"unseen\"\n[target]\nwidth = 4\nheight = 4\n[[material]]\nname = \"m\"\n\
                      [[object]]\nmesh = \"quad\"\nmaterial = \"m\"\nposition = [900.0, 0.0, 0.0]\n";

/// One texel of straight over that `exact` confirms.
const HOLDS: &str = r#"{"format":"rgba8unorm","blend":null,"mask":15,"constant":"00000000000000000000000000000000","dual":false,"src":"0000803f0000003f0000000000000000","src1":null,"dst":"00000000","out":"ff800000"}"#;

/// The same, one code off.
const FAILS: &str = r#"{"format":"rgba8unorm","blend":null,"mask":15,"constant":"00000000000000000000000000000000","dual":false,"src":"0000803f0000003f0000000000000000","src1":null,"dst":"00000000","out":"ff7f0000"}"#;

/// A blend on a signed target, which fixed-point models do not cover.
const NOT_COVERED: &str = r#"{"format":"rgba8snorm","blend":{"color":{"src":"one","dst":"one","op":"add"},"alpha":{"src":"one","dst":"one","op":"add"}},"mask":15,"constant":"00000000000000000000000000000000","dual":false,"src":"0000803f0000003f0000000000000000","src1":null,"dst":"00000000","out":"7f400000"}"#;

/// Exit status, stdout, stderr.
fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = outmerge(arguments).output().expect("runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

/// `arguments` with FILE replaced by a file that holds `content`.
fn with(name: &str, content: &str, arguments: &[&str]) -> (i32, String, String) {
    let (_folder, path) = file(name, content);
    let path = path.to_str().expect("UTF-8");
    run(&arguments.iter().map(|argument| if *argument == "FILE" { path } else { argument }).collect::<Vec<_>>())
}

#[test]
fn nothing_to_do_is_status_2() {
    let empty = [("empty.jsonl", ""), ("blank.jsonl", "\n\n")];
    for (name, content) in empty {
        for arguments in [
            &["vectors", "check", "--model", "exact", "FILE"][..],
            &["vectors", "judge", "FILE"],
            &["vectors", "judge", "--spec", "d3d", "FILE"],
            &["identify", "FILE"],
        ] {
            let (status, _, stderr) = with(name, content, arguments);
            assert_eq!(status, 2, "{arguments:?}: {stderr}");
            assert!(!stderr.is_empty() && !stderr.contains("panicked"), "{arguments:?}: {stderr}");
        }
    }
    for arguments in [
        &["lint", "FILE"][..],
        &["plan", "FILE"],
        &["render", "FILE", "--trap", "nan,inf,clamp"],
        &["render", "FILE", "--trap", "nan", "--json"],
    ] {
        let (status, _, stderr) = with("empty.toml", EMPTY_SCENE, arguments);
        assert_eq!((status, stderr.as_str()), (2, "outmerge: not run: nothing was compared\n"), "{arguments:?}");
    }
    for arguments in [&["plan", "FILE"][..], &["render", "FILE", "--trap", "nan,inf,clamp"]] {
        let (status, _, stderr) = with("unseen.toml", UNSEEN, arguments);
        assert_eq!((status, stderr.as_str()), (2, "outmerge: not run: nothing was compared\n"), "{arguments:?}");
    }
    let folder = TempDir::new().expect("a temporary folder");
    fails(&["texture", "--max-error", "1", folder.path().to_str().expect("UTF-8")], "no .png file");
    let csv = "state,src,dst,out\n";
    assert_eq!(with("samples.csv", csv, &["identify", "FILE"]).0, 2, "a head without samples");
}

#[test]
fn nothing_to_fill_in_leaves_no_file() {
    let (folder, path) = file("in.jsonl", "\n");
    let out = folder.path().join("out.jsonl");
    let (path, out) = (path.to_str().expect("UTF-8"), out.to_str().expect("UTF-8"));
    fails(&["vectors", "apply", "--model", "exact", path, "-o", out], "no line to fill in");
    assert_eq!(files(folder.path()), ["in.jsonl"], "no output");
}

#[test]
fn numbers_that_are_none_do_not_make_a_comparison_pass() {
    let leaf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes/leaf.png");
    for limit in ["nan", "inf", "-1"] {
        fails(&["texture", leaf, &format!("--max-error={limit}")], "--max-error");
    }
    fails(&["bound", "--tolerance", "nan"], "--tolerance");
}

#[test]
fn lines_that_the_model_does_not_cover_are_counted_and_do_not_pass_alone() {
    let check = |content: &str, json: &[&str]| {
        with("v.jsonl", content, &[&["vectors", "check", "--model", "fixed:8", "FILE"], json].concat())
    };
    let (status, text, _) = check(&format!("{NOT_COVERED}\n{HOLDS}\n"), &[]);
    assert_eq!(status, 0, "the line after the one that is not covered was compared: {text}");
    assert!(text.contains("not covered: 1 lines: ") && text.contains("fixed:8 holds: 1 lines, 1 texels"), "{text}");
    let (status, text, _) = check(&format!("{NOT_COVERED}\n{FAILS}\n"), &[]);
    assert!(status == 1 && text.contains("fixed:8 fails: 1 lines"), "{text}");
    let (status, text, stderr) = check(NOT_COVERED, &["--json"]);
    assert!(status == 2 && text.contains("\"verdict\": \"not-covered\""), "{text}");
    assert_eq!(stderr, "outmerge: not covered: no rule covers anything that was given\n");
}

#[test]
fn a_changed_digit_of_a_recorded_line_fails() {
    // Every hex digit of the result of a line, one at a time.
    let start = HOLDS.find("ff80").expect("the result");
    for at in start..start + 8 {
        let digit = &HOLDS[at..=at];
        let other = if digit == "0" { "1" } else { "0" };
        let changed = format!("{}{other}{}", &HOLDS[..at], &HOLDS[at + 1..]);
        let (status, text, _) = with("v.jsonl", &changed, &["vectors", "check", "--model", "exact", "FILE"]);
        assert_eq!(status, 1, "digit {at}: {text}");
    }
    let (status, ..) = with("v.jsonl", HOLDS, &["vectors", "check", "--model", "exact", "FILE"]);
    assert_eq!(status, 0, "unchanged");
    let line = HOLDS.replace(r#","out":"ff800000""#, "");
    let (status, _, stderr) = with("v.jsonl", &line, &["vectors", "check", "--model", "exact", "FILE"]);
    assert!(status == 2 && stderr.contains("line 1"), "a line without a result: {stderr}");
}

#[test]
fn samples_that_write_no_channel_identify_nothing() {
    let masked = HOLDS.replace(r#""mask":15"#, r#""mask":0"#).replace("ff800000", "00000000");
    let (status, _, stderr) = with("v.jsonl", &masked, &["identify", "FILE"]);
    assert!(status == 2 && stderr.contains("no sample writes a channel"), "{stderr}");
}

#[test]
fn what_any_result_conforms_to_is_not_covered_rather_than_conforming() {
    // NaN on a float target: any result does, in Vulkan.
    let line = r#"{"format":"r32float","blend":{"color":{"src":"one","dst":"one","op":"add"},"alpha":{"src":"one","dst":"one","op":"add"}},"mask":15,"constant":"00000000000000000000000000000000","dual":false,"src":"0000c07f0000c07f0000c07f0000c07f","src1":null,"dst":"00000000","out":"00000000"}"#;
    let (status, text, _) = with("v.jsonl", line, &["vectors", "judge", "--spec", "vulkan", "FILE"]);
    assert!(status == 2 && text.contains("vulkan: not covered: any result conforms"), "{text}");
}

/// The words and the exit statuses of the page are those of the program.
#[test]
fn the_page_on_verdicts_has_every_word() {
    use outmerge::verdict::Verdict;
    let page = include_str!("../../docs/verdicts.md");
    for verdict in Verdict::ALL {
        let mut row = format!("| {verdict} | `");
        write!(row, "{}` | {} |", verdict.word().replace(' ', "-"), verdict.exit_status()).expect("a string");
        assert!(page.contains(&row), "`{row}` in docs/verdicts.md");
    }
}

#[cfg(feature = "gpu")]
mod conform {
    //! `conform` without a device: all of this is found before one is opened, or is about files.

    use std::path::Path;

    use outmerge::conform::{Asked, Level, ModelOutcome, Results, Shard, UnitOutcome, file, result};

    use super::*;

    /// Results of a shard of the units with this format, every one of which model `m` fits.
    fn results(index: usize, count: usize) -> Results {
        let shard = Shard { index, count };
        let asked = Asked { only: Some("/r8unorm/".to_owned()), every_model: true, ..Asked::default() };
        let outcome = ModelOutcome { states: 1, states_matched: 1, ..ModelOutcome::default() };
        let unit = |unit: &outmerge::conform::Unit| UnitOutcome {
            texels: 16,
            states: 1,
            not_run: None,
            models: [("m".to_owned(), outcome.clone())].into(),
            ..UnitOutcome::not_run(unit, "")
        };
        let units = asked.units(Level::Full, &[shard]).map(|u| unit(&u)).collect();
        Results {
            version: result::VERSION,
            adapter: "a".to_owned(),
            driver: None,
            level: Level::Full,
            asked,
            shards: vec![shard],
            models: vec!["m".to_owned()],
            specs: Vec::new(),
            units,
        }
    }

    /// Writes results and merges them with these options.
    fn merge(parts: &[Results], options: &[&str]) -> (i32, String, String) {
        let texts: Vec<String> = parts.iter().map(|part| file::write(part).expect("JSON")).collect();
        merge_texts(&texts, options)
    }

    fn merge_texts(texts: &[String], options: &[&str]) -> (i32, String, String) {
        let folder = TempDir::new().expect("a temporary folder");
        let write = |(i, text): (usize, &String)| {
            let path = folder.path().join(format!("{i}.json"));
            std::fs::write(&path, text).expect("writable");
            path.to_str().expect("UTF-8").to_owned()
        };
        let paths: Vec<String> = texts.iter().enumerate().map(write).collect();
        let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
        run(&[&["conform", "merge"], options, &paths[..]].concat())
    }

    #[test]
    fn no_unit_is_status_2() {
        for arguments in [
            &["conform", "--only", "zzz", "--model", "llvmpipe"][..],
            &["conform", "--only", "zzz", "--list"],
            &["conform", "--only", "r8unorm", "--skip", "r8unorm", "--model", "llvmpipe"],
            &["conform", "--only", "sample-mask", "--shard", "1/900", "--list"],
        ] {
            fails(arguments, "has no unit; --list prints those of a level");
        }
        fails(&["conform", "--require", "rgba9unorm"], "--require");
    }

    #[test]
    fn a_lost_shard_is_named_and_fails() {
        let parts = [1, 2, 3].map(|index| results(index, 3));
        assert!(parts.iter().all(|part| !part.units.is_empty()), "every shard has a unit");
        let (status, text, _) = merge(&parts, &[]);
        assert!(status == 0 && text.contains("in all: holds"), "all three: {text}");
        for lost in 0..3 {
            let left: Vec<Results> = (0..3).filter(|i| *i != lost).map(|i| parts[i].clone()).collect();
            let (status, text, _) = merge(&left, &[]);
            assert_eq!(status, 1, "shard {} lost: {text}", lost + 1);
            assert!(text.contains(&format!("missing: 1 shard: {}/3", lost + 1)), "{text}");
            assert!(text.contains("in all: fails"), "{text}");
        }
    }

    #[test]
    fn a_lost_unit_is_named_and_fails() {
        let mut whole = results(1, 1);
        let lost = whole.units.remove(1).unit;
        let (status, text, _) = merge(&[whole], &[]);
        assert!(status == 1 && text.contains(&format!("missing: 1 unit: {lost}")), "{text}");
    }

    #[test]
    fn units_that_were_not_run_do_not_pass() {
        let mut none = results(1, 1);
        for unit in &mut none.units {
            unit.not_run = Some("the adapter does not render to r8unorm".to_owned());
            unit.models.clear();
        }
        let (status, text, stderr) = merge(&[none.clone()], &[]);
        assert!(status == 2 && text.contains("in all: not run"), "{text}");
        assert_eq!(stderr, "outmerge: not run: nothing was compared\n");
        // One that was run is enough, unless more is expected.
        none.units[0] = results(1, 1).units[0].clone();
        let count = none.units.len();
        assert_eq!(merge(&[none.clone()], &[]).0, 0, "one unit was run");
        let (status, _, stderr) = merge(&[none.clone()], &["--expect", &count.to_string()]);
        assert!(status == 1 && stderr.contains("1 units were run"), "{stderr}");
        assert_eq!(merge(&[none.clone()], &["--expect", "1"]).0, 0, "as expected");
        let (status, _, stderr) = merge(&[none], &["--require", "r8unorm,rgba8unorm"]);
        assert!(status == 1 && stderr.contains("--require r8unorm: unit") && stderr.contains("rgba8unorm: no unit"));
    }

    #[test]
    fn tampered_results_are_errors_that_name_the_line() {
        let text = file::write(&results(1, 1)).expect("JSON");
        let (line, unit) =
            (1..).zip(text.lines()).find(|(_, line)| line.contains("\"unit\"")).expect("a unit has a line");
        let changed = text.replacen(unit, &unit.replacen("\"states_matched\":1", "\"states_matched\":0", 1), 1);
        let (status, _, stderr) = merge_texts(&[changed], &[]);
        assert!(status == 2 && stderr.contains(&format!("line {line}: unit ")), "{stderr}");
        for (from, to) in [
            ("\"every_model\":true", "\"every_model\":false"),
            ("\"level\": \"full\"", "\"level\": \"quick\""),
            ("\"models\": [\"m\"]", "\"models\": []"),
            ("\"shards\": [\"1/1\"]", "\"shards\": [\"1/2\"]"),
            ("\"version\": 2", "\"version\": 3"),
        ] {
            assert!(text.contains(from), "{from} in {text}");
            let (status, _, stderr) = merge_texts(&[text.replacen(from, to, 1)], &[]);
            assert_eq!(status, 2, "{to}: {stderr}");
        }
        let (status, _, stderr) = merge_texts(&[text.replacen(&format!("{unit}\n"), "", 1)], &[]);
        assert!(status == 2 && stderr.contains("a unit left out"), "{stderr}");
        assert_eq!(merge_texts(&["{}".to_owned()], &[]).0, 2, "no results");
    }

    #[test]
    fn devices_side_by_side_must_be_whole() {
        let compare = |results: &Results| {
            let (_folder, path) = file("device.json", file::write(results).expect("JSON"));
            run(&["conform", "compare", path.to_str().expect("UTF-8")])
        };
        assert_eq!(compare(&results(1, 1)).0, 0, "whole");
        let (status, text, _) = compare(&results(1, 2));
        assert!(status == 1 && text.contains("missing: 1 shard: 2/2"), "{text}");
        let mut none = results(1, 1);
        none.units.iter_mut().for_each(|unit| unit.not_run = Some("no device".to_owned()));
        assert_eq!(compare(&none).0, 2, "nothing was run");
    }

    /// Logs of long runs are in the repository: their checksums hold.
    #[test]
    fn the_recorded_logs_are_whole() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/drivers");
        for name in ["lavapipe-exhaustive", "swiftshader-exhaustive", "nvidia-h100-full"] {
            let text = std::fs::read_to_string(folder.join(name).with_extension("jsonl")).expect("readable");
            let mut lines = text.lines();
            let head: serde_json::Value = serde_json::from_str(lines.next().expect("a head")).expect("JSON");
            assert_eq!(head["version"], result::VERSION, "{name}");
            for (number, line) in (2..).zip(lines) {
                let sealed = serde_json::from_str(line).expect("JSON");
                let unit = outmerge::conform::unseal(sealed).unwrap_or_else(|error| panic!("{name}:{number}: {error}"));
                assert!(unit.not_run.is_none(), "{name}:{number}: a log has what was run");
            }
        }
    }
}
