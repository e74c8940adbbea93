//! Interval arithmetic over the blend equation: every number a conforming blender of one kind may hold.
//!
//! Identities are exact in every blender, as Vulkan lists them and D3D11.3 3.1.3 has them: 1 x, 0 x (x finite), x + 0.
//! Every other operation is rounded outward to the blender's precision.

use super::Api;
use super::real::Real;
use super::span::Span;
use crate::format::{ChannelKind, ColorFormat, FloatLayout, Rounding, TargetClass, snorm, srgb, unorm};
use crate::model::{Arithmetic, Number};

/// How coarse a blender's numbers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    /// Real numbers.
    Real,
    /// Each result a float of this layout: either neighbour in Vulkan; the nearest, or anything finer, in D3D.
    Float(FloatLayout),
    /// Each result a multiple of 1 / N: either neighbour in Vulkan; within 0.6, or anything finer, in D3D.
    Codes(u32),
}

/// What becomes of results beyond the largest finite number of a [`Precision::Float`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Overflow {
    /// Carried on in a wider range, the largest number, or Inf.
    Any,
    /// The largest finite number.
    Saturate,
    /// Inf.
    Infinite,
}

/// One kind of blender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Blender {
    pub api: Api,
    pub precision: Precision,
    pub overflow: Overflow,
}

/// D3D's tolerance of a conversion, in codes.
pub(super) const D3D_TOLERANCE: (i128, i128) = (6, 10);

/// Vulkan asks for about one part in 10^5 of floating-point computation, here of the sRGB curve on the linear side, where
/// it counts 2.4 times.
pub(super) const VULKAN_CURVE: f64 = 2.4e-5;

/// Vulkan's conversion of a stored code to binary32: four units in the last place, well inside one part in 10^5.
const VULKAN_DECODE: f64 = 1.0 / 4_194_304.0;

impl Blender {
    /// Rounds a result outward.
    pub(super) fn round(&self, x: Span) -> Span {
        if x.empty {
            return x;
        }
        match self.precision {
            Precision::Real => x,
            Precision::Float(layout) => self.round_float(x, layout),
            Precision::Codes(steps) => {
                let code = |code: i128| Real::fraction(code, steps.into());
                let scale = i128::from(steps);
                let (min, max) = match self.api {
                    Api::Vulkan => (code(x.min.floor_code(scale)), code(x.max.ceil_code(scale))),
                    Api::D3d => (
                        code(x.min.least_within(scale, D3D_TOLERANCE)).least(x.min),
                        code(x.max.greatest_within(scale, D3D_TOLERANCE)).greatest(x.max),
                    ),
                };
                Span { min, max, stored: None, ..x }
            }
        }
    }

    /// Rounds a sum outward. Sums of codes are codes, and the store rounds the others.
    fn round_sum(&self, x: Span) -> Span {
        if matches!(self.precision, Precision::Codes(_)) { x } else { self.round(x) }
    }

    fn round_float(&self, x: Span, layout: FloatLayout) -> Span {
        let (low, high) = (x.min.lo, x.max.hi);
        let mut ends = match self.api {
            Api::Vulkan => (below(layout, low), above(layout, high)),
            Api::D3d => (nearest(layout, low).min(low), nearest(layout, high).max(high)),
        };
        if layout == FloatLayout::SINGLE {
            // Denormals may be flushed.
            let tiny = f64::from(f32::MIN_POSITIVE);
            ends.0 = if ends.0 > 0.0 && ends.0 < tiny { 0.0 } else { ends.0 };
            ends.1 = if ends.1 < 0.0 && ends.1 > -tiny { 0.0 } else { ends.1 };
        }
        let largest = layout.decode(layout.max_finite());
        let ends = match self.overflow {
            Overflow::Saturate => (ends.0.clamp(-largest, largest), ends.1.clamp(-largest, largest)),
            Overflow::Infinite => (to_infinity(ends.0, largest), to_infinity(ends.1, largest)),
            Overflow::Any => (
                if ends.0 < -largest { f64::NEG_INFINITY } else { ends.0 },
                if ends.1 > largest { f64::INFINITY } else { ends.1 },
            ),
        };
        if ends == (low, high) && x.min.lo == x.min.hi && x.max.lo == x.max.hi {
            return Span { stored: None, ..x };
        }
        Span { min: Real::exact(ends.0), max: Real::exact(ends.1), stored: None, ..x }
    }

