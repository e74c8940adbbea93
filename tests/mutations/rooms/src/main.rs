//! Mutation tests of whole rooms of the crate, without a build for each mutant.
//!
//! cargo-mutants makes the list of mutants. All mutants of a room are compiled into one program, each behind a number, and
//! the number to switch on is read from the environment: a mutant costs the tests that reach it, and no build.
//!
//! - [`list`]: the mutants, from cargo-mutants;
//! - [`source`]: places in a file, [`switch`]: the file with its mutants behind switches;
//! - [`compile`]: the build, without the mutants that the compiler refuses;
//! - [`reach`]: which test reaches which switch, and how long it takes; [`run`](mod@run): the verdict of each mutant.
//!
//! usage: `rooms TREE OUT ROOM...`; TREE is a copy of the crate and is changed, OUT gets a file for each room. With
//! `--survivors FILE` only the mutants that the file names are run again.

mod compile;
mod list;
mod reach;
mod run;
mod source;
mod switch;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Anything that ends the program.
type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match start() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("rooms: {error}");
            ExitCode::from(2)
        }
    }
}

/// Whether nine of ten viable mutants were caught in every room.
fn start() -> Result<bool, Failure> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut wanted = None;
    if let Some(at) = arguments.iter().position(|argument| argument == "--survivors") {
        let file = arguments.get(at + 1).ok_or("--survivors FILE")?.clone();
        arguments.drain(at..at + 2);
        let names = std::fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
        wanted = Some(names.lines().filter_map(name_of_survivor).map(place_free).collect::<BTreeSet<_>>());
    }
    let [tree, out, rooms @ ..] = arguments.as_slice() else { return Err("usage: rooms TREE OUT ROOM...".into()) };
    let (tree, out) = (std::fs::canonicalize(tree)?, PathBuf::from(out));
    std::fs::create_dir_all(&out)?;
    let mut mutants = list::of_rooms(&tree, rooms)?;
    if let Some(wanted) = &wanted {
        mutants.retain(|mutant| wanted.contains(&place_free(&mutant.name)));
    }
    if mutants.is_empty() {
        return Err("no mutants to run".into());
    }
    let built = compile::build(&tree, &mut mutants)?;
    let reached = reach::measure(&tree, &built)?;
    run::all(&tree, &out, rooms, &mutants, &built, &reached)
}

/// The name on a line of a result file that tells of a survivor.
fn name_of_survivor(line: &str) -> Option<&str> {
    let (verdict, rest) = line.split_once('\t')?;
    let name = rest.split('\t').next()?;
    matches!(verdict, "survived" | "not reached").then_some(name)
}

/// A mutant's name without line and column, which other changes move.
fn place_free(name: &str) -> String {
    let mut parts = name.splitn(4, ':');
    let file = parts.next().unwrap_or_default();
    format!("{file}:{}", parts.nth(2).unwrap_or_default())
}

/// A file below the tree, with a message that names it.
fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()).into())
}
