//! `outmerge conform`: a device against numeric models, bit for bit, and against specifications.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use super::judge::Judging;
use super::{Failure, Outcome, output};
use crate::conform::log::Log;
use crate::conform::result::VERSION;
use crate::conform::run::Subject;
use crate::conform::{Asked, Level, Panel, Results, Shard, Unit, compare, file, junit, table};
use crate::crosscheck::{Device, OpenOptions, adapter};
use crate::format::{ColorFormat, DepthFormat};
use crate::model::registry;
use crate::verdict::Verdict;

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
    /// Results of several devices side by side, as Markdown.
    Compare(Compare),
    /// List the adapters there are.
    Adapters,
}

/// Arguments of `conform compare`.
#[derive(Debug, Args)]
struct Compare {
    /// Result files, as written by --json-file, a device each.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Where to write the tables; `-` is stdout.
    #[arg(long, short, default_value = "-")]
    output: PathBuf,
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
    /// Where to write the table as Markdown.
    #[arg(long)]
    markdown: Option<PathBuf>,
    #[command(flatten)]
    demands: Demands,
}

/// What must have been run, beside what is compared.
#[derive(Debug, Args)]
struct Demands {
    /// Number of units that must have been run, exit 1 if it is another: a driver that suddenly lacks a format is noticed.
    #[arg(long, value_name = "UNITS")]
    expect: Option<usize>,
    /// Formats, comma separated, of which every unit must have been run, exit 1 if one was not.
    #[arg(long, value_name = "FORMAT", value_delimiter = ',')]
    require: Vec<String>,
}

impl Demands {
    /// Formats are known by name, so that a slip is no failure of the device.
    fn check(&self) -> Result<(), Failure> {
        for name in &self.require {
            if DepthFormat::from_name(name).is_none() {
                ColorFormat::from_name(name).map_err(|error| format!("--require: {error}"))?;
            }
        }
        Ok(())
    }

    /// What the results end in, with a complaint for each demand that is not met.
    fn verdict(&self, results: &Results, all_shards: bool) -> Verdict {
        let mut complaints = results.lacking(&self.require);
        complaints.iter_mut().for_each(|complaint| complaint.insert_str(0, "--require "));
        let run = results.units_run();
        if let Some(expected) = self.expect.filter(|expected| *expected != run) {
            complaints.push(format!("--expect {expected}: {run} units were run"));
        }
        complaints.iter().for_each(|complaint| output::complain(complaint));
        let demands = if complaints.is_empty() { None } else { Some(Verdict::Fails) };
        Verdict::of_all([results.verdict(all_shards)].into_iter().chain(demands))
    }
}

/// Arguments of a sweep.
#[derive(Debug, Args)]
struct Sweep {
    /// Part of the adapter's name or driver; `gl:NAME` looks among OpenGL's (feature `gl`), `gl:` takes the first.
    #[arg(long, short)]
    adapter: Option<String>,
    /// Model that must match, exit 1 if it does not. May be repeated. Unless given, and unless --spec is, all models are
    /// tried, exit 1 if none matches.
    #[arg(long, short)]
    model: Vec<String>,
    #[command(flatten)]
    judging: Judging,
    #[command(flatten)]
    demands: Demands,
    /// How thorough.
    #[arg(long, short, value_enum, default_value_t = Level::Quick)]
    level: Level,
    /// Part i of n of the level.
    #[arg(long, default_value_t = Shard::ALL)]
    shard: Shard,
    /// Only units whose name contains this text; see --list.
    #[arg(long)]
    only: Option<String>,
    /// Not the units whose name contains this text.
    #[arg(long)]
    skip: Option<String>,
    /// Texels for each blend state, in place of the level's.
    #[arg(long, value_parser = clap::value_parser!(u32).range(64..=2_097_152))]
    texels: Option<u32>,
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
    /// Write the table as Markdown.
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
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
            Some(Command::Compare(compare)) => compare.run(),
            Some(Command::Adapters) => adapters(),
            None => self.sweep.run(),
        }
    }
}

fn adapters() -> Result<Outcome, Failure> {
    let reports = adapter::Adapters::enumerate().reports();
    let lines: String = reports.iter().map(|report| format!("{report}\n")).collect();
    output::print(if lines.is_empty() { "no Vulkan adapter found\n" } else { &lines })?;
    #[cfg(feature = "gl")]
    for report in adapter::Adapters::enumerate_gl().reports() {
        output::print(&format!("{}{report}\n", adapter::GL_PREFIX))?;
    }
    Ok(Outcome::Done)
}

fn read(path: &Path) -> Result<Results, Failure> {
    let mut text = String::new();
    output::open(path)?
        .read_to_string(&mut text)
        .map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    Ok(file::read(&text).map_err(|error| format!("{}: {error}", path.display()))?)
}

impl Compare {
    fn run(self) -> Result<Outcome, Failure> {
        let devices = self.files.iter().map(|path| read(path)).collect::<Result<Vec<_>, _>>()?;
        write_text(&self.output, &compare::markdown(&devices))?;
        Ok(Outcome::Judged(compare::verdict(&devices)))
    }
}

