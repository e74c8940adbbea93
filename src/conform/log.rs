//! The log of a run: a header, then one JSON line a finished unit, so that an interrupted run goes on where it stopped.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{Results, UnitOutcome};

/// A log that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// Reading or writing failed.
    #[error("{path}: {source}")]
    Io {
        /// The log.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A damaged line.
    #[error("{path}: line {line}: {source}")]
    Line {
        /// The log.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// Why.
        source: serde_json::Error,
    },
    /// The units of another run are not comparable.
    #[error(
        "{path}: the log belongs to a run with another adapter, driver, processor, level, models or specifications; name another log"
    )]
    Foreign {
        /// The log.
        path: PathBuf,
    },
}

/// An open log.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: File,
}

impl Log {
    /// Opens the log of this run, made if it is not there, and reads the units finished before.
    ///
    /// # Errors
    /// [`LogError`]; a last line cut off by an interruption is none, it is dropped and its unit is run again.
    pub fn open(path: &Path, run: &Results) -> Result<(Self, BTreeMap<String, UnitOutcome>), LogError> {
        let io = |source| LogError::Io { path: path.to_owned(), source };
        let mut file = OpenOptions::new().create(true).read(true).append(true).open(path).map_err(io)?;
        let mut units = BTreeMap::new();
        let mut good = 0_u64;
        let mut reader = BufReader::new(&file);
        let mut line = String::new();
        for number in 1.. {
            line.clear();
            // Only whole lines count.
            if reader.read_line(&mut line).map_err(io)? == 0 || !line.ends_with('\n') {
                break;
            }
            let damaged = |source| LogError::Line { path: path.to_owned(), line: number, source };
            if number == 1 {
                if serde_json::from_str::<Value>(&line).map_err(damaged)? != header(run) {
                    return Err(LogError::Foreign { path: path.to_owned() });
                }
            } else if number > 1 && serde_json::from_str::<Value>(&line).is_ok_and(|value| value == header(run)) {
                // Two processes that began the log at the same moment.
            } else {
                let unit: UnitOutcome = serde_json::from_str(&line).map_err(damaged)?;
                units.insert(unit.unit.clone(), unit);
            }
            good += line.len() as u64;
        }
        file.set_len(good).map_err(io)?;
        if good == 0 {
            file.write_all(format!("{}\n", header(run)).as_bytes()).map_err(io)?;
        }
        Ok((Self { path: path.to_owned(), file }, units))
    }

    /// Adds a finished unit. One that was not run is left out, so that the next run tries it again.
    ///
    /// # Errors
    /// [`LogError::Io`].
    pub fn add(&mut self, unit: &UnitOutcome) -> Result<(), LogError> {
        if unit.not_run.is_some() {
            return Ok(());
        }
        let io = |source| LogError::Io { path: self.path.clone(), source };
        let line = serde_json::to_string(unit).map_err(|error| io(error.into()))? + "\n";
        // One write, so that lines of two processes on one log do not mix.
        self.file.write_all(line.as_bytes()).map_err(io)
    }
}

/// What a log's units are comparable with.
fn header(run: &Results) -> Value {
    // Results depend on the driver and the processor as much as on the adapter's line.
    let mut header =
        serde_json::json!({ "version": run.version, "adapter": run.adapter, "level": run.level, "models": run.models });
    if let Some(driver) = &run.driver {
        header["driver"] = serde_json::to_value(driver).unwrap_or_default();
    }
    if !run.specs.is_empty() {
        header["specs"] = run.specs.clone().into();
    }
    header
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conform::Level;
    use crate::conform::result::VERSION;

    fn results() -> Results {
        Results {
            version: VERSION,
            adapter: "a".to_owned(),
            driver: None,
            level: Level::Exhaustive,
            shards: vec!["1/1".to_owned()],
            models: vec!["m".to_owned()],
            specs: Vec::new(),
            units: Vec::new(),
        }
    }

    fn unit(name: &str) -> UnitOutcome {
        UnitOutcome {
            unit: name.to_owned(),
            format: "f".to_owned(),
            texels: 1,
            states: 1,
            seconds: 0.5,
            not_run: None,
            left_out: None,
            models: BTreeMap::new(),
            specs: BTreeMap::new(),
        }
    }

    #[test]
    fn an_interrupted_run_keeps_its_whole_lines() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("log");
        let (mut log, known) = Log::open(&path, &results()).expect("a new log");
        assert!(known.is_empty(), "nothing done yet");
        log.add(&unit("one")).expect("written");
        log.add(&UnitOutcome { not_run: Some("no".to_owned()), ..unit("two") }).expect("left out");
        drop(log);
        let mut text = std::fs::read_to_string(&path).expect("readable");
        text.push_str("{\"unit\":\"thr");
        std::fs::write(&path, text).expect("cut off");

        let (mut log, known) = Log::open(&path, &results()).expect("the same run");
        assert_eq!(known.keys().collect::<Vec<_>>(), ["one"], "what was finished");
        log.add(&unit("three")).expect("written");
        drop(log);
        let (_, known) = Log::open(&path, &results()).expect("still whole");
        assert_eq!(known.keys().collect::<Vec<_>>(), ["one", "three"], "no line swallowed");
    }

    #[test]
    fn two_processes_that_begin_a_log_together_leave_it_readable() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("log");
        let (mut log, _) = Log::open(&path, &results()).expect("a new log");
        // What the other process writes that found the log empty as well.
        let mut other = OpenOptions::new().append(true).open(&path).expect("there");
        other.write_all(format!("{}\n", header(&results())).as_bytes()).expect("written");
        log.add(&unit("one")).expect("written");
        let (_, known) = Log::open(&path, &results()).expect("a second header is none of a foreign run");
        assert_eq!(known.keys().collect::<Vec<_>>(), ["one"], "what was finished");
    }

    #[test]
    fn a_log_of_another_run_or_a_damaged_one_is_refused() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("log");
        Log::open(&path, &results()).expect("a new log");
        let other = Results { adapter: "b".to_owned(), ..results() };
        assert!(matches!(Log::open(&path, &other), Err(LogError::Foreign { .. })), "another adapter");
        let text = std::fs::read_to_string(&path).expect("readable");
        std::fs::write(&path, format!("{text}nonsense\n")).expect("damaged");
        assert!(matches!(Log::open(&path, &results()), Err(LogError::Line { line: 2, .. })), "the damaged line");
    }
}
