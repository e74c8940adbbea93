//! Depth and stencil: conversion, clamp, comparison and what may be stored.
//!
//! Stencil is exact in every text. Depth: D3D and WebGPU clamp to the viewport's range, D3D rounds a unorm code by
//! "add 0.5 and cut", Vulkan takes either neighbour and does not say whether the fragment's depth is compared before or
//! after its conversion. Sources: Vulkan, *Fragment Operations / Depth Test, Stencil Test*; D3D11.3 17.9 to 17.11.

use wgpu_types::DepthStencilState;

use super::real::Real;
use super::span::Span;
use super::store::{CodeSet, Store, store};
use super::{Api, Class, Judge, Verdict};
use crate::format::depth::{DepthFormat, DepthKind};
use crate::format::{ChannelKind, FloatLayout};
use crate::merger::depth_stencil::{DepthStencil, stencil_after, stencil_passes};
use crate::merger::discard::compare;

/// One sample that meets depth and stencil tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthStencilCase<'a> {
    /// The state.
    pub state: &'a DepthStencilState,
    /// The target's format.
    pub format: DepthFormat,
    /// Whether the fragment is front-facing.
    pub front_facing: bool,
    /// The stencil reference.
    pub reference: u32,
    /// The fragment's depth.
    pub z: f32,
    /// The viewport's depth range.
    pub range: [f32; 2],
    /// What the sample holds before.
    pub stored: DepthStencil,
}

/// The channel a depth code is like.
#[must_use]
pub fn channel_kind(kind: DepthKind) -> ChannelKind {
    match kind {
        DepthKind::Unorm(bits) => ChannelKind::Unorm(bits),
        DepthKind::Float32 => ChannelKind::Float(FloatLayout::SINGLE),
    }
}

/// The codes a fragment's depth may be converted to, clamped to `range` first.
///
/// Vulkan (through WebGPU, which always clamps): either neighbour; NaN is undefined. D3D: the nearest, ties up; NaN is
/// the range's lower end. Binary32 depth is stored as it is, with either zero; denormals may be flushed, as a shader's
/// results may be in both.
#[must_use]
pub fn depth_codes(api: Api, kind: DepthKind, z: f32, range: [f32; 2]) -> CodeSet {
    if z.is_nan() && api == Api::Vulkan {
        return CodeSet::anything();
    }
    match (kind, api) {
        (DepthKind::Unorm(_), Api::Vulkan) => {
            let clamped = z.max(range[0]).min(range[1]).clamp(0.0, 1.0);
            store(&Span::point(Real::exact(f64::from(clamped))), channel_kind(kind), Store::Neighbours)
        }
        _ => {
            let code = kind.encode(z, range);
            let mut set = CodeSet::only(channel_kind(kind), code);
            if kind == DepthKind::Float32 && f32::from_bits(code).is_subnormal() {
                set.unite(CodeSet::only(channel_kind(kind), 0));
            }
            set.with_both_zeros(channel_kind(kind))
        }
    }
}

impl DepthStencilCase<'_> {
    /// Whether the sample may hold `got` afterwards, by one text.
    fn admits(&self, api: Api, got: DepthStencil) -> bool {
        let face = if self.front_facing { &self.state.stencil.front } else { &self.state.stencil.back };
        let stencil_passed = !self.format.has_stencil()
            || stencil_passes(&self.state.stencil, face, self.reference, self.stored.stencil);
        let stencil_for = |depth_passed| {
            if !self.format.has_stencil() {
                return self.stored.stencil;
            }
            let outcomes = (stencil_passed, depth_passed);
            stencil_after(&self.state.stencil, face, self.reference, self.stored.stencil, outcomes)
        };
        let Some(kind) = self.format.depth() else { return got.stencil == stencil_for(true) };
        let function = self.state.depth_compare.unwrap_or_default();
        let writes = self.state.depth_write_enabled == Some(true);
        let codes = depth_codes(api, kind, self.z, self.range);
        let same_depth = |a: u32, b: u32| CodeSet::only(channel_kind(kind), a).contains(channel_kind(kind), b);
        let kept = same_depth(self.stored.depth, got.depth);
        let agrees = |passed: bool, code: u32| {
            let written = passed && stencil_passed && writes;
            got.stencil == stencil_for(passed) && if written { same_depth(code, got.depth) } else { kept }
        };
        codes.codes(channel_kind(kind), 4).into_iter().any(|code| {
            let converted = match kind {
                DepthKind::Unorm(_) => compare(function, &code, &self.stored.depth),
                DepthKind::Float32 => compare(function, &f32::from_bits(code), &f32::from_bits(self.stored.depth)),
            };
            let clamped = f64::from(self.z.max(self.range[0]).min(self.range[1]));
            let unconverted = compare(function, &clamped, &kind.value(self.stored.depth));
            agrees(converted, code) || (api == Api::Vulkan && agrees(unconverted, code))
        })
    }
}

