//! What storing colors premultiplied costs an image.
//!
//! A premultiplied color keeps only the codes 0 to alpha: at alpha a of 255 there are a + 1 levels left, and dividing by
//! alpha again misses the original by up to floor(127 / a + 1/2) codes. Straight storage pays elsewhere, under
//! filtering, where the color of invisible texels bleeds in. [`measure`] puts numbers on both for one image; [`table`]
//! holds the law of every (color, alpha) pair of 8 bits.

pub mod composite;
pub mod curve;
pub mod filter;
pub mod pipeline;
pub mod source;
pub mod table;
#[cfg(test)]
mod tests;
mod verdict;

use rayon::prelude::*;
use serde::Serialize;

use crate::model::NumericModel;
use crate::report::difference::LEGEND;
use crate::scene::Picture;
use composite::Composite;
use curve::Curve;
use filter::{Coverage, Filtering};
use pipeline::Pipeline;
pub use source::{Source, SourceError, Space};

/// How far a pipeline's recovered color is from the original, over all texels that are not wholly transparent.
///
/// Errors are in codes of 8 bits, fractional for images of 16 bits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PipelineReport {
    /// The storage.
    pub pipeline: Pipeline,
    /// The largest error of a channel.
    pub worst: f64,
    /// The mean error of a channel.
    pub mean: f64,
    /// Share of the image's texels with any error, 0 to 1.
    pub texels_changed: f64,
    /// Channels by error, rounded up to whole codes: index 0 counts exact ones, 1 those off by up to one code ...
    pub histogram: Vec<u64>,
    /// Drawn once over several backgrounds.
    pub composites: Vec<Composite>,
}

/// What 8-bit premultiplied storage does to the texels of one alpha.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlphaRow {
    /// Alpha as a code of 8 bits.
    pub alpha: u8,
    /// Texels of the image that have it.
    pub texels: u64,
    /// Color levels left: alpha + 1 of 256.
    pub levels: u32,
    /// Bits lost of the 8 of each channel: 8 - log2(levels).
    pub bits_lost: f64,
    /// The largest error there can be for any color.
    pub worst_possible: u32,
    /// The largest error in this image.
    pub worst: f64,
    /// The mean error in this image.
    pub mean: f64,
}

/// One image, measured.
#[derive(Clone, Debug, Serialize)]
pub struct ImageReport {
    /// The file.
    pub name: String,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Bits of a channel in the file, 8 or 16.
    pub bits: u32,
    /// What the stored colors mean.
    pub space: Space,
    /// Texels with alpha 0.
    pub transparent: u64,
    /// Texels with alpha between 0 and 1.
    pub translucent: u64,
    /// Bits of color lost per texel by 8-bit premultiplied storage, of 24, averaged over texels that are not wholly
    /// transparent.
    pub bits_lost_per_texel: f64,
    /// The storages, in [`Pipeline::ALL`]'s order.
    pub pipelines: Vec<PipelineReport>,
    /// The alphas that occur, ascending, for [`Pipeline::Premultiplied8`].
    pub alphas: Vec<AlphaRow>,
    /// Filtering before and after storing.
    pub filtering: Filtering,
    /// Cutout coverage by mip level.
    pub coverage: Vec<Coverage>,
    /// What it means, in words.
    pub verdict: String,
    /// Where [`Pipeline::Premultiplied8`] changes colors, the worst channel of each texel.
    #[serde(skip)]
    pub heat_map: Option<Picture>,
}

/// Options of [`measure`].
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Models the composites are computed in.
    pub models: &'a [&'a dyn NumericModel],
    /// The yardstick of the composites.
    pub exact: &'a dyn NumericModel,
    /// Alpha at and above which a cutout texel is kept.
    pub cutoff: f64,
}

/// Sums of errors.
#[derive(Clone, Default)]
struct Errors {
    worst: f64,
    sum: f64,
    channels: u64,
}

impl Errors {
    fn add(&mut self, error: f64) {
        self.worst = self.worst.max(error);
        self.sum += error;
        self.channels += 1;
    }

    fn mean(&self) -> f64 {
        if self.channels == 0 { 0.0 } else { self.sum / count(self.channels) }
    }
}

/// Measures one image.
#[must_use]
pub fn measure(source: &Source, options: &Options<'_>) -> ImageReport {
    let curve = Curve::new(source.space, source.top());
    let opaque = source.texels.iter().filter(|texel| u32::from(texel[3]) == source.top()).count() as u64;
    let transparent = source.texels.iter().filter(|texel| texel[3] == 0).count() as u64;
    let pipelines: Vec<PipelineReport> = Pipeline::ALL
        .into_par_iter()
        .map(|pipeline| PipelineReport {
            composites: composite::all(source, &curve, pipeline, options),
            ..recovered(source, &curve, pipeline)
        })
        .collect();
    let alphas = alpha_rows(source, &curve);
    let visible: u64 = alphas.iter().map(|row| row.texels).sum();
    let lost: f64 = alphas.iter().map(|row| 3.0 * row.bits_lost * count(row.texels)).sum();
    let mut report = ImageReport {
        name: source.name.clone(),
        width: source.width,
        height: source.height,
        bits: source.bits,
        space: source.space,
        transparent,
        translucent: source.texels.len() as u64 - opaque - transparent,
        bits_lost_per_texel: if visible == 0 { 0.0 } else { lost / count(visible) },
        pipelines,
        alphas,
        filtering: filter::filtering(source),
        coverage: filter::coverage(source, options.cutoff),
        verdict: String::new(),
        heat_map: Some(heat_map(source, &curve)),
    };
    report.verdict = verdict::verdict(&report);
    report
}

