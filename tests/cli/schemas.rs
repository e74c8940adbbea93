//! The JSON of every command has the form that `docs/schemas` says, its version included.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use super::outmerge;

/// A command for each form, and for forms with several shapes one for each; FOLDER is a temporary folder.
const COMMANDS: &[(&str, &[&str])] = &[
    ("bound", &["bound", "-n", "20", "--search", "--format", "rgba8unorm"]),
    ("bound", &["bound", "-n", "20"]),
    ("explain", &["explain", "--state", "fade", "--src", "0,0,0,0.5", "--dst", "#7f7f7fff"]),
    ("explain", &["explain", "--state", "fade", "-f", "rgba16snorm", "--src", "nan,inf,-3,0.5", "--dst", "0,0,0,1"]),
    ("explain-pixel", &["explain", "stencil-cutout", "--pixel", "40,40", "--stack"]),
    ("explain-pixel", &["explain", "light-passes", "--pixel", "48,48", "--stack"]),
    ("fixpoint", &["fixpoint"]),
    ("fixpoint", &["fixpoint", "--state", "zero one-minus-dst", "--alpha", "0.5"]),
    ("fixpoint-every", &["fixpoint", "--every", "--model", "fixed:8"]),
    ("identify", &["identify", "--of", "f16", "--format", "rgba8unorm"]),
    ("identify", &["identify", "tests/data/nvidia-h200.jsonl"]),
    ("lint", &["lint", "overlap-zwrite-on"]),
    ("lint", &["lint", "opaque"]),
    ("list", &["models"]),
    ("list", &["formats"]),
    ("list", &["scenes"]),
    ("list", &["presets"]),
    ("plan", &["plan", "cutout-quad"]),
    ("plan", &["plan", "stencil-cutout"]),
    ("report", &["report", "fade-over-opaque", "--models", "f32", "-o", "FOLDER"]),
    ("report", &["report", "cutout-quad", "--models", "f32", "-o", "FOLDER", "--analyses"]),
    ("stability", &["stability", "-n", "8", "--models", "exact,f16", "--scenes", "fade-over-opaque"]),
    ("texture", &["texture", "examples/scenes/leaf.png", "--models", "f32", "--max-error", "200"]),
    ("texture", &["texture", "examples/scenes/leaf.png", "--models", "f32"]),
    ("tradeoff", &["tradeoff", "--formats", "rgba8unorm", "--models", "exact,f32", "-n", "1", "--no-adapter"]),
    ("trap", &["render", "fade-over-opaque", "--trap", "nan,inf,clamp"]),
    ("trap", &["render", "fire-and-smoke", "--trap", "clamp"]),
    ("vectors-check", &["vectors", "check", "--model", "exact", "tests/data/nvidia-h200.jsonl", "--report"]),
    ("vectors-check", &["vectors", "check", "--model", "fixed:8", "tests/data/nvidia-h200.jsonl", "--report"]),
    ("vectors-judge", &["vectors", "judge", "tests/data/nvidia-h200.jsonl"]),
];

/// The form that `conform` writes; without a device it is the merge of a file.
#[cfg(feature = "gpu")]
const OF_CONFORM: &str = "conform";

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("docs/schemas/{name}.json"))
}

fn holds(name: &str, value: &Value) {
    let (mut schemas, mut compiler) = (boon::Schemas::new(), boon::Compiler::new());
    let file = path(name);
    let schema = compiler.compile(&file.to_string_lossy(), &mut schemas);
    let schema = schema.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    if let Err(error) = schemas.validate(value, schema) {
        let shown: String = format!("{error:#}").chars().take(2000).collect();
        panic!("{name}: {shown}");
    }
    assert_eq!(value["schema"], name, "the form names itself");
    assert!(value["version"].is_u64(), "{name}: a version");
}

fn run(arguments: &[&str]) -> Value {
    let folder = TempDir::new().expect("a temporary folder");
    let folder = folder.path().to_str().expect("UTF-8");
    let mut arguments: Vec<&str> = arguments.iter().map(|a| if *a == "FOLDER" { folder } else { a }).collect();
    if !arguments.contains(&"--report") {
        arguments.push("--json");
    }
    if arguments[0] == "report" && cfg!(feature = "gpu") {
        arguments.push("--no-device");
    }
    let output = outmerge(&arguments).output().expect("runs");
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{arguments:?}: {error}: {}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn every_command_s_json_has_the_form_that_is_documented() {
    for (name, arguments) in COMMANDS {
        holds(name, &run(arguments));
    }
}

#[cfg(feature = "gpu")]
#[test]
fn result_files_of_conform_have_the_form_that_is_documented() {
    use outmerge::conform::{Asked, Level, Results, Shard, UnitOutcome, file, result};
    let asked = Asked { only: Some("/r8unorm/".to_owned()), texels: Some(64), every_model: false, ..Asked::default() };
    let units = asked.units(Level::Quick, &[Shard::ALL]).map(|unit| UnitOutcome::not_run(&unit, "no device")).collect();
    let results = Results {
        version: result::VERSION,
        adapter: "a".to_owned(),
        driver: None,
        level: Level::Quick,
        asked,
        shards: vec![Shard::ALL],
        models: vec!["exact".to_owned()],
        specs: vec!["vulkan".to_owned()],
        units,
    };
    let text = file::write(&results).expect("JSON");
    holds(OF_CONFORM, &serde_json::from_str(&text).expect("JSON"));
}

#[test]
fn every_schema_is_used_and_says_what_it_is_of() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/schemas");
    let files = std::fs::read_dir(folder).expect("readable").map(|entry| entry.expect("readable").path());
    let stem = |path: PathBuf| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let found: BTreeSet<String> =
        files.filter(|path| path.extension().is_some_and(|e| e == "json")).map(stem).collect();
    let used = COMMANDS.iter().map(|(name, _)| (*name).to_owned()).chain(["conform".to_owned()]);
    assert_eq!(found, used.collect(), "the files and the commands");
    for name in found {
        let text = std::fs::read(path(&name)).expect("readable");
        let schema: Value = serde_json::from_slice(&text).expect("JSON");
        assert!(schema["title"].is_string() && schema["description"].is_string(), "{name}: title and description");
        assert_eq!(schema["additionalProperties"], false, "{name}: members that are not named are errors");
    }
}
