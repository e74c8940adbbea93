//! How a model merges one channel of 8 bits, as integer arithmetic.
//!
//! Let s, d be codes and f, g the codes of their factors. In real numbers the sum is (s f + d g) / 255 codes, a fraction
//! with an odd denominator, so it never lies half-way between two codes: the nearest is at least 1/510 away from doubt.
//! `exact` takes in a source of s / 255 rounded to binary32, which moves the sum by less than 255 x 4 x 2^-24 = 0.00006
//! codes, and `f32` adds a rounding an operation, a few times as much: both give the nearest code. So `exact` and `f32`
//! share [`Rule::Exact`]. The tests compare all of this with the models themselves.

use crate::format::{Rounding, unorm};
use crate::model::llvmpipe::generation::Product;
use crate::model::llvmpipe::{VectorWidth, integer};

/// The rule of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rule {
    /// One rounding, of the whole sum: `exact` and `f32`.
    Exact,
    /// Each product rounded to the nearest code: `fixed:8`.
    RoundedProducts,
    /// Each product of codes by the driver's rule: a `llvmpipe`.
    Llvmpipe(Product),
}

impl Rule {
    /// A shader output or constant as the code that stands for it, if one does: models that quantise sources round, the
    /// others only know what is a code already.
    #[inline]
    #[must_use]
    pub fn code(self, x: f32) -> Option<u8> {
        if !(0.0..=1.0).contains(&x) {
            return self.code_of_outlier(x);
        }
        match self {
            Self::Llvmpipe(_) => Some(rounded_32(x)),
            Self::RoundedProducts => Some(rounded_64(x)),
            Self::Exact => Some(rounded_64(x)).filter(|code| UNIT[usize::from(*code)] == x),
        }
    }

    /// The same for numbers that are not between 0 and 1.
    fn code_of_outlier(self, x: f32) -> Option<u8> {
        /// Below any number that is too large for the driver's conversion with narrow vectors.
        const ALL_WIDTHS: f32 = 8.0e6;
        let code = match self {
            Self::Llvmpipe(_) if x > ALL_WIDTHS => return None,
            Self::Llvmpipe(_) => integer::quantize8(x, VectorWidth::Bits256),
            Self::RoundedProducts | Self::Exact => unorm::encode(f64::from(x), 8, Rounding::NearestEven),
        };
        u8::try_from(code).ok()
    }
}

/// k / 255 by code.
const UNIT: [f32; 256] = {
    let mut unit = [0.0; 256];
    let mut k = 0_u8;
    loop {
        unit[k as usize] = k as f32 / 255.0;
        if k == u8::MAX {
            break unit;
        }
        k += 1;
    }
};

/// x * 255 in binary32, to nearest even, for x in [0, 1]: a number of that size has no bits behind the point beside 2^23.
#[inline(always)]
pub(super) fn rounded_32(x: f32) -> u8 {
    let [code, ..] = (x * 255.0 + 8_388_608.0).to_bits().to_le_bytes();
    code
}

/// The real x * 255, to nearest even, for x in [0, 1].
#[inline(always)]
pub(super) fn rounded_64(x: f32) -> u8 {
    let [code, ..] = (f64::from(x) * 255.0 + 4_503_599_627_370_496.0).to_bits().to_le_bytes();
    code
}

/// Largest sum in units of 1/255 code.
const LIMIT: u16 = 255 * 255;

/// n / 255 to the nearest integer, for n up to 255 x 255.
#[inline(always)]
#[must_use]
pub fn divide(n: u16) -> u16 {
    let t = n + 128;
    (t + (t >> 8)) >> 8
}

/// [`Product::Near`] of codes, near a b / 255.
#[inline(always)]
#[must_use]
pub fn near_product(a: u8, b: u8) -> u16 {
    let t = u16::from(a) * u16::from(b);
    (t + (t >> 8) + 128) >> 8
}

/// One rule, chosen before the row begins.
pub(super) trait Arithmetic: Copy {
    /// A term in the rule's unit.
    fn product(self, x: u8, factor: u8) -> u16;
    /// The code of the sum of two terms.
    fn add(self, s: u16, d: u16) -> u8;
    /// The code of the first term less the second.
    fn subtract(self, s: u16, d: u16) -> u8;
}

