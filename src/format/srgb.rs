//! The sRGB transfer functions of 8-bit channels, with proven enclosures instead of platform `powf`.
//!
//! decode: e <= 0.04045: e / 12.92, else ((e + 0.055) / 1.055)^2.4. encode: l <= 0.0031308: 12.92 l, else
//! 1.055 l^(1/2.4) - 0.055. Sources: IEC 61966-2-1; Khronos Data Format Specification, *sRGB EOTF*; D3D11.3 3.2.3.7.
//!
//! Only 511 points of the curve matter to an 8-bit channel: its 256 codes, and the 255 half-way points between them,
//! which are the thresholds of a correctly rounding encode. Each is enclosed to any precision by an integer fifth
//! root, since x^2.4 is the fifth root of x^12.

use std::sync::LazyLock;

use num_bigint::{BigInt, BigUint};
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// The last half-code on the linear segment: 2c of code c, 2c + 1 of the threshold above it; h / 510 <= 0.04045.
pub const LAST_LINEAR_HALF_CODE: u32 = 510 * 4045 / 100_000;

/// A closed interval that holds a real number; a point where the number is rational and known exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Enclosure {
    /// Lower end.
    pub lo: BigRational,
    /// Upper end.
    pub hi: BigRational,
}

/// Encloses the linear value of the sRGB-encoded value `half_code / 510` to within 2^-`bits`.
///
/// `half_code` is 0 to 510. The linear segment and the end point 1 are exact.
#[must_use]
pub fn linear_enclosure(half_code: u32, bits: u32) -> Enclosure {
    enclose_linear(half_code, 510, bits)
}

/// Encloses the linear value of the sRGB-encoded value `numerator / denominator`, from 0 to 1, to within 2^-`bits`.
///
/// The linear segment and the end point 1 are exact. Products with 100,000 must fit: denominators up to 40,000 do.
#[must_use]
pub fn enclose_linear(numerator: u32, denominator: u32, bits: u32) -> Enclosure {
    let rational = |n: u32, d: u32| BigRational::new(BigInt::from(n), BigInt::from(d));
    if numerator * 100_000 <= denominator * 4045 {
        let exact = rational(numerator * 100, denominator) / rational(1292, 1);
        return Enclosure { lo: exact.clone(), hi: exact };
    }
    if numerator == denominator {
        return Enclosure { lo: rational(1, 1), hi: rational(1, 1) };
    }
    // (n / d + 0.055) / 1.055 = p / q.
    let p = BigUint::from(1000 * numerator + denominator * 55);
    let q = BigUint::from(denominator * 1055);
    let root = ((p.pow(12) << (5 * bits as usize)) / q.pow(12)).nth_root(5);
    let scale = BigInt::from(1) << bits as usize;
    let lo = BigRational::new(BigInt::from(root.clone()), scale.clone());
    let hi = BigRational::new(BigInt::from(root + 1_u32), scale);
    Enclosure { lo, hi }
}

/// An `f64` and a bound on its distance from the real number it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approximation {
    /// The nearby `f64`.
    pub value: f64,
    /// |value - real| <= error.
    pub error: f64,
}

/// The 511 points of the curve that an 8-bit channel needs, by half-code.
static POINTS: LazyLock<Vec<Approximation>> = LazyLock::new(|| (0..=510).map(|h| approximate(h, 510)).collect());

/// The linear value of the sRGB-encoded value `numerator / denominator`, from 0 to 1; see [`enclose_linear`].
///
/// # Panics
/// Never: numbers in `[0, 1]` have `f64` neighbours.
#[must_use]
pub fn approximate(numerator: u32, denominator: u32) -> Approximation {
    // 2^-96 is far below half a unit in the last place of the smallest point, 2^-65.
    let Enclosure { lo, hi } = enclose_linear(numerator, denominator, 96);
    let value = lo.to_f64().expect("a number in [0, 1] has an f64 neighbour");
    let exact = BigRational::from_float(value).expect("finite");
    let below = (exact.clone() - lo).to_f64().unwrap_or(0.0).abs();
    let above = (hi - exact).to_f64().unwrap_or(0.0).abs();
    // One step up covers the rounding of the difference itself.
    let error = if below.max(above) == 0.0 { 0.0 } else { below.max(above).next_up() };
    Approximation { value, error }
}

