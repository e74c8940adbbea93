//! The `fixed` model: a parametric fixed-point blender, the shape of simple blending hardware.
//!
//! Source, constant and destination enter as unsigned codes of `source_bits`; factors are narrowed to `factor_bits`;
//! products are rounded to `product_bits`, unless the blender is fused and rounds only their sum; the result is stored
//! with its own rounding. A factor of exactly one or zero (as a state, not as a code) bypasses the multiplier, as
//! hardware does: so `One Zero` and `Zero One` keep codes in every member of the family.
//!
//! Defined for unsigned normalised targets; sRGB values are linearised into `source_bits`. Rules of this kind are
//! documented for software blenders (the `>> 8` family) and admitted by Vulkan and D3D, which ask only for the
//! target's own precision.

mod rounding;
mod spec;

use wgpu_types::BlendState;

use super::{Arithmetic, ColorInputs, Explanation, Number, NumericModel, Unsupported, evaluate, explain};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, Rounding, TargetClass, srgb, unorm};

pub use rounding::ProductRounding;
pub use spec::{FixedPoint, FixedSpecError};

/// A number in the blender: `num / den`, both exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value {
    num: i128,
    den: i128,
}

impl Value {
    /// A code of N = 2^bits - 1.
    fn code(code: u32, bits: u32) -> Self {
        Self { num: code.into(), den: unorm::steps(bits).into() }
    }

    /// Rounded to a code of `bits` bits; below zero gives a negative code.
    fn to_code(self, bits: u32, rounding: Rounding) -> i128 {
        let scaled = self.num * i128::from(unorm::steps(bits));
        let (floor, rest) =
            (scaled.unsigned_abs() / self.den.unsigned_abs(), scaled.unsigned_abs() % self.den.unsigned_abs());
        let up = rounding.round_up(floor % 2 == 1, rest == 0, (2 * rest).cmp(&self.den.unsigned_abs()));
        let code = i128::try_from(floor + u128::from(up)).expect("codes are small");
        if scaled < 0 { -code } else { code }
    }

    /// The nearest binary64 number.
    fn decimal(self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "numerators and denominators stay below 2^53")]
        let quotient = self.num as f64 / self.den as f64;
        quotient
    }

    fn requantized(self, bits: u32, rounding: Rounding) -> Self {
        Self { num: self.to_code(bits, rounding), den: unorm::steps(bits).into() }
    }
}

impl Arithmetic for FixedPoint {
    type Value = Value;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Value {
        Value::code(unorm::encode(f64::from(x), self.source_bits, self.source_rounding), self.source_bits)
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            ChannelKind::Unorm(bits) => Value::code(code, bits).requantized(self.source_bits, Rounding::NearestEven),
            ChannelKind::Srgb => {
                let linear = srgb::decode(code).value;
                Value::code(unorm::encode(linear, self.source_bits, Rounding::NearestEven), self.source_bits)
            }
            ChannelKind::Absent | ChannelKind::Snorm(_) | ChannelKind::Float(_) => self.zero(),
        }
    }

    fn zero(&self) -> Value {
        Value { num: 0, den: 1 }
    }

    fn one(&self) -> Value {
        Value { num: 1, den: 1 }
    }

    fn complement(&self, x: &Value) -> Value {
        Value { num: x.den - x.num, den: x.den }
    }

    fn factor(&self, x: Value) -> Value {
        if x.den == 1 { x } else { x.requantized(self.factor_bits, Rounding::NearestEven) }
    }

    fn multiply(&self, x: &Value, factor: &Value) -> Value {
        if factor.den == 1 {
            return Value { num: x.num * factor.num, den: x.den };
        }
        if self.fused {
            return Value { num: x.num * factor.num, den: x.den * factor.den };
        }
        let code = self.product_rounding.product(x.num, x.den, factor.num, factor.den, self.product_bits);
        Value { num: code, den: unorm::steps(self.product_bits).into() }
    }

    fn add(&self, x: &Value, y: &Value) -> Value {
        if x.den == y.den {
            return Value { num: x.num + y.num, den: x.den };
        }
        Value { num: x.num * y.den + y.num * x.den, den: x.den * y.den }
    }

    fn subtract(&self, x: &Value, y: &Value) -> Value {
        self.add(x, &Value { num: -y.num, den: y.den })
    }

    fn minimum(&self, x: &Value, y: &Value) -> Value {
        if y.num * x.den < x.num * y.den { *y } else { *x }
    }

    fn maximum(&self, x: &Value, y: &Value) -> Value {
        if y.num * x.den > x.num * y.den { *y } else { *x }
    }

    fn clamp(&self, x: &Value, class: TargetClass) -> Value {
        match class {
            TargetClass::Float => *x,
            TargetClass::Unorm | TargetClass::Snorm => self.minimum(&self.maximum(x, &self.zero()), &self.one()),
        }
    }

    fn encode(&self, x: &Value, kind: ChannelKind) -> u32 {
        let store = |bits| u32::try_from(x.to_code(bits, self.store_rounding)).expect("clamped to [0, 1]");
        match kind {
            ChannelKind::Unorm(bits) => store(bits),
            // The linear code through the ideal curve; linear codes of up to 24 bits are never on a threshold.
            ChannelKind::Srgb => srgb::encode(x.decimal()).unwrap_or(0),
            ChannelKind::Absent | ChannelKind::Snorm(_) | ChannelKind::Float(_) => 0,
        }
    }

    fn describe(&self, x: &Value) -> Number {
        Number::ratio(x.num, x.den)
    }
}

impl NumericModel for FixedPoint {
    fn name(&self) -> String {
        self.to_string()
    }

    fn provenance(&self) -> String {
        "a parametric fixed-point blender; no device is claimed".to_owned()
    }

    fn supports(&self, format: ColorFormat, _blend: Option<&BlendState>) -> Result<(), Unsupported> {
        if format.class() == TargetClass::Unorm {
            return Ok(());
        }
        Err(Unsupported {
            model: NumericModel::name(self),
            what: format.name().to_owned(),
            reason: "fixed point is defined for unsigned normalised targets only; use exact, f32 or f16",
        })
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        evaluate(self, inputs)
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        explain(self, inputs)
    }

    fn unorm8_rule(&self) -> Option<crate::kernel::Rule> {
        (*self == Self::default()).then_some(crate::kernel::Rule::RoundedProducts)
    }

    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        kind.encode(z, range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_narrowed_to_their_own_width() {
        let model: FixedPoint = "source=10,factor=4,product=10".parse().expect("valid");
        let format = ColorFormat::from_name("rgb10a2unorm").expect("a format");
        let source = model.take_in(512.0 / 1023.0, format, 0);
        assert_eq!(source, Value { num: 512, den: 1023 }, "ten bits of source");
        assert_eq!(model.factor(source), Value { num: 8, den: 15 }, "four bits of factor: 7.507 rounds to 8");
        assert_eq!(model.factor(model.one()), model.one(), "the constant one bypasses the multiplier");
    }
}
