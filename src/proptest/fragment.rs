//! Fragments that fit a state: outputs by target format, depths by depth format, coverage, facing, discard.

use ::proptest::collection::{SizeRange, vec};
use ::proptest::prelude::*;

use super::number;
use crate::format::{ColorFormat, DepthFormat};
use crate::fragment::Fragment;
use crate::state::MergerState;

/// Any fragment for a state.
///
/// Outputs of locations without a target are zero. One fragment in ten is discarded, and coverage is full, partial or
/// empty.
pub fn fragment(state: &MergerState) -> BoxedStrategy<Fragment> {
    with_outputs(state, number::color)
}

/// A fragment whose color outputs are finite.
pub fn finite_fragment(state: &MergerState) -> BoxedStrategy<Fragment> {
    with_outputs(state, number::finite_color)
}

/// A stack of fragments for one texel, in drawing order; shrinks to the fewest.
pub fn stack(state: &MergerState, layers: impl Into<SizeRange>) -> BoxedStrategy<Vec<Fragment>> {
    vec(fragment(state), layers).boxed()
}

/// A stack of fragments that nothing but depth and color tells apart: fully covering, front-facing, never discarded.
pub fn opaque_stack(state: &MergerState, layers: impl Into<SizeRange>) -> BoxedStrategy<Vec<Fragment>> {
    let plain = |fragment| Fragment { coverage: !0, front_facing: true, discarded: false, ..fragment };
    vec(finite_fragment(state).prop_map(plain), layers).boxed()
}

fn with_outputs(state: &MergerState, color: fn(ColorFormat) -> BoxedStrategy<[f32; 4]>) -> BoxedStrategy<Fragment> {
    let outputs: Vec<_> = state
        .targets
        .iter()
        .map(|target| match target.as_ref().and_then(|target| ColorFormat::new(target.format).ok()) {
            Some(format) => color(format),
            None => Just([0.0; 4]).boxed(),
        })
        .collect();
    let first = outputs.first().cloned().unwrap_or_else(|| Just([0.0; 4]).boxed());
    let kind = state.depth_stencil.as_ref().and_then(|state| DepthFormat::new(state.format).ok()?.depth());
    let coverage = prop_oneof![4 => Just(!0_u32), 2 => 0..16_u32, 1 => any::<u32>()];
    let discarded = ::proptest::bool::weighted(0.1);
    (outputs, first, number::depth(kind), coverage, any::<bool>(), discarded)
        .prop_map(|(outputs, src1, depth, coverage, back_facing, discarded)| {
            let mut fragment =
                Fragment { src1, depth, coverage, front_facing: !back_facing, discarded, ..Fragment::default() };
            for (slot, output) in fragment.outputs.iter_mut().zip(outputs) {
                *slot = output;
            }
            fragment
        })
        .boxed()
}
