//! `outmerge vectors record`: test vectors from a live adapter.

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::PathBuf;

use clap::Args;

use super::{Failure, Outcome, output};
use crate::crosscheck::{Device, OpenOptions, adapter, vector};
use crate::vectors::{self, Entry, Kind, Line};
use crate::verdict::Verdict;

/// Arguments of `vectors record`.
#[derive(Debug, Args)]
pub(super) struct Record {
    /// Part of the adapter's name or driver.
    #[arg(long, short)]
    adapter: Option<String>,
    /// Vectors whose inputs are drawn; `-` is stdin. Random ones unless given.
    input: Option<PathBuf>,
    /// Formats, comma separated; all the adapter renders unless given.
    #[arg(long, value_delimiter = ',', conflicts_with = "input")]
    format: Vec<String>,
    /// Kinds of lines, comma separated; color unless given, depth where only depth formats are.
    #[arg(long, value_enum, value_delimiter = ',', conflicts_with = "input")]
    kind: Vec<Kind>,
    /// Lines for each format.
    #[arg(long, default_value_t = 16, conflicts_with = "input", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    lines: u32,
    /// Texels a line.
    #[arg(long, default_value_t = 64, conflicts_with = "input", value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    texels: u32,
    /// Seed; equal seeds give equal inputs.
    #[arg(long, default_value_t = 1, conflicts_with = "input")]
    seed: u64,
    /// Output file; `-` is stdout.
    #[arg(long, short)]
    output: PathBuf,
}

impl Record {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let lines = self.lines()?;
        adapter::reexec_without_shader_cache()?;
        let device = Device::open(&OpenOptions { adapter: self.adapter.clone(), ..OpenOptions::default() })?;
        let mut not_run = BTreeMap::<(String, &str), usize>::new();
        let driver = device.report().record();
        if let Some(warning) = &driver.warning {
            output::complain(warning);
        }
        let mut recorded = 0_usize;
        output::write_file(&self.output, |file| {
            writeln!(file, "{}", driver.to_json())?;
            for mut line in lines {
                if let Some(reason) = vector::refusal(&device, &line) {
                    *not_run.entry((line.group(), reason)).or_default() += 1;
                    continue;
                }
                vector::record(&device, &mut line)?;
                writeln!(file, "{}", line.to_json())?;
                recorded += 1;
            }
            for ((group, reason), lines) in &not_run {
                output::complain(&format!("{}: {lines} lines of {group}: {reason}", Verdict::NotRun));
            }
            if recorded == 0 { Err("no line could be recorded".into()) } else { Ok(()) }
        })?;
        Ok(Outcome::Done)
    }

    /// The lines to draw, all read before the device is opened.
    fn lines(&self) -> Result<Vec<Line>, Failure> {
        let Some(path) = &self.input else {
            let formats = super::vectors::formats(&self.format)?;
            let (lines, texels) = (self.lines as usize, self.texels as usize);
            let kinds = super::vectors::kinds(&self.kind, &formats)?.into_iter();
            let of = |kind| vectors::generate_kind(kind, self.seed, &formats.0, &formats.1, lines, texels);
            return Ok(kinds.flat_map(of).collect());
        };
        let mut lines = Vec::new();
        for (number, text) in (1..).zip(output::open(path)?.lines()) {
            let text = text.map_err(|error| format!("{}: {error}", path.display()))?;
            if !text.trim().is_empty() {
                let wrong = |error| format!("{}: line {number}: {error}", path.display());
                // Who recorded the input's results is of no interest: they are drawn anew.
                if let Entry::Line(line) = Entry::parse(&text).map_err(wrong)? {
                    lines.push(line);
                }
            }
        }
        Ok(lines)
    }
}
