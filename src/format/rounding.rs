//! Rounding a real number to an integer: the modes, and the one place where they are applied.

use std::cmp::Ordering;

/// How a number between two representable ones is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Rounding {
    /// To the nearest; ties to the even code (IEEE 754's default).
    #[default]
    NearestEven,
    /// To the nearest; ties away from zero (D3D's "add 0.5 and truncate").
    NearestAway,
    /// Toward zero.
    TowardZero,
}

impl Rounding {
    /// Rounds `floor + fraction` (magnitudes), the fraction given by how it compares with a half.
    ///
    /// `exact` says that the fraction is zero; `half` is then ignored.
    #[must_use]
    pub fn round_up(self, floor_is_odd: bool, exact: bool, half: Ordering) -> bool {
        if exact {
            return false;
        }
        match (self, half) {
            (Self::TowardZero, _) | (_, Ordering::Less) => false,
            (_, Ordering::Greater) => true,
            (Self::NearestEven, Ordering::Equal) => floor_is_odd,
            (Self::NearestAway, Ordering::Equal) => true,
        }
    }

    /// `magnitude / 2^shift`, rounded.
    #[must_use]
    pub fn shift_right(self, magnitude: u128, shift: u32) -> u128 {
        if shift == 0 {
            return magnitude;
        }
        if shift > 127 {
            // Below 2^127 the quotient is under a half: only the magnitudes that reach the top bit could differ,
            // and no caller's do.
            return 0;
        }
        let floor = magnitude >> shift;
        let rest = magnitude & ((1 << shift) - 1);
        let up = self.round_up(floor & 1 == 1, rest == 0, rest.cmp(&(1 << (shift - 1))));
        floor + u128::from(up)
    }
}

/// A finite number as `magnitude * 2^exponent` with an integer magnitude below 2^53, and its sign.
#[must_use]
pub(crate) fn decompose(x: f64) -> (bool, u128, i32) {
    let bits = x.to_bits();
    let exponent = i32::try_from((bits >> 52) & 0x7ff).expect("eleven bits fit");
    let mantissa = u128::from(bits & ((1 << 52) - 1));
    let negative = x.is_sign_negative();
    if exponent == 0 { (negative, mantissa, -1074) } else { (negative, mantissa | (1 << 52), exponent - 1075) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_where_the_mode_says() {
        for (mode, expected) in [
            (Rounding::NearestEven, [0, 2, 2, 4]),
            (Rounding::NearestAway, [1, 2, 3, 4]),
            (Rounding::TowardZero, [0, 1, 2, 3]),
        ] {
            let rounded = [1, 3, 5, 7].map(|halves| mode.shift_right(halves, 1));
            assert_eq!(rounded, expected, "{mode:?}: 0.5, 1.5, 2.5, 3.5");
        }
    }

    #[test]
    fn nearest_looks_at_every_bit() {
        assert_eq!(Rounding::NearestEven.shift_right((1 << 100) + 1, 101), 1, "just above a half");
        assert_eq!(Rounding::NearestEven.shift_right((1 << 100) - 1, 101), 0, "just below a half");
    }

    #[test]
    fn decompose_is_exact() {
        for x in [0.0, 1.0, -0.75, f64::MIN_POSITIVE / 4.0, f64::MAX, 1.2e-7] {
            let (negative, magnitude, exponent) = decompose(x);
            let sign = if negative { -1.0 } else { 1.0 };
            #[expect(clippy::cast_precision_loss, reason = "the magnitude is below 2^53")]
            let mut again = sign * magnitude as f64;
            let mut left = exponent;
            while left != 0 {
                let step = left.clamp(-1000, 1000);
                again *= 2.0_f64.powi(step);
                left -= step;
            }
            assert_eq!(again.to_bits(), x.to_bits(), "{x}");
        }
    }
}
