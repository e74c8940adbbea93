//! The depth test. Sources: V, *Depth Test*; D 17.9-17.11; W, *Depth/stencil state*.

use outmerge::format::depth::DepthKind;
use outmerge::fragment::Fragment;
use outmerge::merger::{Fate, Merger};
use outmerge::model::registry;
use outmerge::state::MergerState;
use outmerge::target::{Extent, Framebuffer};
use wgpu_types::{
    CompareFunction as C, DepthBiasState, DepthStencilState, StencilFaceState, StencilState, TextureFormat as T,
};

use crate::texel::model;

const FORMATS: [T; 3] = [T::Depth16Unorm, T::Depth24Plus, T::Depth32Float];

fn state(format: T, compare: C, write: bool) -> MergerState {
    MergerState {
        targets: vec![Some(T::Rgba8Unorm.into())],
        depth_stencil: Some(DepthStencilState {
            format,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: StencilState::default(),
            bias: DepthBiasState::default(),
        }),
        ..MergerState::default()
    }
}

/// Whether a fragment at `z` passes over what fragments at `before` left, and the depth stored afterwards.
fn test(state: &MergerState, before: f32, z: f32) -> (bool, u32) {
    let mut targets = Framebuffer::for_state(Extent::new(1, 1).expect("a texel"), state).expect("targets");
    let model = model("exact");
    let kind = targets.depth_stencil.as_ref().and_then(|target| target.format().depth()).expect("a depth aspect");
    let stored = model.depth_code(kind, before, [0.0, 1.0]);
    targets.depth_stencil.as_mut().expect("depth").depth_mut()[0] = stored;
    let merger = Merger::new(state, &*model, &targets).expect("a merger");
    let trace = merger.trace(&Fragment::new([1.0; 4]).at_depth(z), 0, 0, &mut targets);
    (trace.samples[0].fate == Fate::Merged, targets.depth_stencil.expect("depth").depth()[0])
}

#[test]
fn the_fragment_is_on_the_left_of_the_comparison() {
    // (less, equal, greater) fragments against the stored value.
    let table = [
        (C::Never, [false; 3]),
        (C::Less, [true, false, false]),
        (C::Equal, [false, true, false]),
        (C::LessEqual, [true, true, false]),
        (C::Greater, [false, false, true]),
        (C::NotEqual, [true, false, true]),
        (C::GreaterEqual, [false, true, true]),
        (C::Always, [true; 3]),
    ];
    for format in FORMATS {
        for (compare, expected) in table {
            let got = [0.25, 0.5, 0.75].map(|z| test(&state(format, compare, false), 0.5, z).0);
            assert_eq!(got, expected, "{compare:?} on {format:?}");
        }
    }
}

/// Uploaded depth may hold anything; float depth compares as numbers (V: "floating-point comparison"), not as bits.
#[test]
fn float_depth_compares_as_numbers() {
    let passes = |compare, stored: f32, z: f32| {
        let state = state(T::Depth32Float, compare, false);
        let mut targets = Framebuffer::for_state(Extent::new(1, 1).expect("a texel"), &state).expect("targets");
        targets.depth_stencil.as_mut().expect("depth").depth_mut()[0] = stored.to_bits();
        let model = model("exact");
        let merger = Merger::new(&state, &*model, &targets).expect("a merger");
        let trace = merger.trace(&Fragment::new([1.0; 4]).at_depth(z), 0, 0, &mut targets);
        trace.samples[0].fate == Fate::Merged
    };
    assert!(passes(C::Equal, -0.0, 0.0), "-0 equals +0");
    assert!(!passes(C::Less, -0.0, 0.0) && !passes(C::Less, 0.0, -0.0), "neither zero is less");
    assert!(passes(C::Greater, -0.5, 0.25), "negative numbers are less, though their bits are not");
    for compare in [C::Less, C::LessEqual, C::Equal, C::GreaterEqual, C::Greater] {
        assert!(!passes(compare, f32::NAN, 0.5), "{compare:?} with NaN is false");
    }
    assert!(passes(C::NotEqual, f32::NAN, 0.5), "except not-equal");
}

#[test]
fn depth_is_clamped_to_the_viewport_range_before_the_test() {
    for format in FORMATS {
        assert!(test(&state(format, C::Equal, false), 1.0, 7.0).0, "7 is 1 on {format:?}");
        assert!(test(&state(format, C::Equal, false), 0.0, -7.0).0, "-7 is 0 on {format:?}");
        let mut narrow = state(format, C::Equal, false);
        narrow.dynamic.depth_range = [0.25, 0.75];
        assert!(test(&narrow, 0.75, 1.0).0 && test(&narrow, 0.25, 0.0).0, "to the viewport's range on {format:?}");
    }
}

