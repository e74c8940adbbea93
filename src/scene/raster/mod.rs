//! Triangles in, covered pixels with interpolated varyings out.
//!
//! Rules that hold here, in the order a triangle meets them:
//! 1. A vertex with a non-finite position drops its triangle; so does one whose `1/w` or `z/w` overflows binary32.
//! 2. [`clip`]: homogeneous clipping to `0 <= z <= w`, `w > 0` and a guard band far outside the target, in binary64.
//!    A cut edge gives the same new vertex whichever triangle it is seen from.
//! 3. [`setup`]: division and viewport in binary32, then positions are snapped to 1/256 of a pixel or to a coarser
//!    grid ([`RasterState::subpixel_bits`]), ties to even.
//!    Facing, culling and everything after use the snapped positions.
//! 4. [`edge`]: exact integer edge functions and the top-left rule: a pixel centre on an edge shared by two triangles
//!    belongs to exactly one of them.
//! 5. [`interpolate`]: depth linear in screen space, varyings perspective-correct, both in binary64 and rounded to
//!    binary32 once; [`bias`] adds the depth bias.
//!
//! [`llvmpipe`] has that driver's clipping, interpolation and bias instead.
//!
//! Sources: WebGPU, *Rasterization*; Vulkan, *Rasterization / Basic Polygon Rasterization*; D3D11.3 3.4.

pub mod bias;
pub mod clip;
pub mod edge;
pub mod interpolate;
pub mod llvmpipe;
pub mod setup;
#[cfg(test)]
mod tests;

pub use edge::Span;
pub use setup::Primitive;

use wgpu_types::{DepthBiasState, PrimitiveState, TextureFormat};

use crate::format::depth::DepthKind;
use crate::model::llvmpipe::Generation;
use crate::target::Extent;

/// Sub-pixel positions a pixel is divided into, per axis: the unit of positions, whatever grid they are snapped to.
pub const SUBPIXELS: i64 = 256;

/// Vulkan's `subPixelPrecisionBits` of most devices, and the most this rasteriser knows.
pub const MAX_SUBPIXEL_BITS: u8 = 8;

/// The least `subPixelPrecisionBits` that Vulkan allows.
pub const MIN_SUBPIXEL_BITS: u8 = 4;

/// A vertex after the vertex shader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex<const N: usize> {
    /// Clip-space position x, y, z, w; any `f32`.
    pub position: [f32; 4],
    /// Values to interpolate; any `f32`.
    pub varyings: [f32; N],
}

/// Whose clipping and interpolation. Snapping, facing and coverage by the top-left rule are everybody's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Rasteriser {
    /// This module's own: a wide guard band, binary64, the triangle as it is snapped.
    #[default]
    Reference,
    /// [`llvmpipe`]'s, bit for bit, on a processor with fused multiply-add instructions.
    Llvmpipe(Generation),
    /// The same on a processor without them.
    LlvmpipeUnfused(Generation),
}

/// A name that is no rasteriser's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown rasteriser `{0}`; use reference, llvmpipe, llvmpipe-unfused, or one of the latter with a version: llvmpipe:mesa=22.3"
)]
pub struct RasteriserNameError(String);

impl std::str::FromStr for Rasteriser {
    type Err = RasteriserNameError;

    /// `reference`; `llvmpipe` or `llvmpipe-unfused`, of the newest generation unless `:mesa=VERSION` follows.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let error = || RasteriserNameError(name.to_owned());
        let (kind, generation) = match name.split_once(":mesa=") {
            Some((kind, version)) => (kind, Generation::from_name(version).ok_or_else(error)?),
            None => (name, Generation::default()),
        };
        match kind {
            "reference" if kind == name => Ok(Self::Reference),
            "llvmpipe" => Ok(Self::Llvmpipe(generation)),
            "llvmpipe-unfused" => Ok(Self::LlvmpipeUnfused(generation)),
            _ => Err(error()),
        }
    }
}

impl<'de> serde::Deserialize<'de> for Rasteriser {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = <String as serde::Deserialize>::deserialize(deserializer)?;
        name.parse().map_err(serde::de::Error::custom)
    }
}

impl Rasteriser {
    /// Whether derivatives are taken along a fragment's own row and column of its quad, or once for the quad. APIs admit
    /// both (SPIR-V, *Derivative Instructions*).
    #[must_use]
    pub fn has_fine_derivatives(self) -> bool {
        self != Self::Reference
    }

    /// The driver's generation.
    #[must_use]
    pub fn generation(self) -> Option<Generation> {
        match self {
            Self::Reference => None,
            Self::Llvmpipe(generation) | Self::LlvmpipeUnfused(generation) => Some(generation),
        }
    }

    /// Whether [`llvmpipe`] cuts at twice the target's size instead of at its edges. It does so in x and y where a target of
    /// some formats is the only one and nothing is attached for depth; `format` is that target's, if so.
    #[must_use]
    pub fn has_guard_band(self, format: Option<TextureFormat>) -> bool {
        let formats = self.generation().map_or(&[][..], |generation| generation.rules().guard_band);
        format.is_some_and(|format| formats.contains(&format))
    }
}

/// What rasterisation is told about one draw. The viewport is the whole target.
#[derive(Clone, Copy, Debug)]
pub struct RasterState {
    /// Size of the target.
    pub extent: Extent,
    /// Depths that `z = 0` and `z = w` map to.
    pub depth_range: [f32; 2],
    /// Front face, culling and depth clipping; the topology is always a triangle list.
    pub primitive: PrimitiveState,
    /// Depth bias; all zero adds nothing.
    pub bias: DepthBiasState,
    /// Kind of the depth attachment, which sets the unit of the bias; `None` without one.
    pub depth: Option<DepthKind>,
    /// Positions are snapped to `2^-bits` of a pixel, [`MIN_SUBPIXEL_BITS`] to [`MAX_SUBPIXEL_BITS`]; values beyond count
    /// as the nearer of the two.
    pub subpixel_bits: u8,
    /// Whose rules.
    pub rasteriser: Rasteriser,
    /// [`Rasteriser::has_guard_band`]. The reference has a wide guard band always.
    pub guard_band: bool,
}

impl RasterState {
    /// Both faces, depth range `[0, 1]`, no bias, no depth attachment, 8 sub-pixel bits, the reference rasteriser.
    #[must_use]
    pub fn new(extent: Extent) -> Self {
        Self {
            extent,
            depth_range: [0.0, 1.0],
            primitive: PrimitiveState::default(),
            bias: DepthBiasState::default(),
            depth: None,
            subpixel_bits: MAX_SUBPIXEL_BITS,
            rasteriser: Rasteriser::default(),
            guard_band: false,
        }
    }
}

/// The parts of one triangle that may cover pixels: none, one, or a fan where clipping cut it.
#[must_use]
pub fn assemble<const N: usize>(triangle: [Vertex<N>; 3], state: &RasterState) -> Vec<Primitive<N>> {
    match state.rasteriser {
        Rasteriser::Reference => {
            fan(&clip::clip(triangle, state)).filter_map(|part| Primitive::new(part, state)).collect()
        }
        Rasteriser::Llvmpipe(_) => llvmpipe::assemble(triangle, state, true),
        Rasteriser::LlvmpipeUnfused(_) => llvmpipe::assemble(triangle, state, false),
    }
}

/// The triangles of a convex polygon, around its first vertex.
fn fan<V: Copy>(polygon: &[V]) -> impl Iterator<Item = [V; 3]> {
    polygon.get(1..).unwrap_or_default().windows(2).map(|pair| [polygon[0], pair[0], pair[1]])
}
