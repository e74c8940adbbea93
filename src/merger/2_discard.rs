//! Stage 2: fragments that end here: the shader's discard, the fixed-function alpha test, alpha to coverage.
//!
//! A fragment that ends here leaves no trace in color, depth or stencil. Sources: Vulkan, *Fragment Operations*
//! (order of tests; multisample coverage); OpenGL 2.1 4.1.4 and Direct3D 9 `D3DRS_ALPHATESTENABLE` for the alpha test.

use wgpu_types::{CompareFunction, MultisampleState};

use crate::state::AlphaTest;

/// `left compare right` as IEEE 754 numbers: with a NaN, everything but not-equal and always is false.
#[must_use]
pub fn compare<T: PartialOrd>(function: CompareFunction, left: &T, right: &T) -> bool {
    match function {
        CompareFunction::Never => false,
        CompareFunction::Less => left < right,
        CompareFunction::Equal => left == right,
        CompareFunction::LessEqual => left <= right,
        CompareFunction::Greater => left > right,
        CompareFunction::NotEqual => left != right,
        CompareFunction::GreaterEqual => left >= right,
        CompareFunction::Always => true,
    }
}

impl AlphaTest {
    /// Whether a fragment with this alpha lives.
    #[must_use]
    pub fn passes(self, alpha: f32) -> bool {
        match self {
            Self::Off => true,
            Self::On { compare: function, reference } => compare(function, &alpha, &reference),
        }
    }
}

/// The samples alpha to coverage keeps, as a mask to AND with the coverage.
///
/// Specs fix only the ends: alpha <= 0 (and NaN, D3D11.3 17.18) keeps none, alpha >= 1 all. Between them this model
/// keeps the first round(alpha * count) samples, ties up; any pattern with a roughly proportional count conforms.
#[must_use]
pub fn alpha_to_coverage(multisample: &MultisampleState, alpha: f32) -> u32 {
    if !multisample.alpha_to_coverage_enabled {
        return u32::MAX;
    }
    let count = multisample.count.clamp(1, 32);
    // The number of thresholds (i + 0.5) / count that alpha reaches; products of small integers and f32 are exact in f64.
    let kept = (0..count).filter(|&i| f64::from(alpha) * f64::from(2 * count) >= f64::from(2 * i + 1)).count();
    (0..kept).fold(0, |mask, i| mask | 1 << i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_test_compares_alpha_on_the_left() {
        let test = |compare| AlphaTest::On { compare, reference: 0.5 };
        assert!(test(CompareFunction::Greater).passes(0.6), "0.6 > 0.5");
        assert!(!test(CompareFunction::Greater).passes(0.5), "0.5 > 0.5");
        assert!(test(CompareFunction::GreaterEqual).passes(0.5), "0.5 >= 0.5");
        assert!(test(CompareFunction::LessEqual).passes(0.5), "0.5 <= 0.5");
        assert!(test(CompareFunction::Less).passes(0.4), "0.4 < 0.5");
        assert!(test(CompareFunction::Equal).passes(0.5), "0.5 == 0.5");
        assert!(test(CompareFunction::NotEqual).passes(0.4), "0.4 != 0.5");
        assert!(test(CompareFunction::Always).passes(f32::NAN), "always");
        assert!(!test(CompareFunction::Never).passes(0.5), "never");
        assert!(AlphaTest::Off.passes(-1.0), "off");
    }

    #[test]
    fn nan_alpha_passes_only_not_equal_and_always() {
        use CompareFunction as C;
        for function in [C::Never, C::Less, C::Equal, C::LessEqual, C::Greater, C::GreaterEqual] {
            assert!(!compare(function, &f32::NAN, &0.5), "{function:?}");
        }
        assert!(compare(C::NotEqual, &f32::NAN, &0.5), "NaN != x");
    }

    #[test]
    fn alpha_to_coverage_is_empty_at_zero_full_at_one_and_grows() {
        let state = MultisampleState { count: 4, mask: !0, alpha_to_coverage_enabled: true };
        let counts = [0.0, -1.0, f32::NAN, 0.2, 0.5, 0.8, 1.0, 7.0].map(|a| alpha_to_coverage(&state, a).count_ones());
        assert_eq!(counts, [0, 0, 0, 1, 2, 3, 4, 4], "samples kept");
    }
}
