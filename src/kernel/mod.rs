//! Fast paths: whole rows of texels merged at once, byte for byte as the reference does it.
//!
//! A [`Kernel`] is compiled once from state, format and model; then nothing branches on state inside a row. Kernels exist
//! for 8-bit unorm targets with four channels and sources that are 8-bit codes, in the models that have an integer
//! [`Rule`] for that: `exact`, `f32`, `fixed:8` and `llvmpipe`. [`Kernel::new`] answers `None` for everything else, which
//! the reference merger covers.
//!
//! - [`rule`]: how each model rounds, as 16-bit integer arithmetic, with the proof that it is the model;
//! - [`row`]: operands, factors, terms and write mask of a row;
//! - [`simd`]: the same code compiled for each instruction set, and the choice between them;
//! - [`depth`]: the depth test of a row, which makes the write mask of its texels;
//! - [`tile`]: many layers at once, tile by tile, so that the target stays in the cache.
//!
//! `tests/kernel` compares kernels with the reference: exhaustively where inputs are 8-bit, on every instruction set that
//! the machine has.

pub mod depth;
pub mod row;
pub mod rule;
pub mod simd;
pub mod tile;

pub use rule::Rule;
pub use simd::Isa;

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, ColorTargetState, ColorWrites, TextureFormat};

use crate::format::{Rounding, unorm};
use crate::model::NumericModel;
use crate::model::llvmpipe::{VectorWidth, integer};
use row::{Operand, Side};

/// Bytes of a texel.
pub const TEXEL: usize = 4;

/// A row kernel for one color target.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub(crate) rule: Rule,
    /// Blending is off: the source replaces the destination.
    pub(crate) replace: bool,
    pub(crate) src: Side,
    pub(crate) dst: Side,
    /// Operation of color and alpha.
    pub(crate) operations: [BlendOperation; 2],
    /// The blend constant as codes, in the target's byte order.
    pub(crate) constant: [u8; TEXEL],
    /// 255 for the bytes that are written.
    pub(crate) write_mask: [u8; TEXEL],
}

impl Kernel {
    /// The kernel of a color target in a model; `None` where only the reference can do it.
    ///
    /// `constant` is the blend constant, RGBA. A constant that is no 8-bit code has a kernel only in models that quantise
    /// it.
    #[must_use]
    pub fn new(target: &ColorTargetState, constant: [f32; 4], model: &dyn NumericModel) -> Option<Self> {
        let swap = match target.format {
            TextureFormat::Rgba8Unorm => false,
            TextureFormat::Bgra8Unorm => true,
            _ => return None,
        };
        let rule = model.unorm8_rule()?;
        let order = |mut rgba: [u8; TEXEL]| {
            if swap {
                rgba.swap(0, 2);
            }
            rgba
        };
        let reads_constant = |c: &BlendComponent| {
            [c.src_factor, c.dst_factor].into_iter().any(|f| matches!(f, F::Constant | F::OneMinusConstant))
        };
        let codes = constant.map(|x| code(x, rule));
        let needed = target.blend.is_some_and(|blend| reads_constant(&blend.color) || reads_constant(&blend.alpha));
        if needed && codes.contains(&None) {
            return None;
        }
        let [color, alpha] = target.blend.map_or([BlendComponent::REPLACE; 2], |blend| [blend.color, blend.alpha]);
        let mask = |bit| if target.write_mask.contains(bit) { u8::MAX } else { 0 };
        Some(Self {
            rule,
            replace: target.blend.is_none(),
            src: Side::new(color.src_factor, alpha.src_factor),
            dst: Side::new(color.dst_factor, alpha.dst_factor),
            operations: [color.operation, alpha.operation],
            constant: order(codes.map(|code| code.unwrap_or(0))),
            write_mask: order([ColorWrites::RED, ColorWrites::GREEN, ColorWrites::BLUE, ColorWrites::ALPHA].map(mask)),
        })
    }

    /// Whether the second source is read.
    #[must_use]
    pub fn reads_second_source(&self) -> bool {
        let second = |side: &Side| side.operands.iter().any(|o| matches!(o, Operand::Src1 | Operand::Src1Alpha));
        !self.replace && (second(&self.src) || second(&self.dst))
    }

    /// Merges a row on the widest instruction set of the machine. All slices hold texels of 4 bytes in the target's own
    /// byte order: `src` the fragments' color as codes, `src1` the second source if the state reads it, `dst` the target.
    /// `keep`, one byte a texel, is 255 where the fragment is merged and 0 where it was discarded or failed a test.
    ///
    /// # Panics
    /// When the slices do not have the same number of texels, or `src1` is missing though the state reads it.
    pub fn merge_row(&self, src: &[u8], src1: Option<&[u8]>, keep: Option<&[u8]>, dst: &mut [u8]) {
        self.merge_row_on(Isa::best(), src, src1, keep, dst);
    }

    /// [`merge_row`](Self::merge_row) on a given instruction set.
    ///
    /// # Panics
    /// As `merge_row`, and when the machine lacks the instruction set.
    pub fn merge_row_on(&self, isa: Isa, src: &[u8], src1: Option<&[u8]>, keep: Option<&[u8]>, dst: &mut [u8]) {
        assert_eq!(src.len(), dst.len(), "source and target have as many texels");
        assert_eq!(dst.len() % TEXEL, 0, "whole texels");
        assert!(!self.reads_second_source() || src1.is_some(), "the state reads a second source");
        assert!(src1.is_none_or(|src1| src1.len() == dst.len()), "second source and target have as many texels");
        assert!(keep.is_none_or(|keep| keep.len() * TEXEL == dst.len()), "one byte of `keep` a texel");
        simd::run(isa, self, src, src1, keep, dst);
    }
}

/// A constant as a code: rounded by models that quantise it, otherwise only if it stands for a code.
fn code(x: f32, rule: Rule) -> Option<u8> {
    let code = match rule {
        Rule::Llvmpipe => integer::quantize8(x, VectorWidth::Bits256),
        Rule::RoundedProducts | Rule::Exact => unorm::encode(f64::from(x), 8, Rounding::NearestEven),
    };
    let byte = u8::try_from(code).ok()?;
    let clamped = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
    (rule != Rule::Exact || f32::from(byte) / 255.0 == clamped).then_some(byte)
}
