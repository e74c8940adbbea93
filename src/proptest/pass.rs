//! A whole small pass: a state, filled targets of one texel, and a stack of fragments on it.

use ::proptest::collection::SizeRange;
use ::proptest::prelude::*;

use super::{fragment, target};
use crate::fragment::Fragment;
use crate::merger::{Merger, MergerError};
use crate::model::NumericModel;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// One draw of several fragments on a single texel.
#[derive(Clone, Debug)]
pub struct Pass {
    /// The state of all fragments.
    pub state: MergerState,
    /// The targets before, 1 x 1 with the state's samples.
    pub before: Framebuffer,
    /// The fragments in drawing order.
    pub fragments: Vec<Fragment>,
}

impl Pass {
    /// The targets after all fragments, by a model.
    ///
    /// # Errors
    /// [`MergerError::Unsupported`] where the model does not cover the state.
    pub fn run(&self, model: &dyn NumericModel) -> Result<Framebuffer, MergerError> {
        let mut after = self.before.clone();
        let merger = Merger::new(&self.state, model, &after)?;
        for fragment in &self.fragments {
            merger.merge(fragment, 0, 0, &mut after);
        }
        Ok(after)
    }
}

/// A pass with a state from a strategy and this many fragments.
///
/// # Panics
/// When a state has a sample count other than 1 or 4; states from [`super::state`] have not.
pub fn pass(states: impl Strategy<Value = MergerState> + 'static, layers: impl Into<SizeRange>) -> BoxedStrategy<Pass> {
    let layers = layers.into();
    states
        .prop_flat_map(move |state| {
            let extent = Extent::with_samples(1, 1, state.multisample.count).expect("one texel of 1 or 4 samples");
            let contents = (target::framebuffer(&state, extent), fragment::stack(&state, layers.clone()));
            contents.prop_map(move |(before, fragments)| Pass { state: state.clone(), before, fragments })
        })
        .boxed()
}
