//! What `LoadOp::Clear` stores: the driver packs clear colors on the host, by other conversions than those of fragments.
//!
//! | channel | Mesa 22.3 | from 25.0 on, where it differs |
//! |---|---|---|
//! | 8-bit unorm | as a fragment's store | |
//! | other unorm | clamped, NaN 0; floor(x steps + 1/2), both operations in binary32 | halves to even |
//! | snorm | clamped, NaN -1; the same with a half away from zero | halves to even |
//! | 8-bit sRGB | a table of 104 lines over the true curve, not the fragment's roots | |
//! | half | truncated; a NaN keeps its sign and the top of its payload | |
//! | 11/10-bit float | truncated, denormals 0, NaN with payload 1 | to the nearest, halves to even, with denormals |
//! | 32-bit float | the bits | |

use super::generation::Clear;
use super::{VectorWidth, float, integer};
use crate::format::{ChannelKind, FloatLayout, Rounding, snorm};

/// The code that a clear to `x` leaves in one channel.
pub(super) fn code(kind: ChannelKind, x: f32, rule: Clear) -> u32 {
    match kind {
        ChannelKind::Absent => 0,
        ChannelKind::Srgb => u32::from(fast_srgb8::f32_to_srgb8(x)),
        // The host has no narrow vectors here.
        ChannelKind::Unorm(8) => integer::quantize8(x, VectorWidth::Bits256),
        ChannelKind::Unorm(bits) => scaled(super::srgb::clamp_unit(x), (1 << bits) - 1, rule).unsigned_abs(),
        ChannelKind::Snorm(bits) => {
            let clamped = if x > -1.0 { x.min(1.0) } else { -1.0 };
            snorm::stored_code(scaled(clamped, snorm::steps(bits), rule), bits)
        }
        ChannelKind::Float(layout) if layout == FloatLayout::HALF && x.is_nan() => {
            let bits = x.to_bits();
            (bits >> 16 & 0x8000) | 0x7e00 | (bits >> 13 & 0x3ff)
        }
        ChannelKind::Float(layout) if !layout.signed && x.is_nan() => layout.infinity() + 1,
        ChannelKind::Float(layout) if !layout.signed && rule == Clear::HalvesEven => nearest_finite(layout, x),
        ChannelKind::Float(layout) if !layout.signed && x < LEAST_SMALL => 0,
        ChannelKind::Float(layout) => float::store(layout, x),
    }
}

/// The nearest code, ties to even; numbers beyond the largest finite one become that.
fn nearest_finite(layout: FloatLayout, x: f32) -> u32 {
    let code = layout.encode(f64::from(x.max(0.0)), Rounding::NearestEven);
    if x.is_finite() { code.min(layout.max_finite()) } else { code }
}

/// 2^-14: the least 11- or 10-bit float that is not denormal.
const LEAST_SMALL: f32 = 1.0 / 16384.0;

/// x steps to the nearest integer: halves away from zero by adding one half, which rounds to binary32 once more, or to even.
fn scaled(x: f32, steps: i32, rule: Clear) -> i32 {
    #[expect(clippy::cast_precision_loss, reason = "at most 65535")]
    let scaled = x * steps as f32;
    let whole = match rule {
        Clear::HalvesAway => scaled + 0.5_f32.copysign(scaled),
        Clear::HalvesEven => scaled.round_ties_even(),
    };
    #[expect(clippy::cast_possible_truncation, reason = "in range")]
    let code = whole as i32;
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    fn old(kind: ChannelKind, x: f32) -> u32 {
        code(kind, x, Clear::HalvesAway)
    }

    #[test]
    fn halves_go_up_where_a_fragments_go_to_even() {
        assert_eq!(old(ChannelKind::Unorm(2), 0.5), 2, "1.5 of 3");
        assert_eq!(old(ChannelKind::Unorm(10), 0.5), 512, "511.5 of 1023");
        assert_eq!(old(ChannelKind::Unorm(16), 0.5), 32768, "32767.5 of 65535");
        // The largest number under 1/6 times 3, plus a half, is 1 in binary32.
        assert_eq!(old(ChannelKind::Unorm(2), f32::from_bits(0x3e2a_aaaa)), 1, "just under half a code");
        assert_eq!(old(ChannelKind::Snorm(8), -0.5), 0xc0, "-63.5 goes to -64");
    }

    #[test]
    fn no_signed_clear_stores_the_spare_code() {
        for x in [f32::NAN, f32::NEG_INFINITY, -2.0, -1.0] {
            assert_eq!(old(ChannelKind::Snorm(8), x), 0x81, "{x}");
            assert_eq!(old(ChannelKind::Snorm(16), x), 0x8001, "{x}");
        }
    }

    #[test]
    fn small_floats_lose_their_denormals_and_nans_their_payload() {
        let red = ChannelKind::Float(FloatLayout { exponent_bits: 5, mantissa_bits: 6, signed: false });
        assert_eq!(old(red, 1e-5), 0);
        assert_eq!(old(red, LEAST_SMALL), 1 << 6);
        assert_eq!(old(red, f32::NAN), 0x7c1);
        assert_eq!(old(red, -1.0), 0);
        assert_eq!(old(ChannelKind::Float(FloatLayout::HALF), -f32::NAN), 0xfe00);
    }

    #[test]
    fn from_25_0_on_halves_go_to_even_and_small_floats_to_the_nearest() {
        let new = |kind, x| code(kind, x, Clear::HalvesEven);
        assert_eq!(new(ChannelKind::Unorm(10), 0.5), 512, "511.5 of 1023");
        assert_eq!(new(ChannelKind::Unorm(2), 0.5), 2, "1.5 of 3");
        assert_eq!(new(ChannelKind::Unorm(2), 1.0 / 6.0), 0, "0.5 of 3, by the nearest number");
        assert_eq!(new(ChannelKind::Snorm(8), -0.5), 0xc0, "-63.5 goes to -64");
        let red = ChannelKind::Float(FloatLayout { exponent_bits: 5, mantissa_bits: 6, signed: false });
        assert_eq!(new(red, 1.0 + 3.0 / 128.0), 15 << 6 | 2, "half-way to even");
        assert_eq!(new(red, 6e-7), 1, "2^-20 and less is denormal");
        assert_eq!([1e9, f32::INFINITY, f32::NAN, -1.0].map(|x| new(red, x)), [0x7bf, 0x7c0, 0x7c1, 0], "special");
    }
}