#[test]
fn nan_depth_becomes_the_minimum() {
    for format in FORMATS {
        let mut narrow = state(format, C::Equal, false);
        narrow.dynamic.depth_range = [0.25, 0.75];
        assert!(test(&narrow, 0.25, f32::NAN).0, "min(max, max(min, NaN)) on {format:?} (D 17.10)");
    }
}

#[test]
fn unorm_depth_is_converted_before_comparing() {
    // Two depths that store as one code are equal, not less.
    let near = 0.5_f32 + 1.0 / 1_048_576.0;
    assert!(!test(&state(T::Depth16Unorm, C::Less, true), near, 0.5).0, "the same code of 16 bits");
    assert!(test(&state(T::Depth32Float, C::Less, true), near, 0.5).0, "but different numbers");
}

#[test]
fn an_equal_retest_of_the_same_depth_passes_in_every_model() {
    for model in registry::every_generation() {
        for kind in [DepthKind::Unorm(16), DepthKind::Unorm(24), DepthKind::Float32] {
            for i in 0..=1000_u32 {
                let z = i as f32 / 1000.0;
                let (code, again) = (model.depth_code(kind, z, [0.0, 1.0]), model.depth_code(kind, z, [0.0, 1.0]));
                assert_eq!(code, again, "{}: {z}", model.name());
            }
        }
    }
}

#[test]
fn unorm_depth_rounds_to_nearest() {
    for (kind, steps) in [(DepthKind::Unorm(16), 65_535.0), (DepthKind::Unorm(24), 16_777_215.0)] {
        for i in 0..=10_000_u32 {
            let z = i as f32 / 10_000.0;
            let code = f64::from(model("exact").depth_code(kind, z, [0.0, 1.0]));
            assert!((f64::from(z) * steps - code).abs() <= 0.5, "{z} as {code} of {steps}");
        }
    }
}

#[test]
fn a_failed_fragment_writes_neither_depth_nor_color() {
    for format in FORMATS {
        let (passed, stored) = test(&state(format, C::Less, true), 0.25, 0.5);
        let kind = outmerge::format::DepthFormat::new(format).expect("depth").depth().expect("depth");
        assert!(!passed, "0.5 < 0.25 fails on {format:?}");
        assert_eq!(stored, model("exact").depth_code(kind, 0.25, [0.0, 1.0]), "the depth stays on {format:?}");
    }
}

#[test]
fn depth_is_written_only_with_writes_enabled() {
    assert_ne!(test(&state(T::Depth24Plus, C::Always, true), 0.5, 0.25).1, test_code(0.5), "ZWrite On");
    assert_eq!(test(&state(T::Depth24Plus, C::Always, false), 0.5, 0.25).1, test_code(0.5), "ZWrite Off");
}

#[test]
fn always_with_writes_writes_as_webgpu_has_it() {
    // V and D have a switch that turns the whole test off, writes included; WebGPU has not.
    assert_eq!(test(&state(T::Depth24Plus, C::Always, true), 0.25, 0.75), (true, test_code(0.75)), "written");
}

#[test]
fn without_an_attachment_every_fragment_passes() {
    let state = MergerState { targets: vec![Some(T::Rgba8Unorm.into())], ..MergerState::default() };
    let mut targets = Framebuffer::for_state(Extent::new(1, 1).expect("a texel"), &state).expect("targets");
    let model = model("exact");
    let merger = Merger::new(&state, &*model, &targets).expect("a merger");
    let trace = merger.trace(&Fragment::new([1.0; 4]).at_depth(f32::NAN), 0, 0, &mut targets);
    assert_eq!(trace.samples[0].fate, Fate::Merged, "no depth to compare with");
}

#[test]
fn a_stencil_failure_stops_the_depth_write() {
    // W's algorithm text forgets this; V and D clear the sample.
    let face = StencilFaceState { compare: C::Never, ..StencilFaceState::IGNORE };
    let mut state = state(T::Depth24PlusStencil8, C::Always, true);
    state.depth_stencil.as_mut().expect("depth").stencil =
        StencilState { front: face, back: face, read_mask: !0, write_mask: !0 };
    assert_eq!(test(&state, 0.25, 0.75), (false, test_code(0.25)), "nothing written");
}

fn test_code(z: f32) -> u32 {
    model("exact").depth_code(DepthKind::Unorm(24), z, [0.0, 1.0])
}
