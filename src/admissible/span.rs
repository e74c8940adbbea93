//! A set of numbers a blender may hold: everything between two reals, and NaN where it may occur.

use super::real::Real;
use crate::format::ChannelKind;

/// Everything from `min` to `max`; nothing but NaN when `empty`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub min: Real,
    pub max: Real,
    /// No number at all.
    pub empty: bool,
    /// NaN is among the values.
    pub nan: bool,
    /// A NaN or an infinity went into it, which Vulkan need not support.
    pub special: bool,
    /// It is the value of this stored code, untouched.
    pub stored: Option<(ChannelKind, u32)>,
}

impl Span {
    pub(super) fn point(x: Real) -> Self {
        Self::between(x, x)
    }

    pub(super) fn between(min: Real, max: Real) -> Self {
        Self { min, max, empty: false, nan: false, special: false, stored: None }
    }

    /// An `f64` as it is, NaN included.
    pub(super) fn exact(x: f64) -> Self {
        let special = !x.is_finite();
        if x.is_nan() {
            return Self { empty: true, nan: true, special, ..Self::point(Real::ZERO) };
        }
        Self { special, ..Self::point(Real::exact(x)) }
    }

    /// Whether it is the number x and nothing else.
    pub(super) fn is(&self, x: f64) -> bool {
        !self.empty && !self.nan && self.min.is(x) && self.max.is(x)
    }

    fn is_finite(&self) -> bool {
        !self.empty && !self.nan && self.min.lo.is_finite() && self.max.hi.is_finite()
    }

    fn tainted(self, other: &Self) -> Self {
        Self { special: self.special || other.special, ..self }
    }

    /// NaN alone, or with the numbers of the given span.
    fn collect(self, other: &Self, candidates: impl IntoIterator<Item = Option<Real>>) -> Self {
        let mut out = Self { empty: true, nan: self.nan || other.nan, special: self.special || other.special, ..self };
        out.stored = None;
        if self.empty || other.empty {
            out.nan = true;
            return out;
        }
        for candidate in candidates {
            match candidate {
                None => out.nan = true,
                Some(x) if out.empty => (out.min, out.max, out.empty) = (x, x, false),
                Some(x) => (out.min, out.max) = (out.min.least(x), out.max.greatest(x)),
            }
        }
        out
    }

    pub(super) fn negated(&self) -> Self {
        Self { min: self.max.negated(), max: self.min.negated(), stored: None, ..*self }
    }

    /// x + y and whether it is one of the operands unchanged.
    pub(super) fn add(&self, other: &Self) -> (Self, bool) {
        if self.is(0.0) {
            return (other.tainted(self), true);
        }
        if other.is(0.0) {
            return (self.tainted(other), true);
        }
        let mut sum = self.collect(other, [self.min.add(&other.min), self.max.add(&other.max)]);
        // Infinities of either sign meet.
        let (low, high) = (|x: &Self| x.min.lo == f64::NEG_INFINITY, |x: &Self| x.max.hi == f64::INFINITY);
        sum.nan |= (low(self) && high(other)) || (high(self) && low(other));
        (sum, false)
    }

    /// x * y and whether it is one of the operands unchanged.
    pub(super) fn multiply(&self, other: &Self) -> (Self, bool) {
        for (a, b) in [(self, other), (other, self)] {
            if a.is(1.0) || (a.is(0.0) && b.is_finite()) {
                let product = if a.is(1.0) { b } else { a };
                return (product.tainted(self).tainted(other), true);
            }
        }
        let corner = |a: &Real, b: &Real| a.multiply(b);
        let corners = [
            corner(&self.min, &other.min),
            corner(&self.min, &other.max),
            corner(&self.max, &other.min),
            corner(&self.max, &other.max),
        ];
        let mut product = self.collect(other, corners);
        // An infinity meets the zero inside the other span.
        product.nan |= (self.has_infinity() && other.has_zero()) || (other.has_infinity() && self.has_zero());
        (product, false)
    }

    fn has_infinity(&self) -> bool {
        self.min.lo == f64::NEG_INFINITY || self.max.hi == f64::INFINITY
    }

    pub(super) fn has_zero(&self) -> bool {
        !self.empty && self.min.lo <= 0.0 && self.max.hi >= 0.0
    }

    /// The smaller; the number where the other is NaN, or NaN. Operands that cannot overlap come out untouched.
    pub(super) fn minimum(&self, other: &Self) -> Self {
        self.select(other, Real::least, |a, b| a.max.at_most(&b.min))
    }

    /// The larger, likewise.
    pub(super) fn maximum(&self, other: &Self) -> Self {
        self.select(other, Real::greatest, |a, b| b.max.at_most(&a.min))
    }

    fn select(&self, other: &Self, pick: fn(Real, Real) -> Real, first: fn(&Self, &Self) -> bool) -> Self {
        let nan = self.nan || other.nan;
        let special = self.special || other.special;
        if self.empty || other.empty {
            return Self { nan, special, ..if self.empty { *other } else { *self } };
        }
        if !nan && first(self, other) {
            return Self { special, ..*self };
        }
        if !nan && first(other, self) {
            return Self { special, ..*other };
        }
        let picked = Self::between(pick(self.min, other.min), pick(self.max, other.max));
        // Where one may be NaN, the other may come out whole.
        let whole = |nan: bool, span: &Self, picked: Self| if nan { picked.hull(span) } else { picked };
        let picked = whole(other.nan, self, whole(self.nan, other, picked));
        Self { nan, special, ..picked }
    }

    /// The smallest span that holds both.
    pub(super) fn hull(self, other: &Self) -> Self {
        let (nan, special) = (self.nan || other.nan, self.special || other.special);
        if self.empty || other.empty {
            return Self { nan, special, ..if self.empty { *other } else { self } };
        }
        Self { nan, special, ..Self::between(self.min.least(other.min), self.max.greatest(other.max)) }
    }

    /// Kept between two numbers; an end that is already there stays as it is.
    pub(super) fn clamped(&self, low: f64, high: f64) -> Self {
        if self.empty || (self.min.lo >= low && self.max.hi <= high) {
            return *self;
        }
        let clamp = |x: Real| x.greatest(Real::exact(low)).least(Real::exact(high));
        Self { min: clamp(self.min), max: clamp(self.max), stored: None, ..*self }
    }
}
