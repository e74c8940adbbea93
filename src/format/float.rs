//! Binary floating-point channels: exact decoding to `f64`, and encoding with an explicit rounding mode.
//!
//! One routine serves binary16, binary32 and the unsigned 11- and 10-bit floats. Sources: Vulkan, *Floating-Point
//! Format Conversions*, *16-Bit*, *Unsigned 11-Bit* and *Unsigned 10-Bit Floating-Point Numbers*; D3D11.3 3.2.2.

use super::FloatLayout;
use super::rounding::{Rounding, decompose};

impl FloatLayout {
    /// binary16.
    pub const HALF: Self = Self { exponent_bits: 5, mantissa_bits: 10, signed: true };
    /// binary32.
    pub const SINGLE: Self = Self { exponent_bits: 8, mantissa_bits: 23, signed: true };

    /// The code of +Inf: exponent all ones, mantissa zero.
    #[must_use]
    pub const fn infinity(self) -> u32 {
        ((1 << self.exponent_bits) - 1) << self.mantissa_bits
    }

    /// The code of a quiet NaN: Inf with the top mantissa bit set.
    #[must_use]
    pub const fn nan(self) -> u32 {
        self.infinity() | 1 << (self.mantissa_bits - 1)
    }

    /// The sign bit; 0 where the layout has none.
    #[must_use]
    pub const fn sign(self) -> u32 {
        if self.signed { 1 << (self.exponent_bits + self.mantissa_bits) } else { 0 }
    }

    /// The code of the largest finite number.
    #[must_use]
    pub const fn max_finite(self) -> u32 {
        self.infinity() - 1
    }

    /// Whether a code is a NaN.
    #[must_use]
    pub const fn is_nan(self, code: u32) -> bool {
        code & !self.sign() > self.infinity()
    }

    /// Exponent of the least significant bit of subnormal numbers, e.g. -24 for binary16.
    #[must_use]
    pub const fn least_exponent(self) -> i32 {
        let bias = (1 << (self.exponent_bits - 1)) - 1;
        1 - bias - self.mantissa_bits.cast_signed()
    }

    /// The value of a code; every finite one is exact in `f64`.
    #[must_use]
    pub fn decode(self, code: u32) -> f64 {
        let magnitude = code & !self.sign();
        let sign = if code & self.sign() == 0 { 1.0 } else { -1.0 };
        if magnitude > self.infinity() {
            return f64::NAN;
        }
        if magnitude == self.infinity() {
            return sign * f64::INFINITY;
        }
        let exponent = magnitude >> self.mantissa_bits;
        let mantissa = magnitude & ((1 << self.mantissa_bits) - 1);
        let implied = if exponent == 0 { 0 } else { 1 << self.mantissa_bits };
        let scale = self.least_exponent() + (exponent.max(1) - 1).cast_signed();
        sign * f64::from(mantissa | implied) * 2.0_f64.powi(scale)
    }

    /// The code that stores `x`.
    ///
    /// NaN gives the quiet NaN, negative numbers give 0 in an unsigned layout. A finite number beyond the largest
    /// finite one becomes Inf under the nearest modes (IEEE 754) and the largest finite number toward zero.
    #[must_use]
    pub fn encode(self, x: f64, rounding: Rounding) -> u32 {
        if x.is_nan() {
            return self.nan();
        }
        if x.is_sign_negative() && !self.signed {
            return 0;
        }
        let sign = if x.is_sign_negative() { self.sign() } else { 0 };
        if x.is_infinite() {
            return sign | self.infinity();
        }
        let (_, magnitude, exponent) = decompose(x);
        sign | self.encode_magnitude(magnitude, exponent, rounding)
    }

    /// The code, sign aside, of `magnitude * 2^exponent`; the magnitude is below 2^53.
    fn encode_magnitude(self, magnitude: u128, exponent: i32, rounding: Rounding) -> u32 {
        if magnitude == 0 {
            return 0;
        }
        let top = exponent + (127 - magnitude.leading_zeros().cast_signed());
        let unit = self.unit_exponent(top);
        let shift = unit - exponent;
        let units = match u32::try_from(shift) {
            Ok(right) => rounding.shift_right(magnitude, right),
            Err(_) => magnitude << shift.unsigned_abs().min(64),
        };
        self.assemble(u32::try_from(units).unwrap_or(u32::MAX), unit, rounding)
    }

