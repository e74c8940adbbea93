//! Replaying vectors through a numeric model.

use std::collections::BTreeMap;
use std::io::{BufRead, Read, Write};

use serde::Serialize;

use super::{DriverRecord, Entry, Line, LineError, VectorError, VectorLine};
use crate::limit::Limits;
use crate::merger::write_mask;
use crate::model::NumericModel;
use crate::verdict::Verdict;

/// The first texel of a line that differs, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// Line number, from 1.
    pub line: usize,
    /// Index of the texel in the line.
    pub texel: usize,
    /// Texels of the line that differ.
    pub texels: usize,
    /// Texels of the line.
    pub of: usize,
    /// Format and state.
    pub state: String,
    /// The fragment, and what is stored before.
    pub inputs: String,
    /// What the model stores.
    pub expected: String,
    /// What the line says.
    pub got: String,
}

/// Counts by format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Checked {
    /// Lines compared.
    pub lines: usize,
    /// Lines with a texel that differs.
    pub failed_lines: usize,
    /// Texels compared.
    pub texels: usize,
    /// Texels that differ.
    pub failed_texels: usize,
    /// Texels whose result depends on the driver's history, and is one of the possible ones: neither match nor mismatch.
    pub undecided_texels: usize,
    /// Lines that the model does not cover: not compared.
    pub not_covered_lines: usize,
}

impl Checked {
    /// What the comparison ended in.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let compared = Verdict::of_counts(self.failed_texels as u64, self.texels as u64, self.undecided_texels as u64);
        let covered = if self.not_covered_lines > 0 { Verdict::NotCovered } else { Verdict::NotRun };
        Verdict::of_parts([compared, covered])
    }

    fn add(&mut self, other: &Self) {
        self.lines += other.lines;
        self.failed_lines += other.failed_lines;
        self.texels += other.texels;
        self.failed_texels += other.failed_texels;
        self.undecided_texels += other.undecided_texels;
        self.not_covered_lines += other.not_covered_lines;
    }
}

/// The outcome of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// The model's name.
    pub model: String,
    /// The driver that recorded the file, where it says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<DriverRecord>,
    /// What it all ended in.
    pub verdict: Verdict,
    /// Everything.
    pub total: Checked,
    /// By format name; layers by `layers ` and the format's.
    pub formats: BTreeMap<String, Checked>,
    /// Why lines are not covered, with their number.
    pub not_covered: BTreeMap<String, usize>,
}

/// Replays every line and calls `failed` for each that differs.
///
/// # Errors
/// [`VectorError`] at the first line that is malformed or has no `out`. A line that the model does not cover is none: it is
/// counted.
pub fn check(
    model: &dyn NumericModel,
    input: impl BufRead,
    failed: impl FnMut(&Mismatch),
) -> Result<Report, VectorError> {
    check_within(model, input, &Limits::default(), failed)
}

/// [`check`] with limits of the caller's.
///
/// # Errors
/// As [`check`].
pub fn check_within(
    model: &dyn NumericModel,
    input: impl BufRead,
    limits: &Limits,
    mut failed: impl FnMut(&Mismatch),
) -> Result<Report, VectorError> {
    let mut report = Report {
        model: model.name(),
        recorded_by: None,
        verdict: Verdict::NotRun,
        total: Checked::default(),
        formats: BTreeMap::new(),
        not_covered: BTreeMap::new(),
    };
    report.recorded_by = for_each_line(input, limits, |number, line| {
        let mut count = |mine: Checked| {
            report.total.add(&mine);
            report.formats.entry(line.group()).or_default().add(&mine);
        };
        if let Err(reason) = line.supported(model) {
            count(Checked { not_covered_lines: 1, ..Checked::default() });
            *report.not_covered.entry(reason.to_string()).or_default() += 1;
            return Ok(());
        }
        let compared = line.compare(model, number);
        let compared = compared.ok_or(VectorError::Line { line: number, source: LineError::NoOut })?;
        let mine = Checked {
            lines: 1,
            failed_lines: usize::from(compared.different > 0),
            texels: line.len(),
            failed_texels: compared.different,
            undecided_texels: compared.undecided,
            not_covered_lines: 0,
        };
        count(mine);
        if let Some(first) = compared.first {
            failed(&first);
        }
        Ok(())
    })?;
    report.verdict = report.total.verdict();
    Ok(report)
}

/// Writes every line back with `out` filled in by the model; order and count stay, but for a line that names the driver, whose
/// results these are no more. Returns the number of lines.
///
/// # Errors
/// [`VectorError`] at the first line that is malformed or beyond the model, or when writing fails.
pub fn apply(model: &dyn NumericModel, input: impl BufRead, output: impl Write) -> Result<usize, VectorError> {
    apply_within(model, input, output, &Limits::default())
}

/// [`apply`] with limits of the caller's.
///
/// # Errors
/// As [`apply`].
pub fn apply_within(
    model: &dyn NumericModel,
    input: impl BufRead,
    mut output: impl Write,
    limits: &Limits,
) -> Result<usize, VectorError> {
    let mut count = 0;
    for_each_line(input, limits, |number, mut line| {
        supported(model, number, &line)?;
        line.fill(model);
        writeln!(output, "{}", line.to_json())?;
        count += 1;
        Ok(())
    })?;
    Ok(count)
}

/// Sets `out` to the model's result. The model must [support](NumericModel::supports) the line's format and state.
pub fn fill(model: &dyn NumericModel, line: &mut VectorLine) {
    let each = line.format.bytes_per_texel();
    let mut out = vec![0; line.dst.len()];
    for i in 0..line.len() {
        let inputs = line.inputs(i);
        let codes = write_mask::select(line.mask, inputs.dst, model.merge_color(&inputs));
        line.format.pack(codes, &mut out[i * each..]);
    }
    line.out = Some(out);
}

fn supported(model: &dyn NumericModel, number: usize, line: &Line) -> Result<(), VectorError> {
    line.supported(model).map_err(|source| VectorError::Unsupported { line: number, source })
}

/// Parses line by line; blank lines are passed over. Returns the driver that recorded the file, where a line says so.
pub(super) fn for_each_line(
    mut input: impl BufRead,
    limits: &Limits,
    mut each: impl FnMut(usize, Line) -> Result<(), VectorError>,
) -> Result<Option<DriverRecord>, VectorError> {
    let mut driver = None;
    let mut bytes = Vec::new();
    for number in 1.. {
        bytes.clear();
        if input.by_ref().take(limits.line_bytes.saturating_add(1)).read_until(b'\n', &mut bytes)? == 0 {
            break;
        }
        let wrong = |source| VectorError::Line { line: number, source };
        if bytes.len() as u64 > limits.line_bytes {
            return Err(wrong(LineError::TooLong(limits.line_bytes)));
        }
        let text = std::str::from_utf8(&bytes).map_err(|error| wrong(LineError::Utf8(error.valid_up_to())))?;
        if text.trim().is_empty() {
            continue;
        }
        match Entry::parse(text).map_err(wrong)? {
            Entry::Driver(record) => driver = Some(record),
            Entry::Line(line) => each(number, line)?,
        }
    }
    Ok(driver)
}