/// [`Rule::Exact`].
#[derive(Clone, Copy)]
pub(super) struct Exact;

/// [`Rule::RoundedProducts`].
#[derive(Clone, Copy)]
pub(super) struct RoundedProducts;

/// [`Rule::Llvmpipe`] with [`Product::Near`]. With [`Product::Nearest`] it is [`RoundedProducts`] on codes.
#[derive(Clone, Copy)]
pub(super) struct NearProducts;

impl Arithmetic for Exact {
    #[inline(always)]
    fn product(self, x: u8, factor: u8) -> u16 {
        u16::from(x) * u16::from(factor)
    }

    #[inline(always)]
    fn add(self, s: u16, d: u16) -> u8 {
        low(divide(s.saturating_add(d).min(LIMIT)))
    }

    #[inline(always)]
    fn subtract(self, s: u16, d: u16) -> u8 {
        low(divide(s.saturating_sub(d)))
    }
}

impl Arithmetic for RoundedProducts {
    #[inline(always)]
    fn product(self, x: u8, factor: u8) -> u16 {
        divide(u16::from(x) * u16::from(factor))
    }

    #[inline(always)]
    fn add(self, s: u16, d: u16) -> u8 {
        low((s + d).min(255))
    }

    #[inline(always)]
    fn subtract(self, s: u16, d: u16) -> u8 {
        low(s.saturating_sub(d))
    }
}

impl Arithmetic for NearProducts {
    #[inline(always)]
    fn product(self, x: u8, factor: u8) -> u16 {
        near_product(x, factor)
    }

    #[inline(always)]
    fn add(self, s: u16, d: u16) -> u8 {
        low((s + d).min(255))
    }

    #[inline(always)]
    fn subtract(self, s: u16, d: u16) -> u8 {
        low(s.saturating_sub(d))
    }
}

/// A code that fits a byte.
#[inline(always)]
pub(super) fn low(code: u16) -> u8 {
    #[expect(clippy::cast_possible_truncation, reason = "every rule ends at 255 at most")]
    let byte = code as u8;
    byte
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_become_codes_as_the_models_round_them() {
        // Every 255th number from 0 to 1, all numbers around codes and ties, and outliers.
        let all = (0..=1.0_f32.to_bits()).step_by(255).map(f32::from_bits);
        let near = (0..=510_u16).flat_map(|k| {
            let bits = (f32::from(k) / 510.0).to_bits();
            (bits.saturating_sub(300)..bits + 300).map(f32::from_bits)
        });
        let outliers = [-0.0, -1.0, 1.5, 1e7, 1e30, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -f32::MIN_POSITIVE];
        for x in all.chain(near).chain(outliers) {
            let nearest = u8::try_from(unorm::encode(f64::from(x), 8, Rounding::NearestEven)).expect("8 bits");
            assert_eq!(Rule::RoundedProducts.code(x), Some(nearest), "{x:e}");
            let clamped = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
            let exact = (f32::from(nearest) / 255.0 == clamped).then_some(nearest);
            assert_eq!(Rule::Exact.code(x), exact, "{x:e}");
            let driver = [VectorWidth::Bits128, VectorWidth::Bits256].map(|width| integer::quantize8(x, width));
            match Rule::Llvmpipe(Product::Near).code(x) {
                Some(code) => assert_eq!(driver, [u32::from(code); 2], "{x:e}"),
                None => assert!(x > 1e6, "{x:e} is out of reach"),
            }
        }
    }

    #[test]
    fn division_is_to_the_nearest_for_every_sum() {
        for n in 0..=LIMIT {
            let nearest = (2 * u32::from(n) + 255) / 510;
            assert_eq!(u32::from(divide(n)), nearest, "{n} / 255");
        }
    }

    #[test]
    fn no_intermediate_overflows() {
        for a in 0..=u8::MAX {
            for b in 0..=u8::MAX {
                assert!(near_product(a, b) <= 255 && RoundedProducts.product(a, b) <= 255, "{a} x {b}");
            }
        }
    }
}
