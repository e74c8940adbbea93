//! Fast paths: whole rows of texels merged at once, byte for byte as the reference does it.
//!
//! A [`Kernel`] is compiled once from state, format and model; then nothing branches on state inside a row. Kernels exist
//! for
//!
//! - 8-bit unorm targets with four channels, every blend state, sources that are 8-bit codes, in the models that have an
//!   integer [`Rule`] for that: `exact`, `f32`, `fixed:8` and `llvmpipe`;
//! - 8-bit sRGB targets, sources that are 8-bit codes of linear color, and `rgba16float`, sources that are halves: straight
//!   and premultiplied over and additive blending, in the models with a [`FloatRule`]: `exact`, `f32` and `llvmpipe`.
//!
//! Sources of 8-bit unorm targets that are any numbers, in planes, have kernels of their own in `exact` and `f32`, behind
//! [`SpanMerger`].
//!
//! [`Kernel::new`] answers `None` for everything else, which the reference merger covers. [`SpanMerger`] makes that choice
//! for whole states, target by target and fragment by fragment.
//!
//! - [`rule`]: how each model rounds, as 16-bit integer arithmetic, with the proof that it is the model;
//! - `unorm8`, `srgb8`, `half`: the rows of 8-bit, sRGB and half-float targets;
//! - [`simd`]: instruction sets, the choice between them, and vectors as safe functions;
//! - [`depth`]: the depth test of a row, which makes the write mask of its texels;
//! - [`span`]: spans of fragments under any state, by kernels where they fit;
//! - [`tile`]: many layers at once, tile by tile, so that the target stays in the cache.
//!
//! `tests/kernel` compares kernels with the reference: exhaustively where inputs are 8-bit, on every instruction set that
//! the machine has.

pub mod depth;
mod half;
mod over;
pub mod simd;
pub mod span;
mod srgb8;
pub mod tile;
mod unorm8;

pub use over::FloatRule;
pub use simd::Isa;
pub use span::{Colors, Span, SpanMerger};
pub use unorm8::rule::{self, Rule};

use wgpu_types::{ColorTargetState, TextureFormat};

use crate::model::NumericModel;
use unorm8::Unorm8;
use unorm8::flat::{self, Flat};

/// Bytes of an 8-bit texel with four channels.
pub const TEXEL: usize = 4;

/// A row kernel for one color target.
#[derive(Clone, Debug)]
pub struct Kernel(Path);

/// One family of targets each.
#[derive(Clone, Debug)]
enum Path {
    Unorm8(Unorm8),
    Half(half::Half),
    Srgb8(srgb8::Srgb8),
}

/// The slices of a row; lengths are checked.
pub(crate) struct Row<'a> {
    pub(crate) src: &'a [u8],
    pub(crate) src1: Option<&'a [u8]>,
    pub(crate) keep: Option<&'a [u8]>,
    pub(crate) dst: &'a mut [u8],
}

impl Kernel {
    /// The kernel of a color target in a model; `None` where only the reference can do it.
    ///
    /// `constant` is the blend constant, RGBA. A constant that is no 8-bit code has a kernel only in models that quantise
    /// it.
    #[must_use]
    pub fn new(target: &ColorTargetState, constant: [f32; 4], model: &dyn NumericModel) -> Option<Self> {
        Some(Self(match target.format {
            TextureFormat::Rgba8Unorm => Path::Unorm8(Unorm8::new(target, constant, model.unorm8_rule()?, false)?),
            TextureFormat::Bgra8Unorm => Path::Unorm8(Unorm8::new(target, constant, model.unorm8_rule()?, true)?),
            TextureFormat::Rgba8UnormSrgb | TextureFormat::Bgra8UnormSrgb => {
                Path::Srgb8(srgb8::Srgb8::new(target, model.float_rule()?)?)
            }
            TextureFormat::Rgba16Float => Path::Half(half::Half::new(target, model.float_rule()?)?),
            _ => return None,
        }))
    }

    /// Bytes of a texel: 4, or 8 for halves.
    #[must_use]
    pub fn texel(&self) -> usize {
        match self.0 {
            Path::Unorm8(_) | Path::Srgb8(_) => TEXEL,
            Path::Half(_) => half::TEXEL,
        }
    }

