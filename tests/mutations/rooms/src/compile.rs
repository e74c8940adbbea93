//! The build: all mutants that compile, in one set of test programs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use super::list::{Mutant, State};
use super::source::Source;
use super::switch::{self, Switched};
use super::{Failure, read};

/// Rounds of compiling and giving up what the compiler refuses; types, borrows and constants are checked one after another.
const ROUNDS: usize = 40;

/// Test programs left out: sweeps over every input, seeds of the fuzzers and draws on a device, which take long and are about other
/// rooms.
const LEFT_OUT: [&str; 4] = ["exact", "kernel", "crosscheck", "fuzz_corpus"];

/// The module that the switches ask.
const MUTANT: &str = r#"//! Which mutant is switched on.

use std::io::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

const UNREAD: u32 = u32::MAX;
const RECORD: u32 = u32::MAX - 1;
const SWITCHES: usize = 1 << 15;
static ACTIVE: AtomicU32 = AtomicU32::new(UNREAD);
static SEEN: [AtomicBool; SWITCHES] = [const { AtomicBool::new(false) }; SWITCHES];

/// The mutant that is switched on, 0 for none; `switch` is the place that asks.
#[inline]
pub fn on(switch: u32) -> u32 {
    let active = ACTIVE.load(Ordering::Relaxed);
    if active < RECORD {
        return active;
    }
    // While switches are recorded, the loops of a test come by here again and again.
    if SEEN[switch as usize].load(Ordering::Relaxed) { 0 } else { first(switch) }
}

#[cold]
#[inline(never)]
fn first(switch: u32) -> u32 {
    let Ok(path) = std::env::var("OUTMERGE_REACH") else {
        let active = std::env::var("OUTMERGE_MUTANT").ok().and_then(|text| text.parse().ok()).unwrap_or(0);
        ACTIVE.store(active, Ordering::Relaxed);
        return active;
    };
    ACTIVE.store(RECORD, Ordering::Relaxed);
    if !SEEN[switch as usize].swap(true, Ordering::Relaxed) {
        if let Ok(mut file) = std::fs::OpenOptions::new().create(true).append(true).open(path) {
            let _ = file.write_all(format!("{switch}\n").as_bytes());
        }
    }
    0
}
"#;

/// What was built.
#[derive(Debug)]
pub struct Built {
    /// Test programs by name.
    pub programs: Vec<(String, PathBuf)>,
    /// The switch of each mutant.
    pub switch_of: BTreeMap<u32, u32>,
}

/// Builds the test programs with all mutants that compile, and marks the others.
pub fn build(tree: &Path, mutants: &mut [Mutant]) -> Result<Built, Failure> {
    prepare(tree)?;
    for mutant in mutants.iter_mut() {
        mutant.state = State::Switched;
    }
    let files: BTreeSet<String> = mutants.iter().map(|mutant| mutant.file.clone()).collect();
    let mut sources = BTreeMap::new();
    for file in files {
        sources.insert(file.clone(), Source::new(read(&tree.join(&file))?));
    }
    for round in 1..=ROUNDS {
        let (switched, switch_of) = write(tree, &sources, mutants)?;
        let errors = check(tree)?;
        if errors.is_empty() {
            return Ok(Built { programs: programs(tree)?, switch_of });
        }
        let before = mutants.iter().filter(|mutant| mutant.state == State::Switched).count();
        for error in &errors {
            give_up(error, &switched, mutants)?;
        }
        let after = mutants.iter().filter(|mutant| mutant.state == State::Switched).count();
        eprintln!("round {round}: {} errors, {} mutants given up", errors.len(), before - after);
        if before == after {
            return Err(format!("the compiler's errors are about no mutant: {}", errors[0]["message"]).into());
        }
    }
    Err("the mutants do not come to compile".into())
}

/// No lint ends a build; the switches' module is there.
fn prepare(tree: &Path) -> Result<(), Failure> {
    std::fs::write(tree.join("src/mutant.rs"), MUTANT)?;
    let root = tree.join("src/lib.rs");
    let text = read(&root)?;
    if !text.contains("pub mod mutant;") {
        let allowed =
            "#![allow(warnings, clippy::all, arithmetic_overflow, unconditional_panic, overflowing_literals)]";
        // Inner attributes come after the inner documentation.
        let at =
            text.lines().take_while(|line| line.starts_with("//!") || line.is_empty()).map(|line| line.len() + 1).sum();
        let (documentation, rest) = text.split_at(at);
        std::fs::write(&root, format!("{documentation}{allowed}\n{rest}\n/// Switches.\npub mod mutant;\n"))?;
    }
    let manifest = tree.join("Cargo.toml");
    let kept: Vec<String> =
        read(&manifest)?.split("\n[").filter(|part| !part.starts_with("lints")).map(str::to_owned).collect();
    std::fs::write(&manifest, kept.join("\n["))?;
    Ok(())
}

type Written = (BTreeMap<String, Switched>, BTreeMap<u32, u32>);

fn write(tree: &Path, sources: &BTreeMap<String, Source>, mutants: &mut [Mutant]) -> Result<Written, Failure> {
    let (mut switched, mut switch_of) = (BTreeMap::new(), BTreeMap::new());
    let mut next = 0;
    for (file, source) in sources {
        let mut own: Vec<&mut Mutant> = mutants.iter_mut().filter(|mutant| mutant.file == *file).collect();
        let result = switch::switch(source, &mut own, next, &mut switch_of)?;
        next += u32::try_from(result.switches.len())?;
        std::fs::write(tree.join(file), &result.text)?;
        switched.insert(file.clone(), result);
    }
    Ok((switched, switch_of))
}

