//! Which channels a color format has and where they lie in a texel's bytes.

use wgpu_types::TextureFormat as T;

use super::{ChannelKind, Codes, FloatLayout, FormatError, TargetClass};

const HALF: ChannelKind = ChannelKind::Float(FloatLayout { exponent_bits: 5, mantissa_bits: 10, signed: true });
const SINGLE: ChannelKind = ChannelKind::Float(FloatLayout { exponent_bits: 8, mantissa_bits: 23, signed: true });
const UFLOAT11: ChannelKind = ChannelKind::Float(FloatLayout { exponent_bits: 5, mantissa_bits: 6, signed: false });
const UFLOAT10: ChannelKind = ChannelKind::Float(FloatLayout { exponent_bits: 5, mantissa_bits: 5, signed: false });
const NONE: ChannelKind = ChannelKind::Absent;

/// A color target format: its channels and their place in memory.
///
/// Cheap to copy; two are equal when they are the same `TextureFormat`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ColorFormat {
    texture_format: T,
    channels: [ChannelKind; 4],
    /// First bit of each channel, counted from the least significant bit of the little-endian texel.
    offsets: [u32; 4],
    bytes: usize,
}

/// Every color format outmerge models, with WebGPU's name of each.
pub const FORMATS: [(&str, T); 23] = [
    ("r8unorm", T::R8Unorm),
    ("rg8unorm", T::Rg8Unorm),
    ("rgba8unorm", T::Rgba8Unorm),
    ("bgra8unorm", T::Bgra8Unorm),
    ("rgba8unorm-srgb", T::Rgba8UnormSrgb),
    ("bgra8unorm-srgb", T::Bgra8UnormSrgb),
    ("r8snorm", T::R8Snorm),
    ("rg8snorm", T::Rg8Snorm),
    ("rgba8snorm", T::Rgba8Snorm),
    ("rgb10a2unorm", T::Rgb10a2Unorm),
    ("r16unorm", T::R16Unorm),
    ("rg16unorm", T::Rg16Unorm),
    ("rgba16unorm", T::Rgba16Unorm),
    ("r16snorm", T::R16Snorm),
    ("rg16snorm", T::Rg16Snorm),
    ("rgba16snorm", T::Rgba16Snorm),
    ("r16float", T::R16Float),
    ("rg16float", T::Rg16Float),
    ("rgba16float", T::Rgba16Float),
    ("rg11b10ufloat", T::Rg11b10Ufloat),
    ("r32float", T::R32Float),
    ("rg32float", T::Rg32Float),
    ("rgba32float", T::Rgba32Float),
];

impl ColorFormat {
    /// The layout of a `wgpu-types` format.
    ///
    /// # Errors
    /// [`FormatError::NotColor`] for integer, depth, compressed and shared-exponent formats.
    pub fn new(texture_format: T) -> Result<Self, FormatError> {
        use ChannelKind::{Snorm, Srgb, Unorm};
        let (channels, offsets, bytes) = match texture_format {
            T::R8Unorm => ([Unorm(8), NONE, NONE, NONE], [0; 4], 1),
            T::Rg8Unorm => ([Unorm(8), Unorm(8), NONE, NONE], [0, 8, 0, 0], 2),
            T::Rgba8Unorm => ([Unorm(8); 4], [0, 8, 16, 24], 4),
            T::Bgra8Unorm => ([Unorm(8); 4], [16, 8, 0, 24], 4),
            T::Rgba8UnormSrgb => ([Srgb, Srgb, Srgb, Unorm(8)], [0, 8, 16, 24], 4),
            T::Bgra8UnormSrgb => ([Srgb, Srgb, Srgb, Unorm(8)], [16, 8, 0, 24], 4),
            T::R8Snorm => ([Snorm(8), NONE, NONE, NONE], [0; 4], 1),
            T::Rg8Snorm => ([Snorm(8), Snorm(8), NONE, NONE], [0, 8, 0, 0], 2),
            T::Rgba8Snorm => ([Snorm(8); 4], [0, 8, 16, 24], 4),
            T::Rgb10a2Unorm => ([Unorm(10), Unorm(10), Unorm(10), Unorm(2)], [0, 10, 20, 30], 4),
            T::R16Unorm => ([Unorm(16), NONE, NONE, NONE], [0; 4], 2),
            T::Rg16Unorm => ([Unorm(16), Unorm(16), NONE, NONE], [0, 16, 0, 0], 4),
            T::Rgba16Unorm => ([Unorm(16); 4], [0, 16, 32, 48], 8),
            T::R16Snorm => ([Snorm(16), NONE, NONE, NONE], [0; 4], 2),
            T::Rg16Snorm => ([Snorm(16), Snorm(16), NONE, NONE], [0, 16, 0, 0], 4),
            T::Rgba16Snorm => ([Snorm(16); 4], [0, 16, 32, 48], 8),
            T::R16Float => ([HALF, NONE, NONE, NONE], [0; 4], 2),
            T::Rg16Float => ([HALF, HALF, NONE, NONE], [0, 16, 0, 0], 4),
            T::Rgba16Float => ([HALF; 4], [0, 16, 32, 48], 8),
            T::Rg11b10Ufloat => ([UFLOAT11, UFLOAT11, UFLOAT10, NONE], [0, 11, 22, 0], 4),
            T::R32Float => ([SINGLE, NONE, NONE, NONE], [0; 4], 4),
            T::Rg32Float => ([SINGLE, SINGLE, NONE, NONE], [0, 32, 0, 0], 8),
            T::Rgba32Float => ([SINGLE; 4], [0, 32, 64, 96], 16),
            other => return Err(FormatError::NotColor(other)),
        };
        Ok(Self { texture_format, channels, offsets, bytes })
    }

