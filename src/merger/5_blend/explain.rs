//! The blend equation with the numbers substituted, for people.
//!
//! Every step shows the rule in symbols, the rule with this model's numbers, and what that gives in real arithmetic
//! wherever the model rounds: so that each rounding can be found, and checked by hand.

use wgpu_types::{BlendFactor, BlendOperation, BlendState};

use super::describe::{channel_steps, each, finish, formula, same, short, step, stored};
use super::{Equation, Operands, Steps, component, equation, operation};
use crate::format::{ChannelKind, Codes, Rounding, snorm, unorm};
use crate::model::exact::extended::{Extended, Value};
use crate::model::{Arithmetic, ColorInputs, Explanation, Number, Step, StepKind};

/// Numbers of one step, RGBA.
type Numbers = [Number; 4];

/// Turns the values of [`super::blend`] and the codes stored into steps of text.
pub fn explain<A: Arithmetic>(
    arithmetic: &A,
    inputs: &ColorInputs,
    steps: &Steps<A::Value>,
    codes: Codes,
) -> Explanation {
    let describe = |values: &[A::Value; 4]| -> Numbers { std::array::from_fn(|i| arithmetic.describe(&values[i])) };
    let operands = Operands {
        src: describe(&steps.operands.src),
        src1: describe(&steps.operands.src1),
        constant: describe(&steps.operands.constant),
        dst: describe(&steps.operands.dst),
    };
    let mut out = taken_in(inputs, &operands);
    let result = describe(&steps.result);
    if let (Some(state), Some(inner)) = (&inputs.blend, &steps.equation) {
        let numbers = Equation {
            src_factors: describe(&inner.src_factors),
            dst_factors: describe(&inner.dst_factors),
            terms: std::array::from_fn(|i| {
                (arithmetic.describe(&inner.terms[i].0), arithmetic.describe(&inner.terms[i].1))
            }),
        };
        out.extend(blended(inputs, state, &operands, &numbers, &result));
    }
    let clamped = describe(&steps.clamped);
    if (0..4).any(|i| !same(&clamped[i], &result[i])) {
        out.push(each(StepKind::Clamped, |i| step("to the target's range", "", None, &clamped[i])));
    }
    let scaled = |i: usize| Some((channel_steps(inputs.format, i)?, &clamped[i], &steps.clamped[i]));
    out.push(Step {
        kind: StepKind::Scaled,
        channels: std::array::from_fn(|i| {
            let (n, number, value) = scaled(i)?;
            let unrounded =
                number.fraction().map(|x| Number::rational(x * num_rational::BigRational::from_integer(n.into())));
            let value = arithmetic.describe_scaled(value, n);
            Some(step(&format!("result * {n}"), &format!("{} * {n}", short(number)), unrounded, &value))
        }),
    });
    out.push(stored(inputs.format, codes));
    finish(inputs.format, out, codes)
}

/// Source, second source, constant and destination, as far as the equation reads them.
fn taken_in(inputs: &ColorInputs, operands: &Operands<Number>) -> Vec<Step> {
    let ideal = Extended::new(Rounding::NearestEven);
    let class = inputs.format.class();
    let read = |kind, symbol: &str, given: [f32; 4], taken: &Numbers| {
        each(kind, |i| {
            let clamped = super::clamp::clamp_input(given[i], class);
            let clamps = clamped.to_bits() != given[i].to_bits();
            let formula = if clamps { format!("{symbol}, clamped") } else { symbol.to_owned() };
            let substituted = if clamps { format!("{}", given[i]) } else { String::new() };
            step(&formula, &substituted, Some(Number::binary(clamped.into())), &taken[i])
        })
    };
    let mut out = vec![read(StepKind::Source, "S", inputs.src, &operands.src)];
    let Some(state) = &inputs.blend else { return out };
    if uses(state, BlendFactor::ref_second_blend_source) {
        out.push(read(StepKind::SecondSource, "S1", inputs.src1, &operands.src1));
    }
    if uses(state, |f| matches!(f, BlendFactor::Constant | BlendFactor::OneMinusConstant)) {
        out.push(read(StepKind::Constant, "K", inputs.constant, &operands.constant));
    }
    out.push(each(StepKind::Destination, |i| {
        let kind = inputs.format.channels()[i];
        let code = inputs.dst[i];
        let formula = match kind {
            ChannelKind::Absent => "D, no such channel".to_owned(),
            ChannelKind::Unorm(bits) => format!("D, code {code} of {}", unorm::steps(bits)),
            ChannelKind::Snorm(bits) => format!("D, code {} of {}", snorm::signed_code(code, bits), snorm::steps(bits)),
            ChannelKind::Srgb => format!("D, linear value of code {code}"),
            ChannelKind::Float(_) => format!("D, bits {code:#x}"),
        };
        let decoded = (kind != ChannelKind::Absent).then(|| ideal.describe(&ideal.decode(code, kind)));
        step(&formula, "", decoded, &operands.dst[i])
    }));
    out
}