fn cargo(tree: &Path, arguments: &[&str]) -> Result<Vec<Value>, Failure> {
    let mut command = Command::new("cargo");
    command.current_dir(tree).args(arguments).args(["--all-features", "--message-format=json"]);
    // What a run that was stopped left of an incremental build does not link.
    command.env("CARGO_INCREMENTAL", "0");
    let output = command.stderr(Stdio::inherit()).output()?;
    let lines = output.stdout.split(|byte| *byte == b'\n').filter(|line| line.first() == Some(&b'{'));
    Ok(lines.map(serde_json::from_slice).collect::<Result<_, _>>()?)
}

/// The compiler's errors.
fn check(tree: &Path) -> Result<Vec<Value>, Failure> {
    let messages = cargo(tree, &["check", "--lib", "--profile", "test"])?;
    let errors = messages.into_iter().filter(|m| m["reason"] == "compiler-message").map(|mut m| m["message"].take());
    Ok(errors
        .filter(|m| m["level"] == "error" && m["spans"].as_array().is_some_and(|spans| !spans.is_empty()))
        .collect())
}

/// Gives up the mutants that an error is about: the one in whose text it is, or all of the innermost switch around it.
fn give_up(error: &Value, switched: &BTreeMap<String, Switched>, mutants: &mut [Mutant]) -> Result<(), Failure> {
    let of = |part: &'_ Value| part["spans"].as_array().cloned().unwrap_or_default();
    let mut spans = of(error);
    spans.sort_by_key(|span| span["is_primary"] != true);
    if error["code"]["code"] == "E0004" {
        // A match without its last arm: the compiler points at the match, and where one more arm would go.
        spans = error["children"].as_array().into_iter().flatten().flat_map(of).collect();
    }
    spans = spans.into_iter().map(call_site).collect();
    let number = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    let place = |span: &Value| (number(&span["byte_start"]), number(&span["byte_end"]));
    let mut give = |ids: &[u32], state: State| {
        for mutant in mutants.iter_mut().filter(|m| ids.contains(&m.id) && m.state == State::Switched) {
            mutant.state = state;
        }
    };
    // An error in the text of one mutant is about that.
    for span in &spans {
        let Some(file) = span["file_name"].as_str().and_then(|file| switched.get(file)) else { continue };
        let (start, end) = place(span);
        let around = file.mutants.iter().filter(|(range, _)| range.start <= start && end <= range.end);
        if let Some((_, id)) = around.min_by_key(|(range, _)| range.len()) {
            give(&[*id], State::Unviable);
            return Ok(());
        }
    }
    for span in &spans {
        let Some(file) = span["file_name"].as_str().and_then(|file| switched.get(file)) else { continue };
        let (start, end) = place(span);
        let around = file.switches.iter().filter(|(range, _)| range.start <= start && end <= range.end);
        let inside = file.switches.iter().filter(|(range, _)| start <= range.start && range.end <= end);
        if let Some((_, ids)) = around.min_by_key(|(range, _)| range.len()) {
            give(ids, State::NotSwitched);
            return Ok(());
        }
        let ids: Vec<u32> = inside.flat_map(|(_, ids)| ids.clone()).collect();
        if !ids.is_empty() {
            give(&ids, State::NotSwitched);
            return Ok(());
        }
    }
    // A body with two kinds of values for one `impl Trait`: the error is about what comes after the return.
    for span in &spans {
        let Some(file) = span["file_name"].as_str().and_then(|file| switched.get(file)) else { continue };
        let before = file.switches.iter().filter(|(range, _)| range.end <= place(span).0);
        if let Some((_, ids)) = before.max_by_key(|(range, _)| range.end) {
            give(ids, State::NotSwitched);
            return Ok(());
        }
    }
    Err(format!("an error is about no mutant: {}", error["rendered"].as_str().unwrap_or_default()).into())
}

/// A place inside a macro of the standard library stands for where the crate calls it.
fn call_site(mut span: Value) -> Value {
    while span["file_name"].as_str().is_some_and(|file| !file.starts_with("src/")) && span["expansion"].is_object() {
        span = span["expansion"]["span"].take();
    }
    span
}

/// Builds the tests.
fn programs(tree: &Path) -> Result<Vec<(String, PathBuf)>, Failure> {
    let messages = cargo(tree, &["test", "--no-run", "--lib", "--bins", "--tests"])?;
    let mut programs = Vec::new();
    for message in messages.iter().filter(|m| m["reason"] == "compiler-artifact" && m["profile"]["test"] == true) {
        let (Some(path), Some(name)) = (message["executable"].as_str(), message["target"]["name"].as_str()) else {
            continue;
        };
        let kind = message["target"]["kind"][0].as_str().unwrap_or_default();
        if kind != "bin" && !LEFT_OUT.contains(&name) {
            programs.push((if kind == "lib" { "lib".to_owned() } else { name.to_owned() }, PathBuf::from(path)));
        }
    }
    if programs.is_empty() { Err("no test program was built".into()) } else { Ok(programs) }
}
