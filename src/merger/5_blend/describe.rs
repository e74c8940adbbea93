//! The pieces explanations are made of: steps, short numbers, formulas of factors.

use wgpu_types::BlendFactor;

use super::Operands;
use crate::format::{ChannelKind, Codes, ColorFormat, snorm, unorm};
use crate::model::{ChannelStep, Explanation, Number, Step, StepKind, decimal};

/// Drops what concerns no channel of the format, and steps without channels.
pub(crate) fn finish(format: ColorFormat, mut steps: Vec<Step>, codes: Codes) -> Explanation {
    let channels = format.channels();
    for step in &mut steps {
        for (i, kind) in channels.iter().enumerate() {
            // An absent alpha still feeds factors; its own result is never stored.
            if *kind == ChannelKind::Absent && (i != 3 || step.kind > StepKind::Destination) {
                step.channels[i] = None;
            }
        }
    }
    steps.retain(|step| step.channels.iter().any(Option::is_some));
    Explanation { steps, codes }
}

/// The codes, as the last step.
pub(crate) fn stored(format: ColorFormat, codes: Codes) -> Step {
    each(StepKind::Stored, |i| {
        let code = match format.channels()[i] {
            ChannelKind::Snorm(bits) => f64::from(snorm::signed_code(codes[i], bits)),
            _ => f64::from(codes[i]),
        };
        ChannelStep { formula: String::new(), substituted: String::new(), unrounded: None, value: Number::binary(code) }
    })
}

/// A step of all four channels.
pub(crate) fn each(kind: StepKind, of: impl Fn(usize) -> ChannelStep) -> Step {
    Step { kind, channels: std::array::from_fn(|i| Some(of(i))) }
}

/// One channel's step; the unrounded value is kept only where it is another.
pub(crate) fn step(formula: &str, substituted: &str, unrounded: Option<Number>, value: &Number) -> ChannelStep {
    ChannelStep {
        formula: formula.to_owned(),
        substituted: substituted.to_owned(),
        unrounded: unrounded.filter(|unrounded| !same(unrounded, value)),
        value: value.clone(),
    }
}

/// Whether two numbers are one, as far as is known.
pub(super) fn same(a: &Number, b: &Number) -> bool {
    match (a.fraction(), b.fraction()) {
        (Some(a), Some(b)) => a == b,
        _ => a.decimal == b.decimal || (a.decimal.is_nan() && b.decimal.is_nan()),
    }
}

/// The short form of a number inside an equation.
pub(crate) fn short(number: &Number) -> String {
    if number.exact.is_empty() || number.exact.len() > 16 { decimal(number.decimal) } else { number.exact.clone() }
}

/// The formula of a factor for a channel, in the notation of `wgpu-types`, and with its numbers.
pub(crate) fn formula(factor: BlendFactor, channel: usize, operands: &Operands<Number>) -> (String, String) {
    let Operands { src, src1, constant, dst } = operands;
    let plain = |symbol: &str| (symbol.to_owned(), String::new());
    let complement = |symbol: &str, x: &Number| (format!("1 - {symbol}"), format!("1 - {}", short(x)));
    match factor {
        BlendFactor::Zero => plain("0"),
        BlendFactor::One => plain("1"),
        BlendFactor::Src => plain("S"),
        BlendFactor::OneMinusSrc => complement("S", &src[channel]),
        BlendFactor::SrcAlpha => plain("S.a"),
        BlendFactor::OneMinusSrcAlpha => complement("S.a", &src[3]),
        BlendFactor::Dst => plain("D"),
        BlendFactor::OneMinusDst => complement("D", &dst[channel]),
        BlendFactor::DstAlpha => plain("D.a"),
        BlendFactor::OneMinusDstAlpha => complement("D.a", &dst[3]),
        BlendFactor::SrcAlphaSaturated if channel == 3 => plain("1"),
        BlendFactor::SrcAlphaSaturated => {
            ("min(S.a, 1 - D.a)".to_owned(), format!("min({}, 1 - {})", short(&src[3]), short(&dst[3])))
        }
        BlendFactor::Constant => plain("K"),
        BlendFactor::OneMinusConstant => complement("K", &constant[channel]),
        BlendFactor::Src1 => plain("S1"),
        BlendFactor::OneMinusSrc1 => complement("S1", &src1[channel]),
        BlendFactor::Src1Alpha => plain("S1.a"),
        BlendFactor::OneMinusSrc1Alpha => complement("S1.a", &src1[3]),
    }
}

/// N of a linear normalised channel.
pub(crate) fn channel_steps(format: ColorFormat, channel: usize) -> Option<u32> {
    match format.channels()[channel] {
        ChannelKind::Unorm(bits) => Some(unorm::steps(bits)),
        ChannelKind::Snorm(bits) => Some(snorm::steps(bits).unsigned_abs()),
        ChannelKind::Absent | ChannelKind::Srgb | ChannelKind::Float(_) => None,
    }
}
