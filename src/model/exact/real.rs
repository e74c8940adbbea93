//! Real numbers as the blend equation makes them, exactly: a + b d + c d^2 with rational a, b, c.
//!
//! Example: S + D * D on an sRGB channel that holds code 127 is S + d^2, where d = ((40 * 127 + 561) / 10761)^(12/5) is
//! irrational. No other irrational number meets d in one channel, and no equation multiplies more than two of them.
//!
//! **Equality is decided by algebra, order by precision.** On the power segment d is the fifth root of a rational that is no
//! fifth power, so 1, d and d^2 are linearly independent over the rationals: two such numbers are equal only if a, b and
//! c are. The points of the curve (codes and the thresholds between them) are such roots too, d itself among them, and no
//! other is a rational multiple of d or of d^2: roots in different classes modulo fifth powers are linearly independent,
//! and `no_two_points_share_a_class` tries all classes. Two numbers that are not equal have disjoint enclosures at some
//! precision, so that the search for it ends.

use std::cmp::Ordering;
use std::sync::LazyLock;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use crate::format::srgb::{self, Enclosure};

/// Bits of the enclosures that are tried first, and of those that stand for an irrational number where it is only shown.
const BITS: u32 = 128;

/// The 511 points of the sRGB curve, by half-code.
static POINTS: LazyLock<Vec<Enclosure>> =
    LazyLock::new(|| (0..=510).map(|h| srgb::linear_enclosure(h, BITS)).collect());

/// A point of the sRGB curve: code c is half-code 2 c, the threshold above it 2 c + 1.
fn point(half_code: u32, bits: u32) -> Enclosure {
    if bits == BITS { POINTS[half_code as usize].clone() } else { srgb::linear_enclosure(half_code, bits) }
}

/// A real number a + b d + c d^2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Real {
    /// a, b, c.
    coefficients: [BigRational; 3],
    /// The sRGB code whose linear value is d; 0 where b and c are.
    code: u32,
}

impl From<BigRational> for Real {
    fn from(a: BigRational) -> Self {
        Self { coefficients: [a, BigRational::zero(), BigRational::zero()], code: 0 }
    }
}

impl Real {
    /// numerator / denominator.
    #[must_use]
    pub fn ratio(numerator: impl Into<BigInt>, denominator: impl Into<BigInt>) -> Self {
        BigRational::new(numerator.into(), denominator.into()).into()
    }

    /// The linear value of an sRGB code, 0 to 255.
    #[must_use]
    pub fn srgb(code: u32) -> Self {
        let Enclosure { lo, hi } = point(2 * code, BITS);
        if lo == hi {
            return lo.into();
        }
        Self { coefficients: [BigRational::zero(), BigRational::one(), BigRational::zero()], code }
    }

    /// The number, where it is rational.
    #[must_use]
    pub fn rational(&self) -> Option<&BigRational> {
        let [a, b, c] = &self.coefficients;
        (b.is_zero() && c.is_zero()).then_some(a)
    }

    /// The number, or a rational less than 2^-100 away for those that the equation makes.
    #[must_use]
    pub fn near(&self) -> BigRational {
        self.rational().cloned().unwrap_or_else(|| self.enclose(BITS).lo)
    }

    /// Whether the number is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.coefficients.iter().all(Zero::is_zero)
    }

    /// The code whose linear value two numbers share.
    fn common_code(&self, other: &Self) -> u32 {
        debug_assert!(self.code == other.code || self.code == 0 || other.code == 0, "one channel has one stored code");
        self.code.max(other.code)
    }

    fn of(coefficients: [BigRational; 3], code: u32) -> Self {
        let rational = coefficients[1].is_zero() && coefficients[2].is_zero();
        Self { coefficients, code: if rational { 0 } else { code } }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let sum = std::array::from_fn(|i| &self.coefficients[i] + &other.coefficients[i]);
        Self::of(sum, self.common_code(other))
    }

    /// The number with the other sign.
    #[must_use]
    pub fn negated(&self) -> Self {
        Self { coefficients: std::array::from_fn(|i| -self.coefficients[i].clone()), code: self.code }
    }

    /// The product; the equation has none beyond d^2.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut product: [BigRational; 3] = std::array::from_fn(|_| BigRational::zero());
        for (i, x) in self.coefficients.iter().enumerate() {
            for (j, y) in other.coefficients.iter().enumerate().filter(|_| !x.is_zero()) {
                let part = x * y;
                match product.get_mut(i + j) {
                    Some(sum) => *sum += part,
                    None => debug_assert!(part.is_zero(), "the equation multiplies two operands"),
                }
            }
        }
        Self::of(product, self.common_code(other))
    }

    /// An interval that holds the number, the smaller the more bits.
    fn enclose(&self, bits: u32) -> Enclosure {
        let [a, b, c] = &self.coefficients;
        let mut sum = Enclosure { lo: a.clone(), hi: a.clone() };
        if self.rational().is_some() {
            return sum;
        }
        // d is not negative, so that d^2 grows with it.
        let d = point(2 * self.code, bits);
        let square = Enclosure { lo: &d.lo * &d.lo, hi: &d.hi * &d.hi };
        for (factor, power) in [(b, d), (c, square)] {
            let (least, most) = if factor.is_negative() { (&power.hi, &power.lo) } else { (&power.lo, &power.hi) };
            sum = Enclosure { lo: sum.lo + factor * least, hi: sum.hi + factor * most };
        }
        sum
    }

    /// How the number compares with another of its channel.
    #[must_use]
    pub fn compare(&self, other: &Self) -> Ordering {
        let difference = self.plus(&other.negated());
        if let Some(rational) = difference.rational() {
            return rational.cmp(&BigRational::zero());
        }
        let zero = Enclosure { lo: BigRational::zero(), hi: BigRational::zero() };
        until_apart(|bits| (difference.enclose(bits), zero.clone()))
    }

    /// How the number compares with a point of the sRGB curve, by half-code.
    #[must_use]
    pub fn compare_with_point(&self, half_code: u32) -> Ordering {
        let at = point(half_code, BITS);
        if at.lo == at.hi {
            return self.compare(&at.lo.into());
        }
        if half_code == 2 * self.code {
            return self.compare(&Self::srgb(self.code));
        }
        // An irrational point that is no multiple of d or d^2: never equal.
        until_apart(|bits| (self.enclose(bits), point(half_code, bits)))
    }
}

