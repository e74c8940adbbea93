//! From the numbers a blender may hold to the codes it may store.

use std::sync::LazyLock;

use super::blender::{D3D_TOLERANCE, VULKAN_CURVE};
use super::span::Span;
use crate::format::srgb::{self, Approximation};
use crate::format::{ChannelKind, FloatLayout, Rounding, snorm, unorm};

/// The codes a channel may hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CodeSet {
    /// Closed ranges of keys: codes of unsigned channels, signed codes, floats in the order of their values.
    ranges: Vec<(i64, i64)>,
    nan: bool,
    anything: bool,
}

/// Which codes a conversion may choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Store {
    /// The nearest, both at a tie.
    Nearest,
    /// Either neighbour (Vulkan, *Fixed-Point Data Conversions*, *Floating-Point Format Conversions*).
    Neighbours,
    /// As [`Neighbours`](Self::Neighbours) for sRGB with the curve's tolerance.
    VulkanCurve,
    /// Within 0.6 codes (D3D11.3 3.2.3); floats toward zero (3.2.2).
    D3d,
    /// As [`D3d`](Self::D3d), and floats to the nearest as well, as a blender in half precision stores (3.1.5).
    D3dBlended,
    /// The nearest code; floats as [`D3d`](Self::D3d).
    D3dNearest,
    /// The nearest code; floats as [`D3dBlended`](Self::D3dBlended).
    D3dBlendedNearest,
}

impl CodeSet {
    /// Nothing is excluded.
    pub(super) fn anything() -> Self {
        Self { anything: true, ..Self::default() }
    }

    /// This code and no other; NaN is any NaN.
    pub(super) fn only(kind: ChannelKind, code: u32) -> Self {
        match kind {
            ChannelKind::Float(layout) if layout.is_nan(code) => Self { nan: true, ..Self::default() },
            _ => Self { ranges: vec![(key(kind, code), key(kind, code))], ..Self::default() },
        }
    }

    /// Whether any code conforms.
    #[must_use]
    pub fn is_undefined(&self) -> bool {
        self.anything
    }

    /// Whether a code of this kind is in the set. Any NaN is any other.
    #[must_use]
    pub fn contains(&self, kind: ChannelKind, code: u32) -> bool {
        match kind {
            _ if self.anything => true,
            ChannelKind::Absent => true,
            ChannelKind::Float(layout) if layout.is_nan(code) => self.nan,
            _ => self.ranges.iter().any(|(low, high)| (*low..=*high).contains(&key(kind, code))),
        }
    }

    /// How many codes there are; all NaNs count as one. `None` where any code conforms.
    #[must_use]
    pub fn len(&self) -> Option<u64> {
        let numbers: u64 = self.ranges.iter().map(|(low, high)| high.abs_diff(*low) + 1).sum();
        (!self.anything).then_some(numbers + u64::from(self.nan))
    }

    /// Whether no code conforms; never, for sets of a channel that exists.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == Some(0)
    }

    /// The codes, ascending by value, at most `limit`; NaN last.
    #[must_use]
    pub fn codes(&self, kind: ChannelKind, limit: usize) -> Vec<u32> {
        let numbers = self.ranges.iter().flat_map(|(low, high)| *low..=*high).map(|key| code(kind, key));
        let nan = match kind {
            ChannelKind::Float(layout) if self.nan => Some(layout.nan()),
            _ => None,
        };
        numbers.chain(nan).take(limit).collect()
    }

    pub(super) fn first(&self, kind: ChannelKind) -> u32 {
        self.codes(kind, 1).first().copied().unwrap_or(0)
    }

    pub(super) fn unite(&mut self, other: Self) {
        self.nan |= other.nan;
        self.anything |= other.anything;
        self.ranges.extend(other.ranges);
        self.ranges.sort_unstable();
        let mut merged: Vec<(i64, i64)> = Vec::with_capacity(self.ranges.len());
        for (low, high) in self.ranges.drain(..) {
            match merged.last_mut() {
                Some(last) if low <= last.1 + 1 => last.1 = last.1.max(high),
                _ => merged.push((low, high)),
            }
        }
        self.ranges = merged;
    }

    /// Either zero, where one is in the set: Vulkan does not name the sign, and D3D's rules for it contradict each other.
    pub(super) fn with_both_zeros(mut self, kind: ChannelKind) -> Self {
        if matches!(kind, ChannelKind::Float(layout) if layout.signed) {
            for range in &mut self.ranges {
                if range.1 == -1 {
                    range.1 = 0;
                }
                if range.0 == 0 {
                    range.0 = -1;
                }
            }
        }
        self
    }
}

