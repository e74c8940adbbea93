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
    let upper = horner(&[0.095_428_18, 0.477_790_95, 0.197_828_13], m);
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

    #[test]
    fn the_polynomials_come_within_a_few_millionths() {
        for i in 1..1000_u16 {
            let x = f32::from(i) / 1000.0;
            let ideal = f64::from(x).powf(1.0 / 2.4);
            let relative = (f64::from(power(x, 1.0 / 2.4)) - ideal).abs() / ideal;
            assert!(relative < 1e-5, "{x}: {relative}");
        }
    }
}
