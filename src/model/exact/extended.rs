//! Extended real arithmetic: rationals, infinities, NaN and signed zeros; the fallback of `exact`.
//!
//! A finite number is an enclosure by two rationals, a single point unless an sRGB code on the power segment is
//! involved. Infinities, NaN and the sign of zero follow IEEE 754.
//!
//! **Ties.** A point is compared with a threshold exactly, ties included. A proper enclosure is refined until it lies on
//! one side, which ends because a blend that involves an irrational sRGB value never meets a threshold: on the power
//! segment codes are (x / 10761)^(12/5) with x = 40 c + 561, thresholds the same with x = 40 c + 581. Fifth roots of
//! rationals in different classes modulo fifth powers are linearly independent over the rationals, so a combination of
//! them with rational coefficients (every blend factor that is not itself such a root, is rational) equals a threshold
//! only if it is a single root in the threshold's class. Two integers x, y of that size share a class only if their
//! ratio is a fifth power, at most 5^5 / 3^5 between odd numbers, which `no_code_shares_a_class_with_a_threshold` rules
//! out by trying them all; products d * d are tried there too.
//!
//! Toward zero the thresholds are the codes themselves, and a blend that keeps a code meets one. Its enclosure is then the
//! threshold's own, for products with 1 and sums with 0 keep both ends. Where numbers cancel, as in S (1 - D) + D with S = 1,
//! an enclosure that the finest precision cannot tell from a threshold is that threshold.

use std::cell::Cell;
use std::cmp::Ordering;

use num_bigint::{BigInt, BigUint, Sign};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::super::{Arithmetic, Number};
use crate::format::srgb::{self, Enclosure};
use crate::format::{ChannelKind, ColorFormat, FloatLayout, Rounding, TargetClass, snorm, unorm};

/// An extended real number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// Not a number.
    Nan,
    /// An infinity, and whether it is negative.
    Infinity(bool),
    /// A finite number, enclosed; the flag is the sign of an exact zero.
    Finite(Enclosure, bool),
}

/// Bits of the finest enclosure that is tried.
pub(super) const FINEST: u32 = 16384;

/// Extended real arithmetic with enclosures of a given precision.
#[derive(Debug)]
pub struct Extended {
    rounding: Rounding,
    /// sRGB values are enclosed to 2^-bits.
    bits: u32,
    in_doubt: Cell<bool>,
}

impl Extended {
    /// An arithmetic that stores with this rounding and encloses sRGB values to 2^-`bits`.
    #[must_use]
    pub fn new(rounding: Rounding, bits: u32) -> Self {
        Self { rounding, bits, in_doubt: Cell::new(false) }
    }

    /// Whether a rounding could not be decided at this precision.
    #[must_use]
    pub fn in_doubt(&self) -> bool {
        self.in_doubt.get()
    }

    /// The code both ends store as, or doubt.
    fn encode_by(&self, x: &Enclosure, encode: impl Fn(&BigRational) -> u32) -> u32 {
        let code = encode(&x.lo);
        if x.lo != x.hi && encode(&x.hi) != code {
            self.in_doubt.set(true);
        }
        code
    }
}

/// A rational point, positive if zero.
fn point(x: BigRational) -> Value {
    Value::Finite(Enclosure { lo: x.clone(), hi: x }, false)
}

/// numerator / denominator.
fn ratio(numerator: impl Into<BigInt>, denominator: impl Into<BigInt>) -> Value {
    point(BigRational::new(numerator.into(), denominator.into()))
}

/// An `f64` as an extended real.
fn from_f64(x: f64) -> Value {
    match BigRational::from_float(x) {
        Some(rational) => {
            Value::Finite(Enclosure { lo: rational.clone(), hi: rational }, x == 0.0 && x.is_sign_negative())
        }
        None if x.is_nan() => Value::Nan,
        None => Value::Infinity(x < 0.0),
    }
}

impl From<&Number> for Value {
    /// The number itself where it is known exactly, else its decimal.
    fn from(number: &Number) -> Self {
        match number.fraction() {
            Some(rational) if !rational.is_zero() => point(rational.clone()),
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
            Self::Finite(x, zero_sign) => {
                if x.lo.is_zero() && x.hi.is_zero() {
                    *zero_sign
                } else {
                    x.hi.is_negative()
                }
            }
        }
    }

    fn is_zero(&self) -> bool {
        matches!(self, Self::Finite(x, _) if x.lo.is_zero() && x.hi.is_zero())
    }

    fn negated(&self) -> Self {
        match self {
            Self::Nan => Self::Nan,
            Self::Infinity(negative) => Self::Infinity(!negative),
            Self::Finite(x, sign) => Self::Finite(Enclosure { lo: -x.hi.clone(), hi: -x.lo.clone() }, !sign),
        }
    }
}

/// The product of two enclosures.
fn multiply_enclosures(x: &Enclosure, y: &Enclosure) -> Enclosure {
    if x.lo == x.hi && y.lo == y.hi {
        let product = &x.lo * &y.lo;
        return Enclosure { lo: product.clone(), hi: product };
    }
    let ends = [&x.lo * &y.lo, &x.lo * &y.hi, &x.hi * &y.lo, &x.hi * &y.hi];
    let [first, ..] = &ends;
    let lo = ends.iter().fold(first, |a, b| if b < a { b } else { a }).clone();
    let hi = ends.iter().fold(first, |a, b| if b > a { b } else { a }).clone();
    Enclosure { lo, hi }
}

