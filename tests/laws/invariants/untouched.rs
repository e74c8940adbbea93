//! What a fragment must not touch.

use outmerge::fragment::Fragment;
use outmerge::model::registry;
use outmerge::proptest::{pass, state};
use outmerge::state::AlphaTest;
use proptest::prelude::*;
use wgpu_types::{ColorWrites, CompareFunction};

/// The textbook models: a driver may rewrite the NaNs of a texel that it covers.
const MODELS: [&str; 4] = ["exact", "f32", "f16", "fixed:8"];

proptest! {
    /// A discarded fragment leaves color, depth and stencil as they were, in any state.
    #[test]
    fn discard_touches_nothing(pass in pass::pass(state::any_state(), 1..4)) {
        let mut pass = pass;
        for fragment in &mut pass.fragments {
            fragment.discarded = true;
        }
        for name in MODELS {
            let model = registry::by_name(name).expect("a model");
            let Ok(after) = pass.run(&*model) else { continue };
            prop_assert_eq!(&after, &pass.before, "{}", name);
        }
    }

    /// So does a fragment that fails the alpha test.
    #[test]
    fn a_failed_alpha_test_touches_nothing(pass in pass::pass(state::any_state(), 1..4)) {
        let mut pass = pass;
        pass.state.alpha_test = AlphaTest::On { compare: CompareFunction::Never, reference: 0.5 };
        for name in MODELS {
            let model = registry::by_name(name).expect("a model");
            let Ok(after) = pass.run(&*model) else { continue };
            prop_assert_eq!(&after, &pass.before, "{}", name);
        }
    }

    /// A failed depth test touches neither color nor depth; stencil may change.
    #[test]
    fn a_failed_depth_test_touches_neither_color_nor_depth(pass in pass::pass(state::any_state(), 1..4)) {
        let mut pass = pass;
        let Some(depth_stencil) = &mut pass.state.depth_stencil else { return Ok(()) };
        let has_depth = pass.before.depth_stencil.as_ref().is_some_and(|target| !target.depth().is_empty());
        prop_assume!(has_depth);
        depth_stencil.depth_compare = Some(CompareFunction::Never);
        for name in MODELS {
            let model = registry::by_name(name).expect("a model");
            let Ok(after) = pass.run(&*model) else { continue };
            prop_assert_eq!(&after.colors, &pass.before.colors, "{}", name);
            let depth = |targets: &outmerge::Framebuffer| targets.depth_stencil.as_ref().map(|t| t.depth().to_vec());
            prop_assert_eq!(depth(&after), depth(&pass.before), "{}", name);
        }
    }

    /// Masked channels keep their bits: NaN payloads, -0 and snorm's spare code too.
    #[test]
    fn masked_channels_keep_their_bits(pass in pass::pass(state::any_state(), 1..4)) {
        for name in MODELS {
            let model = registry::by_name(name).expect("a model");
            let Ok(after) = pass.run(&*model) else { continue };
            for (i, target) in pass.state.targets.iter().enumerate() {
                let (Some(target), Some(before), Some(after)) = (target, &pass.before.colors[i], &after.colors[i]) else {
                    continue;
                };
                for sample in 0..pass.before.extent.samples {
                    let (before, after) = (before.codes(0, 0, sample), after.codes(0, 0, sample));
                    for channel in 0..4 {
                        let mask = ColorWrites::from_bits_truncate(1 << channel);
                        if !target.write_mask.contains(mask) {
                            prop_assert_eq!(before[channel], after[channel], "{}, target {}", name, i);
                        }
                    }
                }
            }
        }
    }

    /// Stencil bits outside the write mask stay.
    #[test]
    fn stencil_bits_outside_the_write_mask_stay(pass in pass::pass(state::any_state(), 1..4)) {
        let Some(depth_stencil) = &pass.state.depth_stencil else { return Ok(()) };
        let keep = !depth_stencil.stencil.write_mask.to_le_bytes()[0];
        let after = pass.run(&*registry::by_name("exact").expect("a model")).expect("exact covers every state");
        let stencil = |targets: &outmerge::Framebuffer| {
            targets.depth_stencil.as_ref().map(|t| t.stencil().iter().map(|s| s & keep).collect::<Vec<_>>())
        };
        prop_assert_eq!(stencil(&after), stencil(&pass.before));
    }

    /// Uncovered samples stay; with no sample covered, everything does.
    #[test]
    fn uncovered_samples_stay(pass in pass::pass(state::any_state(), 1..4), coverage in 0_u32..16) {
        let mut pass = pass;
        for fragment in &mut pass.fragments {
            *fragment = Fragment { coverage, ..*fragment };
        }
        for name in MODELS {
            let model = registry::by_name(name).expect("a model");
            let Ok(after) = pass.run(&*model) else { continue };
            for sample in (0..pass.before.extent.samples).filter(|sample| coverage >> sample & 1 == 0) {
                for (before, after) in pass.before.colors.iter().flatten().zip(after.colors.iter().flatten()) {
                    prop_assert_eq!(before.codes(0, 0, sample), after.codes(0, 0, sample), "{}", name);
                }
            }
        }
    }
}
