//! The image drawn once over several backgrounds, by the merger, in each storage and numeric model.
//!
//! Colors are blended where the storage multiplied them: in linear light onto `rgba8unorm-srgb`, or as encoded values
//! onto `rgba8unorm`; straight colors of sRGB images in linear light. The yardstick is the exact composite of the
//! original image there, correctly rounded to the target's codes.

use serde::Serialize;
use wgpu_types::{BlendState, TextureFormat};

use super::curve::Curve;
use super::pipeline::{Pipeline, Stored};
use super::source::{Source, Space};
use super::{Options, count};
use crate::format::{Codes, ColorFormat};
use crate::model::{ColorInputs, NumericModel};

/// Texels drawn at most; of larger images an evenly spaced part is drawn.
pub const MAX_DRAWN: usize = 1 << 16;

/// What the image is drawn over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Background {
    /// Code 0.
    Black,
    /// Code 255.
    White,
    /// Code 128.
    Grey,
    /// Squares of 8 x 8 texels, codes 102 and 153.
    Checker,
}

impl Background {
    /// Every background.
    pub const ALL: [Self; 4] = [Self::Black, Self::White, Self::Grey, Self::Checker];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Black => "black",
            Self::White => "white",
            Self::Grey => "grey",
            Self::Checker => "checker",
        }
    }

    fn code(self, x: u32, y: u32) -> u32 {
        match self {
            Self::Black => 0,
            Self::White => 255,
            Self::Grey => 128,
            Self::Checker if (x / 8 + y / 8).is_multiple_of(2) => 102,
            Self::Checker => 153,
        }
    }
}

/// One storage in one model over one background.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Composite {
    /// The background.
    pub background: Background,
    /// The numeric model.
    pub model: String,
    /// Peak signal-to-noise ratio against the yardstick, in dB; `None` where every code is equal.
    pub psnr: Option<f64>,
    /// The largest difference of a color channel, in codes.
    pub worst: u32,
}

/// The image over every background in every model.
pub(super) fn all(source: &Source, curve: &Curve, pipeline: Pipeline, options: &Options<'_>) -> Vec<Composite> {
    let painter = Painter::new(source, curve, pipeline);
    Background::ALL.into_iter().flat_map(|background| painter.over(background, options)).collect()
}

/// Draws one image as one storage keeps it.
struct Painter<'a> {
    source: &'a Source,
    curve: &'a Curve,
    pipeline: Pipeline,
    format: ColorFormat,
    blend: BlendState,
}

/// Sums of one model's differences.
#[derive(Clone, Copy, Default)]
struct Sums {
    worst: u32,
    squares: u64,
    channels: u64,
}

impl<'a> Painter<'a> {
    fn new(source: &'a Source, curve: &'a Curve, pipeline: Pipeline) -> Self {
        let linear = pipeline.in_linear_light() && source.space == Space::Srgb;
        let format = if linear { TextureFormat::Rgba8UnormSrgb } else { TextureFormat::Rgba8Unorm };
        let format = ColorFormat::new(format).expect("both are color formats");
        let premultiplied = BlendState::PREMULTIPLIED_ALPHA_BLENDING;
        let blend = if pipeline.is_premultiplied() { premultiplied } else { BlendState::ALPHA_BLENDING };
        Self { source, curve, pipeline, format, blend }
    }

    fn over(&self, background: Background, options: &Options<'_>) -> Vec<Composite> {
        let source = self.source;
        let mut sums = vec![Sums::default(); options.models.len()];
        let step = source.texels.len().div_ceil(MAX_DRAWN);
        for index in (0..source.texels.len()).step_by(step) {
            let texel = source.texels[index];
            let (x, y) = (index % source.width as usize, index / source.width as usize);
            let under = background.code(u32::try_from(x).unwrap_or(0), u32::try_from(y).unwrap_or(0));
            let truth = self.draw(options.exact, BlendState::ALPHA_BLENDING, self.original(texel), under);
            let stored = self.stored(texel);
            for (sums, model) in sums.iter_mut().zip(options.models) {
                let drawn = self.draw(*model, self.blend, stored, under);
                for (mine, truth) in drawn.iter().zip(truth).take(3) {
                    let difference = mine.abs_diff(truth);
                    sums.worst = sums.worst.max(difference);
                    sums.squares += u64::from(difference) * u64::from(difference);
                    sums.channels += 1;
                }
            }
        }
        let composite = |(sums, model): (&Sums, &&dyn NumericModel)| Composite {
            background,
            model: model.name(),
            psnr: (sums.squares > 0)
                .then(|| 10.0 * (255.0 * 255.0 * count(sums.channels) / count(sums.squares)).log10()),
            worst: sums.worst,
        };
        sums.iter().zip(options.models).map(composite).collect()
    }

    /// What the shader outputs of the original image: straight.
    fn original(&self, texel: [u16; 4]) -> [f64; 4] {
        let linear = self.format.texture_format() == TextureFormat::Rgba8UnormSrgb;
        let color = |i: usize| if linear { self.curve.linear(texel[i]) } else { self.source.value(texel[i]) };
        [color(0), color(1), color(2), self.source.value(texel[3])]
    }

    /// What the shader outputs of the stored image.
    fn stored(&self, texel: [u16; 4]) -> [f64; 4] {
        let store = |i: usize| self.pipeline.store(self.curve, self.source.top(), texel[i], texel[3]);
        let [r, g, b]: [Stored; 3] = std::array::from_fn(store);
        [r.color, g.color, b.color, r.alpha]
    }

    fn draw(&self, model: &dyn NumericModel, blend: BlendState, src: [f64; 4], under: u32) -> Codes {
        model.merge_color(&ColorInputs {
            format: self.format,
            blend: Some(blend),
            constant: [0.0; 4],
            src: src.map(to_f32),
            src1: [0.0; 4],
            dst: [under, under, under, 255],
        })
    }
}

/// A shader's output: rounded to binary32.
fn to_f32(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = x as f32;
    rounded
}
