//! The driver's sRGB curve in binary32: powers by polynomials for log2 and exp2, nothing fused.

/// x^y as exp2(y log2 x).
fn power(x: f32, y: f32) -> f32 {
    exp2(log2(x) * y)
}

/// A polynomial's value by Horner's rule, highest coefficient first.
fn horner(coefficients: &[f32], x: f32) -> f32 {
    coefficients.iter().copied().reduce(|sum, next| sum * x + next).unwrap_or(0.0)
}

/// log2 for x >= 0: exponent, plus (m - 1) times a quotient of two polynomials in the mantissa m.
fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    if bits == f32::INFINITY.to_bits() {
        return f32::INFINITY;
    }
    let one = 1.0_f32.to_bits();
    // The exponent's bits become mantissa bits of a number from 1 to 2.
    let exponent = (f32::from_bits((bits & 0x7f80_0000) >> 8 | one) - 1.496_093_8) * 256.0;
    let m = f32::from_bits(bits & 0x007f_ffff | one);
    // 0.095428176 is 0x3dc36fd9: with the next float, 0.09542818, 18 inputs of the encode come out one code too high.
    let upper = horner(&[0.095_428_176, 0.477_790_95, 0.197_828_13], m);
    let lower = horner(&[0.016_618_466, 0.203_505_08, 0.273_829, 0.040_496_69], m);
    exponent + (m - 1.0) * (upper / lower)
}

/// 2^x: the integer part as an exponent, the rest by a polynomial.
fn exp2(x: f32) -> f32 {
    // -126.99999 and 128: the exponents of binary32.
    let x = super::higher(super::lower(x, 128.0), f32::from_bits(0xc2fd_ffff));
    let whole = (x - 0.5).round_ties_even();
    #[expect(clippy::cast_possible_truncation, reason = "from -127 to 128")]
    let exponent = (whole as i32 + 127).cast_unsigned() << 23;
    let coefficients = [0x3af6_1905, 0x3c13_4806, 0x3d64_aa23, 0x3e75_ead4, 0x3f31_727b, 0x3f80_0000];
    f32::from_bits(exponent) * horner(&coefficients.map(f32::from_bits), x - whole)
}

/// Linear to sRGB, before the clamp.
#[must_use]
pub fn encode(x: f32) -> f32 {
    if x < 0.003_130_8 { x * 12.92 } else { 1.055 * power(x, 1.0 / 2.4) + -0.055 }
}

/// sRGB to linear.
#[must_use]
pub fn decode(x: f32) -> f32 {
    if x < 0.040_45 { x * (1.0 / 12.92) } else { power(x * (1.0 / 1.055) + 0.055 / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::ChannelKind;
    use crate::model::{Arithmetic, swiftshader::SwiftShader};

    #[test]
    fn the_polynomials_come_within_a_few_millionths() {
        for i in 1..1000_u16 {
            let x = f32::from(i) / 1000.0;
            let ideal = f64::from(x).powf(1.0 / 2.4);
            let relative = (f64::from(power(x, 1.0 / 2.4)) - ideal).abs() / ideal;
            assert!(relative < 1e-5, "{x}: {relative}");
        }
    }

    /// Inputs whose code on the device depends on the last bit of log2's first coefficient: bits, code read back.
    const AT_THRESHOLDS: [(u32, u32); 18] = [
        (0x3bed_64aa, 20),
        (0x3c72_dd72, 32),
        (0x3c72_dd73, 32),
        (0x3cdb_5d4e, 45),
        (0x3d62_831c, 66),
        (0x3d7e_7627, 70),
        (0x3de2_b30b, 93),
        (0x3e57_7ac7, 126),
        (0x3e92_118a, 145),
        (0x3e96_8094, 147),
        (0x3ed1_dc9e, 171),
        (0x3ee8_3d5d, 179),
        (0x3ef9_e5a3, 185),
        (0x3f30_b5bf, 216),
        (0x3f55_b40e, 235),
        (0x3f66_8481, 243),
        (0x3f73_9e49, 249),
        (0x3f7c_966f, 253),
    ];

    #[test]
    fn the_inputs_next_to_a_threshold_get_the_codes_the_device_stores() {
        for (bits, code) in AT_THRESHOLDS {
            let got = SwiftShader::default().encode(&f32::from_bits(bits), ChannelKind::Srgb);
            assert_eq!(got, code, "store of {bits:#010x}");
        }
    }

    #[test]
    fn two_floats_on_the_next_code_begins() {
        for (bits, code) in AT_THRESHOLDS {
            let got = SwiftShader::default().encode(&f32::from_bits(bits + 2), ChannelKind::Srgb);
            assert_eq!(got, code + 1, "store of {:#010x}", bits + 2);
        }
    }
}
