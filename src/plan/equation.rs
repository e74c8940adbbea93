//! What one channel's blend equation reads, after everything that cannot show has been taken out of it.
//!
//! 1. A factor that names a channel the format lacks is a constant: destination alpha is 1 there.
//! 2. On a normalised target every operand is finite, so a term whose factor is the constant zero is 0 and reads nothing.
//! 3. On a float target it is not: 0 x NaN and 0 x Inf are NaN, and 0 x (-d) is -0, which decides the sign of a zero sum.
//!    There the term counts as read, unless the model says that it drops such terms
//!    ([`NumericModel::drops_zero_destination`](crate::model::NumericModel::drops_zero_destination)).
//! 4. Min and max take both operands and no factor.

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use crate::format::{ChannelKind, ColorFormat, TargetClass};
use crate::merger::blend::component;
use crate::merger::blend::operation::ignores_factors;

/// The operands an equation reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// Channels of the shader's output, RGBA.
    pub source: [bool; 4],
    /// The second source.
    pub second_source: bool,
    /// The blend constant.
    pub constant: bool,
    /// The stored texel.
    pub destination: bool,
}

impl Reads {
    fn source(channel: usize) -> Self {
        Self { source: std::array::from_fn(|i| i == channel), ..Self::default() }
    }

    const DESTINATION: Self = Self { source: [false; 4], second_source: false, constant: false, destination: true };

    /// Both together.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            source: std::array::from_fn(|i| self.source[i] || other.source[i]),
            second_source: self.second_source || other.second_source,
            constant: self.constant || other.constant,
            destination: self.destination || other.destination,
        }
    }
}

/// Whether a channel is stored by the format.
#[must_use]
pub fn stored(format: ColorFormat, channel: usize) -> bool {
    format.channels()[channel] != ChannelKind::Absent
}

/// A factor with the target's missing alpha put in.
#[must_use]
pub fn fold(factor: BlendFactor, channel: usize, format: ColorFormat) -> BlendFactor {
    match factor {
        BlendFactor::SrcAlphaSaturated if channel == 3 => BlendFactor::One,
        _ if stored(format, 3) => factor,
        BlendFactor::DstAlpha => BlendFactor::One,
        BlendFactor::OneMinusDstAlpha => BlendFactor::Zero,
        // min(source alpha, 1 - 1): 0 where source alpha cannot be negative or NaN.
        BlendFactor::SrcAlphaSaturated if format.class() == TargetClass::Unorm => BlendFactor::Zero,
        other => other,
    }
}

/// What the equation of one stored channel reads. `drops_zero` is the model's word of rule 3.
#[must_use]
pub fn reads(blend: &BlendState, channel: usize, format: ColorFormat, drops_zero: bool) -> Reads {
    let part = component(blend, channel);
    let (src, dst) = (Reads::source(channel), Reads::DESTINATION);
    if ignores_factors(part.operation) {
        return src.union(dst);
    }
    let finite = format.class() != TargetClass::Float;
    let term = |operand: Reads, factor: BlendFactor, zero_drops: bool| match fold(factor, channel, format) {
        BlendFactor::Zero if zero_drops => Reads::default(),
        folded => operand.union(factor_reads(folded, channel)),
    };
    term(src, part.src_factor, finite).union(term(dst, part.dst_factor, finite || drops_zero))
}

fn factor_reads(factor: BlendFactor, channel: usize) -> Reads {
    use BlendFactor as F;
    match factor {
        F::Zero | F::One => Reads::default(),
        F::Src | F::OneMinusSrc => Reads::source(channel),
        F::SrcAlpha | F::OneMinusSrcAlpha => Reads::source(3),
        F::Dst | F::OneMinusDst | F::DstAlpha | F::OneMinusDstAlpha => Reads::DESTINATION,
        F::SrcAlphaSaturated => Reads::source(3).union(Reads::DESTINATION),
        F::Constant | F::OneMinusConstant => Reads { constant: true, ..Reads::default() },
        F::Src1 | F::OneMinusSrc1 | F::Src1Alpha | F::OneMinusSrc1Alpha => {
            Reads { second_source: true, ..Reads::default() }
        }
    }
}

/// Whether a channel's equation is the source alone: source times one, and nothing added or taken away.
#[must_use]
pub fn is_source(blend: &BlendState, channel: usize, format: ColorFormat) -> bool {
    let BlendComponent { src_factor, dst_factor, operation } = *component(blend, channel);
    matches!(operation, BlendOperation::Add | BlendOperation::Subtract)
        && fold(src_factor, channel, format) == BlendFactor::One
        && fold(dst_factor, channel, format) == BlendFactor::Zero
}
