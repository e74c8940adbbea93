//! Where a model's computation first departs from exact arithmetic.

use serde::Serialize;

use crate::model::{Explanation, Number, StepKind};

/// The first step at which a channel that ends in another code has another value than in exact arithmetic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Departure {
    /// Channel, 0 to 3 = R, G, B, A.
    pub channel: usize,
    /// The step.
    pub step: StepKind,
    /// Its rule in symbols, e.g. `1 - S.a`.
    pub formula: String,
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
        model.steps.iter().filter(|step| step.kind != StepKind::Stored).find_map(|step| {
            let (mine, theirs) = (step.channels[channel].as_ref()?, exact.value(step.kind, channel)?);
            (mine.value.decimal != theirs.decimal).then(|| Self {
                channel,
                step: step.kind,
                formula: mine.formula.clone(),
                model: mine.value.clone(),
                exact: theirs.clone(),
            })
        })
    }
}