/// The error of one pipeline for any color and alpha of an image.
struct ErrorOf<'a> {
    curve: &'a Curve,
    pipeline: Pipeline,
    top: u32,
    /// For images of 8 bits: by color and alpha.
    table: Vec<f64>,
}

impl<'a> ErrorOf<'a> {
    fn new(source: &Source, curve: &'a Curve, pipeline: Pipeline) -> Self {
        let mut this = Self { curve, pipeline, top: source.top(), table: Vec::new() };
        // Smaller images are as quick without.
        if source.bits == 8 && source.texels.len() > 1 << 14 {
            let pairs = (0..=u16::MAX).map(|pair| (pair >> 8, pair & 0xff));
            this.table = pairs.map(|(color, alpha)| if alpha == 0 { 0.0 } else { this.one(color, alpha) }).collect();
        }
        this
    }

    /// The error of one channel, in codes of 8 bits; alpha is not 0.
    fn one(&self, color: u16, alpha: u16) -> f64 {
        let recovered = self.pipeline.round_trip(self.curve, self.top, color, alpha);
        f64::from(recovered.abs_diff(u32::from(color))) * 255.0 / f64::from(self.top)
    }

    /// The errors of the color channels of a texel whose alpha is not 0.
    fn texel(&self, texel: [u16; 4]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let looked_up = self.table.get(usize::from(texel[i]) << 8 | usize::from(texel[3]));
            looked_up.copied().unwrap_or_else(|| self.one(texel[i], texel[3]))
        })
    }
}

/// The errors of one pipeline.
fn recovered(source: &Source, curve: &Curve, pipeline: Pipeline) -> PipelineReport {
    let errors = ErrorOf::new(source, curve, pipeline);
    let mut sums = Errors::default();
    let mut histogram = vec![0_u64; 257];
    let mut changed = 0_u64;
    for texel in source.texels.iter().filter(|texel| texel[3] != 0) {
        let errors = errors.texel(*texel);
        changed += u64::from(errors.iter().any(|error| *error > 0.0));
        for error in errors {
            sums.add(error);
            histogram[whole_codes(error)] += 1;
        }
    }
    let used = histogram.iter().rposition(|n| *n > 0).map_or(0, |last| last + 1);
    histogram.truncate(used);
    PipelineReport {
        pipeline,
        worst: sums.worst,
        mean: sums.mean(),
        texels_changed: count(changed) / count(source.texels.len() as u64),
        histogram,
        composites: Vec::new(),
    }
}

/// The texels by alpha.
fn alpha_rows(source: &Source, curve: &Curve) -> Vec<AlphaRow> {
    let errors = ErrorOf::new(source, curve, Pipeline::Premultiplied8);
    let mut rows = vec![(Errors::default(), 0_u64); 256];
    for texel in source.texels.iter().filter(|texel| texel[3] != 0) {
        let alpha = pipeline::to_code(source.value(texel[3]), 255);
        let (sums, texels) = &mut rows[alpha as usize];
        *texels += 1;
        for error in errors.texel(*texel) {
            sums.add(error);
        }
    }
    let row = |(alpha, (sums, texels)): (u8, (Errors, u64))| AlphaRow {
        alpha,
        texels,
        levels: table::levels(alpha),
        bits_lost: table::bits_lost(alpha),
        worst_possible: table::worst_error(alpha),
        worst: sums.worst,
        mean: sums.mean(),
    };
    (0..=u8::MAX).zip(rows).filter(|(_, (_, texels))| *texels > 0).map(row).collect()
}

/// The errors of 8-bit premultiplied storage as a picture in the colors of [`LEGEND`]; transparent texels are black.
fn heat_map(source: &Source, curve: &Curve) -> Picture {
    let errors = ErrorOf::new(source, curve, Pipeline::Premultiplied8);
    let color = |texel: &[u16; 4]| {
        if texel[3] == 0 {
            return [0, 0, 0, u8::MAX];
        }
        let worst = errors.texel(*texel).into_iter().fold(0.0, f64::max);
        let codes = whole_codes(worst);
        let (_, [r, g, b], _) = LEGEND.iter().find(|(most, ..)| codes <= *most as usize).unwrap_or(&LEGEND[5]);
        [*r, *g, *b, u8::MAX]
    };
    Picture { width: source.width, height: source.height, rgba: source.texels.iter().flat_map(color).collect() }
}

/// An error rounded up to whole codes, 0 to 256.
fn whole_codes(error: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=256 before")]
    let codes = error.ceil().clamp(0.0, 256.0) as usize;
    codes
}

/// A count as a number.
fn count(n: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
    let number = n as f64;
    number
}
