//! What is drawn: random, adversarial and picture fragments, the same in every model and run.

use serde::Serialize;
use wgpu_types::{BlendFactor, BlendState};

use crate::analysis::texture::Source;
use crate::format::{Codes, ColorFormat};
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel};
use crate::scene::texture::Pattern;
use crate::scene::texture::pattern::PatternImage;

/// A kind of input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Input {
    /// Uniform in `[0, 1]`, with all the bits of binary32.
    Random,
    /// Near the places where roundings change: codes, half-way points between codes, both ends; one step off in turn.
    Adversarial,
    /// Texels of a picture.
    Image,
}

impl Input {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Random, Self::Adversarial, Self::Image];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Adversarial => "adversarial",
            Self::Image => "image",
        }
    }
}

/// A stack of layers over one texel.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// The codes stored before.
    pub dst: Codes,
    /// The shader's outputs, the first drawn first.
    pub layers: Vec<[f32; 4]>,
}

/// The picture and the seed.
#[derive(Clone, Debug)]
pub struct Inputs {
    seed: u64,
    /// Straight values of a picture; at least one.
    picture: Vec<[f32; 4]>,
}

impl Inputs {
    /// Inputs with a built-in picture: fire, smoke and a leaf.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let pattern = |pattern, colors| PatternImage { pattern, size: [64, 64], colors, cells: 5 };
        let pictures = [
            pattern(Pattern::FireAndSmoke, [[1.0, 0.6, 0.2, 0.0], [0.4, 0.4, 0.45, 0.9]]),
            pattern(Pattern::Leaf, [[0.3, 0.6, 0.2, 1.0], [0.8, 0.9, 0.5, 1.0]]),
            pattern(Pattern::Radial, [[0.2, 0.5, 1.0, 1.0], [0.0, 0.1, 0.3, 0.0]]),
        ];
        let value = |code: u8| f32::from(code) / 255.0;
        let texels = |picture: &PatternImage| {
            let picture = *picture;
            (0..64).flat_map(move |y| (0..64).map(move |x| picture.codes(x, y).map(value)))
        };
        Self { seed, picture: pictures.iter().flat_map(texels).collect() }
    }

    /// Inputs with a picture of one's own.
    #[must_use]
    pub fn with_picture(seed: u64, source: &Source) -> Self {
        let top = if source.bits == 16 { 65535.0 } else { 255.0 };
        Self { seed, picture: source.texels.iter().map(|texel| texel.map(|code| f32::from(code) / top)).collect() }
    }

    /// The stack over texel `texel`. Colors are premultiplied (in binary32) where the state takes the source as it is
    /// and the picture's are straight.
    ///
    /// # Panics
    /// Never: the picture has a texel.
    #[must_use]
    pub fn stack(&self, input: Input, format: ColorFormat, blend: &BlendState, texel: u32, layers: u32) -> Stack {
        let mut rng = fastrand::Rng::with_seed(self.seed ^ u64::from(texel) << 20 ^ u64::from(layers));
        let premultiplied =
            blend.color.src_factor == BlendFactor::One && blend.color.dst_factor == BlendFactor::OneMinusSrcAlpha;
        let mut color = |first: bool| match input {
            Input::Random => std::array::from_fn(|_| rng.f32()),
            Input::Adversarial => std::array::from_fn(|_| adversarial(&mut rng)),
            Input::Image => {
                let texel = self.picture[rng.usize(0..self.picture.len())];
                if first { [texel[0], texel[1], texel[2], 1.0] } else { texel }
            }
        };
        let unblended =
            ColorInputs { format, blend: None, constant: [0.0; 4], src: color(true), src1: [0.0; 4], dst: [0; 4] };
        let dst = Exact::default().merge_color(&unblended);
        let layer = |_| {
            let [r, g, b, a] = color(false);
            if premultiplied { [r * a, g * a, b * a, a] } else { [r, g, b, a] }
        };
        Stack { dst, layers: (0..layers).map(layer).collect() }
    }
}

/// A value at, or one step beside, a code or a half-way point of 8 bits, or at an end.
fn adversarial(rng: &mut fastrand::Rng) -> f32 {
    let at = match rng.u8(0..8) {
        0 => 0.0,
        1 => 1.0,
        2 => f32::from(rng.u8(0..3)) / 510.0,
        3 => 1.0 - f32::from(rng.u8(0..3)) / 510.0,
        4 => 0.5,
        _ => f32::from(rng.u16(0..=510)) / 510.0,
    };
    let beside = match rng.u8(0..3) {
        0 => at.next_down(),
        1 => at.next_up(),
        _ => at,
    };
    beside.clamp(0.0, 1.0)
}
