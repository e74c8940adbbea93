//! The smallest alpha that still moves a code, and the smallest that brings it to its goal.

use serde::Serialize;

use super::question::Question;
use crate::model::NumericModel;

/// Alphas tried before refining: the multiples of 1/4096 in `[0, 1]`.
pub const GRID: u16 = 4096;

/// Thresholds of alpha, with everything else of the question kept.
///
/// Searched on the multiples of 1/4096, all of them up to the first that succeeds, then by bisection between it and its
/// neighbour below, to the last bit of the `f32`. Under `exact` success is monotone in alpha for straight over, so the
/// result is the smallest alpha there is; in other models no multiple of 1/4096 below it succeeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SmallestAlpha {
    /// Alpha that changes the starting code at all; `None` if none up to 1 does.
    pub moves: Option<f32>,
    /// Alpha that brings the starting code to the goal; `None` if none up to 1 does, or there is no goal.
    pub reaches: Option<f32>,
}

impl SmallestAlpha {
    /// Searches for both.
    #[must_use]
    pub fn search(question: &Question, model: &dyn NumericModel, from: u32) -> Self {
        let with = |alpha| Question { alpha, ..*question };
        Self {
            moves: search(|alpha| with(alpha).next(model, from) != from),
            reaches: search(|alpha| {
                let question = with(alpha);
                question.goal().is_some_and(|goal| ends_at(&question, model, from, goal))
            }),
        }
    }
}

/// Whether repeated blending comes to rest at `goal`.
fn ends_at(question: &Question, model: &dyn NumericModel, from: u32, goal: u32) -> bool {
    let mut seen = vec![false; question.last_code() as usize + 1];
    let mut code = from;
    while !seen[code as usize] {
        seen[code as usize] = true;
        let next = question.next(model, code);
        if next == code {
            return code == goal;
        }
        code = next;
    }
    false
}

/// The smallest alpha in `[0, 1]` that `succeeds`, by grid and bisection.
fn search(succeeds: impl Fn(f32) -> bool) -> Option<f32> {
    let alpha = |step: u16| f32::from(step) / f32::from(GRID);
    let first = (0..=GRID).find(|&step| succeeds(alpha(step)))?;
    let Some(below) = first.checked_sub(1) else { return Some(0.0) };
    // Non-negative floats are ordered as their bits are.
    let (mut fails, mut works) = (alpha(below).to_bits(), alpha(first).to_bits());
    while works - fails > 1 {
        let middle = u32::midpoint(fails, works);
        if succeeds(f32::from_bits(middle)) { works = middle } else { fails = middle }
    }
    Some(f32::from_bits(works))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_ends_at_the_first_float_that_succeeds() {
        for threshold in [0.0_f32, 1e-30, 0.001_953_125, 0.3, 1.0] {
            assert_eq!(search(|alpha| alpha >= threshold), Some(threshold), "{threshold}");
        }
        assert_eq!(search(|_| false), None, "nothing succeeds");
    }
}
