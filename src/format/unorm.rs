//! Unsigned normalised channels: value = code / N with N = 2^n - 1.
//!
//! Source: Vulkan, *Fixed-Point Data Conversions*; D3D11.3 3.2.3.3.

use super::rounding::{Rounding, decompose};

/// N = 2^bits - 1, the largest code and the number of steps between 0 and 1.
///
/// `bits` is 1 to 32.
#[must_use]
pub const fn steps(bits: u32) -> u32 {
    u32::MAX >> (32 - bits)
}

/// The code that stores `x`: clamped to `[0, 1]`, NaN as 0, scaled by N exactly and rounded once.
///
/// # Panics
/// When `bits` is not 1 to 32.
#[must_use]
pub fn encode(x: f64, bits: u32, rounding: Rounding) -> u32 {
    if x.is_nan() || x <= 0.0 {
        return 0;
    }
    if x >= 1.0 {
        return steps(bits);
    }
    let (_, magnitude, exponent) = decompose(x);
    // Below 1 the exponent is at most -53; the product stays below 2^85.
    let code = rounding.shift_right(magnitude * u128::from(steps(bits)), exponent.unsigned_abs());
    u32::try_from(code).expect("a value below 1 scales to at most N")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_decode_and_encode() {
        for bits in [2, 8, 10, 16] {
            for code in 0..=steps(bits) {
                let value = f64::from(code) / f64::from(steps(bits));
                assert_eq!(encode(value, bits, Rounding::NearestEven), code, "{bits} bits, code {code}");
            }
        }
    }

    #[test]
    fn out_of_range_values_clamp_and_nan_is_zero() {
        for (x, code) in [(-1.0, 0), (2.0, 255), (f64::INFINITY, 255), (f64::NEG_INFINITY, 0), (f64::NAN, 0)] {
            assert_eq!(encode(x, 8, Rounding::NearestEven), code, "{x}");
        }
    }

    #[test]
    fn a_half_is_the_only_tie_of_an_eight_bit_channel() {
        // 255 is odd, so 0.5 scales to 127.5; the two neighbours decide themselves.
        assert_eq!(encode(0.5, 8, Rounding::NearestEven), 128, "even");
        assert_eq!(encode(0.5_f64.next_down(), 8, Rounding::NearestEven), 127, "just below");
        assert_eq!(encode(0.5, 8, Rounding::TowardZero), 127, "toward zero");
    }
}
