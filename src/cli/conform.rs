//! `outmerge conform`: a device against numeric models, bit for bit.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, output};
use crate::conform::result::VERSION;
use crate::conform::run::Subject;
use crate::conform::{Level, Results, Shard, Unit, UnitOutcome, junit, level};
use crate::crosscheck::{Device, OpenOptions, adapter};
use crate::model::registry;

/// Arguments of `conform`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(super) struct Conform {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    sweep: Sweep,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Put the results of shards together.
    Merge(Merge),
    /// List the adapters there are.
    Adapters,
}

/// Arguments of `conform merge`.
#[derive(Debug, Args)]
struct Merge {
    /// Result files, as written by --json-file.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Where to write the merged results; `-` is stdout.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Where to write JUnit XML.
    #[arg(long)]
    junit: Option<PathBuf>,
}

/// Arguments of a sweep.
#[derive(Debug, Args)]
struct Sweep {
    /// Part of the adapter's name or driver.
    #[arg(long, short)]
    adapter: Option<String>,
    /// Model that must match, exit 1 if it does not; all models, to say which fits, unless given. May be repeated.
    #[arg(long, short)]
    model: Vec<String>,
    /// How thorough.
    #[arg(long, short, value_enum, default_value_t = Level::Quick)]
    level: Level,
    /// Part i of n of the level.
    #[arg(long, default_value_t = Shard::ALL)]
    shard: Shard,
    /// Only units whose name contains this text; see --list.
    #[arg(long)]
    only: Option<String>,
    /// Print the names of the units and end.
    #[arg(long)]
    list: bool,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
    /// Write the results as JSON.
    #[arg(long, value_name = "FILE")]
    json_file: Option<PathBuf>,
    /// Write JUnit XML.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Log of finished units: an interrupted run with the same log goes on where it stopped.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Longest wait for one draw, in seconds.
    #[arg(long, default_value_t = 60)]
    timeout: u64,
}

impl Conform {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        match self.command {
            Some(Command::Merge(merge)) => merge.run(),
            Some(Command::Adapters) => adapters(),
            None => self.sweep.run(),
        }
    }
}

fn adapters() -> Result<Outcome, Failure> {
    let reports = adapter::Adapters::enumerate().reports();
    let lines: String = reports.iter().map(|report| format!("{report}\n")).collect();
    output::print(if lines.is_empty() { "no Vulkan adapter found\n" } else { &lines })?;
    Ok(Outcome::Fine)
}

impl Merge {
    fn run(self) -> Result<Outcome, Failure> {
        let read = |path: &PathBuf| -> Result<Results, Failure> {
            serde_json::from_reader(output::open(path)?).map_err(|error| format!("{}: {error}", path.display()).into())
        };
        let results = Results::merge(self.files.iter().map(read).collect::<Result<_, _>>()?)?;
        if let Some(path) = &self.output {
            write_json(path, &results)?;
        }
        if let Some(path) = &self.junit {
            write_junit(path, &results)?;
        }
        output::print(&table(&results))?;
        let matched = results.totals().values().any(|total| total.mismatches == 0 && total.states > 0);
        Ok(if matched { Outcome::Fine } else { Outcome::Finding })
    }
}

