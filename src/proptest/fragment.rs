//! Fragments that fit a state: outputs by target format, depths by depth format, coverage, facing, discard.

use ::proptest::collection::{SizeRange, vec};
use ::proptest::prelude::*;
use ::proptest::sample::select;

use super::number;
use crate::format::depth::DepthKind;
use crate::format::{ColorFormat, DepthFormat, unorm};
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

/// Depths of a stack in drawing order: nearer each time, farther, all equal, neighbours of one another, or any.
///
/// `kind` is the depth format's; `None` stands for a target without depth.
pub fn depth_sequence(kind: Option<DepthKind>, layers: impl Into<SizeRange>) -> BoxedStrategy<Vec<f32>> {
    let order = select(vec![Order::Equal, Order::Nearer, Order::Farther, Order::Neighbours, Order::Any]);
    (vec(number::depth(kind), layers), order)
        .prop_map(move |(mut depths, order)| {
            let first = depths.first().copied().unwrap_or(0.0);
            match order {
                Order::Any => {}
                Order::Equal => depths.fill(first),
                Order::Nearer => depths.sort_by(|a, b| b.total_cmp(a)),
                Order::Farther => depths.sort_by(f32::total_cmp),
                Order::Neighbours => {
                    let mut depth = first;
                    for slot in &mut depths {
                        *slot = depth;
                        depth = next(depth, kind);
                    }
                }
            }
            depths
        })
        .boxed()
}

/// How the depths of a stack follow one another.
#[derive(Clone, Copy, Debug)]
enum Order {
    Equal,
    Nearer,
    Farther,
    Neighbours,
    Any,
}

/// The next number that the depth format can tell from this one; the next binary32 number where it has none.
fn next(depth: f32, kind: Option<DepthKind>) -> f32 {
    let Some(DepthKind::Unorm(bits)) = kind else { return depth.next_up() };
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what a shader would do")]
    let next = (f64::from(depth) + 1.0 / f64::from(unorm::steps(bits))) as f32;
    next
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

#[cfg(test)]
mod tests {
    use super::*;

    proptest! {
        #[test]
        fn depth_sequences_have_the_asked_length_and_neighbours_differ_as_codes(
            depths in depth_sequence(Some(DepthKind::Unorm(16)), 5)
        ) {
            prop_assert_eq!(depths.len(), 5);
            let step = next(0.25, Some(DepthKind::Unorm(16)));
            let code = |z| DepthKind::Unorm(16).encode(z, [0.0, 1.0]);
            prop_assert_eq!(code(step), code(0.25) + 1);
        }
    }

    #[test]
    fn every_order_of_depths_occurs() {
        use ::proptest::strategy::ValueTree;
        let mut runner = ::proptest::test_runner::TestRunner::deterministic();
        let strategy = depth_sequence(Some(DepthKind::Float32), 4);
        let (mut equal, mut rising, mut falling) = (0, 0, 0);
        for _ in 0..256 {
            let depths = strategy.new_tree(&mut runner).expect("depths").current();
            equal += usize::from(depths.windows(2).all(|pair| pair[0] == pair[1]));
            rising += usize::from(depths.windows(2).all(|pair| pair[0] < pair[1]));
            falling += usize::from(depths.windows(2).all(|pair| pair[0] > pair[1]));
        }
        assert!(equal > 10 && rising > 10 && falling > 10, "{equal} equal, {rising} rising, {falling} falling");
    }
}
