//! The steps of one model as text: one line a step, channels that go the same way together.

use std::fmt::Write as _;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use wgpu_types::{BlendComponent, BlendOperation, ColorWrites};

use super::{Answer, Question};
use crate::format::{ChannelKind, Codes, ColorFormat, TargetClass};
use crate::model::{ChannelStep, Explanation, Number, StepKind, decimal};
use crate::state::spelling;

/// Names of the channels.
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// Longest exact form that is printed.
const MAX_EXACT: usize = 26;

/// What was asked.
pub(super) fn heading(question: &Question) -> String {
    let inputs = &question.inputs;
    let format = inputs.format;
    let mut text = format!("{} on {}\n", question.state.trim(), format.name());
    match &inputs.blend {
        None => text.push_str("  equation     S (blending off)\n"),
        Some(blend) if blend.color == blend.alpha => {
            let _ = writeln!(text, "  equation     {}", equation(&blend.color));
        }
        Some(blend) => {
            let _ = writeln!(text, "  equation     {}; alpha {}", equation(&blend.color), equation(&blend.alpha));
        }
    }
    let numbers = |color: [f32; 4]| color.map(|x| x.to_string()).join(", ");
    let _ = writeln!(text, "  source       S = {}", numbers(inputs.src));
    if text.contains("S1") {
        let _ = writeln!(text, "  second       S1 = {}", numbers(inputs.src1));
    }
    if text.contains('K') {
        let _ = writeln!(text, "  constant     K = {}", numbers(inputs.constant));
    }
    let stored = codes(inputs.dst, format);
    let _ =
        writeln!(text, "  destination  D = {} {stored}, in memory {}", spell_codes(format), bytes(inputs.dst, format));
    if question.mask != ColorWrites::ALL {
        let masked: Vec<&str> =
            (0..4).filter(|&i| question.stores(i) && !question.writes(i)).map(|i| CHANNELS[i]).collect();
        let _ = writeln!(text, "  write mask   keeps the bits of {}", masked.join(", "));
    }
    text
}

/// The equation of one component in symbols.
fn equation(c: &BlendComponent) -> String {
    let factor = |symbol: &str, factor| {
        let formula = spelling::factor_formula(factor);
        if formula.contains(' ') && !formula.starts_with("min") {
            format!("{symbol} * ({formula})")
        } else {
            format!("{symbol} * {formula}")
        }
    };
    let (src, dst) = (factor("S", c.src_factor), factor("D", c.dst_factor));
    match c.operation {
        BlendOperation::Add => format!("{src} + {dst}"),
        BlendOperation::Subtract => format!("{src} - {dst}"),
        BlendOperation::ReverseSubtract => format!("{dst} - {src}"),
        BlendOperation::Min => "min(S, D)".to_owned(),
        BlendOperation::Max => "max(S, D)".to_owned(),
    }
}

/// One model's steps.
pub(super) fn answer(answer: &Answer, question: &Question) -> String {
    let mut text = format!("\n{}", wrap(&format!("{}: {}", answer.model, answer.provenance), 2));
    let explanation = &answer.explanation;
    for group in groups(|i| question.writes(i), |i, j| same_way(explanation, i, j)) {
        let _ = writeln!(text, "  {}", names(&group));
        let rows: Vec<[String; 4]> = explanation
            .steps
            .iter()
            .filter_map(|step| Some((step.kind, step.channels[group[0]].as_ref()?)))
            .flat_map(|(kind, step)| row(explanation, kind, step, group[0], question.inputs.format))
            .collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let (name, rule, exact) = (width(0), width(1).min(48), width(2));
        for [a, b, c, d] in &rows {
            let _ = writeln!(text, "{}", format!("    {a:name$}  {b:rule$}  {c:exact$}  {d}").trim_end());
        }
    }
    text
}

/// A step's line: name, rule, exact value, decimal with a note; source alpha comes along where a factor reads it.
fn row(
    explanation: &Explanation,
    kind: StepKind,
    step: &ChannelStep,
    channel: usize,
    format: ColorFormat,
) -> Vec<[String; 4]> {
    let line = |name: String, step: &ChannelStep, formula: &str| {
        let rule = match step.substituted.as_str() {
            "" => formula.to_owned(),
            substituted => format!("{formula} = {substituted}"),
        };
        let (exact, decimal) = value(&step.value);
        let note = step.unrounded.as_ref().map_or(String::new(), |from| rounded_from(from, &step.value));
        [name, rule, exact, format!("{decimal}{note}")]
    };
    if kind == StepKind::Stored {
        return vec![stored(explanation, channel, format)];
    }
    let mut lines = vec![line(kind.to_string(), step, &step.formula)];
    let alpha_of = |symbol: &str| {
        let factors = [StepKind::SourceFactor, StepKind::DestinationFactor];
        factors.iter().filter_map(|kind| explanation.step(*kind, channel)).any(|f| f.formula.contains(symbol))
    };
    let (name, symbol, next) = match kind {
        StepKind::Source => ("source alpha", "S.a", "S"),
        StepKind::SecondSource => ("second source alpha", "S1.a", "S1"),
        StepKind::Destination => ("destination alpha", "D.a", "D"),
        _ => return lines,
    };
    if let Some(alpha) = explanation.step(kind, 3).filter(|_| channel != 3 && alpha_of(symbol)) {
        lines.push(line(name.to_owned(), alpha, &alpha.formula.replacen(next, symbol, 1)));
    }
    lines
}