/// The linear value of a code, 0 to 255.
#[must_use]
pub fn decode(code: u32) -> Approximation {
    POINTS[2 * code as usize]
}

/// The linear value of a code, correctly rounded to binary32.
#[must_use]
pub fn decode_f32(code: u32) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = decode(code).value as f32;
    rounded
}

/// The linear value half-way (on the encoded side) between `code` and `code + 1`; `code` is 0 to 254.
#[must_use]
pub fn threshold(code: u32) -> Approximation {
    POINTS[2 * code as usize + 1]
}

/// The code that stores the linear value `l`, correctly rounded; clamped to `[0, 1]`, NaN as 0.
///
/// `None` when `l` lies within a threshold's error, less than one `f64` in 10^15.
#[must_use]
pub fn encode(l: f64) -> Option<u32> {
    points_reached(l, 1)
}

/// The largest code whose linear value is at most `l`; clamped to `[0, 1]`, NaN as 0.
///
/// `None` when `l` lies within the error of a code's value.
#[must_use]
pub fn encode_toward_zero(l: f64) -> Option<u32> {
    points_reached(l, 2)
}

/// How many of the points of half-code `2 c + first`, one a code c, are at or below `l`.
fn points_reached(l: f64, first: usize) -> Option<u32> {
    if l.is_nan() || l <= 0.0 {
        return Some(0);
    }
    let points = &*POINTS;
    let (mut low, mut high) = (0_u32, 255_u32);
    while low < high {
        let middle = u32::midpoint(low, high);
        let at = points[2 * middle as usize + first];
        // A code that is known exactly, as 1 is, is reached by its own value; at a threshold there is a tie to break.
        let is_code = first == 2 && at.error == 0.0 && l == at.value;
        if !is_code && (l - at.value).abs() <= at.error {
            return None;
        }
        if is_code || l > at.value { low = middle + 1 } else { high = middle }
    }
    Some(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_decode_and_encode() {
        for code in 0..=255 {
            assert_eq!(encode(decode(code).value), Some(code), "code {code}");
        }
    }

    #[test]
    fn toward_zero_a_code_begins_at_its_value() {
        for code in 1..=255 {
            let value = decode(code).value;
            assert_eq!(encode_toward_zero(value * (1.0 + 1e-12)), Some(code), "just above code {code}");
            assert_eq!(encode_toward_zero(value * (1.0 - 1e-12)), Some(code - 1), "just below code {code}");
        }
        assert_eq!((encode_toward_zero(7.0), encode_toward_zero(f64::NAN)), (Some(255), Some(0)), "clamped");
    }

    #[test]
    fn points_agree_with_the_formula_in_f64() {
        for half_code in 0..=510_u32 {
            let e = f64::from(half_code) / 510.0;
            let formula = if e <= 0.04045 { e / 12.92 } else { ((e + 0.055) / 1.055).powf(2.4) };
            let point = POINTS[half_code as usize];
            assert!((point.value - formula).abs() <= 1e-15, "half-code {half_code}: {} and {formula}", point.value);
            assert!(point.error <= point.value * f64::EPSILON, "half-code {half_code}: the bound is half an ulp");
        }
    }

    #[test]
    fn points_increase() {
        assert!(POINTS.windows(2).all(|pair| pair[0].value < pair[1].value), "the curve is strictly increasing");
    }

    #[test]
    fn enclosures_nest_as_precision_grows() {
        for half_code in [21, 22, 255, 509] {
            let coarse = linear_enclosure(half_code, 64);
            let fine = linear_enclosure(half_code, 256);
            assert!(coarse.lo <= fine.lo && fine.hi <= coarse.hi, "half-code {half_code}");
            assert!(fine.lo < fine.hi, "half-code {half_code} is irrational");
        }
    }

    #[test]
    fn the_binary32_table_is_correctly_rounded() {
        for code in 0..=255 {
            let Enclosure { lo, hi } = linear_enclosure(2 * code, 200);
            let single = |x: &BigRational| x.to_f32().expect("in range");
            assert_eq!(single(&lo), single(&hi), "code {code}: precise enough to decide");
            assert_eq!(decode_f32(code), single(&lo), "code {code}");
        }
    }
}
