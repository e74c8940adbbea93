//! Extended real numbers on dashu rationals.

use dashu_int::{IBig, UBig};
use dashu_ratio::Relaxed;

/// A rational, an infinity (negative or not), or NaN. Zero has a sign.
#[derive(Clone, Debug)]
pub enum Number {
    Nan,
    Infinite(bool),
    Rational(Relaxed, bool),
}

use Number::{Infinite, Nan, Rational};

pub fn ratio(numerator: i64, denominator: u64) -> Number {
    Rational(Relaxed::from_parts(IBig::from(numerator), UBig::from(denominator)), false)
}

/// magnitude * 2^exponent.
pub fn dyadic(magnitude: u64, exponent: i32) -> Relaxed {
    let shift = exponent.unsigned_abs() as usize;
    if exponent >= 0 {
        Relaxed::from(UBig::from(magnitude) << shift)
    } else {
        Relaxed::from_parts(IBig::from(magnitude), UBig::ONE << shift)
    }
}

/// A binary32 number, from its bits.
pub fn single(x: f32) -> Number {
    if x.is_nan() {
        return Nan;
    }
    let negative = x.is_sign_negative();
    if x.is_infinite() {
        return Infinite(negative);
    }
    let bits = x.to_bits() & 0x7fff_ffff;
    let (exponent, mantissa) = ((bits >> 23).cast_signed(), u64::from(bits & 0x7f_ffff));
    let value = if exponent == 0 { dyadic(mantissa, -149) } else { dyadic(mantissa | 0x80_0000, exponent - 150) };
    Rational(if negative { -value } else { value }, negative)
}

impl Number {
    pub fn zero() -> Self {
        ratio(0, 1)
    }

    pub fn one() -> Self {
        ratio(1, 1)
    }

    fn negative(&self) -> bool {
        match self {
            Nan => false,
            Infinite(negative) => *negative,
            Rational(x, sign) => {
                if x.is_zero() {
                    *sign
                } else {
                    *x < Relaxed::ZERO
                }
            }
        }
    }

    fn is_zero(&self) -> bool {
        matches!(self, Rational(x, _) if x.is_zero())
    }

    pub fn negated(&self) -> Self {
        match self {
            Nan => Nan,
            Infinite(negative) => Infinite(!negative),
            Rational(x, sign) => Rational(-x.clone(), !sign),
        }
    }

    pub fn times(&self, other: &Self) -> Self {
        let negative = self.negative() ^ other.negative();
        match (self, other) {
            (Nan, _) | (_, Nan) => Nan,
            (Rational(x, _), Rational(y, _)) => Rational(x * y, negative),
            _ if self.is_zero() || other.is_zero() => Nan,
            _ => Infinite(negative),
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        match (self, other) {
            (Nan, _) | (_, Nan) => Nan,
            (Infinite(a), Infinite(b)) if a != b => Nan,
            (Infinite(a), _) | (_, Infinite(a)) => Infinite(*a),
            (Rational(x, _), Rational(y, _)) => {
                let both_minus_zero = self.is_zero() && other.is_zero() && self.negative() && other.negative();
                Rational(x + y, both_minus_zero)
            }
        }
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }

    /// Whether self < other, -0 before +0; neither is NaN.
    fn before(&self, other: &Self) -> bool {
        match (self, other) {
            (Infinite(a), Infinite(b)) => *a && !*b,
            (Infinite(a), _) => *a,
            (_, Infinite(b)) => !*b,
            (Rational(x, _), Rational(y, _)) => x < y || (x == y && self.negative() && !other.negative()),
            (Nan, _) | (_, Nan) => false,
        }
    }

    /// The smaller number; NaN only if both are.
    pub fn least(&self, other: &Self) -> Self {
        match (self, other) {
            (Nan, x) | (x, Nan) => x.clone(),
            _ => {
                if other.before(self) {
                    other.clone()
                } else {
                    self.clone()
                }
            }
        }
    }

    /// The larger number; NaN only if both are.
    pub fn greatest(&self, other: &Self) -> Self {
        match (self, other) {
            (Nan, x) | (x, Nan) => x.clone(),
            _ => {
                if self.before(other) {
                    other.clone()
                } else {
                    self.clone()
                }
            }
        }
    }
}