/// The order of two numbers that are not equal, from enclosures that become as fine as it takes.
fn until_apart(enclose: impl Fn(u32) -> (Enclosure, Enclosure)) -> Ordering {
    let mut bits = BITS;
    loop {
        let (x, y) = enclose(bits);
        if x.hi < y.lo {
            return Ordering::Less;
        }
        if x.lo > y.hi {
            return Ordering::Greater;
        }
        bits *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigUint;
    use num_integer::Integer;

    /// Whether p / q is the fifth power of a rational.
    fn is_fifth_power(p: &BigUint, q: &BigUint) -> bool {
        let gcd = p.gcd(q);
        [p / &gcd, q / &gcd].iter().all(|n| n.nth_root(5).pow(5) == *n)
    }

    /// The point of half-code h is (x / 10761)^(12/5) with x = 20 h + 561: a fifth root of x^12 / 10761^12, whose class
    /// modulo fifth powers is that of (x / 10761)^2. Squares of classes differ where classes do, 2 and 5 being coprime.
    #[test]
    fn no_two_points_share_a_class() {
        let one = BigUint::from(10761_u32);
        let points: Vec<u32> = (srgb::LAST_LINEAR_HALF_CODE + 1..=509).collect();
        let x = |half_code: u32| BigUint::from(20 * half_code + 561);
        for &code in points.iter().filter(|h| *h % 2 == 0) {
            let d = x(code);
            // d is irrational, and so is d^2; d and d^2 are in different classes, or d would be rational.
            assert!(!is_fifth_power(&d, &one), "code point {code}");
            for &h in &points {
                assert!(!is_fifth_power(&x(h), &one), "point {h} is irrational");
                assert_eq!(is_fifth_power(&x(h), &d), h == code, "point {h} and {code}");
                // (x / 10761) / (d / 10761)^2 = x 10761 / d^2.
                assert!(!is_fifth_power(&(x(h) * &one), &(&d * &d)), "point {h} and the square of {code}");
            }
        }
    }

    #[test]
    fn sums_that_cancel_are_equal_and_not_merely_close() {
        let (one, d) = (Real::ratio(1, 1), Real::srgb(127));
        // S (1 - D) + D with S = 1.
        let kept = one.times(&one.plus(&d.negated())).plus(&d);
        assert_eq!(kept, one, "d cancels");
        let twice = d.plus(&d).times(&Real::ratio(1, 2));
        assert_eq!(twice.compare_with_point(254), Ordering::Equal, "the code itself");
        let close = d.plus(&Real::ratio(1, BigInt::one() << 400_u32));
        assert_eq!(close.compare_with_point(254), Ordering::Greater, "2^-400 above it");
        assert_eq!(close.negated().compare(&d.negated()), Ordering::Less, "and below its negative");
    }

    #[test]
    fn products_and_squares_lie_where_binary64_has_them() {
        for code in [0_u32, 5, 11, 100, 254, 255] {
            let value = srgb::decode(code).value;
            let square = Real::srgb(code).times(&Real::srgb(code));
            for (h, point) in (0..=510).map(|h| (h, srgb::approximate(h, 510).value)) {
                let expected = (value * value).total_cmp(&point);
                if (value * value - point).abs() > 1e-12 {
                    assert_eq!(square.compare_with_point(h), expected, "code {code}, point {h}");
                }
            }
        }
    }
}
