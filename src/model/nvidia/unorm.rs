//! Unsigned normalised targets: codes in, exact arithmetic, the nearest code out.

use crate::format::unorm::steps;
use crate::format::{ChannelKind, ColorFormat, TargetClass};
use crate::model::{Arithmetic, Number};

/// Fractional bits beyond those of a code that a number keeps before it is rounded to a code.
const GUARD_BITS: u32 = 4;

/// The blender of a target whose color channels have `bits` bits.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Bits of a color channel, and of every operand but the destination's alpha.
    pub bits: u32,
}

/// A number in the blender: `num / den`, both exact. No denominator is above 65535^2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value {
    num: i64,
    den: i64,
}

/// The code of `bits` bits of a number from 0 to 1: cut to `bits + 4` fractional bits, then to the nearest, halves down.
#[must_use]
pub fn code(x: f32, bits: u32) -> u32 {
    let kept = bits + GUARD_BITS;
    let scaled = f64::from(x.clamp(0.0, 1.0)) * f64::from(1_u32 << kept);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut on purpose; from 0 to 2^28")]
    let cut = scaled as u64;
    let code = (2 * cut * u64::from(steps(bits)) + (1 << kept) - 1) >> (kept + 1);
    u32::try_from(code).expect("at most 24 bits")
}

impl Unit {
    fn of_code(code: u32, bits: u32) -> Value {
        Value { num: code.into(), den: steps(bits).into() }
    }
}

impl Value {
    /// The nearest code of `bits` bits. Sums of products of codes are never half way: their denominators are odd.
    fn nearest(self, bits: u32) -> u32 {
        let steps = i128::from(steps(bits));
        let (num, den) = (i128::from(self.num.max(0)), i128::from(self.den));
        let code = (2 * num * steps + den).div_euclid(2 * den).min(steps);
        u32::try_from(code).expect("at most the steps")
    }

    fn with_denominator(self, den: i64) -> i64 {
        self.num * (den / self.den)
    }

    /// Both over one denominator: each divides 65535^2 or the other, so the larger one serves.
    fn combine(self, other: Self, operation: impl Fn(i64, i64) -> i64) -> Self {
        let den = if self.den % other.den == 0 { self.den } else { other.den };
        debug_assert!(den % self.den == 0 && den % other.den == 0, "{self:?} and {other:?}");
        Self { num: operation(self.with_denominator(den), other.with_denominator(den)), den }
    }
}

impl Arithmetic for Unit {
    type Value = Value;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Value {
        Self::of_code(code(x, self.bits), self.bits)
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            // The two alpha bits of rgb10a2unorm are thirds: 341 steps of 1023 each.
            ChannelKind::Unorm(bits) if bits < self.bits => {
                Self::of_code(code * (steps(self.bits) / steps(bits)), self.bits)
            }
            _ => Self::of_code(code, self.bits),
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

    fn multiply(&self, x: &Value, factor: &Value) -> Value {
        Value { num: x.num * factor.num, den: x.den * factor.den }
    }

    fn add(&self, x: &Value, y: &Value) -> Value {
        x.combine(*y, |x, y| x + y)
    }

    fn subtract(&self, x: &Value, y: &Value) -> Value {
        x.combine(*y, |x, y| x - y)
    }

    fn minimum(&self, x: &Value, y: &Value) -> Value {
        x.combine(*y, i64::min)
    }

    fn maximum(&self, x: &Value, y: &Value) -> Value {
        x.combine(*y, i64::max)
    }

    fn clamp(&self, x: &Value, _class: TargetClass) -> Value {
        Value { num: x.num.clamp(0, x.den), den: x.den }
    }

    /// Two alpha bits are made of the code's top four, n: the nearest code to n / 15.
    fn encode(&self, x: &Value, kind: ChannelKind) -> u32 {
        let code = x.nearest(self.bits);
        match kind {
            ChannelKind::Unorm(bits) if bits < self.bits => {
                let top = code >> (self.bits - 4);
                (2 * top * steps(bits) + 15) / 30
            }
            _ => code,
        }
    }

    fn describe(&self, x: &Value) -> Number {
        use num_rational::BigRational;
        Number::rational(BigRational::new(x.num.into(), x.den.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_cut_before_they_are_rounded() {
        assert_eq!(code(0.296_078_44, 8), 75, "75.50000 codes, 75.46 after the cut");
        assert_eq!(code(0.5, 8), 127, "a half goes down");
        assert_eq!(code(2049.0 / 4096.0, 8), 128, "the next number that is kept");
        assert_eq!([code(0.0, 8), code(1.0, 8), code(7.0, 8), code(-1.0, 8)], [0, 255, 255, 0]);
    }

    #[test]
    fn codes_stay() {
        for (bits, step) in [(8, 1), (10, 1), (16, 7)] {
            for c in (0..=steps(bits)).step_by(step) {
                #[expect(clippy::cast_possible_truncation, reason = "codes as shaders give them")]
                let x = (f64::from(c) / f64::from(steps(bits))) as f32;
                assert_eq!(code(x, bits), c, "{c} of {bits} bits");
            }
        }
    }

    #[test]
    fn two_bits_of_alpha_come_from_four() {
        let unit = Unit { bits: 10 };
        let store = |code| unit.encode(&Unit::of_code(code, 10), ChannelKind::Unorm(2));
        assert_eq!(
            [store(0), store(191), store(192), store(511), store(512), store(831), store(832)],
            [0, 0, 1, 1, 2, 2, 3]
        );
    }
}
