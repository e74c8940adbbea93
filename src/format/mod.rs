//! What a texel's bits mean: channels, their order in memory, and the number each code stands for.
//!
//! A *code* is the integer stored for one channel; its *value* is what it decodes to. A texel travels through the
//! merger as [`Codes`]: the four channels' bit patterns in RGBA order, zero where the format has no channel.
//!
//! - [`unorm`], [`snorm`], [`float`], [`srgb`]: one family of channels each;
//! - [`layout`]: which channels a `TextureFormat` has and where they lie in memory;
//! - [`depth`]: depth and stencil formats.

pub mod depth;
pub mod float;
pub mod layout;
pub mod rounding;
pub mod snorm;
pub mod srgb;
pub mod unorm;

pub use depth::DepthFormat;
pub use layout::ColorFormat;
pub use rounding::Rounding;

use wgpu_types::TextureFormat;

/// One texel: the bit pattern of each channel, RGBA, right-aligned; 0 for channels the format lacks.
pub type Codes = [u32; 4];

/// How the bits of one channel are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ChannelKind {
    /// The format has no such channel: reads as 0 for R, G, B and as 1 for A.
    Absent,
    /// Unsigned normalised, this many bits: value = code / (2^n - 1).
    Unorm(u32),
    /// Signed normalised, this many bits: value = max(code / (2^(n-1) - 1), -1), code in two's complement.
    Snorm(u32),
    /// Unsigned normalised 8 bit holding an sRGB-encoded value; its value is linear.
    Srgb,
    /// A binary floating-point number.
    Float(FloatLayout),
}

/// Bit layout of a small or ordinary binary float: sign (if any), exponent, mantissa from the top bit down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FloatLayout {
    /// Width of the biased exponent.
    pub exponent_bits: u32,
    /// Width of the stored mantissa, without the implied bit.
    pub mantissa_bits: u32,
    /// Whether a sign bit is stored; without one, negative values store as 0.
    pub signed: bool,
}

/// Which clamps the output merger applies before, inside and after the blend equation.
///
/// Source: Vulkan, *Framebuffer / Blending* (paragraph after the basic blend operations); D3D11.3 17.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TargetClass {
    /// Unsigned normalised (sRGB included): source, constant, factors and result in `[0, 1]`.
    Unorm,
    /// Signed normalised: source, constant, factors and result in `[-1, 1]`.
    Snorm,
    /// Floating point: nothing is clamped.
    Float,
}

/// A texture format the output merger does not handle in the asked role.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// Not a color format this model knows.
    #[error("{0:?} is not a color target format outmerge models; use one of: {list}", list = layout::names())]
    NotColor(TextureFormat),
    /// Not a depth or stencil format.
    #[error(
        "{0:?} is not a depth/stencil format; use depth16unorm, depth24plus, depth24plus-stencil8, depth32float, depth32float-stencil8 or stencil8"
    )]
    NotDepthStencil(TextureFormat),
    /// No format has this name.
    #[error("unknown texture format `{0}`; use one of: {list}", list = layout::names())]
    UnknownName(String),
}
