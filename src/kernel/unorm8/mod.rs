//! 8-bit unorm targets with four channels: any blend state; in integers where sources are 8-bit codes, else by [`numbers`].

pub(crate) mod flat;
mod held;
pub(super) mod numbers;
pub(crate) mod row;
pub mod rule;
mod shape;
mod vector;

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, ColorTargetState, ColorWrites};

use super::simd::{self, Isa, Simd};
use super::{Row, TEXEL};
use crate::model::llvmpipe::generation::Product;
use flat::Flat;
use row::{Operand, Side};
pub(crate) use rule::Rule;
use shape::Shape;

/// The kernel of one state.
#[derive(Clone, Debug)]
pub(crate) struct Unorm8 {
    rule: Rule,
    /// The target's bytes are in BGRA order.
    pub(super) swap: bool,
    /// Blending is off: the source replaces the destination.
    replace: bool,
    src: Side,
    dst: Side,
    /// Operation of color and alpha.
    operations: [BlendOperation; 2],
    /// The blend constant as codes, in the target's byte order.
    constant: [u8; TEXEL],
    /// 255 for the bytes that are written.
    write_mask: [u8; TEXEL],
    shape: Shape,
}

impl Unorm8 {
    /// The kernel of a target whose bytes are in BGRA order if `swap`; `None` for a constant that is no code though the
    /// model does not quantise it.
    pub(crate) fn new(target: &ColorTargetState, constant: [f32; 4], rule: Rule, swap: bool) -> Option<Self> {
        let reads_constant = |c: &BlendComponent| {
            [c.src_factor, c.dst_factor].into_iter().any(|f| matches!(f, F::Constant | F::OneMinusConstant))
        };
        let codes = constant.map(|x| rule.code(x));
        let needed = target.blend.is_some_and(|blend| reads_constant(&blend.color) || reads_constant(&blend.alpha));
        if needed && codes.contains(&None) {
            return None;
        }
        let [color, alpha] = target.blend.map_or([BlendComponent::REPLACE; 2], |blend| [blend.color, blend.alpha]);
        let mut kernel = Self {
            rule,
            swap,
            replace: target.blend.is_none(),
            src: Side::new(color.src_factor, alpha.src_factor),
            dst: Side::new(color.dst_factor, alpha.dst_factor),
            operations: [color.operation, alpha.operation],
            constant: ordered(codes.map(|code| code.unwrap_or(0)), swap),
            write_mask: write_mask(target.write_mask, swap),
            shape: Shape::Any,
        };
        kernel.shape = Shape::new(&kernel);
        Some(kernel)
    }

    /// RGBA as codes in the target's byte order.
    pub(super) fn source(&self, rgba: [f32; 4]) -> Option<[u8; TEXEL]> {
        let [r, g, b, a] = rgba.map(|x| self.rule.code(x));
        Some(ordered([r?, g?, b?, a?], self.swap))
    }

    /// Planes of numbers as a row's source, replacing what is there; `false` where some number is not from 0 to 1 or the
    /// model does not quantise.
    pub(super) fn sources(&self, planes: [&[f32]; 4], row: &mut Vec<u8>) -> bool {
        row.resize(TEXEL * planes[0].len(), 0);
        let places = ordered([0, 1, 2, 3], self.swap).map(usize::from);
        match self.rule {
            Rule::Exact => false,
            Rule::Llvmpipe(_) => interleave(planes, places, row, rule::rounded_32),
            Rule::RoundedProducts => interleave(planes, places, row, rule::rounded_64),
        }
    }

    pub(crate) fn reads_second_source(&self) -> bool {
        let second = |side: &Side| side.operands.iter().any(|o| matches!(o, Operand::Src1 | Operand::Src1Alpha));
        !self.replace && (second(&self.src) || second(&self.dst))
    }

    pub(crate) fn merge(&self, isa: Isa, row: Row<'_>) {
        simd::run(isa, Task { kernel: self, row });
    }

    /// The map of destinations that one color is; `None` where the state needs more than that.
    pub(crate) fn flat(&self, color: [u8; TEXEL]) -> Option<Flat> {
        Flat::new(self, color)
    }
}

struct Task<'a> {
    kernel: &'a Unorm8,
    row: Row<'a>,
}

impl simd::Task for Task<'_> {
    #[inline(always)]
    fn on_vectors<S: Simd>(self, simd: S) {
        vector::row(simd, self.kernel, self.row);
    }

    fn plain(self) {
        match self.kernel.rule {
            Rule::Exact => row::row(rule::Exact, self.kernel, self.row),
            Rule::RoundedProducts | Rule::Llvmpipe(Product::Nearest) => {
                row::row(rule::RoundedProducts, self.kernel, self.row);
            }
            Rule::Llvmpipe(Product::Near) => row::row(rule::NearProducts, self.kernel, self.row),
        }
    }
}

/// Planes as codes at their places of texels; `false` where some number is not from 0 to 1.
#[inline(always)]
fn interleave(planes: [&[f32]; 4], places: [usize; TEXEL], row: &mut [u8], code: impl Fn(f32) -> u8) -> bool {
    places.into_iter().zip(planes).all(|(place, plane)| {
        for (texel, x) in row.chunks_exact_mut(TEXEL).zip(plane) {
            texel[place] = code(*x);
        }
        // No early end: the loop is the compiler's to vectorise.
        plane.iter().fold(true, |all, x| all & (0.0..=1.0).contains(x))
    })
}

/// RGBA in the target's byte order.
pub(crate) fn ordered(mut rgba: [u8; TEXEL], swap: bool) -> [u8; TEXEL] {
    if swap {
        rgba.swap(0, 2);
    }
    rgba
}

/// 255 for the bytes that are written.
pub(crate) fn write_mask(mask: ColorWrites, swap: bool) -> [u8; TEXEL] {
    let byte = |bit| if mask.contains(bit) { u8::MAX } else { 0 };
    ordered([ColorWrites::RED, ColorWrites::GREEN, ColorWrites::BLUE, ColorWrites::ALPHA].map(byte), swap)
}
