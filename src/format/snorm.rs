//! Signed normalised channels: value = max(code / N, -1) with N = 2^(n-1) - 1.
//!
//! The code is stored in two's complement; the spare code -2^(n-1) also reads as -1 and is never produced by a
//! conversion. Source: Vulkan, *Fixed-Point Data Conversions*; D3D11.3 3.2.3.5.

use super::rounding::{Rounding, decompose};

/// N = 2^(bits-1) - 1, the code of 1 and the number of steps between 0 and 1.
///
/// `bits` is 2 to 32.
#[must_use]
pub const fn steps(bits: u32) -> i32 {
    i32::MAX >> (32 - bits)
}

/// The signed code, clamped to `-N..=N`, that a stored bit pattern stands for.
#[must_use]
pub fn signed_code(code: u32, bits: u32) -> i32 {
    let shift = 32 - bits;
    let signed = code.wrapping_shl(shift).cast_signed() >> shift;
    signed.max(-steps(bits))
}

/// The bit pattern that stores a signed code of at most `bits` bits.
#[must_use]
pub fn stored_code(signed: i32, bits: u32) -> u32 {
    signed.cast_unsigned() & super::unorm::steps(bits)
}

/// The bit pattern that stores `x`: clamped to `[-1, 1]`, NaN as 0, scaled by N exactly and rounded once, to nearest
/// or toward zero in magnitude.
///
/// # Panics
/// When `bits` is not 2 to 32.
#[must_use]
pub fn encode(x: f64, bits: u32, rounding: Rounding) -> u32 {
    if x.is_nan() {
        return 0;
    }
    let (negative, magnitude, exponent) = decompose(x.clamp(-1.0, 1.0));
    let scaled = magnitude * u128::from(steps(bits).unsigned_abs());
    let code =
        i32::try_from(rounding.shift_right(scaled, exponent.unsigned_abs())).expect("|x| <= 1 scales to at most N");
    stored_code(if negative { -code } else { code }, bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_but_the_spare_one_survives_decode_and_encode() {
        for code in (0..=255).filter(|&code| code != 0x80) {
            let value = f64::from(signed_code(code, 8)) / 127.0;
            assert_eq!(encode(value, 8, Rounding::NearestEven), code, "code {code:#x}");
        }
        assert_eq!(encode(-7.0, 8, Rounding::NearestEven), 0x81, "below -1 clamps to -127, never -128");
    }

    #[test]
    fn the_spare_code_reads_as_minus_one() {
        assert_eq!(signed_code(0x80, 8), -127, "-128 reads as -1");
        assert_eq!(signed_code(0x81, 8), -127, "-127 is -1");
        assert_eq!(signed_code(0xff, 8), -1, "two's complement");
        assert_eq!(signed_code(0x7f, 8), 127, "one");
    }

    #[test]
    fn stored_and_signed_codes_are_inverse_but_for_the_spare_code() {
        for code in (0..=255).filter(|&code| code != 0x80) {
            assert_eq!(stored_code(signed_code(code, 8), 8), code, "code {code}");
        }
    }
}
