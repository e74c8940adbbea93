//! The log of a run: a header, then one JSON line a finished unit with its checksum, so that an interrupted run goes on where
//! it stopped.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::checksum::{self, SealError};
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
        source: SealError,
    },
    /// Another process writes it.
    #[error("{path}: another process is writing this log; wait for it, or name another log")]
    InUse {
        /// The log.
        path: PathBuf,
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
    /// Opens the log of this run, made if it is not there, and reads the units finished before. It stays locked as long as
    /// it is open: a second process that opens it gets an error.
    ///
    /// # Errors
    /// [`LogError`]; a last line cut off by an interruption is none, it is dropped and its unit is run again.
    pub fn open(path: &Path, run: &Results) -> Result<(Self, BTreeMap<String, UnitOutcome>), LogError> {
        let io = |source| LogError::Io { path: path.to_owned(), source };
        let mut file = OpenOptions::new().create(true).read(true).append(true).open(path).map_err(io)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(LogError::InUse { path: path.to_owned() }),
            Err(TryLockError::Error(error)) => return Err(io(error)),
        }
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
            let value = serde_json::from_str::<Value>(&line).map_err(|error| damaged(error.into()))?;
            if number == 1 {
                if value != header(run) {
                    return Err(LogError::Foreign { path: path.to_owned() });
                }
            } else {
                let unit = checksum::open(value).map_err(damaged)?;
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
        let line = checksum::seal(unit).map_err(|error| io(error.into()))? + "\n";
        // One write, so that an interruption cuts off one line at most.
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
    use crate::conform::result::samples::{self, unit};

    fn results() -> Results {
        Results { level: Level::Exhaustive, ..samples::results(&[]) }
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
    fn a_second_process_on_one_log_is_told_so() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("log");
        let (log, _) = Log::open(&path, &results()).expect("a new log");
        assert!(matches!(Log::open(&path, &results()), Err(LogError::InUse { .. })), "while it is open");
        drop(log);
        Log::open(&path, &results()).expect("when it is closed");
    }

    /// Every digit of a unit's line, one at a time, becomes another.
    #[test]
    fn a_changed_digit_is_an_error_that_names_the_line() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("log");
        let (mut log, _) = Log::open(&path, &results()).expect("a new log");
        ["one", "two"].iter().for_each(|name| log.add(&unit(name)).expect("written"));
        drop(log);
        let text = std::fs::read_to_string(&path).expect("readable");
        let start = text.match_indices('\n').nth(1).expect("two units").0;
        for (at, digit) in text.char_indices().filter(|(at, c)| *at > start && c.is_ascii_digit()) {
            let other = if digit == '9' { '8' } else { char::from(digit as u8 + 1) };
            std::fs::write(&path, format!("{}{other}{}", &text[..at], &text[at + 1..])).expect("changed");
            let error = Log::open(&path, &results()).expect_err("a changed digit").to_string();
            assert!(error.contains("line 3: "), "digit {at}: {error}");
        }
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
