//! The driver's conversions of half and 11/10-bit floats.
//!
//! Stores deviate from Vulkan's *Floating-Point Format Conversions* for Inf and overflow on half targets; loads take
//! half codes with exponent 31 as ordinary numbers.

use crate::format::FloatLayout;
use crate::model::binary32::narrow;

/// The number the blender sees for a stored code.
#[must_use]
pub fn decode(layout: FloatLayout, code: u32) -> f32 {
    if layout != FloatLayout::HALF || code & layout.infinity() != layout.infinity() {
        return narrow(layout.decode(code));
    }
    let magnitude = narrow(f64::from(0x400 | code & 0x3ff) * 64.0);
    if code & layout.sign() == 0 { magnitude } else { -magnitude }
}

/// The code stored for a number.
#[must_use]
pub fn encode(layout: FloatLayout, x: f32) -> u32 {
    match layout {
        FloatLayout::SINGLE => x.to_bits(),
        FloatLayout::HALF => encode_half(x),
        // Rounded to half first, then the surplus mantissa bits are cut; NaN and negative numbers are 0 by comparison.
        _ => encode_half(super::higher(x, 0.0)) >> (10 - layout.mantissa_bits),
    }
}

/// Nearest even, but: numbers from 65520 on take the codes of exponent 31 as if it were an ordinary one, and from 131040
/// on (Inf and NaN included) all bits below the sign are set; both read as NaN or Inf elsewhere. A number below 2^-14
/// loses the bits beyond 2^-37 before it is rounded.
fn encode_half(x: f32) -> u32 {
    let sign = x.to_bits() >> 16 & 0x8000;
    let magnitude = x.to_bits() & 0x7fff_ffff;
    if magnitude > 0x47ff_efff {
        return sign | 0x7fff;
    }
    // Mantissa bits in units of 2^-37 below 2^-14; above, the bits with the exponent's bias moved from 127 to 15.
    let wide = if magnitude < 0x3880_0000 {
        let mantissa = magnitude & 0x007f_ffff | 0x0080_0000;
        let shift = 113 - (magnitude >> 23);
        if shift < 24 { mantissa >> shift } else { 0 }
    } else {
        magnitude - (112 << 23)
    };
    let to_even = wide >> 13 & 1;
    sign | (wide + 0xfff + to_even) >> 13
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Rounding;

    #[test]
    fn normal_half_numbers_are_rounded_to_nearest_even() {
        for bits in (0x3880_0000_u32..0x477f_f000).step_by(997) {
            let x = f32::from_bits(bits);
            let expected = FloatLayout::HALF.encode(f64::from(x), Rounding::NearestEven);
            assert_eq!(encode_half(x), expected, "{bits:#x}");
        }
    }

    #[test]
    fn overflow_and_inf_store_nan() {
        assert_eq!(encode_half(65519.0), 0x7bff, "the largest number");
        assert_eq!(encode_half(65520.0), 0x7c00, "2^16 as a number, Inf to others");
        assert_eq!(encode_half(98304.0), 0x7e00, "1.5 x 2^16 as a number, NaN to others");
        assert_eq!(encode_half(f32::from_bits(0x47ff_efff)), 0x7fff, "the last one that is rounded");
        for x in [131_072.0, f32::INFINITY, f32::NAN] {
            assert_eq!(encode_half(x), 0x7fff, "{x}");
        }
        assert_eq!(encode_half(f32::NEG_INFINITY), 0xffff, "the sign stays");
    }

    #[test]
    fn exponent_31_loads_as_a_number() {
        assert_eq!(decode(FloatLayout::HALF, 0x7c00), 65536.0, "not Inf");
        assert_eq!(decode(FloatLayout::HALF, 0xfe00), -98304.0, "not NaN");
    }

    #[test]
    fn small_unsigned_floats_are_cut_after_rounding_to_half() {
        let eleven = FloatLayout { exponent_bits: 5, mantissa_bits: 6, signed: false };
        assert_eq!(encode(eleven, 1.0), 0x3c0, "1");
        assert_eq!(encode(eleven, 1.015), 0x3c0, "cut, although 1.015625 is nearer");
        assert_eq!(encode(eleven, -1.0), 0, "negative");
        assert_eq!(encode(eleven, f32::NAN), 0, "NaN");
    }
}
