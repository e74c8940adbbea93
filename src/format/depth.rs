//! Depth and stencil formats: what a depth code means and which aspects a format has.

use wgpu_types::TextureFormat as T;

use super::{FloatLayout, FormatError};

/// A depth and/or stencil target format.
///
/// `depth24plus` is modelled as 24-bit unorm, as lavapipe and most desktop drivers have it; WebGPU also admits 32-bit
/// float.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DepthFormat {
    texture_format: T,
}

/// How a depth code is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DepthKind {
    /// value = code / (2^n - 1); n is 16 or 24.
    Unorm(u32),
    /// The code is the bit pattern of a binary32 number.
    Float32,
}

impl DepthKind {
    /// The layout of a float depth code.
    pub const FLOAT_LAYOUT: FloatLayout = FloatLayout { exponent_bits: 8, mantissa_bits: 23, signed: true };

    /// The real value of a depth code.
    #[must_use]
    pub fn value(self, code: u32) -> f64 {
        match self {
            Self::Unorm(bits) => f64::from(code) / f64::from(super::unorm::steps(bits)),
            Self::Float32 => f64::from(f32::from_bits(code)),
        }
    }
}

impl DepthFormat {
    /// The depth/stencil format of a `wgpu-types` format.
    ///
    /// # Errors
    /// [`FormatError::NotDepthStencil`] for color formats.
    pub fn new(texture_format: T) -> Result<Self, FormatError> {
        match texture_format {
            T::Depth16Unorm
            | T::Depth24Plus
            | T::Depth24PlusStencil8
            | T::Depth32Float
            | T::Depth32FloatStencil8
            | T::Stencil8 => Ok(Self { texture_format }),
            other => Err(FormatError::NotDepthStencil(other)),
        }
    }

    /// The `wgpu-types` format.
    #[must_use]
    pub fn texture_format(self) -> T {
        self.texture_format
    }

    /// How depth is stored; `None` without a depth aspect.
    #[must_use]
    pub fn depth(self) -> Option<DepthKind> {
        match self.texture_format {
            T::Depth16Unorm => Some(DepthKind::Unorm(16)),
            T::Depth24Plus | T::Depth24PlusStencil8 => Some(DepthKind::Unorm(24)),
            T::Depth32Float | T::Depth32FloatStencil8 => Some(DepthKind::Float32),
            _ => None,
        }
    }

    /// Whether the format stores an 8-bit stencil value.
    #[must_use]
    pub fn has_stencil(self) -> bool {
        matches!(self.texture_format, T::Depth24PlusStencil8 | T::Depth32FloatStencil8 | T::Stencil8)
    }
}
