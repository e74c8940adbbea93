//! When the order of fragments matters and when it does not.

use outmerge::model::registry;
use outmerge::proptest::{fragment, pass, state};
use outmerge::state::MergerState;
use proptest::prelude::*;
use wgpu_types::{CompareFunction as C, DepthBiasState, DepthStencilState, StencilState, TextureFormat as T};

/// An opaque draw that tests and writes depth, nearest wins.
fn opaque() -> BoxedStrategy<MergerState> {
    let formats = prop::sample::select(vec![T::Depth16Unorm, T::Depth24Plus, T::Depth32Float]);
    (formats, prop::sample::select(vec![C::Less, C::LessEqual, C::Greater, C::GreaterEqual]))
        .prop_map(|(format, compare)| MergerState {
            depth_stencil: Some(DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: StencilState::default(),
                bias: DepthBiasState::default(),
            }),
            targets: vec![Some(T::Rgba8Unorm.into())],
            ..MergerState::default()
        })
        .boxed()
}

proptest! {
    /// The stored depth after opaque draws does not depend on their order, nor does color where no two depths tie.
    #[test]
    fn opaque_draws_may_come_in_any_order(pass in pass::pass(opaque(), 2..6), rotation in 0_usize..6) {
        let model = registry::by_name("exact").expect("a model");
        let mut turned = pass.clone();
        let by = rotation % turned.fragments.len();
        turned.fragments.rotate_left(by);
        turned.fragments.reverse();
        let (one, other) = (pass.run(&*model).expect("covered"), turned.run(&*model).expect("covered"));
        prop_assert_eq!(&one.depth_stencil, &other.depth_stencil, "depth");
        let target = pass.before.depth_stencil.as_ref().expect("depth");
        let kind = target.format().depth().expect("a depth aspect");
        let range = pass.state.dynamic.depth_range;
        let mut codes: Vec<u32> = pass.fragments.iter().map(|f| model.depth_code(kind, f.depth, range)).collect();
        codes.push(target.depth()[0]);
        codes.sort_unstable();
        if codes.windows(2).all(|pair| pair[0] != pair[1]) {
            prop_assert_eq!(one, other, "color");
        }
    }

    /// A stack merges as its parts do one after the other: nothing is carried from fragment to fragment but the targets.
    #[test]
    fn a_stack_merges_as_its_parts(pass in pass::pass(state::any_state(), 2..6), at in 0_usize..6) {
        for model in registry::every_generation() {
            let Ok(whole) = pass.run(&*model) else { continue };
            let at = at % pass.fragments.len();
            let mut first = pass.clone();
            let rest = first.fragments.split_off(at);
            let between = first.run(&*model).expect("covered, as the whole is");
            let second = pass::Pass { state: pass.state.clone(), before: between, fragments: rest };
            prop_assert_eq!(whole, second.run(&*model).expect("covered"), "{}", model.name());
        }
    }

    /// Fragments on the same state shrink and grow a stack without panics, whatever the numbers.
    #[test]
    fn no_state_or_number_panics(pass in pass::pass(state::any_state(), 0..4)) {
        for model in registry::every_generation() {
            let _ = pass.run(&*model);
        }
    }

    /// Valid WebGPU states are covered by `exact` without exception.
    #[test]
    fn exact_covers_every_valid_state(
        (pass, _) in state::valid_state().prop_flat_map(|state| {
            let spare = fragment::fragment(&state);
            (pass::pass(Just(state), 1..2), spare)
        }),
    ) {
        prop_assert!(pass.run(&*registry::by_name("exact").expect("a model")).is_ok());
    }
}