    /// What a conversion of stored codes may give, once the number is computed with.
    fn loosen(&self, x: &Span) -> Span {
        let Some((kind, code)) = x.stored else {
            // Denormal operands may be flushed; rounding, which does that, leaves binary32 numbers alone otherwise.
            let single = self.precision == Precision::Float(FloatLayout::SINGLE);
            return if single { self.round(*x) } else { *x };
        };
        let loose = Span { stored: None, ..*x };
        let ends = match (self.precision, kind, self.api) {
            (Precision::Real, ..) => return loose,
            (_, ChannelKind::Srgb, Api::D3d) => {
                // Half a code on the sRGB side; 0 and 1 exact.
                if code == 0 || code == 255 {
                    return loose;
                }
                let (low, high) = (srgb::threshold(code - 1), srgb::threshold(code));
                (low.value - low.error, high.value + high.error)
            }
            (_, ChannelKind::Srgb, Api::Vulkan) => (x.min.lo * (1.0 - VULKAN_CURVE), x.max.hi * (1.0 + VULKAN_CURVE)),
            (Precision::Float(_), ChannelKind::Unorm(_) | ChannelKind::Snorm(_), Api::Vulkan) => {
                if x.is(0.0) || x.is(1.0) || x.is(-1.0) {
                    return loose;
                }
                (x.min.lo - x.min.lo.abs() * VULKAN_DECODE, x.max.hi + x.max.hi.abs() * VULKAN_DECODE)
            }
            _ => return self.round(loose),
        };
        let loose = Span { min: Real::between(ends.0, ends.0), max: Real::between(ends.1, ends.1), ..loose };
        self.round(loose)
    }
}

/// The largest float at or below x; numbers beyond the finite ones stay.
fn below(layout: FloatLayout, x: f64) -> f64 {
    -above(layout, -x)
}

/// The smallest float at or above x, likewise.
fn above(layout: FloatLayout, x: f64) -> f64 {
    let largest = layout.decode(layout.max_finite());
    if !x.is_finite() || x.abs() > largest {
        return x;
    }
    let code = layout.encode(x, Rounding::TowardZero);
    let toward_zero = layout.decode(code);
    if toward_zero < x && x > 0.0 { layout.decode(code + 1) } else { toward_zero }
}

fn nearest(layout: FloatLayout, x: f64) -> f64 {
    layout.decode(layout.encode(x, Rounding::NearestEven))
}

fn to_infinity(x: f64, largest: f64) -> f64 {
    if x.abs() > largest { f64::INFINITY.copysign(x) } else { x }
}

impl Arithmetic for Blender {
    type Value = Span;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Span {
        Span::exact(f64::from(x))
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Span {
        let span = match kind {
            ChannelKind::Absent => return self.zero(),
            ChannelKind::Unorm(bits) => Span::point(Real::fraction(code.into(), unorm::steps(bits).into())),
            ChannelKind::Snorm(bits) => {
                Span::point(Real::fraction(snorm::signed_code(code, bits).into(), snorm::steps(bits).into()))
            }
            ChannelKind::Srgb => {
                let linear = srgb::decode(code);
                match code {
                    0 | 255 => Span::exact(linear.value),
                    _ => Span::point(Real::between(linear.value - linear.error, linear.value + linear.error)),
                }
            }
            ChannelKind::Float(layout) => return Span::exact(layout.decode(code)),
        };
        Span { stored: Some((kind, code)), ..span }
    }

    fn zero(&self) -> Span {
        Span::point(Real::ZERO)
    }

    fn one(&self) -> Span {
        Span::point(Real::ONE)
    }

    fn complement(&self, x: &Span) -> Span {
        if x.is(0.0) {
            return Span { special: x.special, ..self.one() };
        }
        let (sum, _) = self.one().add(&self.loosen(x).negated());
        self.round_sum(sum)
    }

    fn clamp_factor(&self, factor: Span, class: TargetClass) -> Span {
        match (self.api, class) {
            (Api::Vulkan, TargetClass::Snorm) => self.clamp(&factor, class),
            _ => factor,
        }
    }

    fn multiply(&self, x: &Span, factor: &Span) -> Span {
        let (same, identity) = x.multiply(factor);
        if identity { same } else { self.round(self.loosen(x).multiply(&self.loosen(factor)).0) }
    }

    fn add(&self, x: &Span, y: &Span) -> Span {
        let (same, identity) = x.add(y);
        if identity { same } else { self.round_sum(self.loosen(x).add(&self.loosen(y)).0) }
    }

    fn subtract(&self, x: &Span, y: &Span) -> Span {
        if y.is(0.0) {
            return x.add(y).0;
        }
        self.add(x, &self.loosen(y).negated())
    }

    fn minimum(&self, x: &Span, y: &Span) -> Span {
        x.minimum(y)
    }

    fn maximum(&self, x: &Span, y: &Span) -> Span {
        x.maximum(y)
    }

    fn clamp(&self, x: &Span, class: TargetClass) -> Span {
        match class {
            TargetClass::Float => *x,
            TargetClass::Unorm => x.clamped(0.0, 1.0),
            TargetClass::Snorm => x.clamped(-1.0, 1.0),
        }
    }

    /// One admissible code; the sets are made by [`super::store`].
    fn encode(&self, x: &Span, kind: ChannelKind) -> u32 {
        super::store::store(x, kind, super::store::Store::Nearest).first(kind)
    }

    fn describe(&self, x: &Span) -> Number {
        if x.empty { Number::near(f64::NAN) } else { Number::near(f64::midpoint(x.min.lo, x.max.hi)) }
    }
}
