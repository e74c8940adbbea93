//! The largest error one layer adds, per format and model.

use wgpu_types::TextureFormat;

use super::{BoundError, STATE};
use crate::format::{ChannelKind, ColorFormat, Rounding, snorm, srgb, unorm};
use crate::model::fixed::FixedPoint;
use crate::model::llvmpipe::LlvmpipeName;
use crate::model::{ColorInputs, NumericModel};

/// Operations of `f32` on a layer's way to the store, each off by at most 2^-24 of a value up to 1: decoding, 1 - A, two
/// products, the sum, scaling; with room for the products of those errors.
const BINARY32_STEP: f64 = 8.0 / 16_777_216.0;

/// |stored value - real value| of one layer over a stored color, at most; see the module for the state.
///
/// - `exact` rounds once: half a code, or half a unit in the last place below 1.
/// - `f32` adds its operations' roundings.
/// - Blenders that round each product to the target's width (`llvmpipe` on 8 bits, `fixed`) store product + product,
///   each of which has few arguments once A is given: their errors are found by trying every code.
///
/// # Errors
/// [`BoundError::Model`] for any other model.
pub fn step(format: ColorFormat, model: &dyn NumericModel, alpha: f32) -> Result<f64, BoundError> {
    let name = model.name();
    match name.as_str() {
        // An alpha of 0 leaves every code alone.
        "exact" | "exact:ties-away" | "exact:toward-zero" | "f32" if alpha == 0.0 => Ok(0.0),
        "exact" | "exact:ties-away" => Ok(nearest_store(format)),
        "exact:toward-zero" => Ok(2.0 * nearest_store(format)),
        "f32" => Ok(nearest_store(format) + BINARY32_STEP),
        _ => {
            let source = separable(format, &name).ok_or(BoundError::Model { model: name, format: format.name() })?;
            Ok(by_products(format, model, alpha, source))
        }
    }
}

/// The largest distance of a value in the target's range from the nearest stored one.
fn nearest_store(format: ColorFormat) -> f64 {
    let store = |kind: &ChannelKind| match *kind {
        ChannelKind::Absent => 0.0,
        ChannelKind::Unorm(bits) => (0.5 / f64::from(unorm::steps(bits))).next_up(),
        ChannelKind::Snorm(bits) => (0.5 / f64::from(snorm::steps(bits))).next_up(),
        // In linear light: from a threshold to either neighbour.
        ChannelKind::Srgb => (0..255)
            .flat_map(|code| [code, code + 1].map(|neighbour| (srgb::threshold(code), srgb::decode(neighbour))))
            .map(|(a, b)| ((a.value - b.value).abs() + a.error + b.error).next_up())
            .fold(0.0, f64::max),
        // Half a unit in the last place of numbers from 1/2 to 1.
        ChannelKind::Float(layout) => (1.0 + f64::from(layout.mantissa_bits)).exp2().recip() / 2.0,
    };
    format.channels()[..3].iter().map(store).fold(0.0, f64::max)
}

/// How a model that stores rounded product + rounded product takes its source in.
struct Source {
    bits: u32,
    rounding: Rounding,
}

/// The source of a model whose products have the target's width; `None` for other models.
fn separable(format: ColorFormat, name: &str) -> Option<Source> {
    let ChannelKind::Unorm(bits) = format.channels()[0] else { return None };
    let eight = matches!(format.texture_format(), TextureFormat::Rgba8Unorm | TextureFormat::Bgra8Unorm);
    // Every generation and width quantises a source in range alike; only the products differ, and those are tried.
    if LlvmpipeName::parse(name).is_some() && eight {
        return Some(Source { bits: 8, rounding: Rounding::NearestEven });
    }
    let spec: FixedPoint = name.strip_prefix("fixed:")?.parse().ok()?;
    let fits = spec.product_bits == bits && !spec.fused && spec.source_bits <= 16 && bits <= 16;
    fits.then_some(Source { bits: spec.source_bits, rounding: spec.source_rounding })
}

/// A times the error of taking the source in, plus the largest sum of the two products' errors, signs kept, over all
/// codes.
fn by_products(format: ColorFormat, model: &dyn NumericModel, alpha: f32, source: Source) -> f64 {
    let ChannelKind::Unorm(bits) = format.channels()[0] else { return f64::INFINITY };
    let a = f64::from(alpha);
    let merged = |color: f32, code: u32| {
        let inputs = ColorInputs {
            format,
            blend: Some(STATE),
            constant: [0.0; 4],
            src: [color, color, color, alpha],
            src1: [0.0; 4],
            dst: [code; 4],
        };
        f64::from(model.merge_color(&inputs)[0]) / f64::from(unorm::steps(bits))
    };
    let of = |code: u32, bits: u32| f64::from(code) / f64::from(unorm::steps(bits));
    let truncates = source.rounding == Rounding::TowardZero;
    let first = (0..=unorm::steps(source.bits)).map(|code| {
        let value = of(code, source.bits);
        let nearest = super::adversary::to_f32(value);
        // A source just below its code would be truncated to the code below.
        let color = if truncates && f64::from(nearest) < value { nearest.next_up() } else { nearest };
        merged(color, 0) - value * a
    });
    let second = (0..=unorm::steps(bits)).map(|code| merged(0.0, code) - of(code, bits) * (1.0 - a));
    let taken_in = if truncates { 1.0 } else { 0.5 } / f64::from(unorm::steps(source.bits));
    // The sums and differences above are off by a few units in the last place of 1.
    let ends = |(low, high): (f64, f64), error: f64| (low.min(error), high.max(error));
    let (first, second) = (first.fold((0.0, 0.0), ends), second.fold((0.0, 0.0), ends));
    a * taken_in + (first.1 + second.1).max(-first.0 - second.0) + 8.0 * f64::EPSILON
}
