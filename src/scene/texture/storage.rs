//! How a texture keeps an image: straight or multiplied by alpha, and in how many bits.

use serde::Deserialize;

use super::{ColorSpace, Image};
use crate::scene::number::{f64_to_f32, f64_to_i64, i64_to_f64};

/// What is stored of each texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Storage {
    /// As the image has it.
    #[default]
    AsIs,
    /// Multiplied by alpha, not rounded.
    Premultiplied,
    /// Multiplied by alpha, then rounded to 8 bits a channel in the image's color space: what a premultiplied PNG
    /// keeps.
    Premultiplied8,
    /// The same in 16 bits.
    Premultiplied16,
    /// [`Premultiplied8`](Self::Premultiplied8) divided by alpha again: what is left of the straight color.
    RoundTrip8,
}

impl Storage {
    /// Stores an image of linear values that came from `space`.
    #[must_use]
    pub fn store(self, image: Image, space: ColorSpace) -> Image {
        match self {
            Self::AsIs => image,
            Self::Premultiplied => image.map(premultiply),
            Self::Premultiplied8 => image.map(|texel| quantize(premultiply(texel), space, 0xFF)),
            Self::Premultiplied16 => image.map(|texel| quantize(premultiply(texel), space, 0xFFFF)),
            Self::RoundTrip8 => image.map(|texel| divide(quantize(premultiply(texel), space, 0xFF))),
        }
    }
}

fn premultiply([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    [r * a, g * a, b * a, a]
}

fn divide([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    if a == 0.0 { [0.0; 4] } else { [r / a, g / a, b / a, a].map(|x| x.min(1.0)) }
}

fn quantize([r, g, b, a]: [f32; 4], space: ColorSpace, top: u32) -> [f32; 4] {
    let color = |x: f32| {
        let code = space.encode(f64::from(x), top);
        f64_to_f32(space.decode(f64::from(code) / f64::from(top)))
    };
    let alpha = i64_to_f64(f64_to_i64(f64::from(a.clamp(0.0, 1.0)) * f64::from(top))) / f64::from(top);
    [color(r), color(g), color(b), f64_to_f32(alpha)]
}