/// The last line: the code, and how it was chosen.
fn stored(explanation: &Explanation, channel: usize, format: ColorFormat) -> [String; 4] {
    let code = explanation.codes[channel];
    let kind = format.channels()[channel];
    let number = explanation.value(StepKind::Stored, channel).map_or(f64::from(code), |number| number.decimal);
    let rule = match explanation.value(StepKind::Scaled, channel) {
        Some(scaled) => {
            let off = (number - scaled.decimal).abs();
            if off == 0.0 {
                "a whole code".to_owned()
            } else if off == 0.5 {
                format!(
                    "{} is a tie{}",
                    decimal(scaled.decimal),
                    if code.is_multiple_of(2) { ": to the even code" } else { "" }
                )
            } else if off < 0.5 {
                "the nearest code".to_owned()
            } else {
                "truncated".to_owned()
            }
        }
        None if kind == ChannelKind::Srgb => "nearest on the sRGB curve".to_owned(),
        None => String::new(),
    };
    let (exact, decimal) = match kind {
        ChannelKind::Float(layout) => (format!("{code:#x}"), decimal(layout.decode(code))),
        _ => (format!("{number}"), format!("{code:#x}")),
    };
    ["stored code".to_owned(), rule, exact, decimal]
}

/// Exact form and decimal of a number, the decimal in full only where it stands alone.
fn value(number: &Number) -> (String, String) {
    if number.exact.is_empty() || number.exact.len() > MAX_EXACT {
        return (String::new(), decimal(number.decimal));
    }
    let decimal = short_decimal(number.decimal);
    if number.exact == decimal { (decimal, String::new()) } else { (number.exact.clone(), decimal) }
}

/// Eight significant digits.
fn short_decimal(x: f64) -> String {
    format!("{x:.7e}").parse().map_or_else(|_| decimal(x), decimal)
}

/// What was rounded: `from 63.25098/255`.
fn rounded_from(from: &Number, to: &Number) -> String {
    format!("  from {}", over_same(from, to).unwrap_or_else(|| decimal(from.decimal)))
}

/// A number over the denominator of another, `63.25098/255`, where that has one.
pub(super) fn over_same(from: &Number, to: &Number) -> Option<String> {
    let (_, denominator) = to.exact.split_once('/').filter(|_| to.exact.len() <= MAX_EXACT)?;
    let steps = match denominator.strip_prefix("2^") {
        Some(power) => BigInt::from(1) << power.parse::<u32>().ok()?,
        None => denominator.parse().ok()?,
    };
    let numerator = (from.fraction()? * BigRational::from_integer(steps)).to_f64()?;
    Some(format!("{}/{denominator}", decimal(numerator)))
}

/// Channels in groups of equal ones, in order.
pub(super) fn groups(wanted: impl Fn(usize) -> bool, same: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in (0..4).filter(|&i| wanted(i)) {
        match groups.iter_mut().find(|group| same(group[0], i)) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}

/// `R, G, B`.
pub(super) fn names(group: &[usize]) -> String {
    group.iter().map(|&i| CHANNELS[i]).collect::<Vec<_>>().join(", ")
}

/// Whether two channels have the same numbers and rules all along. Alpha stands alone where it is read as a factor.
fn same_way(explanation: &Explanation, i: usize, j: usize) -> bool {
    let bits = |number: &Number| (number.decimal.to_bits(), number.exact.clone());
    explanation.steps.iter().all(|step| match (&step.channels[i], &step.channels[j]) {
        (Some(a), Some(b)) => {
            bits(&a.value) == bits(&b.value) && a.formula == b.formula && a.substituted == b.substituted
        }
        (None, None) => true,
        _ => false,
    })
}

/// `codes` or, for floats, `bits`.
pub(super) fn spell_codes(format: ColorFormat) -> &'static str {
    if format.class() == TargetClass::Float { "bits" } else { "codes" }
}

/// The codes of the channels there are, decimal for normalised formats and hex for floats.
pub(super) fn codes(codes: Codes, format: ColorFormat) -> String {
    let stored = (0..4).filter(|&i| format.channels()[i] != ChannelKind::Absent);
    stored.map(|i| code(codes[i], format)).collect::<Vec<_>>().join(" ")
}

/// One code.
pub(super) fn code(code: u32, format: ColorFormat) -> String {
    if format.class() == TargetClass::Float { format!("{code:#x}") } else { code.to_string() }
}

/// The texel in memory, in hex.
pub(super) fn bytes(codes: Codes, format: ColorFormat) -> String {
    let mut texel = vec![0; format.bytes_per_texel()];
    format.pack(codes, &mut texel);
    texel.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}

/// Words in lines of at most 110 columns, later lines indented.
pub(super) fn wrap(text: &str, indent: usize) -> String {
    const WIDTH: usize = 110;
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.len() + word.len() < WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(format!("{}{word}", " ".repeat(indent))),
        }
    }
    lines.join("\n") + "\n"
}