    /// RGBA of a fragment as one texel of a row's source, which it stands for exactly; `None` where none does.
    fn source(&self, rgba: [f32; 4]) -> Option<[u8; half::TEXEL]> {
        let mut texel = [0; half::TEXEL];
        match &self.0 {
            Path::Unorm8(kernel) => {
                let codes = kernel.source(rgba)?;
                texel[..TEXEL].copy_from_slice(&codes);
            }
            Path::Srgb8(kernel) => texel[..TEXEL].copy_from_slice(&kernel.source(rgba)?),
            Path::Half(_) => {
                let halves = half::source(rgba)?;
                texel.copy_from_slice(&halves);
            }
        }
        Some(texel)
    }

    /// Planes of numbers as a row's source, where all of them stand for codes; else what is in `row` means nothing.
    fn sources(&self, planes: [&[f32]; 4], row: &mut Vec<u8>) -> bool {
        match &self.0 {
            Path::Unorm8(kernel) => kernel.sources(planes, row),
            Path::Half(_) | Path::Srgb8(_) => false,
        }
    }

    /// Whether a row's source takes RGBA codes as they are.
    fn takes_rgba_codes(&self) -> bool {
        match &self.0 {
            Path::Unorm8(kernel) => !kernel.swap,
            Path::Srgb8(kernel) => !kernel.swap,
            Path::Half(_) => false,
        }
    }

    /// Whether the second source is read.
    #[must_use]
    pub fn reads_second_source(&self) -> bool {
        match &self.0 {
            Path::Unorm8(kernel) => kernel.reads_second_source(),
            Path::Half(_) | Path::Srgb8(_) => false,
        }
    }

    /// Merges a row on the widest instruction set of the machine. All slices hold texels of [`texel`](Self::texel) bytes in
    /// the target's own byte order: `src` the fragments' color, `src1` the second source if the state reads it, `dst` the
    /// target. Source bytes are linear codes (k / 255), also for sRGB targets, and halves for half-float ones.
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
        assert_eq!(dst.len() % self.texel(), 0, "whole texels");
        assert!(!self.reads_second_source() || src1.is_some(), "the state reads a second source");
        assert!(src1.is_none_or(|src1| src1.len() == dst.len()), "second source and target have as many texels");
        assert!(keep.is_none_or(|keep| keep.len() * self.texel() == dst.len()), "one byte of `keep` a texel");
        let row = Row { src, src1, keep, dst };
        match &self.0 {
            Path::Unorm8(kernel) => kernel.merge(isa, row),
            Path::Half(kernel) => kernel.merge(isa, row),
            Path::Srgb8(kernel) => kernel.merge(isa, row),
        }
    }

    /// Merges one color over every texel of `dst`: a span of a flat layer. The color is in the target's byte order.
    ///
    /// # Panics
    /// When the kernel's texels have more than four bytes, `dst` does not hold whole ones, or the state reads a second
    /// source.
    pub fn merge_color(&self, color: [u8; TEXEL], dst: &mut [u8]) {
        self.merge_color_on(Isa::best(), color, dst);
    }

    /// [`merge_color`](Self::merge_color) on a given instruction set.
    ///
    /// # Panics
    /// As `merge_color`, and when the machine lacks the instruction set.
    pub fn merge_color_on(&self, isa: Isa, color: [u8; TEXEL], dst: &mut [u8]) {
        /// Texels of the row that the color is spread to where there is no shorter way.
        const SPREAD: usize = 1024;
        assert_eq!(self.texel(), TEXEL, "texels of four bytes");
        assert_eq!(dst.len() % TEXEL, 0, "whole texels");
        if let Some(flat) = self.flat(color) {
            return flat::merge(isa, &[flat], dst);
        }
        let mut spread = [0; SPREAD * TEXEL];
        let needed = dst.len().min(spread.len());
        spread[..needed].chunks_exact_mut(TEXEL).for_each(|texel| texel.copy_from_slice(&color));
        for part in dst.chunks_mut(SPREAD * TEXEL) {
            self.merge_row_on(isa, &spread[..part.len()], None, None, part);
        }
    }

    /// The short way to merge a color, if there is one.
    fn flat(&self, color: [u8; TEXEL]) -> Option<Flat> {
        match &self.0 {
            Path::Unorm8(kernel) => kernel.flat(color),
            Path::Half(_) | Path::Srgb8(_) => None,
        }
    }
}
