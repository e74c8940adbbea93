//! Alpha to coverage: which samples may be left.
//!
//! Sources: Vulkan, *Multisample Coverage*; D3D11.3 17.18; WebGPU, *Rendering Operations*.

use super::{Api, Class, Spec, Verdict};

/// The verdict on the samples `got` that alpha to coverage left of `covered` (bit i = sample i).
///
/// Alpha <= 0 leaves none and alpha >= 1 all; between them any subset conforms. NaN leaves none in D3D and is undefined
/// elsewhere.
#[must_use]
pub fn judge_coverage(spec: Spec, alpha: f32, covered: u32, got: u32) -> Verdict {
    let by = |api: &Api| match (alpha, api) {
        (x, Api::Vulkan) if x.is_nan() => Verdict::Undefined,
        (x, Api::D3d) if x.is_nan() => exactly(got, 0),
        (x, _) if x <= 0.0 => exactly(got, 0),
        (x, _) if x >= 1.0 => exactly(got, covered),
        _ if got & !covered == 0 => Verdict::Within(Class::Exact),
        _ => Verdict::Outside,
    };
    spec.apis().iter().map(by).reduce(Verdict::or).unwrap_or(Verdict::Undefined)
}

fn exactly(got: u32, wanted: u32) -> Verdict {
    if got == wanted { Verdict::Within(Class::Exact) } else { Verdict::Outside }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_ends_are_fixed() {
        for spec in Spec::ALL {
            let judge = |alpha, got| judge_coverage(spec, alpha, 0b1110, got);
            assert_eq!(judge(0.0, 0), Verdict::Within(Class::Exact), "{spec}: none at 0");
            assert_eq!(judge(-1.0, 0b0010), Verdict::Outside, "{spec}: one sample below 0");
            assert_eq!(judge(1.0, 0b1110), Verdict::Within(Class::Exact), "{spec}: all at 1");
            assert_eq!(judge(1.0, 0b0110), Verdict::Outside, "{spec}: one missing at 1");
            assert_eq!(judge(0.5, 0b1000), Verdict::Within(Class::Exact), "{spec}: any subset between");
            assert_eq!(judge(0.5, 0b0001), Verdict::Outside, "{spec}: a sample that was not covered");
        }
    }

    #[test]
    fn nan_leaves_nothing_in_d3d_and_is_undefined_elsewhere() {
        assert_eq!(judge_coverage(Spec::D3d, f32::NAN, 15, 0), Verdict::Within(Class::Exact), "none");
        assert_eq!(judge_coverage(Spec::D3d, f32::NAN, 15, 1), Verdict::Outside, "one");
        assert_eq!(judge_coverage(Spec::Vulkan, f32::NAN, 15, 1), Verdict::Undefined, "silent");
    }
}
