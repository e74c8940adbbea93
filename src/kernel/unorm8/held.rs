//! Ties of `exact` on 8-bit unorm targets: the equation in fractions whose numerators binary64 holds.
//!
//! A sum lies in the middle between two codes only if it has few bits, and then every step of it usually has. Codes are
//! numerators over 255, so no quotient is taken. An operation that would round gives nothing, and the texel is in doubt.

use std::cell::Cell;

use crate::format::{ChannelKind, ColorFormat, TargetClass};
use crate::model::{Arithmetic, Number};

/// `numerator / 255^power`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fraction {
    numerator: f64,
    power: u32,
}

impl Fraction {
    /// The same number over a power of 255 that is not smaller.
    fn over(self, power: u32) -> Option<Self> {
        let raised = f64::from(255_u32.pow(power - self.power));
        Some(Self { numerator: product(self.numerator, raised)?, power })
    }
}

/// Arithmetic without rounding, as long as that lasts.
#[derive(Debug, Default)]
pub(super) struct Held {
    in_doubt: Cell<bool>,
}

impl Held {
    /// Whether some code could not be told.
    pub(super) fn in_doubt(&self) -> bool {
        self.in_doubt.get()
    }
}

fn whole(numerator: f64) -> Option<Fraction> {
    Some(Fraction { numerator, power: 0 })
}

/// Both over the same power of 255.
fn alike(x: Option<Fraction>, y: Option<Fraction>) -> Option<(Fraction, Fraction)> {
    let (x, y) = (x?, y?);
    let power = x.power.max(y.power);
    Some((x.over(power)?, y.over(power)?))
}

impl Arithmetic for Held {
    /// `None` where binary64 does not hold the number.
    type Value = Option<Fraction>;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Self::Value {
        whole(f64::from(x))
    }

    fn decode(&self, code: u32, _kind: ChannelKind) -> Self::Value {
        // 0 and 1 are no fractions, so that products with them stay short.
        if code.is_multiple_of(255) {
            return whole(f64::from(code / 255));
        }
        Some(Fraction { numerator: f64::from(code), power: 1 })
    }

    fn zero(&self) -> Self::Value {
        whole(0.0)
    }

    fn one(&self) -> Self::Value {
        whole(1.0)
    }

    fn complement(&self, x: &Self::Value) -> Self::Value {
        self.subtract(&self.one(), x)
    }

    fn multiply(&self, x: &Self::Value, factor: &Self::Value) -> Self::Value {
        let (x, factor) = ((*x)?, (*factor)?);
        Some(Fraction { numerator: product(x.numerator, factor.numerator)?, power: x.power + factor.power })
    }

    fn add(&self, x: &Self::Value, y: &Self::Value) -> Self::Value {
        let (x, y) = alike(*x, *y)?;
        Some(Fraction { numerator: sum(x.numerator, y.numerator)?, power: x.power })
    }

    fn subtract(&self, x: &Self::Value, y: &Self::Value) -> Self::Value {
        let negative = y.map(|y| Fraction { numerator: -y.numerator, ..y });
        self.add(x, &negative)
    }

    fn minimum(&self, x: &Self::Value, y: &Self::Value) -> Self::Value {
        let (x, y) = alike(*x, *y)?;
        Some(if y.numerator < x.numerator { y } else { x })
    }

    fn maximum(&self, x: &Self::Value, y: &Self::Value) -> Self::Value {
        let (x, y) = alike(*x, *y)?;
        Some(if y.numerator > x.numerator { y } else { x })
    }

    fn clamp(&self, x: &Self::Value, _class: TargetClass) -> Self::Value {
        self.minimum(&self.maximum(x, &self.zero()), &self.one())
    }

    fn encode(&self, x: &Self::Value, _kind: ChannelKind) -> u32 {
        // 255 x is a numerator only over 255 or less; beyond, there would be a quotient to round.
        let codes = match x {
            Some(Fraction { numerator, power: 0 }) => product(*numerator, 255.0),
            Some(Fraction { numerator, power: 1 }) => Some(*numerator),
            _ => None,
        };
        self.in_doubt.set(self.in_doubt.get() || codes.is_none());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
        let code = codes.unwrap_or_default().round_ties_even() as u32;
        code
    }

    fn describe(&self, x: &Self::Value) -> Number {
        Number::near(x.map_or(f64::NAN, |x| x.numerator / f64::from(255_u32.pow(x.power))))
    }
}

/// `x y`, where that has 53 bits or fewer; both are 0 or at least 2^-298.
fn product(x: f64, y: f64) -> Option<f64> {
    let bits = |x: f64| if x == 0.0 { 0 } else { 53 - (x.to_bits() | 1 << 52).trailing_zeros().min(52) };
    (bits(x) + bits(y) <= 53).then_some(x * y)
}

/// `x + y`, where that is a number: its rounding error is 0 (Knuth's two-sum).
fn sum(x: f64, y: f64) -> Option<f64> {
    let sum = x + y;
    let part = sum - x;
    ((x - (sum - part)) + (y - part) == 0.0).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_sums_that_binary64_does_not_hold_are_told() {
        let odd = |bits: i32| 1.0 + (f64::from(bits) - 1.0).exp2();
        assert_eq!(product(odd(26), odd(27)), Some(odd(26) * odd(27)), "53 bits");
        assert_eq!(product(odd(27), odd(28)), None, "54 bits");
        assert_eq!(product(255.0, 0.5), Some(127.5), "few bits");
        assert_eq!(product(0.0, odd(53)), Some(0.0), "zero has none");
        assert_eq!(sum(1.0, -f64::from(f32::MIN_POSITIVE)), None, "bits too far apart");
        assert_eq!(sum(127.25, 0.25), Some(127.5));
    }
}
