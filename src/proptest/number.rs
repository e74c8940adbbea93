//! Numbers that a shader may put out, weighted towards the ones that matter to a channel.

use ::proptest::prelude::*;
use ::proptest::sample::select;

use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, ColorFormat, FloatLayout, snorm, unorm};

/// Numbers whose products and sums are exact and therefore meet ties: fractions of 256 in `[0, 1]`.
pub fn dyadic() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![select(vec![0.0, 1.0, 0.5, 0.25, 0.75]), (0..=256_u16).prop_map(|n| f32::from(n) / 256.0)]
}

/// Numbers no equation is written for: NaN, infinities, -0, denormals, the ends of binary16 and binary32.
pub fn special() -> impl Strategy<Value = f32> + Clone {
    let max_half = FloatLayout::HALF.decode(FloatLayout::HALF.max_finite());
    select(vec![
        -0.0,
        f32::NAN,
        -f32::NAN,
        f32::from_bits(0x7f80_0001),
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::from_bits(1),
        -f32::from_bits(1),
        f32::MIN_POSITIVE.next_down(),
        f32::MIN_POSITIVE,
        f32::MAX,
        f32::MIN,
        narrow(max_half),
        -narrow(max_half),
        // Half-way to the binary16 number that would follow the largest.
        65520.0,
        65520.0_f32.next_down(),
        65536.0,
        // The smallest binary16 denormal, half of it, and the end of its denormals.
        2.0_f32.powi(-24),
        2.0_f32.powi(-25),
        2.0_f32.powi(-14),
        2.0_f32.powi(-14).next_down(),
    ])
}

/// Every bit pattern, NaNs and denormals in proportion.
pub fn any_bits() -> impl Strategy<Value = f32> + Clone {
    any::<u32>().prop_map(f32::from_bits)
}

/// A shader output for a channel: dyadic fractions, the channel's codes and ties give or take an ulp, ordinary and
/// out-of-range numbers, and now and then anything.
///
/// A missing channel's output only feeds factors; it is drawn as for an 8-bit one.
pub fn output(kind: ChannelKind) -> BoxedStrategy<f32> {
    let plain = prop_oneof![
        4 => dyadic(),
        4 => 0.0_f32..=1.0,
        1 => -1.0_f32..=3.0,
        1 => special(),
        1 => any_bits(),
    ];
    match kind {
        ChannelKind::Absent | ChannelKind::Srgb => prop_oneof![1 => plain, 1 => near_codes(-1, 255)].boxed(),
        ChannelKind::Unorm(bits) => prop_oneof![1 => plain, 1 => near_codes(0, unorm::steps(bits))].boxed(),
        ChannelKind::Snorm(bits) => {
            let steps = snorm::steps(bits);
            prop_oneof![2 => plain, 1 => near_codes(-steps, steps.unsigned_abs()), 1 => -1.0_f32..=1.0].boxed()
        }
        ChannelKind::Float(layout) => prop_oneof![2 => plain, 1 => near_float_codes(layout), 1 => magnitudes()].boxed(),
    }
}

/// [`output`] without NaN and infinities.
pub fn finite_output(kind: ChannelKind) -> BoxedStrategy<f32> {
    output(kind).prop_filter("a finite number", |x| x.is_finite()).boxed()
}

/// An RGBA shader output for a format.
pub fn color(format: ColorFormat) -> BoxedStrategy<[f32; 4]> {
    let [r, g, b, a] = format.channels().map(output);
    (r, g, b, a).prop_map(|(r, g, b, a)| [r, g, b, a]).boxed()
}

/// [`color`] without NaN and infinities.
pub fn finite_color(format: ColorFormat) -> BoxedStrategy<[f32; 4]> {
    let [r, g, b, a] = format.channels().map(finite_output);
    (r, g, b, a).prop_map(|(r, g, b, a)| [r, g, b, a]).boxed()
}

/// An RGBA color in `[0, 1]`: what well-behaved shaders put out.
pub fn unit_color() -> impl Strategy<Value = [f32; 4]> + Clone {
    let unit = prop_oneof![dyadic(), (0..=255_u8).prop_map(|code| f32::from(code) / 255.0), 0.0_f32..=1.0];
    ::proptest::array::uniform4(unit)
}

/// A fragment's depth: the ends, codes and ties of the depth format, numbers out of range, NaN.
pub fn depth(kind: Option<DepthKind>) -> BoxedStrategy<f32> {
    let plain = prop_oneof![4 => dyadic(), 4 => 0.0_f32..=1.0, 1 => -1.0_f32..=2.0, 1 => special()];
    match kind {
        Some(DepthKind::Unorm(bits)) => prop_oneof![2 => plain, 1 => near_codes(0, unorm::steps(bits))].boxed(),
        Some(DepthKind::Float32) | None => plain.boxed(),
    }
}

/// Code values k / N and the ties between them, from k = `first` to N, give or take an ulp.
fn near_codes(first: i32, steps: u32) -> impl Strategy<Value = f32> + Clone {
    let halves = 2 * i64::from(first)..=2 * i64::from(steps);
    (halves, -1..=1_i32).prop_map(move |(halves, ulps)| {
        #[expect(clippy::cast_precision_loss, reason = "at most 2^25, exact")]
        let halves = halves as f64;
        nudged(narrow(halves / (2.0 * f64::from(steps))), ulps)
    })
}

/// Numbers a layout stores exactly and the middles between them, give or take an ulp, of either sign.
fn near_float_codes(layout: FloatLayout) -> impl Strategy<Value = f32> + Clone {
    (0..layout.infinity(), any::<bool>(), any::<bool>(), -1..=1_i32).prop_map(move |(code, middle, negative, ulps)| {
        let below = layout.decode(code);
        let above = if code + 1 < layout.infinity() { layout.decode(code + 1) } else { below };
        let x = narrow(if middle { (below + above) / 2.0 } else { below });
        nudged(if negative { -x } else { x }, ulps)
    })
}

/// Either sign, exponents from below binary16's least to above its greatest.
fn magnitudes() -> impl Strategy<Value = f32> + Clone {
    (-1.0_f32..=1.0, -26..=18_i32).prop_map(|(x, exponent)| x * 2.0_f32.powi(exponent))
}

/// The number this many ulps (-1, 0 or 1) away.
fn nudged(x: f32, ulps: i32) -> f32 {
    match ulps {
        0 => x,
        up if up > 0 => x.next_up(),
        _ => x.next_down(),
    }
}

fn narrow(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = x as f32;
    rounded
}
