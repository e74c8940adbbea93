//! The law of 8-bit premultiplied storage, for every color and alpha.
//!
//! With p = round(c a / 255) and the recovered r = round(255 p / a):
//!
//! - p takes the a + 1 values 0 to a, so log2(256 / (a + 1)) bits are lost;
//! - c a / 255 is never half-way between integers (2 c a is even, 255 (2 p + 1) odd), so |c a - 255 p| <= 127, and the
//!   color is missed by at most 127 / a before and floor(127 / a + 1/2) codes after rounding;
//! - every alpha has a color that is missed by that much (found by trying all of them, see the tests).

/// Distinct colors left at this alpha, of 256.
#[must_use]
pub fn levels(alpha: u8) -> u32 {
    u32::from(alpha) + 1
}

/// Bits lost of a channel's 8: 8 - log2([`levels`]).
#[must_use]
pub fn bits_lost(alpha: u8) -> f64 {
    8.0 - f64::from(levels(alpha)).log2()
}

/// The largest error of a recovered color, in codes; 255 at alpha 0, where nothing is left.
#[must_use]
pub fn worst_error(alpha: u8) -> u32 {
    match u32::from(alpha) {
        0 => 255,
        // floor(127 / a + 1/2)
        a => (254 + a) / (2 * a),
    }
}

/// The stored code: round(c a / 255), never a tie.
#[must_use]
pub fn premultiply(color: u8, alpha: u8) -> u8 {
    let product = u32::from(color) * u32::from(alpha);
    // At most 255.
    u8::try_from((2 * product + 255) / 510).unwrap_or(u8::MAX)
}

/// The recovered code: round(255 p / a), ties up, at most 255; 0 at alpha 0.
#[must_use]
pub fn unpremultiply(stored: u8, alpha: u8) -> u8 {
    let (p, a) = (u32::from(stored), u32::from(alpha));
    if a == 0 {
        return 0;
    }
    u8::try_from((510 * p + a) / (2 * a)).unwrap_or(u8::MAX)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_formulas_agree_with_all_65_536_pairs() {
        for alpha in 0..=255_u8 {
            let stored: BTreeSet<u8> = (0..=255).map(|color| premultiply(color, alpha)).collect();
            assert_eq!(stored.len(), levels(alpha) as usize, "levels at alpha {alpha}");
            let error = |color: u8| u32::from(unpremultiply(premultiply(color, alpha), alpha).abs_diff(color));
            let worst = (0..=255).map(error).max().expect("256 colors");
            assert_eq!(worst, worst_error(alpha), "worst error at alpha {alpha}");
        }
    }

    #[test]
    fn premultiplying_rounds_to_nearest_and_never_meets_a_tie() {
        for (color, alpha) in (0..=255_u8).flat_map(|c| (0..=255_u8).map(move |a| (c, a))) {
            let product = i32::from(color) * i32::from(alpha);
            let miss = product - 255 * i32::from(premultiply(color, alpha));
            assert!(miss.abs() <= 127, "{color} * {alpha}: off by {miss} / 255 of a code");
        }
    }

    #[test]
    fn stored_codes_survive_another_round_trip() {
        for (color, alpha) in (0..=255_u8).flat_map(|c| (1..=255_u8).map(move |a| (c, a))) {
            let stored = premultiply(color, alpha);
            assert_eq!(premultiply(unpremultiply(stored, alpha), alpha), stored, "{color} at alpha {alpha}");
        }
    }

    #[test]
    fn only_full_alpha_loses_nothing() {
        assert_eq!((levels(255), worst_error(255)), (256, 0), "full alpha");
        assert_eq!(worst_error(254), 1, "one step below");
        assert_eq!((worst_error(1), worst_error(2), worst_error(3)), (127, 64, 42), "faint texels");
        assert_eq!(bits_lost(0), 8.0, "everything");
        assert_eq!(bits_lost(127), 1.0, "half of the codes");
    }
}
