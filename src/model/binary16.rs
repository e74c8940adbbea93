//! The `f16` model: the equation in spec order, every operation rounded to binary16, as half-precision blenders do.
//!
//! Values are binary16 numbers held in `f32`. An operation on two of them is computed in binary32 and rounded again,
//! which gives the correctly rounded binary16 result: binary32's 24 bits are at least 2 * 11 + 2 (Figueroa 1995).
//! Shader outputs and destinations are rounded to binary16 when taken in, so a 32-bit target loses precision by design.
//! The sRGB curve counts as one operation, as in [`super::binary32`].

use wgpu_types::BlendState;

use super::binary32::{decode_binary32, encode_scaled, minimum_number, small_to_f32};
use super::{Arithmetic, ColorInputs, Explanation, Number, NumericModel, Unsupported, evaluate, explain};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout, Rounding, TargetClass, snorm, srgb, unorm};

/// The `f16` model.
#[derive(Clone, Copy, Debug, Default)]
pub struct Binary16;

/// Rounds to binary16, to nearest even; too large becomes Inf.
fn half(x: f32) -> f32 {
    half::f16::from_f32(x).to_f32()
}

/// Rounds to binary16 in one step; `half::f16::from_f64` would round twice.
fn half_of(x: f64) -> f32 {
    super::binary32::narrow(FloatLayout::HALF.decode(FloatLayout::HALF.encode(x, Rounding::NearestEven)))
}

impl Arithmetic for Binary16 {
    type Value = f32;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> f32 {
        half(x)
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> f32 {
        match kind {
            // f64 quotients of codes are never within an f64 rounding of a binary16 tie unless exactly on it.
            ChannelKind::Unorm(bits) => half_of(f64::from(code) / f64::from(unorm::steps(bits))),
            ChannelKind::Snorm(bits) => {
                half_of(f64::from(snorm::signed_code(code, bits)) / f64::from(snorm::steps(bits)))
            }
            ChannelKind::Srgb => half_of(srgb::decode(code).value),
            ChannelKind::Absent | ChannelKind::Float(_) => half(decode_binary32(code, kind)),
        }
    }

    fn zero(&self) -> f32 {
        0.0
    }

    fn one(&self) -> f32 {
        1.0
    }

    fn complement(&self, x: &f32) -> f32 {
        half(1.0 - x)
    }

    fn multiply(&self, x: &f32, factor: &f32) -> f32 {
        half(x * factor)
    }

    fn add(&self, x: &f32, y: &f32) -> f32 {
        half(x + y)
    }

    fn subtract(&self, x: &f32, y: &f32) -> f32 {
        half(x - y)
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
        match kind {
            // N = 65535 is Inf in binary16: such targets scale the binary16 value in binary32.
            ChannelKind::Unorm(bits) | ChannelKind::Snorm(bits) if bits > 10 => encode_scaled(*x, kind, |x, n| x * n),
            _ => encode_scaled(*x, kind, |x, n| half(x * n)),
        }
    }

    fn describe(&self, x: &f32) -> Number {
        Number::binary(f64::from(*x))
    }

    fn describe_scaled(&self, x: &f32, steps: u32) -> Number {
        let product = x * small_to_f32(steps);
        Number::binary(f64::from(if steps < 1 << 10 { half(product) } else { product }))
    }
}

impl NumericModel for Binary16 {
    fn name(&self) -> String {
        "f16".to_owned()
    }

    fn provenance(&self) -> String {
        "IEEE 754 binary16, each operation of the equation rounded to nearest even, nothing fused".to_owned()
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

    /// Depth never passes through the blender: rounded once, as in every model that follows the specifications.
    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        kind.encode(z, range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_rounds_to_binary16() {
        let (ulp, model) = (2.0_f32.powi(-10), Binary16);
        assert_eq!(model.multiply(&(1.0 + ulp), &(1.0 + ulp)), 1.0 + 2.0 * ulp, "the square's last term is lost");
        assert_eq!(model.add(&2048.0, &1.0), 2048.0, "a tie goes to even");
        assert_eq!(model.subtract(&2048.0, &-1.0), 2048.0, "likewise");
        assert_eq!(model.complement(&(ulp / 4.0)), 1.0, "half an ulp below 1 is a tie");
        let format = ColorFormat::from_name("rgba16float").expect("a format");
        assert_eq!(model.take_in(1.0 + ulp / 4.0, format, 0), 1.0, "sources too");
    }
}
