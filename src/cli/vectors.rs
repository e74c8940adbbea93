//! `outmerge vectors`: apply, check, judge, generate, record.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{Failure, Outcome, output};
use crate::format::depth::DEPTH_FORMATS;
use crate::format::{ColorFormat, DepthFormat, layout::FORMATS};
use crate::model::registry;
use crate::vectors::{self, Kind, Mismatch};
use crate::verdict::Verdict;

/// Subcommands of `vectors`.
#[derive(Debug, Subcommand)]
pub(super) enum Vectors {
    /// Fill in `out` of every line by a model.
    Apply(Apply),
    /// Compare `out` of every line with a model; exit 1 on any mismatch.
    Check(Check),
    /// Hold `out` of every line against what specifications admit; exit 1 if a result is outside.
    Judge(super::judge::JudgeVectors),
    /// Write lines with random states and awkward inputs, filled in by a model.
    Generate(Generate),
    /// Write lines filled in by a Vulkan device: an input file's, or random ones.
    #[cfg(feature = "gpu")]
    Record(super::record::Record),
}

/// Arguments of `vectors apply`.
#[derive(Debug, Args)]
pub(super) struct Apply {
    /// The numeric model.
    #[arg(long, short)]
    model: String,
    /// Input file; `-` is stdin.
    input: PathBuf,
    /// Output file; `-` is stdout.
    #[arg(long, short)]
    output: PathBuf,
}

/// Arguments of `vectors check`.
#[derive(Debug, Args)]
pub(super) struct Check {
    /// The numeric model.
    #[arg(long, short)]
    model: String,
    /// Input file; `-` is stdin.
    input: PathBuf,
    /// Print counts by format as JSON instead of text.
    #[arg(long, visible_alias = "json")]
    report: bool,
    /// Failing lines to print in full.
    #[arg(long, default_value_t = 10)]
    show: usize,
}

/// Arguments of `vectors generate`.
#[derive(Debug, Args)]
pub(super) struct Generate {
    /// The numeric model.
    #[arg(long, short)]
    model: String,
    /// Formats, comma separated; all the model covers unless given.
    #[arg(long, value_delimiter = ',')]
    format: Vec<String>,
    /// Kinds of lines, comma separated; color unless given, depth where only depth formats are.
    #[arg(long, value_enum, value_delimiter = ',')]
    kind: Vec<Kind>,
    /// Lines for each format.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    lines: u32,
    /// Texels a line.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    texels: u32,
    /// Seed; equal seeds give equal files.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Output file; `-` is stdout.
    #[arg(long, short)]
    output: PathBuf,
}

impl Vectors {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        match self {
            Self::Apply(command) => command.run(),
            Self::Check(command) => command.run(),
            Self::Judge(command) => command.run(),
            Self::Generate(command) => command.run(),
            #[cfg(feature = "gpu")]
            Self::Record(command) => command.run(),
        }
    }
}

/// An error of the file `path`.
pub(super) fn in_file(path: &std::path::Path, error: vectors::VectorError) -> Failure {
    match error {
        // A closed pipe must stay recognisable.
        vectors::VectorError::Io(error) if error.kind() == std::io::ErrorKind::BrokenPipe => error.into(),
        error => format!("{}: {error}", path.display()).into(),
    }
}

impl Apply {
    fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        let input = output::open(&self.input)?;
        output::write_file(&self.output, |file| {
            let lines = vectors::apply_within(model.as_ref(), input, file, super::limits::get())
                .map_err(|e| in_file(&self.input, e))?;
            if lines == 0 { Err(format!("{}: no line to fill in", self.input.display()).into()) } else { Ok(()) }
        })?;
        Ok(Outcome::Done)
    }
}

