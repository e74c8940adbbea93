//! Depth and stencil formats: what a depth code means and which aspects a format has.

use wgpu_types::TextureFormat as T;

use super::{FormatError, Rounding, unorm};

/// A depth and/or stencil target format.
///
/// `depth24plus` is modelled as 24-bit unorm, as lavapipe and most desktop drivers have it; WebGPU also admits 32-bit
/// float.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DepthFormat {
    texture_format: T,
}

/// Every depth/stencil format outmerge models, with WebGPU's name of each.
pub const DEPTH_FORMATS: [(&str, T); 6] = [
    ("depth16unorm", T::Depth16Unorm),
    ("depth24plus", T::Depth24Plus),
    ("depth24plus-stencil8", T::Depth24PlusStencil8),
    ("depth32float", T::Depth32Float),
    ("depth32float-stencil8", T::Depth32FloatStencil8),
    ("stencil8", T::Stencil8),
];

/// How a depth code is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DepthKind {
    /// value = code / (2^n - 1); n is 16 or 24.
    Unorm(u32),
    /// The code is the bit pattern of a binary32 number.
    Float32,
}

impl DepthKind {
    /// The real value of a depth code.
    #[must_use]
    pub fn value(self, code: u32) -> f64 {
        match self {
            Self::Unorm(bits) => f64::from(code) / f64::from(unorm::steps(bits)),
            Self::Float32 => f64::from(f32::from_bits(code)),
        }
    }

    /// The depth code of a fragment: clamped to `range`, then converted, ties away from zero.
    ///
    /// NaN becomes the range's minimum, as `min(max, max(min, z))` gives it with IEEE 754-2008 minimum and maximum.
    /// Source: D3D11.3 17.9 to 17.11 (always clamped; rounded by "add 0.5 and truncate" before comparing).
    #[must_use]
    pub fn encode(self, z: f32, range: [f32; 2]) -> u32 {
        // `f32::max` returns the number when the other operand is NaN.
        let clamped = z.max(range[0]).min(range[1]);
        match self {
            Self::Unorm(bits) => unorm::encode(f64::from(clamped), bits, Rounding::NearestAway),
            // -0 and +0 compare equal; store the one that also compares equal as bits.
            Self::Float32 => (clamped + 0.0).to_bits(),
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

    /// The format with this WebGPU name, e.g. `depth24plus-stencil8`; `None` if it is no depth/stencil format.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let (_, texture_format) = DEPTH_FORMATS.into_iter().find(|(known, _)| *known == name)?;
        Some(Self { texture_format })
    }

    /// WebGPU's name of this format.
    #[must_use]
    pub fn name(self) -> &'static str {
        DEPTH_FORMATS.iter().find(|(_, format)| *format == self.texture_format).map_or("", |(name, _)| name)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_format_is_known_by_its_name() {
        for (name, texture_format) in DEPTH_FORMATS {
            let format = DepthFormat::from_name(name).expect("listed");
            assert_eq!((format.texture_format(), format.name()), (texture_format, name), "{name}");
            assert_eq!(DepthFormat::new(texture_format), Ok(format), "{name}");
        }
        assert_eq!(DepthFormat::from_name("rgba8unorm"), None, "a color format");
    }

    #[test]
    fn nan_depth_becomes_the_minimum() {
        assert_eq!(DepthKind::Unorm(16).encode(f32::NAN, [0.25, 1.0]), 16384, "0.25 in 16 bits");
        assert_eq!(DepthKind::Float32.encode(f32::NAN, [0.0, 1.0]), 0, "zero");
    }

    #[test]
    fn depth_is_clamped_to_the_viewport_range() {
        assert_eq!(DepthKind::Unorm(24).encode(2.0, [0.0, 1.0]), 0x00ff_ffff, "far");
        assert_eq!(DepthKind::Float32.encode(-1.0, [0.5, 1.0]), 0.5_f32.to_bits(), "near");
        assert_eq!(DepthKind::Float32.encode(-0.0, [0.0, 1.0]), 0, "-0 stores as +0");
    }

    #[test]
    fn the_tie_at_a_half_rounds_up() {
        assert_eq!(DepthKind::Unorm(16).encode(0.5, [0.0, 1.0]), 32768, "32767.5");
    }
}
