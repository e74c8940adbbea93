//! Extended real arithmetic: real numbers, infinities, NaN and signed zeros; the fallback of `exact`.
//!
//! A finite number is known exactly, ties included (see [`real`](super::real)). Infinities, NaN and the sign of zero follow
//! IEEE 754.

use std::cmp::Ordering;

use num_bigint::{BigUint, Sign};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

use super::super::{Arithmetic, Number};
use super::real::Real;
use crate::format::{ChannelKind, ColorFormat, FloatLayout, Rounding, TargetClass, snorm, unorm};

/// An extended real number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// Not a number.
    Nan,
    /// An infinity, and whether it is negative.
    Infinity(bool),
    /// A finite number; the flag is the sign of a zero.
    Finite(Real, bool),
}

/// Extended real arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Extended {
    rounding: Rounding,
}

impl Extended {
    /// An arithmetic that stores with this rounding.
    #[must_use]
    pub fn new(rounding: Rounding) -> Self {
        Self { rounding }
    }
}

/// A real number, positive if zero.
fn finite(x: Real) -> Value {
    Value::Finite(x, false)
}

/// An `f64` as an extended real.
fn from_f64(x: f64) -> Value {
    match BigRational::from_float(x) {
        Some(rational) => Value::Finite(rational.into(), x == 0.0 && x.is_sign_negative()),
        None if x.is_nan() => Value::Nan,
        None => Value::Infinity(x < 0.0),
    }
}

impl From<&Number> for Value {
    /// The number itself where it is known exactly, else its decimal.
    fn from(number: &Number) -> Self {
        match number.fraction() {
            Some(rational) if !rational.is_zero() => finite(rational.clone().into()),
            _ => from_f64(number.decimal),
        }
    }
}

impl Value {
    /// Whether the number counts as negative: by its sign, or the sign of zero.
    fn is_negative(&self) -> bool {
        match self {
            Self::Nan => false,
            Self::Infinity(negative) => *negative,
            Self::Finite(x, zero_sign) => match x.compare(&Real::ratio(0, 1)) {
                Ordering::Equal => *zero_sign,
                order => order == Ordering::Less,
            },
        }
    }

    fn is_zero(&self) -> bool {
        matches!(self, Self::Finite(x, _) if x.is_zero())
    }

    fn negated(&self) -> Self {
        match self {
            Self::Nan => Self::Nan,
            Self::Infinity(negative) => Self::Infinity(!negative),
            Self::Finite(x, sign) => Self::Finite(x.negated(), !sign),
        }
    }
}