impl Check {
    fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        let mut text = String::new();
        let mut shown = 0;
        let report =
            vectors::check_within(model.as_ref(), output::open(&self.input)?, super::limits::get(), |mismatch| {
                if shown < self.show {
                    text.push_str(&describe(mismatch));
                }
                shown += 1;
            })
            .map_err(|e| in_file(&self.input, e))?;
        if self.report {
            output::print_json("vectors-check", &report)?;
        } else {
            if let Some(driver) = &report.recorded_by {
                text.insert_str(0, &format!("recorded by {driver}\n"));
            }
            if shown > self.show {
                text.push_str(&format!("... and {} more failing lines\n", shown - self.show));
            }
            for (format, counts) in &report.formats {
                text.push_str(&format!(
                    "{format:16} {:8} texels, {} differ ({} of {} lines){}\n",
                    counts.texels,
                    counts.failed_texels,
                    counts.failed_lines,
                    counts.lines,
                    undecided(counts)
                ));
            }
            for (reason, lines) in &report.not_covered {
                text.push_str(&format!("{}: {lines} lines: {reason}\n", Verdict::NotCovered));
            }
            let total = report.total;
            text.push_str(&format!(
                "{} {}: {} lines, {} texels, {} texels differ in {} lines{}\n",
                report.model,
                report.verdict,
                total.lines,
                total.texels,
                total.failed_texels,
                total.failed_lines,
                undecided(&total)
            ));
            output::print(&text)?;
        }
        Ok(Outcome::Judged(report.verdict))
    }
}

impl Generate {
    fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        let mut formats = formats(&self.format)?;
        if self.format.is_empty() {
            formats.0.retain(|format| model.supports(*format, None).is_ok());
        }
        let (lines, texels) = (self.lines as usize, self.texels as usize);
        output::write_file(&self.output, |file| {
            for kind in kinds(&self.kind, &formats)? {
                for mut line in vectors::generate_kind(kind, self.seed, &formats.0, &formats.1, lines, texels) {
                    // The format without blending may be all this model has.
                    line.reduce_to(model.as_ref());
                    line.supported(model.as_ref())?;
                    line.fill(model.as_ref());
                    writeln!(file, "{}", line.to_json())?;
                }
            }
            Ok(())
        })?;
        Ok(Outcome::Done)
    }
}

/// Texels that count neither way, where there are any.
fn undecided(counts: &vectors::Checked) -> String {
    match counts.undecided_texels {
        0 => String::new(),
        n => format!("; {n} undecided: the driver's result depends on its history"),
    }
}

/// One failing line: its state, and the first texel that differs.
fn describe(m: &Mismatch) -> String {
    format!(
        "line {}: {}: {} of {} texels differ\n  first at texel {}: {}\n  expected {}, got {}\n",
        m.line, m.state, m.texels, m.of, m.texel, m.inputs, m.expected, m.got
    )
}

/// The formats a command names, or all: those of color and layers, and those of depth.
pub(super) fn formats(names: &[String]) -> Result<(Vec<ColorFormat>, Vec<DepthFormat>), Failure> {
    let (mut colors, mut depths) = (Vec::new(), Vec::new());
    if names.is_empty() {
        colors = FORMATS.iter().map(|(_, format)| ColorFormat::new(*format)).collect::<Result<_, _>>()?;
        depths = DEPTH_FORMATS.iter().map(|(_, format)| DepthFormat::new(*format)).collect::<Result<_, _>>()?;
    }
    for name in names {
        match DepthFormat::from_name(name) {
            Some(format) => depths.push(format),
            None => colors.push(ColorFormat::from_name(name)?),
        }
    }
    Ok((colors, depths))
}

/// The kinds of lines to make; every kind needs a format of its own.
pub(super) fn kinds(
    asked: &[Kind],
    (colors, depths): &(Vec<ColorFormat>, Vec<DepthFormat>),
) -> Result<Vec<Kind>, Failure> {
    let has = |kind: &Kind| if *kind == Kind::Depth { !depths.is_empty() } else { !colors.is_empty() };
    if asked.is_empty() {
        // Named depth formats ask for depth lines.
        return Ok(vec![if colors.is_empty() { Kind::Depth } else { Kind::Color }]);
    }
    match asked.iter().find(|kind| !has(kind)) {
        Some(Kind::Depth) => Err("kind `depth` needs a depth format; name one with --format, or none".into()),
        Some(_) => Err("kinds `color` and `layers` need a color format; name one with --format, or none".into()),
        None => Ok(asked.to_vec()),
    }
}
