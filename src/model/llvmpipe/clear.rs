//! What `LoadOp::Clear` stores: the driver packs clear colors on the host, by other conversions than those of fragments.
//!
//! | channel | rule |
//! |---|---|
//! | 8-bit unorm | as a fragment's store |
//! | other unorm | clamped, NaN 0; floor(x steps + 1/2), both operations in binary32 |
//! | snorm | clamped, NaN -1; the same with a half away from zero |
//! | 8-bit sRGB | a table of 104 lines over the true curve, not the fragment's roots |
//! | half | truncated; a NaN keeps its sign and the top of its payload |
//! | 11/10-bit float | truncated, denormals 0, NaN with payload 1 |
//! | 32-bit float | the bits |

use super::{VectorWidth, float, integer};
use crate::format::{ChannelKind, FloatLayout, snorm};

/// The code that a clear to `x` leaves in one channel.
pub(super) fn code(kind: ChannelKind, x: f32) -> u32 {
    match kind {
        ChannelKind::Absent => 0,
        ChannelKind::Srgb => u32::from(fast_srgb8::f32_to_srgb8(x)),
        // The host has no narrow vectors here.
        ChannelKind::Unorm(8) => integer::quantize8(x, VectorWidth::Bits256),
        ChannelKind::Unorm(bits) => half_up(super::srgb::clamp_unit(x), (1 << bits) - 1).unsigned_abs(),
        ChannelKind::Snorm(bits) => {
            let clamped = if x > -1.0 { x.min(1.0) } else { -1.0 };
            snorm::stored_code(half_up(clamped, snorm::steps(bits)), bits)
        }
        ChannelKind::Float(layout) if layout == FloatLayout::HALF && x.is_nan() => {
            let bits = x.to_bits();
            (bits >> 16 & 0x8000) | 0x7e00 | (bits >> 13 & 0x3ff)
        }
        ChannelKind::Float(layout) if !layout.signed && x.is_nan() => layout.infinity() + 1,
        ChannelKind::Float(layout) if !layout.signed && x < LEAST_SMALL => 0,
        ChannelKind::Float(layout) => float::store(layout, x),
    }
}

/// 2^-14: the least 11- or 10-bit float that is not denormal.
const LEAST_SMALL: f32 = 1.0 / 16384.0;

/// x steps to the nearest integer, halves away from zero, with two roundings to binary32 on the way.
fn half_up(x: f32, steps: i32) -> i32 {
    #[expect(clippy::cast_precision_loss, reason = "at most 65535")]
    let scaled = x * steps as f32;
    #[expect(clippy::cast_possible_truncation, reason = "in range")]
    let code = (scaled + 0.5_f32.copysign(scaled)) as i32;
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_go_up_where_a_fragments_go_to_even() {
        assert_eq!(code(ChannelKind::Unorm(2), 0.5), 2, "1.5 of 3");
        assert_eq!(code(ChannelKind::Unorm(10), 0.5), 512, "511.5 of 1023");
        assert_eq!(code(ChannelKind::Unorm(16), 0.5), 32768, "32767.5 of 65535");
        // The largest number under 1/6 times 3, plus a half, is 1 in binary32.
        assert_eq!(code(ChannelKind::Unorm(2), f32::from_bits(0x3e2a_aaaa)), 1, "just under half a code");
        assert_eq!(code(ChannelKind::Snorm(8), -0.5), 0xc0, "-63.5 goes to -64");
    }

    #[test]
    fn no_signed_clear_stores_the_spare_code() {
        for x in [f32::NAN, f32::NEG_INFINITY, -2.0, -1.0] {
            assert_eq!(code(ChannelKind::Snorm(8), x), 0x81, "{x}");
            assert_eq!(code(ChannelKind::Snorm(16), x), 0x8001, "{x}");
        }
    }

    #[test]
    fn small_floats_lose_their_denormals_and_nans_their_payload() {
        let red = ChannelKind::Float(FloatLayout { exponent_bits: 5, mantissa_bits: 6, signed: false });
        assert_eq!(code(red, 1e-5), 0);
        assert_eq!(code(red, LEAST_SMALL), 1 << 6);
        assert_eq!(code(red, f32::NAN), 0x7c1);
        assert_eq!(code(red, -1.0), 0);
        assert_eq!(code(ChannelKind::Float(FloatLayout::HALF), -f32::NAN), 0xfe00);
    }
}
