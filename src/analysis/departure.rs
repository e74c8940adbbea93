//! Where a model's computation first departs from exact arithmetic.

use serde::Serialize;

use crate::model::{Explanation, Number};

/// The first step at which a channel that ends in another code has another value than in exact arithmetic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Departure {
    /// Channel, 0 to 3 = R, G, B, A.
    pub channel: usize,
    /// Name of the step, e.g. `source factor (src-alpha)`.
    pub step: String,
    /// The model's value there.
    pub model: Number,
    /// The exact value there.
    pub exact: Number,
}

impl Departure {
    /// Compares two explanations of the same inputs.
    ///
    /// `None` when every code is equal, or when no value differs before the code: then the store alone rounds
    /// differently.
    #[must_use]
    pub fn between(model: &Explanation, exact: &Explanation) -> Option<Self> {
        let channel = (0..4).find(|&i| model.codes[i] != exact.codes[i])?;
        model.steps.iter().find_map(|step| {
            let twin = exact.steps.iter().find(|other| other.name == step.name)?;
            let (mine, theirs) = (step.values[channel].as_ref()?, twin.values[channel].as_ref()?);
            (mine.decimal != theirs.decimal).then(|| Self {
                channel,
                step: step.name.clone(),
                model: mine.clone(),
                exact: theirs.clone(),
            })
        })
    }
}
