//! How a fixed-point blender rounds a product of two codes.

use crate::format::{Rounding, unorm};

/// Rounding of a product.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ProductRounding {
    /// Nearest; N is odd for the usual widths, so ties do not occur between equal widths.
    #[default]
    Nearest,
    /// Toward zero.
    Truncate,
    /// `(a * b) >> n`: treats N as 2^n, so full times full loses a code.
    Shift,
    /// `(a * b + (a * b >> n) + 2^(n-1)) >> n`: llvmpipe's; off from nearest for 24 of 65,536 pairs at 8 bits.
    ShiftTwice,
    /// `(a * (b + (b >> (n-1)))) >> n`: the factor stretched to 0..=2^n.
    Stretch,
}

impl ProductRounding {
    /// Every member.
    pub const ALL: [Self; 5] = [Self::Nearest, Self::Truncate, Self::Shift, Self::ShiftTwice, Self::Stretch];

    /// The name used in model specifications.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Truncate => "truncate",
            Self::Shift => "shift",
            Self::ShiftTwice => "shift-twice",
            Self::Stretch => "stretch",
        }
    }

    /// The code, of `bits` bits, of (x / x_den) * (f / f_den).
    ///
    /// The shift members work on codes of `bits` bits; operands of another width are rescaled to it first.
    pub(super) fn product(self, x: i128, x_den: i128, f: i128, f_den: i128, bits: u32) -> i128 {
        let steps = i128::from(unorm::steps(bits));
        let scaled = |n: i128, den: i128| -> i128 {
            if den == steps { n } else { divide(n * steps, den, Rounding::NearestEven) }
        };
        match self {
            Self::Nearest => divide(x * f * steps, x_den * f_den, Rounding::NearestEven),
            Self::Truncate => divide(x * f * steps, x_den * f_den, Rounding::TowardZero),
            Self::Shift => (scaled(x, x_den) * scaled(f, f_den)) >> bits,
            Self::ShiftTwice => {
                let t = scaled(x, x_den) * scaled(f, f_den);
                (t + (t >> bits) + (1 << (bits - 1))) >> bits
            }
            Self::Stretch => {
                let f = scaled(f, f_den);
                (scaled(x, x_den) * (f + (f >> (bits - 1)))) >> bits
            }
        }
    }
}

/// n / d for n >= 0, d > 0.
fn divide(n: i128, d: i128, rounding: Rounding) -> i128 {
    let (floor, rest) = (n / d, n % d);
    floor + i128::from(rounding.round_up(floor % 2 == 1, rest == 0, (2 * rest).cmp(&d)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product8(rounding: ProductRounding, a: i128, b: i128) -> i128 {
        rounding.product(a, 255, b, 255, 8)
    }

    #[test]
    fn members_differ_where_their_formulas_do() {
        assert_eq!(product8(ProductRounding::Nearest, 255, 255), 255, "one times one");
        assert_eq!(product8(ProductRounding::Shift, 255, 255), 254, "65025 >> 8");
        assert_eq!(product8(ProductRounding::Stretch, 255, 255), 255, "255 * 256 >> 8");
        assert_eq!(product8(ProductRounding::Truncate, 255, 254), 254, "exact");
        assert_eq!(product8(ProductRounding::Truncate, 128, 127), 63, "63.75 truncated");
        assert_eq!(product8(ProductRounding::Nearest, 128, 127), 64, "63.75 rounded");
    }

    #[test]
    fn shift_twice_misses_nearest_for_24_pairs_of_8_bit_codes() {
        let pairs = (0..256).flat_map(|a| (0..256).map(move |b| (a, b)));
        let misses = pairs
            .filter(|&(a, b)| product8(ProductRounding::ShiftTwice, a, b) != product8(ProductRounding::Nearest, a, b))
            .count();
        assert_eq!(misses, 24, "of 65,536");
    }
}