/// A code's place in the order of values.
fn key(kind: ChannelKind, code: u32) -> i64 {
    match kind {
        ChannelKind::Absent | ChannelKind::Unorm(_) | ChannelKind::Srgb => i64::from(code),
        ChannelKind::Snorm(bits) => i64::from(code.wrapping_shl(32 - bits).cast_signed() >> (32 - bits)),
        ChannelKind::Float(layout) => {
            let magnitude = i64::from(code & !layout.sign());
            // -0 comes just below +0.
            if code & layout.sign() == 0 { magnitude } else { -1 - magnitude }
        }
    }
}

fn code(kind: ChannelKind, key: i64) -> u32 {
    let low = |key: i64| u32::try_from(key & 0xffff_ffff).unwrap_or(0);
    match kind {
        ChannelKind::Absent | ChannelKind::Unorm(_) | ChannelKind::Srgb => low(key),
        ChannelKind::Snorm(bits) => low(key) & unorm::steps(bits),
        ChannelKind::Float(layout) => {
            if key < 0 {
                low(-1 - key) | layout.sign()
            } else {
                low(key)
            }
        }
    }
}

/// The codes a clamped result may be stored as.
pub(super) fn store(x: &Span, kind: ChannelKind, rule: Store) -> CodeSet {
    if x.empty {
        return CodeSet { nan: x.nan, ..CodeSet::default() };
    }
    let range = match (kind, x.stored) {
        (ChannelKind::Absent, _) => (0, 0),
        (ChannelKind::Srgb, Some((ChannelKind::Srgb, code))) => (code.into(), code.into()),
        (ChannelKind::Unorm(bits), _) => {
            let range = linear(x, unorm::steps(bits).into(), rule);
            (range.0.max(0), range.1.min(unorm::steps(bits).into()))
        }
        (ChannelKind::Snorm(bits), _) => {
            let steps = i64::from(snorm::steps(bits));
            let range = linear(x, steps.into(), rule);
            (range.0.max(-steps), range.1.min(steps))
        }
        (ChannelKind::Srgb, _) => curve(x, rule),
        (ChannelKind::Float(layout), _) => {
            (float(x.min.lo, layout, rule, Side::Low), float(x.max.hi, layout, rule, Side::High))
        }
    };
    CodeSet { ranges: vec![range], nan: x.nan, anything: false }
}

/// Codes of a linear channel with N steps.
fn linear(x: &Span, steps: i128, rule: Store) -> (i64, i64) {
    let narrow = |code: i128| i64::try_from(code).unwrap_or(if code < 0 { i64::MIN } else { i64::MAX });
    let within = |tolerance| (x.min.least_within(steps, tolerance), x.max.greatest_within(steps, tolerance));
    let (low, high) = match rule {
        Store::Neighbours | Store::VulkanCurve => (x.min.floor_code(steps), x.max.ceil_code(steps)),
        Store::Nearest | Store::D3dNearest | Store::D3dBlendedNearest => within((1, 2)),
        // Channels under 8 bits may be rounded to 8 first (17.5).
        Store::D3d | Store::D3dBlended if steps < 127 => within((6 * 255 + 6 * steps, 2550)),
        Store::D3d | Store::D3dBlended => within(D3D_TOLERANCE),
    };
    (narrow(low), narrow(high))
}

