//! Float targets: sums of two products, formed in a window of bits and rounded once.
//!
//! The two products are exact. They are aligned to the larger exponent, where an exponent is the sum of the factors' own, so
//! that it does not depend on whether the significands' product reaches 2. Three bits more than the significand's are kept; a
//! product that loses bits there has its last kept bit set (the *sticky* bit). The last bit of the sum says no more than
//! "there was something": it never rounds a half up by itself. The sum is then rounded to the nearest, ties to even.

use super::Operand;
use crate::format::{ChannelKind, ColorFormat, FloatLayout, Rounding, TargetClass};
use crate::model::binary32::{minimum_number, narrow};
use crate::model::{Arithmetic, Number};

/// The blender of one width.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    layout: FloatLayout,
}

/// A number in the blender, or a product of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// Exact: products of two binary32 numbers fit.
    x: f64,
    /// The number's exponent, or the sum of the factors'; for zeros one of the constants below.
    exponent: i32,
    /// Whether it is a stored number, or a product of one: the sign of a sum that is zero depends on it.
    stored: bool,
}

/// A number that is zero.
const IS_ZERO: i32 = -10_000;

/// A term whose factor is zero: it is left out.
const LEFT_OUT: i32 = -10_001;

/// The factor that is the constant zero.
const ZERO: Value = Value { x: 0.0, exponent: IS_ZERO, stored: false };

/// Bits kept below the significand's.
const GUARD_BITS: u32 = 3;

/// What the last bit of a sum stands for: less than half a place of 2 in binary32, the least sum that has one.
const SOMETHING: f64 = 1.0 / 16_777_216.0;

impl Value {
    /// A number as an operand.
    pub(super) fn of(x: f64) -> Self {
        Self { x, exponent: exponent(x), stored: false }
    }

    /// The same, read from the target.
    pub(super) fn read(x: f64) -> Self {
        Self { stored: true, ..Self::of(x) }
    }

    /// The number.
    pub(super) const fn number(self) -> f64 {
        self.x
    }
}

/// floor(log2 |x|), denormals as if they were normalised.
fn exponent(x: f64) -> i32 {
    if x == 0.0 {
        return IS_ZERO;
    }
    // Every operand is normal in binary64.
    i32::try_from(x.to_bits() >> 52 & 0x7ff).expect("eleven bits") - 1023
}

/// |x| cut to an integer, its last bit set if something was cut off.
fn with_sticky(x: f64) -> f64 {
    let cut = x.abs().floor();
    if cut == x.abs() {
        return x;
    }
    let odd = if cut % 2.0 == 0.0 { cut + 1.0 } else { cut };
    odd.copysign(x)
}

impl Unit {
    /// binary16, for half-float, 11/10-bit float and sRGB targets.
    pub const HALF: Self = Self { layout: FloatLayout::HALF };
    /// binary32.
    pub const SINGLE: Self = Self { layout: FloatLayout::SINGLE };

    /// The number of this width toward zero.
    pub(super) fn cut(self, x: f64) -> f64 {
        self.layout.decode(self.layout.encode(x, Rounding::TowardZero))
    }

    /// The nearest number of this width; none is infinite.
    fn round(self, x: f64) -> f64 {
        if x.is_nan() {
            return x;
        }
        let largest = self.layout.decode(self.layout.max_finite());
        let rounded = self.layout.decode(self.layout.encode(x, Rounding::NearestEven)).clamp(-largest, largest);
        self.flush(rounded)
    }

    fn finite(self, x: Value) -> Value {
        if x.x.is_infinite() { Value::of(self.round(x.x)) } else { x }
    }

    /// binary32 has no denormals here.
    fn flush(self, x: f64) -> f64 {
        let flushed = self.layout == FloatLayout::SINGLE && x.abs() < f64::from(f32::MIN_POSITIVE);
        if flushed { 0.0_f64.copysign(x) } else { x }
    }

    /// The sum of a source and a destination term, in either order.
    fn sum(self, a: Value, b: Value) -> f64 {
        if a.x == 0.0 && b.x == 0.0 {
            return zero_of(a, b);
        }
        if !(a.x.is_finite() && b.x.is_finite()) {
            return self.round(a.x + b.x);
        }
        let kept = (self.layout.mantissa_bits + GUARD_BITS).cast_signed();
        let unit = 2.0_f64.powi(a.exponent.max(b.exponent) - kept);
        let sum = with_sticky(a.x / unit) + with_sticky(b.x / unit);
        // The last bit is below every rounding bit, and alone it is nothing.
        let even = (sum.abs() / 2.0).floor() * 2.0;
        if even == 0.0 {
            return 0.0;
        }
        let something = if sum.abs() > even { SOMETHING } else { 0.0 };
        self.round((even + something).copysign(sum) * unit)
    }
}

/// The zero that two terms of zero add to: the destination's, unless its factor is zero.
fn zero_of(a: Value, b: Value) -> f64 {
    let (src, dst) = if a.stored { (b, a) } else { (a, b) };
    if dst.exponent == LEFT_OUT { src.x } else { dst.x }
}

