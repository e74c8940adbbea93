//! Holding recorded results against a specification.

use std::collections::BTreeMap;
use std::io::BufRead;

use serde::Serialize;

use super::check::for_each_line;
use super::{DepthLine, Line, LineError, VectorError, VectorLine, describe};
use crate::admissible::{Counts, DepthStencilCase, Judge, Verdict, judge_depth_stencil};
use crate::limit::Limits;
use crate::merger::depth_stencil::DepthStencil;
use crate::verdict::Verdict as Ended;

/// The first texel of a line that is outside, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Line number, from 1.
    pub line: usize,
    /// Index of the texel in the line.
    pub texel: usize,
    /// Texels of the line that are outside.
    pub texels: u64,
    /// Format and state.
    pub state: String,
    /// The fragment, and what is stored before.
    pub inputs: String,
    /// What was stored, and what is admitted.
    pub why: String,
}

/// Verdicts of some lines.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Judged {
    /// Texels by verdict.
    pub texels: Counts,
    /// Lines by the narrowest class that holds all their texels.
    pub lines: Counts,
    /// Lines of several layers: what each layer read is not recorded, so no class can be named.
    pub not_judged: usize,
}

/// The outcome of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Judgements {
    /// The specification's name.
    pub spec: String,
    /// What it all ended in.
    pub verdict: Ended,
    /// Everything.
    pub total: Judged,
    /// By format name; layers by `layers ` and the format's.
    pub formats: BTreeMap<String, Judged>,
}

/// Judges every line and calls `outside` for each that holds a result which is not admitted.
///
/// # Errors
/// [`VectorError`] at the first line that is malformed or has no `out`.
pub fn judge(
    judge: &Judge,
    input: impl BufRead,
    limits: &Limits,
    mut outside: impl FnMut(&Violation),
) -> Result<Judgements, VectorError> {
    let mut report = Judgements {
        spec: judge.spec.name().to_owned(),
        verdict: Ended::NotRun,
        total: Judged::default(),
        formats: BTreeMap::new(),
    };
    for_each_line(input, limits, |number, line| {
        let missing = || VectorError::Line { line: number, source: LineError::NoOut };
        let (texels, first) = match &line {
            Line::Color(line) => color(judge, line).ok_or_else(missing)?,
            Line::Depth(line) => depth(judge, line).ok_or_else(missing)?,
            Line::Layers(_) => (Counts::default(), None),
        };
        let lines = if texels.total() > 0 { Counts::one(texels.verdict()) } else { Counts::default() };
        for judged in [&mut report.total, report.formats.entry(line.group()).or_default()] {
            judged.texels.add(texels);
            judged.lines.add(lines);
            judged.not_judged += usize::from(matches!(line, Line::Layers(_)));
        }
        if let Some(first) = first {
            outside(&Violation { line: number, texels: texels.outside, ..first });
        }
        Ok(())
    })?;
    let left_over = if report.total.not_judged > 0 { Ended::NotCovered } else { Ended::NotRun };
    report.verdict = Ended::of_parts([report.total.texels.ended(), left_over]);
    Ok(report)
}

fn violation(texel: usize, state: String, inputs: String, why: String) -> Violation {
    Violation { line: 0, texel, texels: 0, state, inputs, why }
}

fn color(judge: &Judge, line: &VectorLine) -> Option<(Counts, Option<Violation>)> {
    let out = line.out.as_ref()?;
    let (mut texels, mut first) = (Counts::default(), None);
    for i in 0..line.len() {
        let (inputs, got) = (line.inputs(i), line.codes(out, i));
        let verdict = judge.judge(&inputs, line.mask, got).verdict;
        texels.add(Counts::one(verdict));
        if verdict == Verdict::Outside && first.is_none() {
            let state = describe::color_state(line.format, line.blend.as_ref(), line.mask);
            let why = judge.counterexample(&inputs, line.mask, got);
            first = Some(violation(i, state, describe::inputs(&inputs), why));
        }
    }
    Some((texels, first))
}

fn depth(judge: &Judge, line: &DepthLine) -> Option<(Counts, Option<Violation>)> {
    let out = line.out.as_ref()?;
    let (mut texels, mut first) = (Counts::default(), None);
    for (i, got) in out.iter().enumerate() {
        let verdict = judge_depth_stencil(judge, &case(line, i), *got);
        texels.add(Counts::one(verdict));
        if verdict == Verdict::Outside && first.is_none() {
            let DepthStencil { depth, stencil } = got;
            let why = format!("{} admits no depth {depth:#x} with stencil {stencil:#x} here", judge.spec);
            first = Some(violation(i, describe::depth_state(line), describe::depth_inputs(line, i), why));
        }
    }
    Some((texels, first))
}

/// Fragment `i` as it meets the tests.
fn case(line: &DepthLine, i: usize) -> DepthStencilCase<'_> {
    DepthStencilCase {
        state: &line.state,
        format: line.format,
        front_facing: line.front(i),
        reference: u32::from(line.reference),
        z: line.z[i],
        range: line.range,
        stored: line.dst[i],
    }
}