impl Arithmetic for Extended {
    type Value = Value;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Value {
        from_f64(f64::from(x))
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            ChannelKind::Absent => self.zero(),
            ChannelKind::Unorm(bits) => ratio(code, unorm::steps(bits)),
            ChannelKind::Snorm(bits) => ratio(snorm::signed_code(code, bits), snorm::steps(bits)),
            ChannelKind::Srgb => Value::Finite(srgb::linear_enclosure(2 * code, self.bits), false),
            ChannelKind::Float(layout) => from_f64(layout.decode(code)),
        }
    }

    fn zero(&self) -> Value {
        point(BigRational::zero())
    }

    fn one(&self) -> Value {
        point(BigRational::one())
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
            (Value::Finite(a, _), Value::Finite(b, _)) => Value::Finite(multiply_enclosures(a, b), negative),
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
                let sum = Enclosure { lo: &a.lo + &b.lo, hi: &a.hi + &b.hi };
                // To nearest, a zero sum is -0 only when both are.
                Value::Finite(sum, x.is_zero() && y.is_zero() && x.is_negative() && y.is_negative())
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
                let lo = if b.lo < a.lo { &b.lo } else { &a.lo };
                let hi = if b.hi < a.hi { &b.hi } else { &a.hi };
                // -0 is below +0.
                Value::Finite(
                    Enclosure { lo: lo.clone(), hi: hi.clone() },
                    (x.is_zero() && *a_sign) || (y.is_zero() && *b_sign),
                )
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
            (Value::Finite(x, _), ChannelKind::Unorm(bits)) => {
                self.encode_by(x, |x| encode_scaled(x, unorm::steps(bits), rounding).0)
            }
            (Value::Finite(x, _), ChannelKind::Snorm(bits)) => self.encode_by(x, |x| {
                let (code, negative) = encode_scaled(x, snorm::steps(bits).unsigned_abs(), rounding);
                let signed = i32::try_from(code).expect("at most N");
                snorm::stored_code(if negative { -signed } else { signed }, bits)
            }),
            (Value::Finite(x, _), ChannelKind::Srgb) => self.encode_srgb(x),
            (Value::Finite(x, zero_sign), ChannelKind::Float(layout)) => {
                self.encode_by(x, |x| encode_float(x, *zero_sign, layout, rounding))
            }
        }
    }

    fn describe(&self, x: &Value) -> Number {
        match x {
            Value::Nan => Number::near(f64::NAN),
            Value::Infinity(negative) => Number::near(if *negative { f64::NEG_INFINITY } else { f64::INFINITY }),
            Value::Finite(x, zero_sign) if *zero_sign && x.lo.is_zero() && x.hi.is_zero() => Number::binary(-0.0),
            Value::Finite(x, _) if x.lo == x.hi => Number::rational(x.lo.clone()),
            Value::Finite(x, _) => Number::near(x.lo.to_f64().unwrap_or(f64::NAN)),
        }
    }
}

impl Extended {
    /// The code of a linear value: how many thresholds it reaches.
    fn encode_srgb(&self, x: &Enclosure) -> u32 {
        let (mut low, mut high) = (0_u32, 255_u32);
        while low < high {
            let middle = u32::midpoint(low, high);
            let half_code = if self.rounding == Rounding::TowardZero { 2 * middle + 2 } else { 2 * middle + 1 };
            let at = srgb::linear_enclosure(half_code, self.bits);
            let reached = if x.lo > at.hi {
                true
            } else if x.hi < at.lo {
                false
            } else if x.lo == x.hi && at.lo == at.hi {
                match self.rounding {
                    Rounding::NearestEven => middle % 2 == 1,
                    Rounding::NearestAway | Rounding::TowardZero => true,
                }
            } else if self.rounding == Rounding::TowardZero
                && ((&x.lo, &x.hi) == (&at.lo, &at.hi) || self.bits >= FINEST)
            {
                true
            } else {
                self.in_doubt.set(true);
                false
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

    /// Whether an integer ratio p / q (in lowest terms by its own prime powers) is a fifth power of a rational.
    fn is_fifth_power(p: &BigUint, q: &BigUint) -> bool {
        let gcd = p.gcd(q);
        [p / &gcd, q / &gcd].iter().all(|n| n.nth_root(5).pow(5) == *n)
    }

    #[test]
    fn no_code_shares_a_class_with_a_threshold() {
        let one = BigUint::from(10761_u32);
        let codes: Vec<BigUint> = (11..=254_u32).map(|c| BigUint::from(40 * c + 561)).collect();
        let thresholds: Vec<BigUint> = (10..=254_u32).map(|c| BigUint::from(40 * c + 581)).collect();
        for y in &thresholds {
            // A threshold is itself irrational.
            assert!(!is_fifth_power(y, &one), "threshold {y}");
            for x in &codes {
                assert!(!is_fifth_power(x, y), "code {x}, threshold {y}");
                assert!(!is_fifth_power(&(x * x), &(y * &one)), "code {x} squared, threshold {y}");
            }
        }
    }

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
