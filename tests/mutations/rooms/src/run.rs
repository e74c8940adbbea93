//! The verdict of each mutant: the tests that reach it, quickest first, until one fails.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use super::Failure;
use super::compile::Built;
use super::list::{Mutant, State};
use super::reach::{Ended, Reached, WORKERS, run};

/// Seconds of tests in one go: a quick batch first, for most mutants end there.
const BATCHES: [f64; 4] = [0.5, 4.0, 30.0, f64::INFINITY];

/// Seconds of tests for one mutant at most; who was not noticed until then survives.
const MOST: f64 = 240.0;

/// What came of a mutant, and by which program's tests.
struct Outcome {
    verdict: &'static str,
    by: String,
}

/// Runs all mutants and writes a file for each room. Returns whether nine of ten viable ones were caught in each.
pub fn all(
    tree: &Path,
    out: &Path,
    rooms: &[String],
    mutants: &[Mutant],
    built: &Built,
    reached: &Reached,
) -> Result<bool, Failure> {
    let mut files = BTreeMap::new();
    for room in rooms {
        files.insert(room.clone(), File::create(out.join(format!("{room}.tsv")))?);
    }
    let (files, queue) = (Mutex::new(files), Mutex::new(mutants.iter().rev().collect::<Vec<_>>()));
    let counts = Mutex::new(BTreeMap::<(String, &'static str), usize>::new());
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                while let Some(mutant) = queue.lock().ok().and_then(|mut queue| queue.pop()) {
                    let outcome = one(tree, mutant, built, reached);
                    let room = mutant.room().to_owned();
                    if let Ok(mut files) = files.lock()
                        && let Some(file) = files.get_mut(&room)
                    {
                        let _ = writeln!(file, "{}\t{}\t{}", outcome.verdict, mutant.name, outcome.by);
                    }
                    if let Ok(mut counts) = counts.lock() {
                        *counts.entry((room, outcome.verdict)).or_default() += 1;
                    }
                }
            });
        }
    });
    let counts = counts.into_inner().map_err(|_| "a worker panicked")?;
    let mut enough = true;
    println!(
        "| room | mutants | refused by the compiler | without a switch | caught | in time | survived | not reached | caught of viable |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    for room in rooms {
        let count = |verdict| counts.get(&(room.clone(), verdict)).copied().unwrap_or(0);
        let (caught, late) = (count("caught"), count("timed out"));
        let (survived, missed) = (count("survived"), count("not reached"));
        let (unviable, without) = (count("unviable"), count("not switched"));
        let viable = caught + late + survived + missed;
        let share = (1000 * (caught + late)).checked_div(viable).unwrap_or(0);
        enough &= viable > 0 && share >= 900;
        println!(
            "| {room} | {} | {unviable} | {without} | {caught} | {late} | {survived} | {missed} | {}.{} % |",
            viable + unviable + without,
            share / 10,
            share % 10
        );
    }
    Ok(enough)
}

fn one(tree: &Path, mutant: &Mutant, built: &Built, reached: &Reached) -> Outcome {
    let ended = |verdict, by: &str| Outcome { verdict, by: by.to_owned() };
    match mutant.state {
        State::Unviable => return ended("unviable", ""),
        State::NotSwitched => return ended("not switched", ""),
        State::Switched => {}
    }
    let tests = built.switch_of.get(&mutant.id).and_then(|switch| reached.by_switch.get(switch));
    let Some(tests) = tests else { return ended("not reached", "") };
    let (mut rest, mut spent) = (tests.as_slice(), 0.0);
    for limit in BATCHES {
        let mut seconds = 0.0;
        let count = rest.iter().take_while(|test| {
            seconds += reached.tests[**test].seconds;
            seconds <= limit && spent + seconds <= MOST
        });
        let (batch, later) = rest.split_at(count.count());
        rest = later;
        // The tests of one program in one process.
        for (program, (name, path)) in built.programs.iter().enumerate() {
            let own: Vec<_> = batch.iter().map(|test| &reached.tests[*test]).filter(|t| t.program == program).collect();
            if own.is_empty() {
                continue;
            }
            let expected: f64 = own.iter().map(|test| test.seconds).sum();
            spent += expected;
            let names: Vec<&str> = own.iter().map(|test| test.name.as_str()).collect();
            let limit = Duration::from_secs_f64(5.0 + 8.0 * expected);
            match run(tree, path, &names, ("OUTMERGE_MUTANT", &mutant.id.to_string()), limit) {
                Ended::Passed => {}
                Ended::Failed => return ended("caught", name),
                Ended::TimedOut => return ended("timed out", name),
            }
        }
    }
    let left = if rest.is_empty() { String::new() } else { format!("{} slow tests were left out", rest.len()) };
    ended("survived", &left)
}
