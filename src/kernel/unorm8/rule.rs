//! How a model merges one channel of 8 bits, as integer arithmetic.
//!
//! Let s, d be codes and f, g the codes of their factors. In real numbers the sum is (s f + d g) / 255 codes, a fraction
//! with an odd denominator, so it never lies half-way between two codes: the nearest is at least 1/510 away from doubt.
//! `exact` takes in a source of s / 255 rounded to binary32, which moves the sum by less than 255 x 4 x 2^-24 = 0.00006
//! codes, and `f32` adds a rounding an operation, a few times as much: both give the nearest code. So `exact` and `f32`
//! share [`Rule::Exact`]. The tests compare all of this with the models themselves.

/// The rule of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rule {
    /// One rounding, of the whole sum: `exact` and `f32`.
    Exact,
    /// Each product rounded to the nearest code: `fixed:8`.
    RoundedProducts,
    /// Each product by (t + (t >> 8) + 128) >> 8: `llvmpipe`.
    Llvmpipe,
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

/// llvmpipe's product, near a b / 255.
#[inline(always)]
#[must_use]
pub fn llvmpipe_product(a: u8, b: u8) -> u16 {
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

/// [`Rule::Llvmpipe`].
#[derive(Clone, Copy)]
pub(super) struct Llvmpipe;

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

impl Arithmetic for Llvmpipe {
    #[inline(always)]
    fn product(self, x: u8, factor: u8) -> u16 {
        llvmpipe_product(x, factor)
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
                assert!(llvmpipe_product(a, b) <= 255 && RoundedProducts.product(a, b) <= 255, "{a} x {b}");
            }
        }
    }
}
