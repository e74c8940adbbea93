//! The blend equation and the stores, from the specifications, in rational arithmetic.

use std::sync::LazyLock;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use dashu_int::{IBig, UBig};
use dashu_ratio::Relaxed;
use outmerge::format::{ChannelKind, ColorFormat, FloatLayout, Rounding};
use outmerge::model::ColorInputs;
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation};

use super::number::{Number, dyadic, ratio, single};

/// The codes after one fragment, all channels written, with this rounding at the store.
pub fn merge(inputs: &ColorInputs, rounding: Rounding) -> [u32; 4] {
    let channels = inputs.format.channels();
    let source = taken_in(inputs.format, inputs.src);
    let second = taken_in(inputs.format, inputs.src1);
    let constant = taken_in(inputs.format, inputs.constant);
    let stored: [Number; 4] = std::array::from_fn(|i| stored_value(channels[i], inputs.dst[i], i));
    std::array::from_fn(|i| {
        if channels[i] == ChannelKind::Absent {
            return 0;
        }
        let Some(state) = &inputs.blend else {
            if channels[i].bits() == 32 {
                return inputs.src[i].to_bits();
            }
            return store(channels[i], &source[i], rounding);
        };
        let equation = if i < 3 { &state.color } else { &state.alpha };
        let weight = |factor| limited(channels[i], weight(factor, i, &source, &second, &constant, &stored));
        store(channels[i], &combine(equation, &source[i], &stored[i], weight), rounding)
    })
}

fn combine(equation: &BlendComponent, s: &Number, d: &Number, weight: impl Fn(BlendFactor) -> Number) -> Number {
    let weighted = || (s.times(&weight(equation.src_factor)), d.times(&weight(equation.dst_factor)));
    match equation.operation {
        BlendOperation::Min => s.least(d),
        BlendOperation::Max => s.greatest(d),
        BlendOperation::Add => {
            let (s, d) = weighted();
            s.plus(&d)
        }
        BlendOperation::Subtract => {
            let (s, d) = weighted();
            s.minus(&d)
        }
        BlendOperation::ReverseSubtract => {
            let (s, d) = weighted();
            d.minus(&s)
        }
    }
}

/// Shader outputs clamp to the range of a normalised target; NaN to 0.
fn taken_in(format: ColorFormat, color: [f32; 4]) -> [Number; 4] {
    color.map(|x| limited(format.channels()[0], single(x)))
}

/// Clamped to a normalised channel's range.
fn limited(kind: ChannelKind, x: Number) -> Number {
    let low = match kind {
        ChannelKind::Float(_) => return x,
        ChannelKind::Snorm(_) => Number::one().negated(),
        _ => Number::zero(),
    };
    if matches!(x, Number::Nan) { Number::zero() } else { x.greatest(&low).least(&Number::one()) }
}

fn weight(
    factor: BlendFactor,
    i: usize,
    s: &[Number; 4],
    s1: &[Number; 4],
    k: &[Number; 4],
    d: &[Number; 4],
) -> Number {
    let not = |x: &Number| Number::one().minus(x);
    match factor {
        BlendFactor::Zero => Number::zero(),
        BlendFactor::One => Number::one(),
        BlendFactor::Src => s[i].clone(),
        BlendFactor::OneMinusSrc => not(&s[i]),
        BlendFactor::SrcAlpha => s[3].clone(),
        BlendFactor::OneMinusSrcAlpha => not(&s[3]),
        BlendFactor::Dst => d[i].clone(),
        BlendFactor::OneMinusDst => not(&d[i]),
        BlendFactor::DstAlpha => d[3].clone(),
        BlendFactor::OneMinusDstAlpha => not(&d[3]),
        BlendFactor::SrcAlphaSaturated => {
            if i == 3 {
                Number::one()
            } else {
                s[3].least(&not(&d[3]))
            }
        }
        BlendFactor::Constant => k[i].clone(),
        BlendFactor::OneMinusConstant => not(&k[i]),
        BlendFactor::Src1 => s1[i].clone(),
        BlendFactor::OneMinusSrc1 => not(&s1[i]),
        BlendFactor::Src1Alpha => s1[3].clone(),
        BlendFactor::OneMinusSrc1Alpha => not(&s1[3]),
    }
}