impl Arithmetic for Extended {
    type Value = Value;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Value {
        from_f64(f64::from(x))
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            ChannelKind::Absent => self.zero(),
            ChannelKind::Unorm(bits) => finite(Real::ratio(code, unorm::steps(bits))),
            ChannelKind::Snorm(bits) => finite(Real::ratio(snorm::signed_code(code, bits), snorm::steps(bits))),
            ChannelKind::Srgb => finite(Real::srgb(code)),
            ChannelKind::Float(layout) => from_f64(layout.decode(code)),
        }
    }

    fn zero(&self) -> Value {
        finite(Real::ratio(0, 1))
    }

    fn one(&self) -> Value {
        finite(Real::ratio(1, 1))
    }

    fn complement(&self, x: &Value) -> Value {
        self.subtract(&self.one(), x)
    }

    fn multiply(&self, x: &Value, factor: &Value) -> Value {
        let negative = x.is_negative() != factor.is_negative();
        match (x, factor) {
            (Value::Nan, _) | (_, Value::Nan) => Value::Nan,
            (Value::Infinity(_), other) | (other, Value::Infinity(_)) => {
                if other.is_zero() {
                    Value::Nan
                } else {
                    Value::Infinity(negative)
                }
            }
            (Value::Finite(a, _), Value::Finite(b, _)) => Value::Finite(a.times(b), negative),
        }
    }

    fn add(&self, x: &Value, y: &Value) -> Value {
        match (x, y) {
            (Value::Nan, _) | (_, Value::Nan) => Value::Nan,
            (Value::Infinity(a), Value::Infinity(b)) => {
                if a == b {
                    Value::Infinity(*a)
                } else {
                    Value::Nan
                }
            }
            (Value::Infinity(negative), _) | (_, Value::Infinity(negative)) => Value::Infinity(*negative),
            (Value::Finite(a, _), Value::Finite(b, _)) => {
                // To nearest, a zero sum is -0 only when both are.
                Value::Finite(a.plus(b), x.is_zero() && y.is_zero() && x.is_negative() && y.is_negative())
            }
        }
    }

    fn subtract(&self, x: &Value, y: &Value) -> Value {
        self.add(x, &y.negated())
    }

    fn minimum(&self, x: &Value, y: &Value) -> Value {
        match (x, y) {
            (Value::Nan, number) | (number, Value::Nan) => number.clone(),
            (Value::Infinity(true), _) | (_, Value::Infinity(true)) => Value::Infinity(true),
            (Value::Infinity(false), other) | (other, Value::Infinity(false)) => other.clone(),
            (Value::Finite(a, a_sign), Value::Finite(b, b_sign)) => {
                let least = if b.compare(a) == Ordering::Less { b } else { a };
                // -0 is below +0.
                Value::Finite(least.clone(), (x.is_zero() && *a_sign) || (y.is_zero() && *b_sign))
            }
        }
    }

    fn maximum(&self, x: &Value, y: &Value) -> Value {
        self.minimum(&x.negated(), &y.negated()).negated()
    }

    fn clamp(&self, x: &Value, class: TargetClass) -> Value {
        let (low, high) = match class {
            TargetClass::Float => return x.clone(),
            TargetClass::Unorm => (self.zero(), self.one()),
            TargetClass::Snorm => (self.one().negated(), self.one()),
        };
        match x {
            Value::Nan => self.zero(),
            _ => self.minimum(&self.maximum(x, &low), &high),
        }
    }

    fn encode(&self, x: &Value, kind: ChannelKind) -> u32 {
        let rounding = self.rounding;
        match (x, kind) {
            (_, ChannelKind::Absent) => 0,
            (Value::Nan, ChannelKind::Float(layout)) => layout.encode(f64::NAN, rounding),
            (Value::Infinity(negative), ChannelKind::Float(layout)) => {
                layout.encode(if *negative { f64::NEG_INFINITY } else { f64::INFINITY }, rounding)
            }
            // Normalised channels are clamped before: neither NaN nor Inf arrives.
            (Value::Nan | Value::Infinity(_), _) => 0,
            (Value::Finite(x, _), ChannelKind::Srgb) => self.encode_srgb(x),
            // Irrational numbers come from sRGB channels only, and stay there.
            (Value::Finite(x, _), ChannelKind::Unorm(bits)) => encode_scaled(&x.near(), unorm::steps(bits), rounding).0,
            (Value::Finite(x, _), ChannelKind::Snorm(bits)) => {
                let (code, negative) = encode_scaled(&x.near(), snorm::steps(bits).unsigned_abs(), rounding);
                let signed = i32::try_from(code).expect("at most N");
                snorm::stored_code(if negative { -signed } else { signed }, bits)
            }
            (Value::Finite(x, zero_sign), ChannelKind::Float(layout)) => {
                encode_float(&x.near(), *zero_sign, layout, rounding)
            }
        }
    }

    fn describe(&self, x: &Value) -> Number {
        match x {
            Value::Nan => Number::near(f64::NAN),
            Value::Infinity(negative) => Number::near(if *negative { f64::NEG_INFINITY } else { f64::INFINITY }),
            Value::Finite(x, zero_sign) if *zero_sign && x.is_zero() => Number::binary(-0.0),
            Value::Finite(x, _) => match x.rational() {
                Some(rational) => Number::rational(rational.clone()),
                None => Number::near(x.near().to_f64().unwrap_or(f64::NAN)),
            },
        }
    }
}

