//! The blend equation with the numbers substituted, for people.

use wgpu_types::{BlendFactor, BlendOperation};

use super::{Steps, component};
use crate::format::{ChannelKind, Codes};
use crate::model::{Arithmetic, ColorInputs, Explanation, Number, Step};

/// Turns the values of [`super::blend`] and the codes stored into steps of text.
pub fn explain<A: Arithmetic>(
    arithmetic: &A,
    inputs: &ColorInputs,
    steps: &Steps<A::Value>,
    codes: Codes,
) -> Explanation {
    let channels = inputs.format.channels();
    let describe = |values: &[A::Value; 4]| -> [Option<Number>; 4] {
        std::array::from_fn(|i| Some(arithmetic.describe(&values[i])))
    };
    let plain =
        |name: &str, values: [Option<Number>; 4]| Step { name: name.to_owned(), values, equation: Default::default() };
    let mut out = vec![plain("source, taken in", describe(&steps.operands.src))];
    if let (Some(state), Some(equation)) = (&inputs.blend, &steps.equation) {
        if uses(state, BlendFactor::ref_second_blend_source) {
            out.push(plain("second source, taken in", describe(&steps.operands.src1)));
        }
        if uses(state, |f| matches!(f, BlendFactor::Constant | BlendFactor::OneMinusConstant)) {
            out.push(plain("blend constant, taken in", describe(&steps.operands.constant)));
        }
        out.push(plain("destination, decoded", describe(&steps.operands.dst)));
        out.push(Step {
            name: "source factor".to_owned(),
            values: describe(&equation.src_factors),
            equation: std::array::from_fn(|i| formula(component(state, i).src_factor, i).to_owned()),
        });
        out.push(Step {
            name: "destination factor".to_owned(),
            values: describe(&equation.dst_factors),
            equation: std::array::from_fn(|i| formula(component(state, i).dst_factor, i).to_owned()),
        });
        let show = |value: &A::Value| short(&arithmetic.describe(value));
        let ignored = |i| super::operation::ignores_factors(component(state, i).operation);
        let product = |i: usize, value: &A::Value, factor: &A::Value| {
            if ignored(i) { "factor ignored".to_owned() } else { format!("{} * {}", show(value), show(factor)) }
        };
        out.push(Step {
            name: "source term".to_owned(),
            values: std::array::from_fn(|i| Some(arithmetic.describe(&equation.terms[i].0))),
            equation: std::array::from_fn(|i| product(i, &steps.operands.src[i], &equation.src_factors[i])),
        });
        out.push(Step {
            name: "destination term".to_owned(),
            values: std::array::from_fn(|i| Some(arithmetic.describe(&equation.terms[i].1))),
            equation: std::array::from_fn(|i| product(i, &steps.operands.dst[i], &equation.dst_factors[i])),
        });
        out.push(Step {
            name: "result".to_owned(),
            values: describe(&steps.result),
            equation: std::array::from_fn(|i| {
                let (src, dst) = (show(&equation.terms[i].0), show(&equation.terms[i].1));
                match component(state, i).operation {
                    BlendOperation::Add => format!("{src} + {dst}"),
                    BlendOperation::Subtract => format!("{src} - {dst}"),
                    BlendOperation::ReverseSubtract => format!("{dst} - {src}"),
                    BlendOperation::Min => format!("min({src}, {dst})"),
                    BlendOperation::Max => format!("max({src}, {dst})"),
                }
            }),
        });
    }
    out.push(plain("result, clamped", describe(&steps.clamped)));
    let on_code_scale = std::array::from_fn(|i| code_scale(channels[i], &arithmetic.describe(&steps.clamped[i])));
    out.push(plain("on the code scale", on_code_scale));
    out.push(Step {
        name: "stored code".to_owned(),
        values: std::array::from_fn(|i| {
            (channels[i] != ChannelKind::Absent)
                .then(|| Number { decimal: f64::from(codes[i]), exact: format!("{:#x}", codes[i]) })
        }),
        equation: Default::default(),
    });
    for step in &mut out {
        for (i, kind) in channels.iter().enumerate() {
            // An absent channel's alpha still feeds factors; its own result is never stored.
            if *kind == ChannelKind::Absent && i != 3 {
                step.values[i] = None;
                step.equation[i].clear();
            }
        }
    }
    Explanation { steps: out, codes }
}

/// Whether any factor in use satisfies `wanted`.
fn uses(state: &wgpu_types::BlendState, wanted: impl Fn(&BlendFactor) -> bool) -> bool {
    [state.color, state.alpha].iter().any(|c| wanted(&c.src_factor) || wanted(&c.dst_factor))
}

/// Where a linear normalised value falls between the codes; nothing for other channels.
fn code_scale(kind: ChannelKind, value: &Number) -> Option<Number> {
    let steps = match kind {
        ChannelKind::Unorm(bits) => f64::from(crate::format::unorm::steps(bits)),
        ChannelKind::Snorm(bits) => f64::from(crate::format::snorm::steps(bits)),
        ChannelKind::Absent | ChannelKind::Srgb | ChannelKind::Float(_) => return None,
    };
    Some(Number { decimal: value.decimal * steps, exact: String::new() })
}

/// The short form of a number inside an equation.
fn short(number: &Number) -> String {
    if number.exact.is_empty() || number.exact.len() > 24 {
        format!("{}", number.decimal)
    } else {
        number.exact.clone()
    }
}

/// The formula of a factor for a channel, in the notation of `wgpu-types`.
fn formula(factor: BlendFactor, channel: usize) -> &'static str {
    match factor {
        BlendFactor::Zero => "0",
        BlendFactor::One => "1",
        BlendFactor::Src => "S",
        BlendFactor::OneMinusSrc => "1 - S",
        BlendFactor::SrcAlpha => "S.a",
        BlendFactor::OneMinusSrcAlpha => "1 - S.a",
        BlendFactor::Dst => "D",
        BlendFactor::OneMinusDst => "1 - D",
        BlendFactor::DstAlpha => "D.a",
        BlendFactor::OneMinusDstAlpha => "1 - D.a",
        BlendFactor::SrcAlphaSaturated if channel == 3 => "1",
        BlendFactor::SrcAlphaSaturated => "min(S.a, 1 - D.a)",
        BlendFactor::Constant => "K",
        BlendFactor::OneMinusConstant => "1 - K",
        BlendFactor::Src1 => "S1",
        BlendFactor::OneMinusSrc1 => "1 - S1",
        BlendFactor::Src1Alpha => "S1.a",
        BlendFactor::OneMinusSrc1Alpha => "1 - S1.a",
    }
}