/// The verdict on what a sample holds after the tests. Conforming results are exact: there are no classes here.
#[must_use]
pub fn judge_depth_stencil(judge: &Judge, case: &DepthStencilCase<'_>, got: DepthStencil) -> Verdict {
    let undefined = |api: &Api| *api == Api::Vulkan && case.z.is_nan() && case.format.depth().is_some();
    let by = |api: &Api| match () {
        () if undefined(api) => Verdict::Undefined,
        () if case.admits(*api, got) => Verdict::Within(Class::Exact),
        () => Verdict::Outside,
    };
    judge.spec.apis().iter().map(by).reduce(Verdict::or).unwrap_or(Verdict::Undefined)
}

#[cfg(test)]
mod tests {
    use super::super::Spec;
    use super::*;
    use wgpu_types::{CompareFunction, StencilFaceState, StencilOperation, StencilState, TextureFormat};

    const FULL: [f32; 2] = [0.0, 1.0];

    #[test]
    fn vulkan_takes_either_neighbour_and_d3d_the_nearest() {
        let kind = DepthKind::Unorm(16);
        let codes = |api, z| depth_codes(api, kind, z, FULL).codes(ChannelKind::Unorm(16), 9);
        assert_eq!(codes(Api::Vulkan, 0.5), [32767, 32768], "a tie");
        assert_eq!(codes(Api::D3d, 0.5), [32768], "ties up");
        assert_eq!(codes(Api::Vulkan, 1.0), [65535], "one is exact");
        assert_eq!(codes(Api::Vulkan, -3.0), [0], "clamped");
        assert_eq!(codes(Api::D3d, f32::NAN), [0], "NaN");
        assert!(depth_codes(Api::Vulkan, kind, f32::NAN, FULL).is_undefined(), "NaN");
    }

    fn state(compare: CompareFunction) -> DepthStencilState {
        let face = StencilFaceState {
            compare: CompareFunction::Always,
            fail_op: StencilOperation::Keep,
            depth_fail_op: StencilOperation::Invert,
            pass_op: StencilOperation::Replace,
        };
        DepthStencilState {
            format: TextureFormat::Depth24PlusStencil8,
            depth_write_enabled: Some(true),
            depth_compare: Some(compare),
            stencil: StencilState { front: face, back: face, read_mask: 255, write_mask: 255 },
            bias: wgpu_types::DepthBiasState::default(),
        }
    }

    #[test]
    fn stencil_must_follow_the_depth_that_was_stored() {
        let state = state(CompareFunction::Less);
        let format = DepthFormat::new(state.format).expect("depth");
        let stored = DepthStencil { depth: 100, stencil: 0x0f };
        let z = 0.25;
        let case = DepthStencilCase { state: &state, format, front_facing: true, reference: 7, z, range: FULL, stored };
        // 0.25 is far beyond code 100: the test fails, and the stencil value is inverted.
        for spec in Spec::ALL {
            let judge = |got| judge_depth_stencil(&Judge::new(spec), &case, got);
            assert_eq!(judge(DepthStencil { depth: 100, stencil: 0xf0 }), Verdict::Within(Class::Exact), "{spec}");
            assert_eq!(judge(DepthStencil { depth: 100, stencil: 7 }), Verdict::Outside, "{spec}: passed, not written");
            assert_eq!(judge(DepthStencil { depth: 101, stencil: 0xf0 }), Verdict::Outside, "{spec}: written");
        }
    }

    #[test]
    fn vulkan_may_compare_before_or_after_the_conversion() {
        let state = state(CompareFunction::Equal);
        let format = DepthFormat::new(state.format).expect("depth");
        // Not a code's value: equal to the stored code only once it is converted.
        let z = 0.3;
        let code = DepthKind::Unorm(24).encode(z, FULL);
        let stored = DepthStencil { depth: code, stencil: 1 };
        let case = DepthStencilCase { state: &state, format, front_facing: true, reference: 7, z, range: FULL, stored };
        let judge =
            |spec, stencil| judge_depth_stencil(&Judge::new(spec), &case, DepthStencil { depth: code, stencil });
        assert_eq!(judge(Spec::D3d, 7), Verdict::Within(Class::Exact), "converted first");
        assert_eq!(judge(Spec::D3d, !1), Verdict::Outside, "not converted");
        assert_eq!(judge(Spec::Vulkan, 7), Verdict::Within(Class::Exact), "converted first");
        assert_eq!(judge(Spec::Vulkan, !1), Verdict::Within(Class::Exact), "not converted");
    }
}
