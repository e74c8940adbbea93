//! Fixed-point dynamics: where a fragment drawn again and again leaves a channel for good.
//!
//! On an unsigned normalised target a constant fragment is a map of codes to codes. [`analyze`] follows every code of
//! it: fixed points, limit cycles, basins and steps. [`sweep::sweep`] does so for every alpha and source of 8 bits.
//!
//! **The dead zone.** Straight over moves a code d towards S by alpha |d - S|. Rounding to nearest undoes every move
//! shorter than half a code, so all codes with |d - S| < 1 / (2 alpha) are fixed points. Truncation undoes every upward
//! move shorter than a whole code and no downward one: it reaches a black source and sticks up to 1 / alpha below a
//! bright one.

mod graph;
mod question;
mod smallest;
pub mod sweep;
#[cfg(test)]
mod tests;

use serde::Serialize;

pub use graph::{Dynamics, Limit};
pub use question::{Channel, FixpointError, Question};
pub use smallest::{GRID, SmallestAlpha};

use crate::analysis::departure::Departure;
use crate::model::NumericModel;

/// What one model does with a question.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// The model's name.
    pub model: String,
    /// Fixed points as ranges of consecutive codes, ends included.
    pub fixed_points: Vec<[u32; 2]>,
    /// Every limit with its basin.
    pub dynamics: Dynamics,
    /// The code it starts from.
    pub from: u32,
    /// The codes it ends in: one, or a cycle.
    pub ends_in: Vec<u32>,
    /// Frames until it is there.
    pub frames: u32,
    /// The code real numbers would come to rest nearest to, if they come to rest.
    pub goal: Option<u32>,
    /// Codes between goal and the farthest code it ends in; 0 is a fade that arrives.
    pub stuck_by: Option<u32>,
    /// The smallest alphas that move the starting code and bring it to the goal.
    pub smallest_alpha: SmallestAlpha,
    /// The first frame at which the model and `exact` differ on the same code, if they ever do on this way.
    pub difference: Option<Difference>,
}

/// Where a model leaves the exact way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Frame, counted from 1.
    pub frame: u32,
    /// The code before it.
    pub code: u32,
    /// The code the model writes.
    pub model: u32,
    /// The code `exact` writes.
    pub exact: u32,
    /// The step that made the difference; `None` when only the store rounds differently.
    pub departure: Option<Departure>,
}

/// Follows every code in one model, and compares its way from `from` with `exact`.
///
/// # Errors
/// [`FixpointError`] when the question makes no map of codes, `from` is no code, or the model does not cover the state.
pub fn analyze(
    question: &Question,
    model: &dyn NumericModel,
    exact: &dyn NumericModel,
    from: u32,
) -> Result<Answer, FixpointError> {
    question.check()?;
    let last = question.last_code();
    if from > last {
        return Err(FixpointError::Code { code: from, last });
    }
    model.supports(question.format, question.blend.as_ref())?;
    let dynamics = Dynamics::of(&question.map(model));
    let (limit, frames) = dynamics.from(from);
    let ends_in = limit.codes.clone();
    let goal = question.goal();
    let stuck_by = goal.and_then(|goal| ends_in.iter().map(|code| code.abs_diff(goal)).max());
    Ok(Answer {
        model: model.name(),
        fixed_points: dynamics.fixed_points().into_iter().map(|range| [*range.start(), *range.end()]).collect(),
        from,
        frames,
        goal,
        stuck_by,
        smallest_alpha: SmallestAlpha::search(question, model, from),
        difference: difference(
            question,
            model,
            exact,
            from,
            // At most 2^16 codes.
            frames.saturating_add(u32::try_from(ends_in.len()).unwrap_or(u32::MAX)),
        ),
        ends_in,
        dynamics,
    })
}

/// The first of `frames` frames at which two models differ on the same code.
fn difference(
    question: &Question,
    model: &dyn NumericModel,
    exact: &dyn NumericModel,
    from: u32,
    frames: u32,
) -> Option<Difference> {
    let mut code = from;
    for frame in 1..=frames {
        let (mine, theirs) = (question.next(model, code), question.next(exact, code));
        if mine != theirs {
            let inputs = question.inputs(code);
            let (mut explained, truth) = (model.explain_color(&inputs), exact.explain_color(&inputs));
            // Only the channel in question counts.
            for i in (0..4).filter(|&i| i != question.index()) {
                explained.codes[i] = truth.codes[i];
            }
            let departure = Departure::between(&explained, &truth);
            return Some(Difference { frame, code, model: mine, exact: theirs, departure });
        }
        code = mine;
    }
    None
}