/// Bits of precision of irrational numbers, and the distance below which two of them count as undecided.
const PRECISION: usize = 320;
const UNDECIDED: usize = 240;

/// The linear value of an sRGB-encoded value h / 510: exact on the line, to 2^-300 or so on the curve.
fn linear(h: u32) -> Relaxed {
    if h == 510 {
        return Relaxed::ONE;
    }
    if f64::from(h) / 510.0 <= 0.04045 {
        return Relaxed::from_parts(IBig::from(h) * IBig::from(25), UBig::from(510_u32 * 323));
    }
    type Real = FBig<HalfEven, 2>;
    let real = |n: u32| Real::from(IBig::from(n)).with_precision(PRECISION).value();
    // ((h / 510 + 0.055) / 1.055) ^ 2.4
    let base = (real(1000 * h) + real(28_050)) / real(538_050);
    let power = base.powf(&(real(12) / real(5)));
    let (significand, exponent) = power.into_repr().into_parts();
    let exponent = i32::try_from(exponent).expect("a small exponent");
    Relaxed::from(significand) * dyadic(1, exponent)
}

static CURVE: LazyLock<Vec<Relaxed>> = LazyLock::new(|| (0..=510).map(linear).collect());

/// Whether a half-code's linear value is irrational.
fn on_the_curve(h: u32) -> bool {
    h < 510 && f64::from(h) / 510.0 > 0.04045
}

fn stored_value(kind: ChannelKind, code: u32, i: usize) -> Number {
    match kind {
        ChannelKind::Absent => ratio(i64::from(i == 3), 1),
        ChannelKind::Unorm(bits) => ratio(i64::from(code), (1_u64 << bits) - 1),
        ChannelKind::Snorm(bits) => {
            let signed = if code >> (bits - 1) == 1 { i64::from(code) - (1 << bits) } else { i64::from(code) };
            let top = (1_i64 << (bits - 1)) - 1;
            ratio(signed.max(-top), top.unsigned_abs())
        }
        ChannelKind::Srgb => Number::Rational(CURVE[2 * code as usize].clone(), false),
        ChannelKind::Float(layout) => float_value(layout, code),
    }
}

fn float_value(layout: FloatLayout, code: u32) -> Number {
    let FloatLayout { exponent_bits, mantissa_bits, signed } = layout;
    let sign_bit = exponent_bits + mantissa_bits;
    let negative = signed && code >> sign_bit == 1;
    let magnitude = code & ((1 << sign_bit) - 1);
    let (exponent, mantissa) = (magnitude >> mantissa_bits, magnitude & ((1 << mantissa_bits) - 1));
    if exponent == (1 << exponent_bits) - 1 {
        return if mantissa == 0 { Number::Infinite(negative) } else { Number::Nan };
    }
    let value = magnitude_value(layout, magnitude);
    Number::Rational(if negative { -value } else { value }, negative)
}

/// The value of a non-negative code; of the code of Inf, the power of two that would follow.
fn magnitude_value(layout: FloatLayout, magnitude: u32) -> Relaxed {
    let FloatLayout { exponent_bits, mantissa_bits, .. } = layout;
    let (exponent, mantissa) = (magnitude >> mantissa_bits, u64::from(magnitude & ((1 << mantissa_bits) - 1)));
    let bias = (1_i32 << (exponent_bits - 1)) - 1;
    let last_place = exponent.max(1).cast_signed() - bias - mantissa_bits.cast_signed();
    dyadic(if exponent == 0 { mantissa } else { mantissa | 1 << mantissa_bits }, last_place)
}

/// The code of a number.
fn store(kind: ChannelKind, x: &Number, rounding: Rounding) -> u32 {
    match kind {
        ChannelKind::Absent => 0,
        ChannelKind::Float(layout) => store_float(layout, x, rounding),
        _ => {
            let Number::Rational(x, _) = limited(kind, x.clone()) else { panic!("clamped numbers are finite") };
            match kind {
                ChannelKind::Unorm(bits) => rounded(&x, (1 << bits) - 1, rounding),
                ChannelKind::Snorm(bits) => {
                    let top = (1 << (bits - 1)) - 1;
                    if x < Relaxed::ZERO {
                        let code = ((1_u64 << bits) - u64::from(rounded(&-x, top, rounding))) & ((1 << bits) - 1);
                        u32::try_from(code).expect("at most 16 bits")
                    } else {
                        rounded(&x, top, rounding)
                    }
                }
                _ => store_srgb(&x, rounding),
            }
        }
    }
}