impl Extended {
    /// The code of a linear value: how many thresholds it reaches.
    fn encode_srgb(&self, x: &Real) -> u32 {
        let (mut low, mut high) = (0_u32, 255_u32);
        while low < high {
            let middle = u32::midpoint(low, high);
            // Toward zero a code begins at its own value, to nearest half-way from the code before.
            let half_code = if self.rounding == Rounding::TowardZero { 2 * middle + 2 } else { 2 * middle + 1 };
            let reached = match (x.compare_with_point(half_code), self.rounding) {
                (Ordering::Equal, Rounding::NearestEven) => middle % 2 == 1,
                (order, _) => order != Ordering::Less,
            };
            if reached { low = middle + 1 } else { high = middle }
        }
        low
    }
}

/// |x| * steps rounded, and whether x is negative.
fn encode_scaled(x: &BigRational, steps: u32, rounding: Rounding) -> (u32, bool) {
    let scaled = x.abs() * BigRational::from_integer(steps.into());
    let code = round(scaled.numer().magnitude(), scaled.denom().magnitude(), rounding);
    (code.to_u32().unwrap_or(u32::MAX).min(steps), x.is_negative())
}

/// numerator / denominator rounded to an integer.
fn round(numerator: &BigUint, denominator: &BigUint, rounding: Rounding) -> BigUint {
    let (floor, rest) = numerator.div_rem(denominator);
    let half: Ordering = (&rest << 1_u32).cmp(denominator);
    let up = rounding.round_up(floor.is_odd(), rest.is_zero(), half);
    if up { floor + 1_u32 } else { floor }
}

/// The code of a rational in a float layout.
fn encode_float(x: &BigRational, zero_sign: bool, layout: FloatLayout, rounding: Rounding) -> u32 {
    if x.is_zero() {
        return if zero_sign { layout.sign() } else { 0 };
    }
    if x.is_negative() && !layout.signed {
        return 0;
    }
    let sign = if x.numer().sign() == Sign::Minus { layout.sign() } else { 0 };
    let (numerator, denominator) = (x.numer().magnitude(), x.denom().magnitude());
    let length = |n: &BigUint| i32::try_from(n.bits()).expect("numbers here have a few thousand bits");
    // 2^top <= |x| < 2^(top + 1).
    let guess = length(numerator) - length(denominator);
    let top = if less_than_power(numerator, denominator, guess) { guess - 1 } else { guess };
    let unit = layout.unit_exponent(top);
    let (numerator, denominator) = if unit >= 0 {
        (numerator.clone(), scale(denominator, unit))
    } else {
        (scale(numerator, -unit), denominator.clone())
    };
    let units = round(&numerator, &denominator, rounding);
    sign | layout.assemble(units.to_u32().unwrap_or(u32::MAX), unit, rounding)
}

/// numerator / denominator < 2^power.
fn less_than_power(numerator: &BigUint, denominator: &BigUint, power: i32) -> bool {
    if power >= 0 { *numerator < scale(denominator, power) } else { scale(numerator, -power) < *denominator }
}

/// n * 2^power for power >= 0, n otherwise.
fn scale(n: &BigUint, power: i32) -> BigUint {
    n << usize::try_from(power).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rational_float_encoding_agrees_with_the_f64_one() {
        for i in 0..20_000_u64 {
            let x = f64::from_bits((i.wrapping_mul(0x9e37_79b9_7f4a_7c15) & !(0x7ff << 52)) | ((890 + i % 260) << 52));
            let rational = BigRational::from_float(x).expect("finite");
            for layout in [FloatLayout::HALF, FloatLayout::SINGLE] {
                for mode in [Rounding::NearestEven, Rounding::NearestAway, Rounding::TowardZero] {
                    assert_eq!(
                        encode_float(&rational, false, layout, mode),
                        layout.encode(x, mode),
                        "{x:e} {layout:?} {mode:?}"
                    );
                }
            }
        }
    }
}