/// The lower; a number rather than NaN. Operands are binary32 numbers at most.
fn lower(x: Value, y: Value) -> Value {
    Value::of(f64::from(minimum_number(narrow(x.x), narrow(y.x))))
}

/// The higher, likewise.
fn higher(x: Value, y: Value) -> Value {
    Value::of(f64::from(-minimum_number(-narrow(x.x), -narrow(y.x))))
}

impl Arithmetic for Unit {
    type Value = Value;

    /// Narrow floats are cut; finite numbers stay finite.
    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Value {
        let x = f64::from(x);
        if self.layout == FloatLayout::SINGLE || !x.is_finite() {
            return Value::of(self.flush(x));
        }
        Value::of(self.cut(x))
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            ChannelKind::Float(layout) => {
                let sign = if code & layout.sign() == 0 { 1.0 } else { -1.0_f64 };
                Value::read(self.flush(layout.decode(code)).copysign(sign))
            }
            _ => ZERO,
        }
    }

    fn zero(&self) -> Value {
        ZERO
    }

    fn one(&self) -> Value {
        Value::of(1.0)
    }

    fn complement(&self, x: &Value) -> Value {
        // A NaN loses its sign.
        if x.x.is_nan() {
            return Value::of(x.x.copysign(1.0));
        }
        if x.x.is_infinite() {
            return Value::of(-x.x);
        }
        Value::of(self.round(1.0 - x.x))
    }

    /// An infinite alpha stays infinite.
    fn saturate(&self, src_alpha: &Value, room: &Value) -> Value {
        lower(*src_alpha, *room)
    }

    fn multiply(&self, x: &Value, factor: &Value) -> Value {
        // Zero times anything is zero, NaN included.
        if x.x == 0.0 || factor.x == 0.0 {
            let negative = x.x.is_sign_negative() != factor.x.is_sign_negative();
            let exponent = if factor.exponent == IS_ZERO { LEFT_OUT } else { IS_ZERO };
            return Value { x: if negative { -0.0 } else { 0.0 }, exponent, ..*x };
        }
        Value { x: x.x * factor.x, exponent: x.exponent + factor.exponent, ..*x }
    }

    fn add(&self, x: &Value, y: &Value) -> Value {
        Value::of(self.sum(*x, *y))
    }

    fn subtract(&self, x: &Value, y: &Value) -> Value {
        Value::of(self.sum(*x, Value { x: -y.x, ..*y }))
    }

    fn minimum(&self, x: &Value, y: &Value) -> Value {
        self.finite(lower(*x, *y))
    }

    fn maximum(&self, x: &Value, y: &Value) -> Value {
        self.finite(higher(*x, *y))
    }

    fn clamp(&self, x: &Value, _class: TargetClass) -> Value {
        *x
    }

    /// 11- and 10-bit floats are cut from the half float.
    fn encode(&self, x: &Value, kind: ChannelKind) -> u32 {
        match kind {
            ChannelKind::Float(FloatLayout::SINGLE) => narrow(x.x).to_bits(),
            ChannelKind::Float(layout) => layout.encode(x.x, Rounding::TowardZero),
            _ => 0,
        }
    }

    fn describe(&self, x: &Value) -> Number {
        Number::binary(x.x)
    }
}

impl Operand for Value {
    fn is_zero(&self) -> bool {
        self.x == 0.0
    }

    fn is_one(&self) -> bool {
        self.x == 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(x: f64, factor: f64) -> Value {
        Unit::HALF.multiply(&Value::of(x), &Value::of(factor))
    }

    #[test]
    fn a_product_alone_is_rounded_correctly() {
        let product = Unit::HALF.sum(term(1.0 + 2.0_f64.powi(-10), 1.0 + 2.0_f64.powi(-10)), term(1.0, 0.0));
        assert_eq!(product, 1.0 + 2.0_f64.powi(-9), "2^-20 more than the nearest half float");
    }

    /// As recorded: the last bit kept of each product makes a tie of a sum that is below one.
    #[test]
    fn sums_lose_what_lies_outside_the_window() {
        let u = 2.0_f64.powi(-10);
        // 90.6875 u + 1342.80762 u = 1433.49512 u stores 1434 u.
        let sum = Unit::HALF.sum(term(90.6875 * u, 1.0), term(3270.0 * u, 0.410_644_531_25));
        assert_eq!(sum / u, 1434.0);
    }

    #[test]
    fn binary32_has_no_denormals() {
        let unit = Unit::SINGLE;
        let half_of_least = unit.multiply(&Value::of(f64::from(f32::MIN_POSITIVE)), &Value::of(0.5));
        assert_eq!(unit.sum(half_of_least, unit.multiply(&Value::read(1.0), &ZERO)), 0.0);
    }

    #[test]
    fn a_term_with_the_factor_zero_is_left_out() {
        assert_eq!(Unit::HALF.multiply(&Value::of(f64::NAN), &ZERO).x, 0.0);
    }
}
