//! The classic mistakes with alpha, found in states and scenes, each with a counter-example.
//!
//! In a scene a rule does not judge by the look of a state: it repairs the state, draws the scene again in the `exact`
//! model, and reports a finding only where that changes a pixel, which it names. Two rules have no pixel to offer: a
//! destination that might hold NaN, and a queue that is wrong but for this scene's order; they say so. A state alone has no
//! pixels, so there the example is a single blend.
//!
//! [`RULES`] lists the rules, in the order of `docs/lint.md`.

mod rules;
#[cfg(test)]
mod tests;
mod view;

use wgpu_types::{BlendState, ColorTargetState};

use crate::format::{Codes, ColorFormat};
use crate::scene::{Scene, SceneError};
use crate::state::StateBlock;

pub use rules::RULES;
pub(crate) use view::View;

/// A mistake that can be looked for.
#[derive(Clone, Copy)]
pub struct Rule {
    /// Its name, as in `docs/lint.md`.
    pub name: &'static str,
    /// What it finds, in a sentence.
    pub about: &'static str,
    /// How to find it in a state alone.
    state: fn(&StateQuestion) -> Option<Finding>,
    /// How to find it in a scene.
    scene: fn(&View<'_>) -> Result<Vec<Finding>, SceneError>,
}

impl std::fmt::Debug for Rule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rule").field("name", &self.name).finish_non_exhaustive()
    }
}

/// A mistake that was found.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Finding {
    /// The rule's name.
    pub rule: &'static str,
    /// Where: a draw, or the member of the state.
    pub place: String,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub fix: String,
    /// Numbers that show it.
    pub example: Example,
}

/// What is stored with and without the mistake.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Example {
    /// The pixel of the scene, column and row; `None` for a state alone, or where no pixel of the scene shows it.
    pub pixel: Option<(u32, u32)>,
    /// What goes in, in words.
    pub given: String,
    /// The color target.
    pub target: usize,
    /// Its format.
    #[cfg_attr(feature = "json", serde(serialize_with = "format_name"))]
    pub format: ColorFormat,
    /// The codes stored as it is, RGBA.
    pub stored: Codes,
    /// The codes stored when repaired.
    pub repaired: Codes,
}

/// A state on its own, and what is known about its use.
#[derive(Clone, Debug, PartialEq)]
pub struct StateQuestion {
    /// The state; target 0 is looked at.
    pub block: StateBlock,
    /// The target's format.
    pub format: ColorFormat,
    /// The blend constant, if it is set.
    pub constant: Option<[f32; 4]>,
    /// How the shader's color relates to its alpha, if known.
    pub source: Option<SourceAlpha>,
    /// Whether the state says something about depth: bare blend factors do not.
    pub depth_known: bool,
}

/// How a color relates to its alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SourceAlpha {
    /// The color is independent of alpha.
    Straight,
    /// The color is already multiplied by alpha.
    Premultiplied,
}

/// The mistakes in a state on its own.
#[must_use]
pub fn lint_state(question: &StateQuestion) -> Vec<Finding> {
    RULES.iter().filter_map(|rule| (rule.state)(question)).collect()
}

/// The mistakes in a scene.
///
/// # Errors
/// [`SceneError`] when the scene cannot be rendered.
pub fn lint_scene(scene: &Scene) -> Result<Vec<Finding>, SceneError> {
    let view = View::new(scene)?;
    let mut findings = Vec::new();
    for rule in &RULES {
        findings.extend((rule.scene)(&view)?);
    }
    Ok(findings)
}

/// The blend state of a target that writes color or alpha.
fn written_blend(target: &ColorTargetState) -> Option<&BlendState> {
    target.blend.as_ref().filter(|_| !target.write_mask.is_empty())
}

#[cfg(feature = "json")]
fn format_name<S: serde::Serializer>(format: &ColorFormat, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(format.name())
}
