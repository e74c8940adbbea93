//! Several draws over the same targets, each with a state of its own and a fragment for every texel.

use ::proptest::collection::{SizeRange, vec};
use ::proptest::prelude::*;

use super::{fragment, state, target};
use crate::fragment::Fragment;
use crate::merger::{Merger, MergerError};
use crate::model::NumericModel;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// One draw: a fragment for every texel.
#[derive(Clone, Debug)]
pub struct Draw {
    /// The draw's state.
    pub state: MergerState,
    /// One a texel, rows from the top.
    pub fragments: Vec<Fragment>,
}

/// Draws over filled targets.
#[derive(Clone, Debug)]
pub struct Layers {
    /// The targets before.
    pub before: Framebuffer,
    /// The draws in order.
    pub draws: Vec<Draw>,
}

impl Layers {
    /// The targets after all draws, by a model.
    ///
    /// # Errors
    /// [`MergerError`] where a state does not fit the targets or the model does not cover it.
    pub fn run(&self, model: &dyn NumericModel) -> Result<Framebuffer, MergerError> {
        let mut after = self.before.clone();
        for draw in &self.draws {
            let merger = Merger::new(&draw.state, model, &after)?;
            let extent = after.extent;
            let texels = (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| (x, y)));
            for (fragment, (x, y)) in draw.fragments.iter().zip(texels) {
                merger.merge(fragment, x, y, &mut after);
            }
        }
        Ok(after)
    }
}

/// Draws over targets of one extent: the first state from a strategy, `further` valid ones over the same formats; each
/// state passes through `fit`, which may change all but formats and sample count. Shrinks to the fewest draws.
///
/// # Panics
/// When the sample count of a state differs from the extent's; `fit` can make it the same for all.
pub fn layers(
    states: impl Strategy<Value = MergerState> + 'static,
    extent: Extent,
    further: impl Into<SizeRange>,
    fit: impl Fn(MergerState) -> MergerState + Clone + 'static,
) -> BoxedStrategy<Layers> {
    let further = further.into();
    states
        .prop_map(fit.clone())
        .prop_flat_map(move |first| {
            assert_eq!(first.multisample.count, extent.samples, "samples of state and extent");
            let texels = extent.width as usize * extent.height as usize;
            let draw = move |state: MergerState| {
                let fragments = vec(fragment::fragment(&state), texels);
                fragments.prop_map(move |fragments| Draw { state: state.clone(), fragments })
            };
            let fit = fit.clone();
            let later = state::valid_state_over(&first).prop_map(fit).prop_flat_map(draw);
            (target::framebuffer(&first, extent), draw(first.clone()), vec(later, further.clone())).prop_map(
                |(before, first, later)| Layers { before, draws: std::iter::once(first).chain(later).collect() },
            )
        })
        .boxed()
}
