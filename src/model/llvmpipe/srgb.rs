//! 8-bit sRGB targets: polynomial decode, float blending, and an encode built on the processor's reciprocal square root.
//!
//! The encode's results depend on the processor: see [`Estimate`]. Its largest distance from the true curve is about 0.66 of
//! a code, and it is not monotone; both are the driver's.

use super::float::{self, Ops, ZeroTerms};
use super::integer::quantize8;
use super::rsqrt::Estimate;
use super::steps::Steps;
use super::{VectorWidth, state};
use crate::format::ChannelKind;
use crate::model::ColorInputs;

/// 8-bit sRGB targets.
pub(super) fn merge(inputs: &ColorInputs, estimate: Estimate) -> Steps {
    let clamp = |color: [f32; 4]| color.map(clamp_unit);
    let operands = float::Operands {
        src: clamp(inputs.src),
        src1: clamp(inputs.src1),
        constant: inputs.constant.map(clamp_constant),
        dst: std::array::from_fn(|i| if i == 3 { decode_alpha(inputs.dst[3]) } else { decode(inputs.dst[i]) }),
    };
    debug_assert_eq!(state::channel_count(inputs.format), 4, "both sRGB formats have four channels");
    let (result, equation) = float::blend(inputs, &operands, OPS, ZeroTerms::Dropped);
    let channels = inputs.format.channels();
    let codes = std::array::from_fn(|i| match channels[i] {
        ChannelKind::Srgb => encode(clamp_unit(result[i]), estimate),
        _ => quantize8(result[i], VectorWidth::Bits256),
    });
    Steps {
        steps: None,
        rule: "binary32, clamped to [0, 1]",
        src: operands.src.map(f64::from),
        dst: operands.dst.map(f64::from),
        equation,
        result: result.map(f64::from),
        codes,
    }
}

/// Clamped to [0, 1]; NaN gives 0.
pub(super) fn clamp_unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// A blend constant clamped to [0, 1]; unlike a fragment's, its NaN gives 1: MINPS takes the bound when nothing compares.
fn clamp_constant(x: f32) -> f32 {
    let bounded = if x < 1.0 { x } else { 1.0 };
    bounded.max(0.0)
}

/// A stored byte as a number; alpha is linear.
fn decode_alpha(code: u32) -> f32 {
    byte(code) * (1.0 / 255.0)
}

/// A stored byte as a linear number: a line up to 15, then a cubic evaluated as even + x odd.
pub(crate) fn decode(code: u32) -> f32 {
    let x = byte(code);
    if code <= 15 {
        return x * LINEAR_SLOPE;
    }
    let square = x * x;
    let even = fma(square, CUBIC[2], CUBIC[0]);
    let odd = fma(square, CUBIC[3], CUBIC[1]);
    fma(odd, x, even)
}

/// 1 / (12.6 * 255).
const LINEAR_SLOPE: f32 = 1.0 / (12.6 * 255.0);

/// 0.0023 + 0.0030 y + 0.6935 y^2 + 0.3012 y^3 with y = x / 255.
const CUBIC: [f32; 4] = [0.0023, 0.0030 / 255.0, 0.6935 / (255.0 * 255.0), 0.3012 / (255.0 * 255.0 * 255.0)];

/// Weights of the fourth root, the square root and 1 in the encode: 0.675 * 1.0622, 0.325 * 1.0622 and -0.062, each rounded
/// to binary32 before it is scaled by 255.
pub(crate) const ENCODE: [f32; 3] = [0.716_985, 0.345_215, -0.062];

/// Denormals are flushed.
const OPS: Ops = Ops { flush: true };

/// The code of a linear number in [0, 1].
pub(super) fn encode(s: f32, estimate: Estimate) -> u32 {
    let scaled = if s <= 0.003_130_8 {
        OPS.multiply(s, 12.92 * 255.0)
    } else {
        let root = s * estimate.rsqrt(s);
        let fourth = estimate.rsqrt(estimate.rsqrt(root * s));
        let sum = fma(ENCODE[1] * 255.0, root, ENCODE[2] * 255.0);
        ENCODE[0] * 255.0 * fourth + sum
    };
    quantize_scaled(scaled)
}

/// To the nearest integer, ties to even.
fn quantize_scaled(x: f32) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "an integer from 0 to 255")]
    let code = x.round_ties_even() as i32;
    code.clamp(0, 255).unsigned_abs()
}

/// A code as a number.
fn byte(code: u32) -> f32 {
    f32::from(u8::try_from(code).expect("sRGB codes have 8 bits"))
}

#[expect(clippy::disallowed_methods, reason = "the driver emits fused multiply-adds here")]
fn fma(a: f32, b: f32, c: f32) -> f32 {
    a.mul_add(b, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_decode_and_encode() {
        for estimate in Estimate::RECORDED.into_iter().chain(Estimate::host()) {
            for code in 0..=255 {
                assert_eq!(encode(decode(code), estimate), code, "code {code}, {estimate:?}");
            }
        }
    }
}
