//! One real number, enclosed: two `f64` that bracket it, and its exact fraction wherever that is at hand.
//!
//! Every operation rounds outward. The fraction decides what the bracket cannot: whether a number is an integer code
//! exactly, or a tie.

use std::cmp::Ordering;

/// n / d with d > 0; not reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ratio {
    n: i128,
    d: i128,
}

impl Ratio {
    fn add(self, other: Self) -> Option<Self> {
        // The common power of two is most of what binary fractions share.
        let common = self.d.trailing_zeros().min(other.d.trailing_zeros());
        let (a, b) = (self.d >> common, other.d >> common);
        let n = self.n.checked_mul(b)?.checked_add(other.n.checked_mul(a)?)?;
        Some(Self { n, d: self.d.checked_mul(b)? }.halved())
    }

    fn multiply(self, other: Self) -> Option<Self> {
        Some(Self { n: self.n.checked_mul(other.n)?, d: self.d.checked_mul(other.d)? }.halved())
    }

    /// Common powers of two removed.
    fn halved(self) -> Self {
        let shift = if self.n == 0 { 0 } else { self.n.trailing_zeros().min(self.d.trailing_zeros()) };
        if self.n == 0 { Self { n: 0, d: 1 } } else { Self { n: self.n >> shift, d: self.d >> shift } }
    }

    /// floor(x * scale + numerator / denominator).
    fn floor_scaled(self, scale: i128, (numerator, denominator): (i128, i128)) -> Option<i128> {
        let scaled = self.n.checked_mul(scale)?.checked_mul(denominator)?;
        let sum = scaled.checked_add(numerator.checked_mul(self.d)?)?;
        Some(sum.div_euclid(self.d.checked_mul(denominator)?))
    }
}

/// A real number or an infinity, `lo <= x <= hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Real {
    pub lo: f64,
    pub hi: f64,
    ratio: Option<Ratio>,
}

impl Real {
    pub(super) const ZERO: Self = Self { lo: 0.0, hi: 0.0, ratio: Some(Ratio { n: 0, d: 1 }) };
    pub(super) const ONE: Self = Self { lo: 1.0, hi: 1.0, ratio: Some(Ratio { n: 1, d: 1 }) };

    /// An `f64` that is meant exactly; not NaN.
    pub(super) fn exact(x: f64) -> Self {
        Self { lo: x, hi: x, ratio: dyadic(x) }
    }

    /// An enclosure without a fraction.
    pub(super) fn between(lo: f64, hi: f64) -> Self {
        Self { lo, hi, ratio: None }
    }

    /// n / d, d > 0.
    pub(super) fn fraction(n: i128, d: i128) -> Self {
        let near = as_f64(n) / as_f64(d);
        let (lo, hi) = if n % d == 0 { (near, near) } else { (near.next_down(), near.next_up()) };
        Self { lo, hi, ratio: Some(Ratio { n, d }) }
    }

    /// Whether this is the number x and nothing else.
    pub(super) fn is(&self, x: f64) -> bool {
        match (self.ratio, x == 0.0 || x == 1.0) {
            (Some(ratio), true) => (x == 0.0 && ratio.n == 0) || (x == 1.0 && ratio.n == ratio.d),
            _ => self.lo == x && self.hi == x,
        }
    }

    /// Whether the number is certainly the other or less.
    pub(super) fn at_most(&self, other: &Self) -> bool {
        let products = self.ratio.zip(other.ratio).and_then(|(a, b)| a.n.checked_mul(b.d).zip(b.n.checked_mul(a.d)));
        products.map_or(self.hi <= other.lo, |(a, b)| a <= b)
    }

    pub(super) fn negated(&self) -> Self {
        let ratio = self.ratio.map(|r| Ratio { n: -r.n, d: r.d });
        Self { lo: -self.hi, hi: -self.lo, ratio }
    }

    /// The sum; `None` for Inf - Inf.
    pub(super) fn add(&self, other: &Self) -> Option<Self> {
        let (lo, hi) = (add_outward(self.lo, other.lo, false), add_outward(self.hi, other.hi, true));
        if lo.is_nan() || hi.is_nan() {
            return None;
        }
        let ratio = self.ratio.zip(other.ratio).and_then(|(a, b)| a.add(b));
        Some(Self { lo, hi, ratio })
    }