/// Linear values of the codes plus 0.6, of the codes, and of the codes plus a half; the last beyond 1.
static ABOVE: LazyLock<Vec<Approximation>> = LazyLock::new(|| points(6));
static AT: LazyLock<Vec<Approximation>> = LazyLock::new(|| points(0));
static HALF: LazyLock<Vec<Approximation>> = LazyLock::new(|| points(5));
/// Of the codes from 1 less 0.6.
static BELOW: LazyLock<Vec<Approximation>> = LazyLock::new(|| points(4));

/// The linear values of 10 c + `tenths` tenths of a code.
fn points(tenths: u32) -> Vec<Approximation> {
    let beyond = Approximation { value: f64::INFINITY, error: 0.0 };
    let point = |n: u32| if n > 2550 { beyond } else { srgb::approximate(n, 2550) };
    (0..=255).map(|code| point(10 * code + tenths)).collect()
}

/// Codes of an sRGB channel.
fn curve(x: &Span, rule: Store) -> (i64, i64) {
    let slack = if rule == Store::VulkanCurve { VULKAN_CURVE } else { 0.0 };
    let (low, high) = (x.min.lo * (1.0 - slack), x.max.hi * (1.0 + slack));
    // The number of points certainly below, and of those possibly at or below.
    let under = |table: &[Approximation], y: f64| table.partition_point(|point| point.value + point.error < y);
    let reached = |table: &[Approximation], y: f64| table.partition_point(|point| point.value - point.error <= y);
    let (first, last) = match rule {
        // floor(y) is the last code at or below y, ceil(y) the first at or above; both exact at 0 and 1.
        Store::Neighbours | Store::VulkanCurve => {
            let floor = AT.partition_point(|point| point.value + point.error <= low).saturating_sub(1);
            (floor, AT.partition_point(|point| point.value - point.error < high))
        }
        Store::Nearest | Store::D3dNearest | Store::D3dBlendedNearest => (under(&HALF, low), reached(&HALF, high)),
        // c + 0.6 >= y, and c - 0.6 = (c - 1) + 0.4 <= y.
        Store::D3d | Store::D3dBlended => (under(&ABOVE, low), reached(&BELOW, high)),
    };
    let narrow = |code: usize| i64::try_from(code).unwrap_or(255).min(255);
    (narrow(first), narrow(last))
}

/// An end of a range.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Low,
    High,
}

/// The key of the lowest or highest code that may store x.
fn float(x: f64, layout: FloatLayout, rule: Store, side: Side) -> i64 {
    let kind = ChannelKind::Float(layout);
    let at = |x: f64, rounding| key(kind, layout.encode(x, rounding));
    if x.is_infinite() || (x < 0.0 && !layout.signed) {
        return at(x, Rounding::NearestEven);
    }
    let toward_zero = at(x, Rounding::TowardZero);
    let exact = layout.decode(code(kind, toward_zero)) == x;
    let away = if exact { toward_zero } else { toward_zero + if x < 0.0 { -1 } else { 1 } };
    let pick = |a: i64, b: i64| if side == Side::Low { a.min(b) } else { a.max(b) };
    match rule {
        Store::Neighbours | Store::VulkanCurve => pick(toward_zero, away),
        Store::Nearest => pick(at(x, Rounding::NearestEven), at(x, Rounding::NearestAway)),
        Store::D3d | Store::D3dNearest => toward_zero,
        Store::D3dBlended | Store::D3dBlendedNearest => {
            // Small floats blend as halves (19.3.4) and are cut afterwards; a finite number never becomes Inf.
            let half = FloatLayout::HALF.encode(x, Rounding::NearestEven);
            let half = half.min(FloatLayout::HALF.max_finite() | half & 0x8000);
            let through_half = match layout.mantissa_bits {
                10.. => at(x, Rounding::NearestEven),
                _ => at(FloatLayout::HALF.decode(half), Rounding::TowardZero),
            };
            let largest = i64::from(layout.max_finite());
            pick(toward_zero, through_half.clamp(-1 - largest, largest))
        }
    }
}