/// Whether a number between two codes, in the upper half or at its middle, takes the upper one.
fn goes_up(upper_half: bool, tie: bool, lower_is_odd: bool, rounding: Rounding) -> bool {
    match rounding {
        Rounding::TowardZero => false,
        Rounding::NearestEven if tie => lower_is_odd,
        Rounding::NearestEven | Rounding::NearestAway => upper_half,
    }
}

/// x * top as an integer; 0 <= x <= 1.
fn rounded(x: &Relaxed, top: u64, rounding: Rounding) -> u32 {
    let scaled = x * Relaxed::from(UBig::from(top));
    let doubled: UBig = (&scaled + &scaled).floor().try_into().expect("not negative");
    let doubled = u64::try_from(doubled).expect("small");
    let (floor, upper_half) = (doubled / 2, doubled % 2 == 1);
    let tie = upper_half && &scaled + &scaled == Relaxed::from(UBig::from(doubled));
    u32::try_from(floor + u64::from(goes_up(upper_half, tie, floor % 2 == 1, rounding))).expect("a code")
}

/// How many thresholds a linear value has reached: half-way points, or toward zero the codes themselves.
fn store_srgb(x: &Relaxed, rounding: Rounding) -> u32 {
    let (mut low, mut high) = (0_u32, 255_u32);
    while low < high {
        let middle = (low + high) / 2;
        let half_code = 2 * middle + if rounding == Rounding::TowardZero { 2 } else { 1 };
        let gap = x - &CURVE[half_code as usize];
        let size = if gap < Relaxed::ZERO { -gap.clone() } else { gap.clone() };
        let close = size <= Relaxed::from_parts(IBig::ONE, UBig::ONE << UNDECIDED);
        let reached = if rounding == Rounding::TowardZero {
            // A blend that keeps a code meets it; what is closer than any other combination gets, is one.
            close || gap > Relaxed::ZERO
        } else if gap.is_zero() && !on_the_curve(half_code) {
            rounding == Rounding::NearestAway || middle % 2 == 1
        } else {
            assert!(!close, "undecided at threshold {middle}: raise the precision");
            gap > Relaxed::ZERO
        };
        if reached { low = middle + 1 } else { high = middle }
    }
    low
}

fn store_float(layout: FloatLayout, x: &Number, rounding: Rounding) -> u32 {
    let FloatLayout { exponent_bits, mantissa_bits, signed } = layout;
    let infinite = ((1 << exponent_bits) - 1) << mantissa_bits;
    let sign = |negative: bool| if negative && signed { 1 << (exponent_bits + mantissa_bits) } else { 0 };
    match x {
        Number::Nan => infinite | 1 << (mantissa_bits - 1),
        Number::Infinite(negative) => {
            if *negative && !signed {
                0
            } else {
                sign(*negative) | infinite
            }
        }
        Number::Rational(x, zero_sign) => {
            let negative = if x.is_zero() { *zero_sign } else { *x < Relaxed::ZERO };
            if negative && !signed {
                return 0;
            }
            let size = if *x < Relaxed::ZERO { -x.clone() } else { x.clone() };
            // The largest code whose value is at most the size.
            let (mut low, mut high) = (0_u32, infinite);
            while high - low > 1 {
                let middle = (low + high) / 2;
                if magnitude_value(layout, middle) <= size { low = middle } else { high = middle }
            }
            let (below, above) = (magnitude_value(layout, low), magnitude_value(layout, high));
            let twice = &size + &size;
            let between = below + above;
            let up = goes_up(twice >= between, twice == between, low % 2 == 1, rounding)
                && size != magnitude_value(layout, low);
            sign(negative) | if up { high } else { low }
        }
    }
}