impl Sweep {
    fn run(self) -> Result<Outcome, Failure> {
        let wanted = |(place, unit): &(usize, Unit)| {
            self.shard.has(*place) && self.only.as_ref().is_none_or(|text| unit.id().contains(text))
        };
        let units: Vec<Unit> =
            level::units(self.level).into_iter().enumerate().filter(wanted).map(|(_, unit)| unit).collect();
        if self.list {
            output::print(&units.iter().map(|unit| unit.id() + "\n").collect::<String>())?;
            return Ok(Outcome::Fine);
        }
        let names = if self.model.is_empty() {
            registry::all().iter().map(|model| model.name()).collect()
        } else {
            self.model.clone()
        };
        let subjects = names.iter().map(|name| Subject::new(name)).collect::<Result<Vec<_>, _>>()?;
        adapter::reexec_without_shader_cache()?;
        let options = OpenOptions {
            adapter: self.adapter.clone(),
            timeout: std::time::Duration::from_secs(self.timeout.max(1)),
            ..OpenOptions::default()
        };
        let device = Device::open(&options)?;
        let mut results = Results {
            version: VERSION,
            adapter: device.report().to_string(),
            level: self.level,
            shards: vec![self.shard.to_string()],
            models: subjects.iter().map(|subject| subject.name.clone()).collect(),
            units: Vec::new(),
        };
        self.sweep(&device, &subjects, &units, &mut results)?;
        if let Some(path) = &self.json_file {
            write_json(path, &results)?;
        }
        if let Some(path) = &self.junit {
            write_junit(path, &results)?;
        }
        if self.json {
            output::print_json(&results)?;
        } else {
            output::print(&table(&results))?;
        }
        let failed = results.totals().values().any(|total| total.mismatches > 0 || total.states == 0);
        let named = !self.model.is_empty();
        Ok(if named && failed { Outcome::Finding } else { Outcome::Fine })
    }

    /// Runs the units that the log does not have yet.
    fn sweep(
        &self,
        device: &Device,
        subjects: &[Subject],
        units: &[Unit],
        results: &mut Results,
    ) -> Result<(), Failure> {
        let known = match &self.log {
            Some(path) => read_log(path, results)?,
            None => BTreeMap::new(),
        };
        let mut log = match &self.log {
            Some(path) => Some(append(path, results, known.is_empty())?),
            None => None,
        };
        let missing: Vec<Unit> = units.iter().filter(|unit| !known.contains_key(&unit.id())).cloned().collect();
        let bar = ProgressBar::new(units.len() as u64)
            .with_style(ProgressStyle::with_template("{bar:30} {pos}/{len} units {elapsed} {wide_msg}")?);
        bar.set_position((units.len() - missing.len()) as u64);
        let mut outcomes = known;
        let mut failure: Option<Failure> = None;
        crate::conform::run(device, subjects, &missing, |outcome| {
            bar.inc(1);
            bar.set_message(outcome.unit.clone());
            // A unit that was not run is tried again by the next run.
            if let Some(file) = log.as_mut().filter(|_| outcome.not_run.is_none()) {
                let line = serde_json::to_string(&outcome).map_err(Failure::from);
                if let Err(error) = line.and_then(|line| Ok(writeln!(file, "{line}").and_then(|()| file.flush())?)) {
                    failure = Some(error);
                    return ControlFlow::Break(());
                }
            }
            outcomes.insert(outcome.unit.clone(), outcome);
            ControlFlow::Continue(())
        });
        bar.finish_and_clear();
        results.units = units.iter().filter_map(|unit| outcomes.remove(&unit.id())).collect();
        failure.map_or(Ok(()), Err)
    }
}

/// The line a log begins with: what its units are comparable with.
fn log_header(results: &Results) -> serde_json::Value {
    serde_json::json!({
        "version": results.version, "adapter": results.adapter, "level": results.level, "models": results.models,
    })
}

/// The units a log has; none if the file is not there.
fn read_log(path: &Path, results: &Results) -> Result<BTreeMap<String, UnitOutcome>, Failure> {
    let Ok(file) = std::fs::File::open(path) else { return Ok(BTreeMap::new()) };
    let mut lines = std::io::BufReader::new(file).lines();
    let named = |problem: String| -> Failure { format!("{}: {problem}", path.display()).into() };
    let Some(first) = lines.next() else { return Ok(BTreeMap::new()) };
    let header: serde_json::Value = serde_json::from_str(&first?).map_err(|e| named(format!("line 1: {e}")))?;
    if header != log_header(results) {
        return Err(named(
            "the log belongs to a run with another adapter, level or models; name another log".to_owned(),
        ));
    }
    let mut units = BTreeMap::new();
    let mut broken = None;
    for (i, line) in lines.enumerate() {
        if let Some(problem) = broken.take() {
            return Err(problem);
        }
        match serde_json::from_str::<UnitOutcome>(&line?) {
            Ok(unit) => {
                units.insert(unit.unit.clone(), unit);
            }
            // A last line cut off by an interruption is run again; anywhere else it is a damaged file.
            Err(error) => broken = Some(named(format!("line {}: {error}", i + 2))),
        }
    }
    Ok(units)
}