    /// Exponent of the last place for a number whose leading bit has exponent `top`.
    pub(crate) fn unit_exponent(self, top: i32) -> i32 {
        (top - self.mantissa_bits.cast_signed()).max(self.least_exponent())
    }

    /// The code of `units * 2^unit`, where `units` is at most 2^(mantissa bits + 1).
    ///
    /// Codes of consecutive numbers are consecutive integers, so a carry into the next binade needs no care.
    pub(crate) fn assemble(self, units: u32, unit: i32, rounding: Rounding) -> u32 {
        let binades = (unit - self.least_exponent()).unsigned_abs();
        if binades >= 1 << self.exponent_bits {
            return self.overflow(rounding);
        }
        let code = (binades << self.mantissa_bits).saturating_add(units);
        if code >= self.infinity() { self.overflow(rounding) } else { code }
    }

    /// What a finite number too large for the layout becomes.
    fn overflow(self, rounding: Rounding) -> u32 {
        match rounding {
            Rounding::TowardZero => self.max_finite(),
            Rounding::NearestEven | Rounding::NearestAway => self.infinity(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UFLOAT11: FloatLayout = FloatLayout { exponent_bits: 5, mantissa_bits: 6, signed: false };
    const UFLOAT10: FloatLayout = FloatLayout { exponent_bits: 5, mantissa_bits: 5, signed: false };

    #[test]
    fn every_small_code_survives_decode_and_encode() {
        for (layout, bits) in [(FloatLayout::HALF, 16), (UFLOAT11, 11), (UFLOAT10, 10)] {
            for code in (0..1_u32 << bits).filter(|&code| !layout.is_nan(code)) {
                for mode in [Rounding::NearestEven, Rounding::NearestAway, Rounding::TowardZero] {
                    assert_eq!(layout.encode(layout.decode(code), mode), code, "{layout:?} {code:#x} {mode:?}");
                }
            }
        }
    }

    #[test]
    fn half_agrees_with_the_half_crate_on_a_spread_of_all_f32() {
        for bits in (0..=u32::MAX).step_by(4099) {
            let x = f32::from_bits(bits);
            if x.is_nan() {
                continue;
            }
            let ours = FloatLayout::HALF.encode(f64::from(x), Rounding::NearestEven);
            assert_eq!(ours, u32::from(half::f16::from_f32(x).to_bits()), "{x} ({bits:#x})");
        }
    }

    #[test]
    fn single_agrees_with_the_platform_conversion() {
        for i in 0..200_000_u64 {
            let x = f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            if x.is_nan() {
                continue;
            }
            #[expect(clippy::cast_possible_truncation, reason = "the conversion under test is IEEE's own")]
            let expected = (x as f32).to_bits();
            assert_eq!(FloatLayout::SINGLE.encode(x, Rounding::NearestEven), expected, "{x}");
        }
    }

    #[test]
    fn half_overflow_is_inf_to_nearest_and_max_finite_toward_zero() {
        assert_eq!(FloatLayout::HALF.encode(65519.9, Rounding::NearestEven), 0x7bff, "below 65520 rounds down");
        assert_eq!(FloatLayout::HALF.encode(65520.0, Rounding::NearestEven), 0x7c00, "the tie goes to Inf");
        assert_eq!(FloatLayout::HALF.encode(1e30, Rounding::TowardZero), 0x7bff, "65504");
        assert_eq!(FloatLayout::HALF.encode(f64::INFINITY, Rounding::TowardZero), 0x7c00, "Inf stays Inf");
    }

    #[test]
    fn unsigned_layouts_store_negatives_as_zero() {
        assert_eq!(UFLOAT11.encode(-1.0, Rounding::NearestEven), 0, "-1");
        assert_eq!(UFLOAT11.encode(f64::NEG_INFINITY, Rounding::NearestEven), 0, "-Inf");
        assert!(UFLOAT10.is_nan(UFLOAT10.encode(f64::NAN, Rounding::NearestEven)), "NaN stays NaN");
    }
}