    /// The layout of the format with this WebGPU name, e.g. `rgba8unorm-srgb`.
    ///
    /// # Errors
    /// [`FormatError::UnknownName`], listing the names there are.
    pub fn from_name(name: &str) -> Result<Self, FormatError> {
        let found = FORMATS.iter().find(|(known, _)| *known == name);
        let (_, format) = found.ok_or_else(|| FormatError::UnknownName(name.to_owned()))?;
        Self::new(*format)
    }

    /// WebGPU's name of this format.
    #[must_use]
    pub fn name(self) -> &'static str {
        FORMATS.iter().find(|(_, format)| *format == self.texture_format).map_or("", |(name, _)| name)
    }

    /// The `wgpu-types` format this is the layout of.
    #[must_use]
    pub fn texture_format(self) -> T {
        self.texture_format
    }

    /// The four channels, RGBA.
    #[must_use]
    pub fn channels(self) -> [ChannelKind; 4] {
        self.channels
    }

    /// Size of a texel in bytes: 1, 2, 4, 8 or 16.
    #[must_use]
    pub fn bytes_per_texel(self) -> usize {
        self.bytes
    }

    /// Which clamps this format's blending applies. Every channel of a format is of one class; channels the format
    /// lacks are clamped like those it has (D3D11.3 17.5).
    #[must_use]
    pub fn class(self) -> TargetClass {
        match self.channels[0] {
            ChannelKind::Snorm(_) => TargetClass::Snorm,
            ChannelKind::Float(_) => TargetClass::Float,
            ChannelKind::Unorm(_) | ChannelKind::Srgb | ChannelKind::Absent => TargetClass::Unorm,
        }
    }

    /// Reads one texel from the first [`Self::bytes_per_texel`] bytes of `bytes`.
    ///
    /// # Panics
    /// When `bytes` is shorter than a texel.
    #[must_use]
    pub fn unpack(self, bytes: &[u8]) -> Codes {
        let mut raw = [0; 16];
        raw[..self.bytes].copy_from_slice(&bytes[..self.bytes]);
        let texel = u128::from_le_bytes(raw);
        std::array::from_fn(|i| {
            let mask = (1_u128 << self.channels[i].bits()) - 1;
            // At most 32 bits remain after the mask.
            u32::try_from((texel >> self.offsets[i]) & mask).expect("a channel has at most 32 bits")
        })
    }

    /// Writes one texel to the first [`Self::bytes_per_texel`] bytes of `bytes`; bits beyond a channel's width are
    /// dropped.
    ///
    /// # Panics
    /// When `bytes` is shorter than a texel.
    pub fn pack(self, codes: Codes, bytes: &mut [u8]) {
        let mut texel = 0_u128;
        for ((code, kind), offset) in codes.into_iter().zip(self.channels).zip(self.offsets) {
            let mask = (1_u128 << kind.bits()) - 1;
            texel |= (u128::from(code) & mask) << offset;
        }
        bytes[..self.bytes].copy_from_slice(&texel.to_le_bytes()[..self.bytes]);
    }
}

impl ChannelKind {
    /// The smallest and the largest number that the channel can hold; of a float channel, the finite ones.
    #[must_use]
    pub fn range(self) -> [f64; 2] {
        match self {
            Self::Absent | Self::Unorm(_) | Self::Srgb => [0.0, 1.0],
            Self::Snorm(_) => [-1.0, 1.0],
            Self::Float(layout) => {
                let largest = layout.decode(layout.max_finite());
                [if layout.signed { -largest } else { 0.0 }, largest]
            }
        }
    }

    /// Width of a code in bits; 0 when absent.
    #[must_use]
    pub fn bits(self) -> u32 {
        match self {
            Self::Absent => 0,
            Self::Unorm(bits) | Self::Snorm(bits) => bits,
            Self::Srgb => 8,
            Self::Float(float) => u32::from(float.signed) + float.exponent_bits + float.mantissa_bits,
        }
    }
}

/// The names of all formats, comma separated, for error messages.
pub(super) fn names() -> String {
    FORMATS.map(|(name, _)| name).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_format_has_a_layout_that_fills_its_bytes() {
        for (name, texture_format) in FORMATS {
            let format = ColorFormat::from_name(name).expect("listed formats are known");
            assert_eq!(format.texture_format(), texture_format, "{name}");
            let bits: u32 = format.channels().iter().map(|kind| kind.bits()).sum();
            assert_eq!(bits as usize, 8 * format.bytes_per_texel(), "{name}");
        }
    }

    #[test]
    fn pack_and_unpack_are_inverse_for_every_byte_pattern_tried() {
        for (name, texture_format) in FORMATS {
            let format = ColorFormat::new(texture_format).expect("listed formats are known");
            for seed in 0..=255_u8 {
                let bytes: Vec<u8> =
                    (0..16_u8).map(|i| seed.wrapping_mul(31).wrapping_add(i.wrapping_mul(57))).collect();
                let mut again = vec![0; 16];
                format.pack(format.unpack(&bytes), &mut again);
                let n = format.bytes_per_texel();
                assert_eq!(again[..n], bytes[..n], "{name}");
            }
        }
    }

    #[test]
    fn bgra_stores_blue_first() {
        let format = ColorFormat::new(T::Bgra8Unorm).expect("known");
        assert_eq!(format.unpack(&[1, 2, 3, 4]), [3, 2, 1, 4], "B, G, R, A in memory");
    }
}
