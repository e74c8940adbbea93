//! Which way a state's rows take, found once.

use wgpu_types::BlendOperation as Op;

use super::row::{Operand, Side};
use super::{Rule, Unorm8};
use crate::kernel::TEXEL;

/// The way a state takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// Blending is off.
    Replace,
    /// The same minimum or maximum for color and alpha.
    Least,
    Most,
    /// s + d g, for color and alpha.
    SourceOne,
    /// s f + d, for color and alpha.
    DestinationOne,
    /// `exact`: s f + d (1 - f), with the source's alpha set to 255 or not.
    Lerp {
        opaque: bool,
    },
    /// The same add or subtract for color and alpha, of two products whose factors need no more than shuffles.
    Add,
    /// [`Self::Add`] whose factors do not read the destination.
    AddBySource,
    Subtract,
    ReverseSubtract,
    /// Sums and differences, without second source, some of the factors saturated or none.
    Mixed {
        saturates: bool,
    },
    /// Everything else.
    Any,
}

impl Shape {
    pub(super) fn new(kernel: &Unorm8) -> Self {
        let one = |side: &Side| side.operands == [Operand::Zero; 2] && side.invert == [u8::MAX; TEXEL];
        let simple = |side: &Side| {
            side.operands.iter().all(|o| !matches!(o, Operand::Saturate | Operand::Src1 | Operand::Src1Alpha))
        };
        let (src, dst) = (&kernel.src, &kernel.dst);
        let opposite = |i: usize| src.operands[i] == dst.operands[i] && src.invert[3 * i] != dst.invert[3 * i];
        let [operation, alpha] = kernel.operations;
        if kernel.replace {
            return Self::Replace;
        }
        if operation != alpha || !simple(src) || !simple(dst) {
            let sum = kernel.operations.iter().all(|o| !matches!(o, Op::Min | Op::Max));
            let saturates = [src, dst].into_iter().any(|side| side.operands.contains(&Operand::Saturate));
            return if sum && !kernel.reads_second_source() { Self::Mixed { saturates } } else { Self::Any };
        }
        let by_source = [src, dst]
            .into_iter()
            .all(|side| side.operands.iter().all(|o| !matches!(o, Operand::Dst | Operand::DstAlpha)));
        match operation {
            Op::Min => Self::Least,
            Op::Max => Self::Most,
            Op::Subtract => Self::Subtract,
            Op::ReverseSubtract => Self::ReverseSubtract,
            Op::Add if one(src) => Self::SourceOne,
            Op::Add if one(dst) => Self::DestinationOne,
            Op::Add if kernel.rule == Rule::Exact && opposite(0) => {
                let alpha_is_one = src.operands[1] == Operand::Zero && src.invert[3] == u8::MAX;
                let alpha_keeps = dst.operands[1] == Operand::SrcAlpha && dst.invert[3] == u8::MAX;
                let by_src_alpha = src.operands[0] == Operand::SrcAlpha && src.invert[0] == 0;
                if opposite(1) {
                    Self::Lerp { opaque: false }
                } else if by_src_alpha && alpha_is_one && alpha_keeps {
                    Self::Lerp { opaque: true }
                } else if by_source {
                    Self::AddBySource
                } else {
                    Self::Add
                }
            }
            Op::Add if by_source => Self::AddBySource,
            Op::Add => Self::Add,
        }
    }
}
