//! The ways to store a color with alpha, and the way back.

use serde::Serialize;

use super::curve::Curve;
use super::source::Space;
use crate::format::{FloatLayout, Rounding};

/// A storage of color and alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pipeline {
    /// Straight colors, 8 bits.
    Straight8,
    /// Encoded colors times alpha, then rounded to 8 bits.
    Premultiplied8,
    /// Colors and alpha rounded to 8 bits first, then multiplied and rounded again.
    Quantized8,
    /// Colors times alpha in linear light, encoded again, rounded to 8 bits.
    Linear8,
    /// Encoded colors times alpha, 16 bits.
    Premultiplied16,
    /// Colors times alpha in linear light as binary16.
    Half,
}

/// What is stored of one channel: the values a sampler returns, color in the pipeline's own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stored {
    /// Color, premultiplied unless the pipeline is straight.
    pub color: f64,
    /// Alpha.
    pub alpha: f64,
}

impl Pipeline {
    /// Every storage.
    pub const ALL: [Self; 6] =
        [Self::Straight8, Self::Premultiplied8, Self::Quantized8, Self::Linear8, Self::Premultiplied16, Self::Half];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Straight8 => "straight, 8 bits",
            Self::Premultiplied8 => "premultiplied, 8 bits",
            Self::Quantized8 => "rounded, then premultiplied, 8 bits",
            Self::Linear8 => "premultiplied in linear light, 8 bits",
            Self::Premultiplied16 => "premultiplied, 16 bits",
            Self::Half => "premultiplied in linear light, half",
        }
    }

    /// Whether colors are stored times alpha.
    #[must_use]
    pub fn is_premultiplied(self) -> bool {
        self != Self::Straight8
    }

    /// Whether colors are multiplied (and so to be blended) in linear light; straight ones are blended there if the
    /// image is sRGB-encoded.
    #[must_use]
    pub fn in_linear_light(self) -> bool {
        matches!(self, Self::Straight8 | Self::Linear8 | Self::Half)
    }

    /// Stores one channel, given as codes of an image with largest code `top`.
    #[must_use]
    pub fn store(self, curve: &Curve, top: u32, color: u16, alpha: u16) -> Stored {
        let of = |code: u16| f64::from(code) / f64::from(top);
        let round = |x: f64, steps: u32| f64::from(to_code(x, steps)) / f64::from(steps);
        let (c, a) = (of(color), of(alpha));
        let alpha8 = round(a, 255);
        match self {
            Self::Straight8 => {
                let code = to_code(c, 255);
                Stored { color: curve.linear8(code), alpha: alpha8 }
            }
            Self::Premultiplied8 => Stored { color: round(c * a, 255), alpha: alpha8 },
            Self::Quantized8 => Stored { color: round(round(c, 255) * alpha8, 255), alpha: alpha8 },
            Self::Linear8 => {
                let code = curve.encode8(curve.linear(color) * a);
                Stored { color: curve.linear8(code), alpha: alpha8 }
            }
            Self::Premultiplied16 => Stored { color: round(c * a, 65535), alpha: round(a, 65535) },
            Self::Half => {
                let half = |x| FloatLayout::HALF.decode(FloatLayout::HALF.encode(x, Rounding::NearestEven));
                Stored { color: half(curve.linear(color) * a), alpha: half(a) }
            }
        }
    }

    /// Stores a channel and makes it straight again: a code of the image. Alpha must not be 0; where it is stored as 0,
    /// the color is 0.
    #[must_use]
    pub fn round_trip(self, curve: &Curve, top: u32, color: u16, alpha: u16) -> u32 {
        let stored = self.store(curve, top, color, alpha);
        let straight = match (self.is_premultiplied(), stored.alpha) {
            (false, _) => stored.color,
            (true, 0.0) => 0.0,
            (true, alpha) => (stored.color / alpha).min(1.0),
        };
        if self.in_linear_light() && curve.space() == Space::Srgb {
            curve.encode_own(straight)
        } else {
            to_code(straight, top)
        }
    }
}

/// The nearest of `steps` + 1 codes of a value in `[0, 1]`, ties up.
pub(super) fn to_code(x: f64, steps: u32) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 65535")]
    let code = (x.clamp(0.0, 1.0) * f64::from(steps) + 0.5).floor() as u32;
    code
}