impl Merge {
    fn run(self) -> Result<Outcome, Failure> {
        self.demands.check()?;
        let results = Results::merge(self.files.iter().map(|path| read(path)).collect::<Result<_, _>>()?)?;
        if let Some(path) = &self.output {
            write_text(path, &file::write(&results)?)?;
        }
        if let Some(path) = &self.junit {
            write_text(path, &junit::xml(&results, true)?)?;
        }
        if let Some(path) = &self.markdown {
            write_text(path, &table::markdown(&results, true))?;
        }
        output::print(&table::text(&results, true))?;
        Ok(Outcome::Judged(self.demands.verdict(&results, true)))
    }
}

impl Sweep {
    fn run(self) -> Result<Outcome, Failure> {
        self.demands.check()?;
        let asked = Asked {
            only: self.only.clone(),
            skip: self.skip.clone(),
            texels: self.texels,
            every_model: !self.model.is_empty(),
        };
        let units: Vec<Unit> = asked.units(self.level, &[self.shard]).collect();
        if units.is_empty() {
            return Err(self.no_unit());
        }
        if self.list {
            output::print(&units.iter().map(|unit| unit.id() + "\n").collect::<String>())?;
            return Ok(Outcome::Done);
        }
        // Names are checked before a device is opened; what they leave unsaid is then the device's.
        for name in &self.model {
            registry::by_name(name)?;
        }
        adapter::reexec_without_shader_cache()?;
        let options = OpenOptions {
            adapter: self.adapter.clone(),
            timeout: std::time::Duration::from_secs(self.timeout.max(1)),
            ..OpenOptions::default()
        };
        let device = Device::open(&options)?;
        if let Some(warning) = device.report().warning() {
            output::complain(&warning);
        }
        let drivers = device.report().drivers();
        let names = if self.model.is_empty() && self.judging.spec.is_empty() {
            registry::all_among(drivers).iter().map(|model| model.name()).collect()
        } else {
            self.model.clone()
        };
        let subjects = names.iter().map(|name| Subject::new(name, drivers)).collect::<Result<Vec<_>, _>>()?;
        let panel = Panel { subjects, judges: self.judging.judges() };
        let mut results = Results {
            version: VERSION,
            adapter: device.report().to_string(),
            driver: Some(device.report().record()),
            level: self.level,
            asked,
            shards: vec![self.shard],
            models: panel.subjects.iter().map(|subject| subject.name.clone()).collect(),
            specs: panel.judges.iter().map(|judge| judge.spec.name().to_owned()).collect(),
            units: Vec::new(),
        };
        self.sweep(&device, &panel, &units, &mut results)?;
        if let Some(path) = &self.json_file {
            write_text(path, &file::write(&results)?)?;
        }
        if let Some(path) = &self.junit {
            write_text(path, &junit::xml(&results, false)?)?;
        }
        if let Some(path) = &self.markdown {
            write_text(path, &table::markdown(&results, false))?;
        }
        if self.json {
            output::print(&file::write(&results)?)?;
        } else {
            output::print(&table::text(&results, false))?;
        }
        if let Err(fault) = device.check() {
            let missing = results.units.iter().filter(|unit| unit.not_run.is_some()).count();
            let hint =
                if self.log.is_some() { "the log keeps the others" } else { "with --log the others would be kept" };
            return Err(format!("{fault}; {missing} units were not run, {hint}").into());
        }
        Ok(Outcome::Judged(self.demands.verdict(&results, false)))
    }

    /// Why there is no unit to run.
    fn no_unit(&self) -> Failure {
        let mut why = String::new();
        if let Some(only) = &self.only {
            why.push_str(&format!(", --only {only}"));
        }
        if let Some(skip) = &self.skip {
            why.push_str(&format!(", --skip {skip}"));
        }
        let (level, shard) = (self.level, self.shard);
        format!("{}: level {level}, shard {shard}{why} has no unit; --list prints those of a level", Verdict::NotRun)
            .into()
    }

    /// Runs the units that the log does not have yet.
    fn sweep(&self, device: &Device, panel: &Panel, units: &[Unit], results: &mut Results) -> Result<(), Failure> {
        let (mut log, known) = match &self.log {
            Some(path) => Log::open(path, results).map(|(log, known)| (Some(log), known))?,
            None => (None, BTreeMap::new()),
        };
        let missing: Vec<Unit> = units.iter().filter(|unit| !known.contains_key(&unit.id())).cloned().collect();
        let bar = ProgressBar::new(units.len() as u64)
            .with_style(ProgressStyle::with_template("{bar:30} {pos}/{len} units {elapsed} {wide_msg}")?);
        bar.set_position((units.len() - missing.len()) as u64);
        let mut outcomes = known;
        let mut failure: Option<Failure> = None;
        crate::conform::run(device, panel, &missing, |outcome| {
            bar.inc(1);
            bar.set_message(outcome.unit.clone());
            if let Some(Err(error)) = log.as_mut().map(|log| log.add(&outcome)) {
                failure = Some(error.into());
                return ControlFlow::Break(());
            }
            outcomes.insert(outcome.unit.clone(), outcome);
            ControlFlow::Continue(())
        });
        bar.finish_and_clear();
        results.units = units.iter().filter_map(|unit| outcomes.remove(&unit.id())).collect();
        failure.map_or(Ok(()), Err)
    }
}

fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    output::write_file(path, |file| Ok(file.write_all(text.as_bytes())?))
}
