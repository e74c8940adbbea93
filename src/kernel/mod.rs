//! Fast paths: whole rows of texels merged at once, byte for byte as the reference does it.
//!
//! A [`Kernel`] is compiled once from state, format and model; then nothing branches on state inside a row. Kernels exist
//! for 8-bit unorm targets with four channels and sources that are 8-bit codes, in the models that have an integer
//! [`Rule`] for that: `exact`, `f32`, `fixed:8` and `llvmpipe`. [`Kernel::new`] answers `None` for everything else, which
//! the reference merger covers.
//!
//! - [`rule`]: how each model rounds, as 16-bit integer arithmetic, with the proof that it is the model;
//! - `unorm8`: the rows of 8-bit targets;
//! - [`simd`]: instruction sets, the choice between them, and vectors as safe functions;
//! - [`depth`]: the depth test of a row, which makes the write mask of its texels;
//! - [`tile`]: many layers at once, tile by tile, so that the target stays in the cache.
//!
//! `tests/kernel` compares kernels with the reference: exhaustively where inputs are 8-bit, on every instruction set that
//! the machine has.

pub mod depth;
pub mod simd;
pub mod tile;
mod unorm8;

pub use simd::Isa;
pub use unorm8::rule::{self, Rule};

use wgpu_types::{ColorTargetState, TextureFormat};

use crate::model::NumericModel;
use unorm8::Unorm8;

/// Bytes of a texel.
pub const TEXEL: usize = 4;

/// A row kernel for one color target.
#[derive(Clone, Debug)]
pub struct Kernel(Unorm8);

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
        let swap = match target.format {
            TextureFormat::Rgba8Unorm => false,
            TextureFormat::Bgra8Unorm => true,
            _ => return None,
        };
        Unorm8::new(target, constant, model.unorm8_rule()?, swap).map(Self)
    }

    /// Whether the second source is read.
    #[must_use]
    pub fn reads_second_source(&self) -> bool {
        self.0.reads_second_source()
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
        self.0.merge(isa, Row { src, src1, keep, dst });
    }
}