    /// The product; `None` for 0 * Inf.
    pub(super) fn multiply(&self, other: &Self) -> Option<Self> {
        let infinite = self.lo.is_infinite() || other.lo.is_infinite();
        if infinite && (self.is(0.0) || other.is(0.0)) {
            return None;
        }
        let corners = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)];
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for (a, b) in corners {
            let near = a * b;
            let exact = infinite || (is_single(a) && is_single(b)) || a.abs() == 1.0 || b.abs() == 1.0;
            let exact = exact || a == 0.0 || b == 0.0;
            lo = lo.min(if exact { near } else { near.next_down() });
            hi = hi.max(if exact { near } else { near.next_up() });
        }
        let ratio = self.ratio.zip(other.ratio).and_then(|(a, b)| a.multiply(b));
        Some(Self { lo, hi, ratio })
    }

    /// The smaller one.
    pub(super) fn least(self, other: Self) -> Self {
        self.choose(other, Ordering::Less)
    }

    /// The larger one.
    pub(super) fn greatest(self, other: Self) -> Self {
        self.choose(other, Ordering::Greater)
    }

    fn choose(self, other: Self, wanted: Ordering) -> Self {
        let (a, b) = (self, other);
        if a.at_most(&b) {
            return if wanted == Ordering::Less { a } else { b };
        }
        if b.at_most(&a) {
            return if wanted == Ordering::Less { b } else { a };
        }
        match wanted {
            Ordering::Less => Self::between(a.lo.min(b.lo), a.hi.min(b.hi)),
            _ => Self::between(a.lo.max(b.lo), a.hi.max(b.hi)),
        }
    }

    /// floor(x * scale + offset), or an integer below where the bracket is in doubt; `up` errs above instead.
    fn floor(&self, scale: i128, offset: (i128, i128), up: bool) -> i128 {
        if let Some(floor) = self.ratio.and_then(|ratio| ratio.floor_scaled(scale, offset)) {
            return floor;
        }
        let x = if up { self.hi } else { self.lo };
        let scaled = x * as_f64(scale);
        let moved = scaled + as_f64(offset.0) / as_f64(offset.1);
        // Three roundings of numbers not much larger than these.
        let slack = (scaled.abs() + moved.abs() + 1.0) * f64::EPSILON * 2.0;
        as_integer((if up { moved + slack } else { moved - slack }).floor())
    }

    /// The least integer c with x * scale <= c + tolerance (a fraction), or less where in doubt.
    pub(super) fn least_within(&self, scale: i128, (n, d): (i128, i128)) -> i128 {
        // ceil(y - t) = -floor(t - y).
        -self.negated().floor(scale, (n, d), true)
    }

    /// The greatest integer c with c - tolerance <= x * scale, or more where in doubt.
    pub(super) fn greatest_within(&self, scale: i128, tolerance: (i128, i128)) -> i128 {
        self.floor(scale, tolerance, true)
    }

    /// floor(x * scale), or less where in doubt.
    pub(super) fn floor_code(&self, scale: i128) -> i128 {
        self.floor(scale, (0, 1), false)
    }

    /// ceil(x * scale), or more where in doubt.
    pub(super) fn ceil_code(&self, scale: i128) -> i128 {
        -self.negated().floor(scale, (0, 1), false)
    }
}

/// x + y, rounded up or down only where it is inexact (Knuth's two-sum finds the error).
fn add_outward(x: f64, y: f64, up: bool) -> f64 {
    let near = x + y;
    if !near.is_finite() {
        return near;
    }
    let y_part = near - x;
    let error = (x - (near - y_part)) + (y - y_part);
    if error > 0.0 && up {
        near.next_up()
    } else if error < 0.0 && !up {
        near.next_down()
    } else {
        near
    }
}

/// Whether x is a binary32 number: products of two such are exact.
fn is_single(x: f64) -> bool {
    #[expect(clippy::cast_possible_truncation, reason = "the question is whether anything is lost")]
    let narrow = x as f32;
    f64::from(narrow) == x
}

/// The fraction of an `f64` with at most 60 binary places and below 2^60.
fn dyadic(x: f64) -> Option<Ratio> {
    if !x.is_finite() {
        return None;
    }
    let (negative, magnitude, exponent) = crate::format::rounding::decompose(x);
    if magnitude == 0 {
        return Some(Ratio { n: 0, d: 1 });
    }
    let zeros = magnitude.trailing_zeros();
    let (magnitude, exponent) = (magnitude >> zeros, exponent + zeros.cast_signed());
    if !(-60..=8).contains(&exponent) {
        return None;
    }
    let magnitude = i128::try_from(magnitude).ok()?;
    let n = if exponent > 0 { magnitude << exponent } else { magnitude };
    Some(Ratio { n: if negative { -n } else { n }, d: 1 << (-exponent).max(0) })
}

fn as_f64(x: i128) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "code scales, and codes below 2^53")]
    let near = x as f64;
    near
}

/// An integer-valued `f64`; infinities saturate.
fn as_integer(x: f64) -> i128 {
    #[expect(clippy::cast_possible_truncation, reason = "an integer, or saturated")]
    let integer = x as i128;
    integer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_decide_integers_that_brackets_cannot() {
        let product = Real::fraction(51, 255).multiply(&Real::fraction(5, 255)).expect("finite");
        assert!(product.lo < product.hi, "1/255 is not binary");
        assert_eq!((product.floor_code(255), product.ceil_code(255)), (1, 1), "exactly one code");
        let bracket = Real::between(product.lo, product.hi);
        assert_eq!((bracket.floor_code(255), bracket.ceil_code(255)), (0, 2), "outward without the fraction");
    }

    #[test]
    fn tolerances_are_closed() {
        let y = Real::fraction(634, 2550);
        assert_eq!((y.least_within(255, (6, 10)), y.greatest_within(255, (6, 10))), (63, 64), "63.4 +- 0.6");
        let y = Real::fraction(633, 2550);
        assert_eq!((y.least_within(255, (6, 10)), y.greatest_within(255, (6, 10))), (63, 63), "63.3 +- 0.6");
    }

    #[test]
    fn sums_round_outward_only_where_inexact() {
        let sum = Real::exact(1.0).add(&Real::exact(2.0_f64.powi(-60))).expect("finite");
        assert_eq!((sum.lo, sum.hi), (1.0, 1.0_f64.next_up()), "between 1 and its neighbour");
        let sum = Real::exact(0.5).add(&Real::exact(0.25)).expect("finite");
        assert_eq!((sum.lo, sum.hi), (0.75, 0.75), "exact");
        assert_eq!(Real::exact(f64::INFINITY).add(&Real::exact(f64::NEG_INFINITY)), None, "not a number");
    }
}
