//! The driver's intermediate numbers, for explanations.

use num_rational::BigRational;
use wgpu_types::BlendOperation;

use crate::format::{ChannelKind, Codes, TargetClass};
use crate::merger::blend::{Operands, component, describe};
use crate::model::{ChannelStep, ColorInputs, Explanation, Number, Step, StepKind};

/// What the driver computed for one texel. Normalised targets hold codes, float targets values.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// The arithmetic, in words.
    pub rule: &'static str,
    /// N where the numbers are codes of N steps; `None` where they are values.
    pub steps: Option<u32>,
    /// Source as taken in.
    pub src: [f64; 4],
    /// Destination as loaded.
    pub dst: [f64; 4],
    /// Factors, terms and the rule of each channel; `None` with blending off.
    pub equation: [Option<Equation>; 4],
    /// The result before the store.
    pub result: [f64; 4],
    /// The codes stored.
    pub codes: Codes,
}

/// One channel's equation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equation {
    /// Source factor.
    pub src_factor: f64,
    /// Destination factor.
    pub dst_factor: f64,
    /// Source and destination terms, where the driver forms them.
    pub terms: Option<(f64, f64)>,
    /// How terms are formed and combined.
    pub rule: &'static str,
}

/// Turns the numbers into text.
pub(super) fn explain(inputs: &ColorInputs, steps: &Steps) -> Explanation {
    let number = |x: f64| match steps.steps {
        Some(n) => code(x, n),
        None => Number::binary(x),
    };
    let all = |values: [f64; 4]| values.map(number);
    let (src, dst) = (all(steps.src), all(steps.dst));
    let given = inputs.src.map(|x| Number::binary(x.into()));
    let mut out = vec![describe::each(StepKind::Source, |i| {
        describe::step(&format!("S, {}", steps.rule), "", Some(given[i].clone()), &src[i])
    })];
    if let Some(state) = &inputs.blend {
        out.push(describe::each(StepKind::Destination, |i| {
            let formula = if inputs.format.channels()[i] == ChannelKind::Absent {
                "D, no such channel".to_owned()
            } else {
                format!("D, code {} loaded", inputs.dst[i])
            };
            describe::step(&formula, "", None, &dst[i])
        }));
        // Second source and constant are shown by the models that follow the equation.
        let zeros = all([0.0; 4]);
        let operands = Operands { src: src.clone(), src1: zeros.clone(), constant: zeros, dst: dst.clone() };
        let factor = |kind, source: bool| Step {
            kind,
            channels: std::array::from_fn(|i| {
                let equation = steps.equation[i]?;
                let c = component(state, i);
                let name = if source { c.src_factor } else { c.dst_factor };
                let (formula, _) = describe::formula(name, i, &operands);
                let value = number(if source { equation.src_factor } else { equation.dst_factor });
                Some(describe::step(&formula, "", None, &value))
            }),
        };
        out.push(factor(StepKind::SourceFactor, true));
        out.push(factor(StepKind::DestinationFactor, false));
        let term = |kind, source: bool| Step {
            kind,
            channels: std::array::from_fn(|i| {
                let equation = steps.equation[i]?;
                let (s, d) = equation.terms?;
                let (symbols, x, factor, value) = if source {
                    ("S Fs", &src[i], number(equation.src_factor), number(s))
                } else {
                    ("D Fd", &dst[i], number(equation.dst_factor), number(d))
                };
                let substituted = format!("{} * {}", describe::short(x), describe::short(&factor));
                let real = x.fraction().zip(factor.fraction()).map(|(x, factor)| Number::rational(x * factor));
                Some(describe::step(symbols, &substituted, real, &value))
            }),
        };
        out.push(term(StepKind::SourceTerm, true));
        out.push(term(StepKind::DestinationTerm, false));
        out.push(Step {
            kind: StepKind::Result,
            channels: std::array::from_fn(|i| {
                let equation = steps.equation[i]?;
                let value = number(steps.result[i]);
                let saturates = steps.steps.is_some();
                Some(result(component(state, i).operation, &equation, saturates, &value, &number))
            }),
        });
    }
    out.push(Step {
        kind: StepKind::Scaled,
        channels: std::array::from_fn(|i| {
            let n = describe::channel_steps(inputs.format, i)?;
            // The driver clamps before it stores.
            let low = if inputs.format.class() == TargetClass::Snorm { -1.0 } else { 0.0 };
            let clamped = match steps.steps {
                Some(_) => number(steps.result[i]),
                None => Number::binary(steps.result[i].clamp(low, 1.0)),
            };
            let scaled = Number::rational(clamped.fraction()? * BigRational::from_integer(n.into()));
            let substituted = format!("{} * {n}", describe::short(&clamped));
            Some(describe::step(&format!("result * {n}"), &substituted, None, &scaled))
        }),
    });
    out.push(describe::stored(inputs.format, steps.codes));
    describe::finish(inputs.format, out, steps.codes)
}

/// The driver's rule; where it forms terms, the operation on them.
fn result(
    operation: BlendOperation,
    equation: &Equation,
    saturates: bool,
    value: &Number,
    number: &dyn Fn(f64) -> Number,
) -> ChannelStep {
    let Some((s, d)) = equation.terms.map(|(s, d)| (number(s), number(d))) else {
        return describe::step(equation.rule, "", None, value);
    };
    let (formula, left, minus, right) = match operation {
        BlendOperation::ReverseSubtract => ("D Fd - S Fs", d, true, s),
        BlendOperation::Subtract => ("S Fs - D Fd", s, true, d),
        _ => ("S Fs + D Fd", s, false, d),
    };
    let formula = if saturates { format!("{formula}, saturating") } else { formula.to_owned() };
    let sign = if minus { '-' } else { '+' };
    let substituted = format!("{} {sign} {}", describe::short(&left), describe::short(&right));
    let real = left.fraction().zip(right.fraction()).map(|(l, r)| Number::rational(if minus { l - r } else { l + r }));
    describe::step(&formula, &substituted, real, value)
}

/// A code of n steps as a fraction.
fn code(x: f64, n: u32) -> Number {
    #[expect(clippy::cast_possible_truncation, reason = "codes are integers of at most 16 bits and a sign")]
    let code = x as i64;
    Number::ratio(code, n)
}
