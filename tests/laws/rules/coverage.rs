//! What ends a fragment before depth and stencil. Sources: V, *Fragment Operations*; D 16.12, 17.18; W, *Rendering*.

use outmerge::fragment::Fragment;
use outmerge::merger::{Fate, Merger};
use outmerge::state::{AlphaTest, MergerState, Rect};
use outmerge::target::{Extent, Framebuffer};
use wgpu_types::{CompareFunction, DepthStencilState, StencilFaceState, StencilOperation, StencilState, TextureFormat};

use crate::texel::model;

/// A state in which every fragment that arrives shows in color, depth and stencil.
fn visible(samples: u32) -> MergerState {
    let face = StencilFaceState { pass_op: StencilOperation::Replace, ..StencilFaceState::IGNORE };
    let stencil = StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff };
    let mut state = MergerState {
        targets: vec![Some(TextureFormat::Rgba8Unorm.into())],
        depth_stencil: Some(DepthStencilState {
            format: TextureFormat::Depth24PlusStencil8,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Always),
            stencil,
            bias: wgpu_types::DepthBiasState::default(),
        }),
        ..MergerState::default()
    };
    state.dynamic.stencil_reference = 77;
    state.multisample.count = samples;
    state
}

/// Fates of the samples, and the targets before and after.
fn run(state: &MergerState, fragment: &Fragment) -> (Vec<Fate>, Framebuffer, Framebuffer) {
    let extent = Extent::with_samples(1, 1, state.multisample.count).expect("a texel");
    let before = Framebuffer::for_state(extent, state).expect("targets");
    let mut after = before.clone();
    let model = model("exact");
    let trace = Merger::new(state, &*model, &after).expect("a merger").trace(fragment, 0, 0, &mut after);
    (trace.samples.iter().map(|sample| sample.fate).collect(), before, after)
}

fn white() -> Fragment {
    Fragment::new([1.0; 4]).at_depth(0.5)
}

/// The samples that a fragment changed, checked to be the same in color, depth and stencil.
fn changed_samples(state: &MergerState, fragment: &Fragment) -> u32 {
    let (_, _, after) = run(state, fragment);
    let depth = after.depth_stencil.as_ref().expect("depth and stencil");
    (0..state.multisample.count).fold(0, |mask, sample| {
        let at = after.extent.index(0, 0, sample);
        let color = after.colors[0].as_ref().expect("color").codes(0, 0, sample) != [0; 4];
        let (z, stencil) = (depth.depth()[at] != 0, depth.stencil()[at] != 0);
        assert!(color == z && z == stencil, "sample {sample}: all three or none ({color}, {z}, {stencil})");
        mask | u32::from(color) << sample
    })
}

#[test]
fn a_fragment_that_arrives_shows_everywhere() {
    assert_eq!(changed_samples(&visible(1), &white()), 1, "the state of these tests hides nothing");
    assert_eq!(changed_samples(&visible(4), &white()), 15, "nor with four samples");
}

#[test]
fn discarded_fragments_leave_no_trace() {
    let fragment = Fragment { discarded: true, ..white() };
    let (fates, before, after) = run(&visible(1), &fragment);
    assert_eq!((fates, before), (vec![Fate::Discarded], after), "color, depth and stencil");
}

#[test]
fn alpha_tested_fragments_leave_no_trace() {
    let mut state = visible(1);
    state.alpha_test = AlphaTest::On { compare: CompareFunction::Greater, reference: 1.0 };
    let (fates, before, after) = run(&state, &white());
    assert_eq!((fates, before), (vec![Fate::AlphaTestFailed], after), "1 > 1 fails");
}

#[test]
fn the_sample_mask_applies_to_single_sampled_targets() {
    let mut state = visible(1);
    state.multisample.mask = !1;
    let (fates, before, after) = run(&state, &white());
    assert_eq!((fates, before), (vec![Fate::NotCovered], after), "bit 0 is off");
}

#[test]
fn the_sample_mask_and_the_primitive_s_coverage_are_anded_and_higher_bits_ignored() {
    let mut state = visible(4);
    state.multisample.mask = 0xff_fff6;
    assert_eq!(changed_samples(&state, &Fragment { coverage: 0xffff_fff3, ..white() }), 0b0010, "0110 and 0011");
}

#[test]
fn the_scissor_admits_its_own_texels_only() {
    let mut state = visible(1);
    state.dynamic.scissor = Some(Rect { x: 0, y: 0, width: 0, height: 5 });
    assert_eq!(changed_samples(&state, &white()), 0, "an empty rectangle");
    state.dynamic.scissor = Some(Rect { x: 0, y: 0, width: 1, height: 1 });
    assert_eq!(changed_samples(&state, &white()), 1, "inside");
}

#[test]
fn alpha_to_coverage_is_empty_at_zero_and_nan_and_full_at_one() {
    let mut state = visible(4);
    state.multisample.alpha_to_coverage_enabled = true;
    let samples = |alpha: f32| changed_samples(&state, &Fragment::new([1.0, 1.0, 1.0, alpha]).at_depth(0.5));
    assert_eq!([0.0, -3.0, f32::NAN].map(samples), [0; 3], "no coverage (D 17.18)");
    assert_eq!([1.0, 2.5, f32::INFINITY].map(samples), [15; 3], "full coverage");
}

/// The APIs leave the masks to the implementation; ours reaches sample i at alpha (i + 1/2) / n, the threshold included.
#[test]
fn alpha_to_coverage_includes_its_thresholds() {
    let mut state = visible(4);
    state.multisample.alpha_to_coverage_enabled = true;
    for (sample, threshold) in (0_u32..).zip([0.125_f32, 0.375, 0.625, 0.875]) {
        let kept =
            |alpha: f32| changed_samples(&state, &Fragment::new([1.0, 1.0, 1.0, alpha]).at_depth(0.5)).count_ones();
        assert_eq!(kept(threshold), sample + 1, "alpha {threshold} reaches sample {sample}");
        assert_eq!(kept(threshold.next_down()), sample, "an ulp less does not");
    }
}

#[test]
fn alpha_to_coverage_leaves_color_depth_and_stencil_of_dropped_samples() {
    let mut state = visible(4);
    state.multisample.alpha_to_coverage_enabled = true;
    let kept = changed_samples(&state, &Fragment::new([1.0, 1.0, 1.0, 0.5]).at_depth(0.5));
    assert_eq!(kept.count_ones(), 2, "half of the samples, each in all three aspects");
}

#[test]
fn alpha_reaches_the_blender_unchanged_by_alpha_to_coverage() {
    let mut state = visible(4);
    state.multisample.alpha_to_coverage_enabled = true;
    let (_, _, after) = run(&state, &Fragment::new([1.0, 1.0, 1.0, 0.5]).at_depth(0.5));
    let color = after.colors[0].as_ref().expect("color");
    let codes: Vec<_> = (0..4).map(|i| color.codes(0, 0, i)).filter(|codes| *codes != [0; 4]).collect();
    assert_eq!(codes, [[255, 255, 255, 128]; 2], "alpha 0.5, not 1 and not a sample's share");
}

#[test]
fn alpha_to_coverage_takes_output_0_before_blending() {
    let mut state = visible(4);
    state.targets.push(state.targets[0].clone());
    state.multisample.alpha_to_coverage_enabled = true;
    let mut fragment = Fragment::new([1.0; 4]).at_depth(0.5);
    fragment.outputs[1] = [0.0; 4];
    assert_eq!(changed_samples(&state, &fragment), 15, "alpha 0 of output 1 does not count");
}
