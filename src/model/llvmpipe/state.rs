//! The blend state as the driver sees it, after the rewriting of factors that name channels the target lacks.

use wgpu_types::{BlendComponent, BlendFactor, BlendState};

use crate::format::{ChannelKind, ColorFormat, TargetClass};

/// Channels a format stores, counted from R.
pub(super) fn channel_count(format: ColorFormat) -> usize {
    format.channels().iter().filter(|kind| **kind != ChannelKind::Absent).count()
}

/// Rewrites factors for a format without stored alpha: destination alpha is 1.
///
/// src-alpha-saturated becomes zero for normalised targets. On float targets, where the source alpha may be negative,
/// it stays min(source alpha, 1 - 1).
pub(super) fn rewrite(state: BlendState, format: ColorFormat) -> BlendState {
    if format.channels()[3] != ChannelKind::Absent {
        return state;
    }
    let normalised = format.class() != TargetClass::Float;
    let factor = |factor| match factor {
        BlendFactor::DstAlpha => BlendFactor::One,
        BlendFactor::OneMinusDstAlpha => BlendFactor::Zero,
        BlendFactor::SrcAlphaSaturated if normalised => BlendFactor::Zero,
        other => other,
    };
    let component = |c: BlendComponent| BlendComponent {
        src_factor: factor(c.src_factor),
        dst_factor: factor(c.dst_factor),
        operation: c.operation,
    };
    BlendState { color: component(state.color), alpha: component(state.alpha) }
}

/// Whether two factors are f and 1 - f, in either order; zero and one count.
pub(super) fn complementary(a: BlendFactor, b: BlendFactor) -> bool {
    complement(a) == Some(b)
}

/// Whether a factor is the inverted one of its pair.
pub(super) fn is_inverted(factor: BlendFactor) -> bool {
    use BlendFactor as F;
    matches!(
        factor,
        F::Zero
            | F::OneMinusSrc
            | F::OneMinusSrcAlpha
            | F::OneMinusDst
            | F::OneMinusDstAlpha
            | F::OneMinusConstant
            | F::OneMinusSrc1
            | F::OneMinusSrc1Alpha
    )
}

/// The other factor of a complementary pair; src-alpha-saturated has none.
fn complement(factor: BlendFactor) -> Option<BlendFactor> {
    use BlendFactor as F;
    Some(match factor {
        F::Zero => F::One,
        F::One => F::Zero,
        F::Src => F::OneMinusSrc,
        F::OneMinusSrc => F::Src,
        F::SrcAlpha => F::OneMinusSrcAlpha,
        F::OneMinusSrcAlpha => F::SrcAlpha,
        F::Dst => F::OneMinusDst,
        F::OneMinusDst => F::Dst,
        F::DstAlpha => F::OneMinusDstAlpha,
        F::OneMinusDstAlpha => F::DstAlpha,
        F::Constant => F::OneMinusConstant,
        F::OneMinusConstant => F::Constant,
        F::Src1 => F::OneMinusSrc1,
        F::OneMinusSrc1 => F::Src1,
        F::Src1Alpha => F::OneMinusSrc1Alpha,
        F::OneMinusSrc1Alpha => F::Src1Alpha,
        F::SrcAlphaSaturated => return None,
    })
}
