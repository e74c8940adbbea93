//! The `f32` model: the equation in spec order, every operation rounded to binary32.
//!
//! This is what the reference rasterisers of conformance suites do: decode to binary32, blend, scale by N and round to
//! the nearest integer, ties to even. No operation is fused. The sRGB curve counts as one operation: decoding is
//! correctly rounded to binary32, and encoding gives the code nearest to the ideal curve at the binary32 value.

use wgpu_types::BlendState;

use super::{Arithmetic, ColorInputs, Explanation, Number, NumericModel, Unsupported, evaluate, explain};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, Rounding, TargetClass, snorm, srgb, unorm};

/// The `f32` model.
#[derive(Clone, Copy, Debug, Default)]
pub struct Binary32;

impl Arithmetic for Binary32 {
    type Value = f32;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> f32 {
        x
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> f32 {
        decode_binary32(code, kind)
    }

    fn zero(&self) -> f32 {
        0.0
    }

    fn one(&self) -> f32 {
        1.0
    }

    fn complement(&self, x: &f32) -> f32 {
        1.0 - x
    }

    fn multiply(&self, x: &f32, factor: &f32) -> f32 {
        x * factor
    }

    fn add(&self, x: &f32, y: &f32) -> f32 {
        x + y
    }

    fn subtract(&self, x: &f32, y: &f32) -> f32 {
        x - y
    }

    fn minimum(&self, x: &f32, y: &f32) -> f32 {
        minimum_number(*x, *y)
    }

    fn maximum(&self, x: &f32, y: &f32) -> f32 {
        -minimum_number(-*x, -*y)
    }

    fn clamp(&self, x: &f32, class: TargetClass) -> f32 {
        crate::merger::blend::clamp::clamp_input(*x, class)
    }

    fn encode(&self, x: &f32, kind: ChannelKind) -> u32 {
        encode_scaled(*x, kind, |x, steps| x * steps)
    }

    fn describe(&self, x: &f32) -> Number {
        Number::binary(f64::from(*x))
    }

    fn describe_scaled(&self, x: &f32, steps: u32) -> Number {
        Number::binary(f64::from(x * small_to_f32(steps)))
    }
}

/// Decodes one channel, the quotient correctly rounded to binary32.
pub(super) fn decode_binary32(code: u32, kind: ChannelKind) -> f32 {
    match kind {
        ChannelKind::Absent => 0.0,
        ChannelKind::Unorm(bits) => small_to_f32(code) / small_to_f32(unorm::steps(bits)),
        ChannelKind::Snorm(bits) => {
            let signed = snorm::signed_code(code, bits);
            let magnitude = small_to_f32(signed.unsigned_abs()) / small_to_f32(snorm::steps(bits).unsigned_abs());
            if signed < 0 { -magnitude } else { magnitude }
        }
        ChannelKind::Srgb => srgb::decode_f32(code),
        ChannelKind::Float(layout) => narrow(layout.decode(code)),
    }
}

/// Encodes one channel: scale in the model's arithmetic, then to the nearest code, ties to even.
pub(super) fn encode_scaled(x: f32, kind: ChannelKind, scale: impl Fn(f32, f32) -> f32) -> u32 {
    match kind {
        ChannelKind::Absent => 0,
        ChannelKind::Unorm(bits) => nearest(scale(x, small_to_f32(unorm::steps(bits)))).unsigned_abs(),
        ChannelKind::Snorm(bits) => {
            snorm::stored_code(nearest(scale(x, small_to_f32(snorm::steps(bits).unsigned_abs()))), bits)
        }
        // No binary32 number lies within 2^-90 of a threshold (a unit test tries the nearest ones).
        ChannelKind::Srgb => srgb::encode(f64::from(x)).unwrap_or(0),
        ChannelKind::Float(layout) => layout.encode(f64::from(x), Rounding::NearestEven),
    }
}

/// The smaller number, NaN only when both are, -0 below +0 (IEEE 754-2019 minimumNumber).
pub(super) fn minimum_number(x: f32, y: f32) -> f32 {
    if x.is_nan() || y < x || (y == x && y.is_sign_negative()) { y } else { x }
}

/// Codes of at most 24 bits are exact in binary32.
pub(super) fn small_to_f32(x: u32) -> f32 {
    debug_assert!(x < 1 << 24, "exact in binary32");
    #[expect(clippy::cast_precision_loss, reason = "below 2^24")]
    let exact = x as f32;
    exact
}

/// The nearest integer, ties to even; |x| is at most 65535.
fn nearest(x: f32) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "an integer of at most 17 bits")]
    let integer = x.round_ties_even() as i32;
    integer
}

/// Rounds to binary32.
pub(crate) fn narrow(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = x as f32;
    rounded
}

impl NumericModel for Binary32 {
    fn name(&self) -> String {
        "f32".to_owned()
    }

    fn provenance(&self) -> String {
        "IEEE 754 binary32, each operation of the equation rounded to nearest even, nothing fused".to_owned()
    }

    fn supports(&self, _format: ColorFormat, _blend: Option<&BlendState>) -> Result<(), Unsupported> {
        Ok(())
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        evaluate(self, inputs)
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        explain(self, inputs)
    }

    fn float_rule(&self) -> Option<crate::kernel::FloatRule> {
        Some(crate::kernel::FloatRule::Binary32)
    }

    fn unorm8_rule(&self) -> Option<crate::kernel::Rule> {
        Some(crate::kernel::Rule::Exact)
    }

    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        kind.encode(z, range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_binary32_number_is_in_doubt_at_an_srgb_threshold() {
        for code in 0..255 {
            let at = srgb::threshold(code);
            let near = narrow(at.value);
            for x in [near.next_down(), near, near.next_up()] {
                assert!(srgb::encode(f64::from(x)).is_some(), "code {code}: {x} must be decided");
            }
        }
    }

    #[test]
    fn minimum_prefers_numbers_and_minus_zero() {
        assert_eq!(minimum_number(f32::NAN, 1.0), 1.0, "left NaN");
        assert_eq!(minimum_number(1.0, f32::NAN), 1.0, "right NaN");
        assert!(minimum_number(0.0, -0.0).is_sign_negative(), "-0 is below +0");
        assert!(minimum_number(-0.0, 0.0).is_sign_negative(), "-0 is below +0");
    }
}