/// The log, open for more lines; begun anew when it has no units.
fn append(path: &Path, results: &Results, empty: bool) -> Result<std::fs::File, Failure> {
    let named = |error: std::io::Error| format!("cannot write {}: {error}", path.display());
    if empty {
        let mut file = std::fs::File::create(path).map_err(named)?;
        writeln!(file, "{}", log_header(results)).map_err(named)?;
        return Ok(file);
    }
    let text = std::fs::read_to_string(path).map_err(named)?;
    let mut file = std::fs::OpenOptions::new().append(true).open(path).map_err(named)?;
    if !text.ends_with('\n') {
        // Keep a cut-off line from swallowing the next one.
        file.set_len(text.rfind('\n').map_or(0, |at| at as u64 + 1)).map_err(named)?;
    }
    file.flush().map_err(named)?;
    Ok(file)
}

fn write_json(path: &Path, results: &Results) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(results)?;
    output::write_file(path, |file| Ok(writeln!(file, "{json}")?))
}

fn write_junit(path: &Path, results: &Results) -> Result<(), Failure> {
    let xml = junit::xml(results)?;
    output::write_file(path, |file| Ok(file.write_all(xml.as_bytes())?))
}

/// States matched by format and model, first differences, and the verdict.
fn table(results: &Results) -> String {
    let mut text = format!("{}\nlevel {}, shard {}\n\n", results.adapter, results.level, results.shards.join(", "));
    let _ = write!(text, "{:18}{:>14}", "states matched", "texels");
    for model in &results.models {
        let _ = write!(text, " {model:>14}");
    }
    text.push('\n');
    for (format, row) in results.by_format() {
        let texels = row.values().map(|total| total.texels).max().unwrap_or(0);
        let _ = write!(text, "{format:18}{texels:>14}");
        for model in &results.models {
            let cell = match row.get(model) {
                Some(total) if total.states > 0 => format!("{}/{}", total.states_matched, total.states),
                _ => "not run".to_owned(),
            };
            let _ = write!(text, " {cell:>14}");
        }
        text.push('\n');
    }
    for unit in &results.units {
        if let Some(reason) = &unit.not_run {
            let _ = writeln!(text, "not run: {}: {reason}", unit.unit);
        }
    }
    let mut left_out: BTreeMap<(&String, &String), usize> = BTreeMap::new();
    for unit in &results.units {
        for (model, outcome) in &unit.models {
            if let Some(reason) = &outcome.not_run {
                *left_out.entry((model, reason)).or_default() += 1;
            }
        }
    }
    for ((model, reason), units) in left_out {
        let _ = writeln!(text, "not run: {model} in {units} units: {reason}");
    }
    text.push('\n');
    for (model, total) in results.totals() {
        let verdict = match (total.states, total.mismatches) {
            (0, _) => "not run".to_owned(),
            (states, 0) => format!("fits: {states} states, {} texels, no mismatch", total.texels),
            (states, mismatches) => {
                format!(
                    "does not fit: {} of {states} states, {mismatches} of {} texels differ",
                    states - total.states_matched,
                    total.texels
                )
            }
        };
        let _ = writeln!(text, "{model:14} {verdict}");
        let first = results.units.iter().find_map(|unit| Some((unit, unit.models.get(&model)?.first.as_ref()?)));
        if let Some((unit, first)) = first {
            let _ = writeln!(text, "{:14} first in {}: {first}", "", unit.unit);
        }
    }
    text
}
