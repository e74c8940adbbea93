//! Normalised targets: codes in, exact arithmetic, the nearest code out.
//!
//! Signed ones are a sign and a magnitude of one bit less. Factors are not clamped: 1 - x of a signed x reaches 2.

use super::Operand;
use crate::format::{ChannelKind, ColorFormat, TargetClass, snorm, unorm};
use crate::model::{Arithmetic, Number};

/// Fractional bits beyond those of a code that a number keeps before it is rounded to a code.
const GUARD_BITS: u32 = 4;

/// The blender of a target whose color channels have `bits` bits.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Bits of a color channel's magnitude, and of every operand's but the destination's alpha.
    bits: u32,
    signed: bool,
}

impl Unit {
    /// For unsigned channels of `bits` bits.
    #[must_use]
    pub const fn unsigned(bits: u32) -> Self {
        Self { bits, signed: false }
    }

    /// For signed channels of `bits` bits, the sign included.
    #[must_use]
    pub const fn signed(bits: u32) -> Self {
        Self { bits: bits - 1, signed: true }
    }

    const fn steps(self) -> u32 {
        unorm::steps(self.bits)
    }

    fn of_code(self, code: i64) -> Value {
        Value { num: code, den: self.steps().into() }
    }
}

/// A number in the blender: `num / den`, both exact. No denominator is above 65535^2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value {
    num: i64,
    den: i64,
}

/// The code of `bits` bits of a number from 0 to 1: cut to `bits + 4` fractional bits, then to the nearest, halves down.
///
/// # Panics
/// When `bits` is above 27: neither color nor depth has as many.
#[must_use]
pub fn code(x: f32, bits: u32) -> u32 {
    let kept = bits + GUARD_BITS;
    let scaled = f64::from(x.clamp(0.0, 1.0)) * f64::from(1_u32 << kept);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut on purpose; from 0 to 2^28")]
    let cut = scaled as u64;
    let code = (2 * cut * u64::from(unorm::steps(bits)) + (1 << kept) - 1) >> (kept + 1);
    u32::try_from(code).expect("at most 24 bits")
}

impl Value {
    /// The nearest multiple of 1 / steps. Sums of products of codes are never half way: their denominators are odd.
    fn nearest(self, steps: u32) -> i64 {
        let (num, den, steps) = (i128::from(self.num), i128::from(self.den), i128::from(steps));
        i64::try_from((2 * num * steps + den).div_euclid(2 * den)).expect("clamped before")
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
        let magnitude = i64::from(code(x.abs(), self.bits));
        self.of_code(if x < 0.0 { -magnitude } else { magnitude })
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            // The two alpha bits of rgb10a2unorm are thirds: 341 steps of 1023 each.
            ChannelKind::Unorm(bits) => self.of_code((code * (self.steps() / unorm::steps(bits))).into()),
            // The lowest code counts as the one above it.
            ChannelKind::Snorm(bits) => self.of_code(i64::from(snorm::signed_code(code, bits))),
            _ => self.zero(),
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

    fn clamp_factor(&self, factor: Value, _class: TargetClass) -> Value {
        factor
    }

    fn clamp(&self, x: &Value, _class: TargetClass) -> Value {
        let lowest = if self.signed { -x.den } else { 0 };
        Value { num: x.num.clamp(lowest, x.den), den: x.den }
    }

    /// Two alpha bits are made of the code's top four, n: the nearest code to n / 15.
    fn encode(&self, x: &Value, kind: ChannelKind) -> u32 {
        let code = x.nearest(self.steps());
        match kind {
            ChannelKind::Snorm(bits) => snorm::stored_code(i32::try_from(code).expect("at most 16 bits"), bits),
            ChannelKind::Unorm(bits) if bits < self.bits => {
                let top = u32::try_from(code >> (self.bits - 4)).expect("four bits");
                (2 * top * unorm::steps(bits) + 15) / 30
            }
            _ => u32::try_from(code).expect("clamped"),
        }
    }

    fn describe(&self, x: &Value) -> Number {
        use num_rational::BigRational;
        Number::rational(BigRational::new(x.num.into(), x.den.into()))
    }
}

impl Operand for Value {
    fn is_zero(&self) -> bool {
        self.num == 0
    }

    fn is_one(&self) -> bool {
        self.num == self.den
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
            for c in (0..=unorm::steps(bits)).step_by(step) {
                #[expect(clippy::cast_possible_truncation, reason = "codes as shaders give them")]
                let x = (f64::from(c) / f64::from(unorm::steps(bits))) as f32;
                assert_eq!(code(x, bits), c, "{c} of {bits} bits");
            }
        }
    }

    #[test]
    fn two_bits_of_alpha_come_from_four() {
        let unit = Unit::unsigned(10);
        let store = |code| unit.encode(&unit.of_code(code), ChannelKind::Unorm(2));
        assert_eq!(
            [store(0), store(191), store(192), store(511), store(512), store(831), store(832)],
            [0, 0, 1, 1, 2, 2, 3]
        );
    }

    #[test]
    fn the_lowest_signed_code_counts_as_the_next() {
        let unit = Unit::signed(8);
        assert_eq!(unit.decode(0x80, ChannelKind::Snorm(8)), unit.decode(0x81, ChannelKind::Snorm(8)));
        assert_eq!(unit.encode(&unit.of_code(-127), ChannelKind::Snorm(8)), 0x81);
    }
}
