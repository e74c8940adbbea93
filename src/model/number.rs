//! Numbers for people: a decimal always, an exact fraction wherever there is one.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// A number as people read it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Number {
    /// Nearest binary64 value.
    pub decimal: f64,
    /// Exact form: `127/510`, `255/255` where the denominator is a code's, `8355711/2^24` for binary floating point;
    /// empty for irrational and non-finite numbers.
    pub exact: String,
    #[cfg_attr(feature = "json", serde(skip))]
    rational: Option<BigRational>,
}

impl Number {
    /// A number that is this `f64` exactly, or is not finite.
    #[must_use]
    pub fn binary(x: f64) -> Self {
        let rational = BigRational::from_float(x);
        let exact = rational.as_ref().map_or(String::new(), |r| text(r, x == 0.0 && x.is_sign_negative()));
        Self { decimal: x, exact, rational }
    }

    /// A rational number.
    #[must_use]
    pub fn rational(x: BigRational) -> Self {
        Self { decimal: x.to_f64().unwrap_or(f64::NAN), exact: text(&x, false), rational: Some(x) }
    }

    /// `numerator / denominator`, written as it is: 255/255 stays 255/255.
    ///
    /// # Panics
    /// When `denominator` is 0.
    #[must_use]
    pub fn ratio(numerator: impl Into<BigInt>, denominator: impl Into<BigInt>) -> Self {
        let (numerator, denominator) = (numerator.into(), denominator.into());
        let exact = if denominator.is_one() { numerator.to_string() } else { format!("{numerator}/{denominator}") };
        let rational = BigRational::new(numerator, denominator);
        Self { decimal: rational.to_f64().unwrap_or(f64::NAN), exact, rational: Some(rational) }
    }

    /// A number known only near this `f64`: irrational.
    #[must_use]
    pub fn near(x: f64) -> Self {
        Self { decimal: x, exact: String::new(), rational: None }
    }

    /// The exact value, where it is rational.
    #[must_use]
    pub fn fraction(&self) -> Option<&BigRational> {
        self.rational.as_ref()
    }
}

/// A decimal of up to twelve significant digits, without trailing zeros.
#[must_use]
pub fn decimal(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    if (1e-5..1e12).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Whole numbers plain, long powers of two in the denominator as powers.
fn text(x: &BigRational, negative_zero: bool) -> String {
    if x.is_zero() {
        return if negative_zero { "-0" } else { "0" }.to_owned();
    }
    let bits = x.denom().bits() - 1;
    if bits > 10 && x.denom().magnitude().count_ones() == 1 {
        return format!("{}/2^{bits}", x.numer());
    }
    x.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_forms_can_be_checked_by_hand() {
        assert_eq!(Number::binary(0.5).exact, "1/2", "small denominators in full");
        assert_eq!(Number::binary(f64::from(127.0_f32 / 255.0)).exact, "16711423/2^25", "long ones as powers");
        assert_eq!(Number::binary(-0.0).exact, "-0", "the sign of zero shows");
        assert_eq!(Number::ratio(255, 255).exact, "255/255", "codes stay codes");
        assert_eq!(Number::ratio(510, 1).exact, "510", "whole");
        assert_eq!(Number::binary(f64::INFINITY).exact, "", "not finite");
    }
}