/// Factors, terms and operation.
fn blended(
    inputs: &ColorInputs,
    state: &BlendState,
    operands: &Operands<Number>,
    numbers: &Equation<Number>,
    result: &Numbers,
) -> Vec<Step> {
    let ideal = Extended::new(Rounding::NearestEven);
    let real = |numbers: &Numbers| -> [Value; 4] { std::array::from_fn(|i| Value::from(&numbers[i])) };
    let operands_real = Operands {
        src: real(&operands.src),
        src1: real(&operands.src1),
        constant: real(&operands.constant),
        dst: real(&operands.dst),
    };
    // Factors in real arithmetic on what the model took in.
    let unrounded = equation(&ideal, state, &operands_real, inputs);
    let factor = |kind, pick: fn(&wgpu_types::BlendComponent) -> BlendFactor, real: &[Value; 4], model: &Numbers| {
        each(kind, |i| {
            let (formula, substituted) = formula(pick(component(state, i)), i, operands);
            step(&formula, &substituted, Some(ideal.describe(&real[i])), &model[i])
        })
    };
    let mut out = vec![
        factor(StepKind::SourceFactor, |c| c.src_factor, &unrounded.src_factors, &numbers.src_factors),
        factor(StepKind::DestinationFactor, |c| c.dst_factor, &unrounded.dst_factors, &numbers.dst_factors),
    ];
    let product = |i: usize, symbols: &str, x: &Number, factor: &Number, model: &Number| {
        if operation::ignores_factors(component(state, i).operation) {
            return step(&format!("{}, factor ignored", &symbols[..1]), "", None, model);
        }
        let real = ideal.describe(&ideal.multiply(&Value::from(x), &Value::from(factor)));
        step(symbols, &format!("{} * {}", short(x), short(factor)), Some(real), model)
    };
    out.push(each(StepKind::SourceTerm, |i| {
        product(i, "S Fs", &operands.src[i], &numbers.src_factors[i], &numbers.terms[i].0)
    }));
    out.push(each(StepKind::DestinationTerm, |i| {
        product(i, "D Fd", &operands.dst[i], &numbers.dst_factors[i], &numbers.terms[i].1)
    }));
    out.push(each(StepKind::Result, |i| {
        let (s, d) = &numbers.terms[i];
        let operation = component(state, i).operation;
        let (formula, substituted) = match operation {
            BlendOperation::Add => ("S Fs + D Fd", format!("{} + {}", short(s), short(d))),
            BlendOperation::Subtract => ("S Fs - D Fd", format!("{} - {}", short(s), short(d))),
            BlendOperation::ReverseSubtract => ("D Fd - S Fs", format!("{} - {}", short(d), short(s))),
            BlendOperation::Min => ("min(S, D)", format!("min({}, {})", short(s), short(d))),
            BlendOperation::Max => ("max(S, D)", format!("max({}, {})", short(s), short(d))),
        };
        let real = operation::apply(&ideal, operation, &Value::from(s), &Value::from(d));
        step(formula, &substituted, Some(ideal.describe(&real)), &result[i])
    }));
    out
}

/// Whether any factor in use satisfies `wanted`.
fn uses(state: &BlendState, wanted: impl Fn(&BlendFactor) -> bool) -> bool {
    [state.color, state.alpha].iter().any(|c| wanted(&c.src_factor) || wanted(&c.dst_factor))
}
