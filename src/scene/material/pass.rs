//! The draws a material asks for, and the state of each.

use serde::Deserialize;

use super::RenderingMode;
use crate::state::block::StateBlock;

/// What a pass computes for its fragments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shader {
    /// The surface in ambient and main light.
    #[default]
    Base,
    /// The surface in one further light; drawn once for each.
    Light,
    /// The tint's color, without the texture's and without light; alpha and holes as the mode has them.
    Flat,
}

/// One pass of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Its name, for reports.
    pub name: String,
    /// What it computes.
    pub shader: Shader,
    /// How its fragments are merged.
    pub state: StateBlock,
    /// The blend constant.
    pub blend_constant: [f32; 4],
}

impl Pass {
    /// The base pass of a mode.
    #[must_use]
    pub fn base(mode: RenderingMode) -> Self {
        let settings = mode.settings();
        let state = StateBlock { depth_write: settings.depth_write, ..StateBlock::with_blend(settings.blend()) };
        Self { name: "base".to_owned(), shader: Shader::Base, state, blend_constant: [0.0; 4] }
    }

    /// The pass of a mode that adds one light: source factor of the mode, destination factor one, no depth write.
    #[must_use]
    pub fn additive(mode: RenderingMode) -> Self {
        let blend = Some(mode.settings().additive_blend());
        let state = StateBlock { depth_write: false, ..StateBlock::with_blend(blend) };
        Self { name: "light".to_owned(), shader: Shader::Light, state, blend_constant: [0.0; 4] }
    }
}
