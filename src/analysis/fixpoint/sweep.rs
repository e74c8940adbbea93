//! Every alpha and source of 8 bits: how wide the dead zones are, and whether anything oscillates.

use rayon::prelude::*;
use serde::Serialize;

use super::graph::Dynamics;
use super::question::{FixpointError, Question};
use crate::model::NumericModel;

/// One alpha over all 256 sources.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AlphaRow {
    /// Alpha as a code; the shader's output is alpha / 255.
    pub alpha: u8,
    /// Half-width of the dead zone of straight over rounded to nearest, 255 / (2 alpha) codes; infinite for alpha 0.
    pub theory: f64,
    /// The farthest above its goal that the largest code ends, over all sources.
    pub stuck_above: u32,
    /// The farthest below its goal that code 0 ends, over all sources.
    pub stuck_below: u32,
    /// Sources with a limit cycle.
    pub sources_with_cycles: u32,
    /// The most frames any code takes for any source.
    pub frames: u32,
}

/// Every alpha in one model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// The model's name.
    pub model: String,
    /// By alpha, 0 to 255.
    pub rows: Vec<AlphaRow>,
}

/// Follows every code of every map: 256 alphas x 256 sources. `done` is called after each alpha, from any thread.
///
/// # Errors
/// [`FixpointError`], as [`super::analyze`]; a state without a goal has no dead zone and gives rows of zeros there.
pub fn sweep(question: &Question, model: &dyn NumericModel, done: &(dyn Fn() + Sync)) -> Result<Sweep, FixpointError> {
    question.check()?;
    model.supports(question.format, question.blend.as_ref())?;
    let row = |alpha: u8| {
        let row = alpha_row(question, model, alpha);
        done();
        row
    };
    Ok(Sweep { model: model.name(), rows: (0..=u8::MAX).into_par_iter().map(row).collect() })
}

fn alpha_row(question: &Question, model: &dyn NumericModel, alpha: u8) -> AlphaRow {
    let last = question.last_code();
    let mut row = AlphaRow {
        alpha,
        theory: 255.0 / (2.0 * f64::from(alpha)),
        stuck_above: 0,
        stuck_below: 0,
        sources_with_cycles: 0,
        frames: 0,
    };
    for source in 0..=u8::MAX {
        let question = Question { source: f32::from(source) / 255.0, alpha: f32::from(alpha) / 255.0, ..*question };
        let dynamics = Dynamics::of(&question.map(model));
        row.sources_with_cycles += u32::from(dynamics.cycles().next().is_some());
        row.frames = row.frames.max(dynamics.steps.iter().copied().max().unwrap_or(0));
        let Some(goal) = question.goal() else { continue };
        let (above, _) = dynamics.from(last);
        let (below, _) = dynamics.from(0);
        row.stuck_above = row.stuck_above.max(above.codes.iter().map(|c| c.saturating_sub(goal)).max().unwrap_or(0));
        row.stuck_below = row.stuck_below.max(below.codes.iter().map(|c| goal.saturating_sub(*c)).max().unwrap_or(0));
    }
    row
}
