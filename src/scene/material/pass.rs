//! The draws a material asks for, and the state of each.

use serde::Deserialize;
use wgpu_types::{BlendState, ColorWrites, CompareFunction, DepthBiasState, Face, StencilState};

use super::RenderingMode;
use crate::state::AlphaTest;

/// What a pass computes for its fragments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shader {
    /// The surface in ambient and main light.
    #[default]
    Base,
    /// The surface in one further light; drawn once for each.
    Light,
    /// The tint alone, neither texture nor light.
    Flat,
}

/// The state a pass sets. What it leaves out (formats, sample count, front face) the scene's target decides.
#[derive(Clone, Debug, PartialEq)]
pub struct PassState {
    /// Blending; `None` is off.
    pub blend: Option<BlendState>,
    /// Channels written.
    pub write_mask: ColorWrites,
    /// The blend constant.
    pub blend_constant: [f32; 4],
    /// Whether depth is written.
    pub depth_write: bool,
    /// The depth test: fragment (left) against stored depth.
    pub depth_compare: CompareFunction,
    /// Depth bias.
    pub bias: DepthBiasState,
    /// Stencil test and operations.
    pub stencil: StencilState,
    /// Stencil reference.
    pub stencil_reference: u32,
    /// The culled face.
    pub cull: Option<Face>,
    /// The fixed-function alpha test.
    pub alpha_test: AlphaTest,
}

impl Default for PassState {
    /// ShaderLab's defaults: no blending, all channels, depth test less-or-equal with write, back faces culled.
    fn default() -> Self {
        Self {
            blend: None,
            write_mask: ColorWrites::ALL,
            blend_constant: [0.0; 4],
            depth_write: true,
            depth_compare: CompareFunction::LessEqual,
            bias: DepthBiasState::default(),
            stencil: StencilState::default(),
            stencil_reference: 0,
            cull: Some(Face::Back),
            alpha_test: AlphaTest::Off,
        }
    }
}

/// One pass of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Its name, for reports.
    pub name: String,
    /// What it computes.
    pub shader: Shader,
    /// How its fragments are merged.
    pub state: PassState,
}

impl Pass {
    /// The base pass of a mode.
    #[must_use]
    pub fn base(mode: RenderingMode) -> Self {
        let settings = mode.settings();
        let state = PassState { blend: settings.blend(), depth_write: settings.depth_write, ..PassState::default() };
        Self { name: "base".to_owned(), shader: Shader::Base, state }
    }

    /// The pass of a mode that adds one light: source factor of the mode, destination factor one, no depth write.
    #[must_use]
    pub fn additive(mode: RenderingMode) -> Self {
        let blend = Some(mode.settings().additive_blend());
        let state = PassState { blend, depth_write: false, ..PassState::default() };
        Self { name: "light".to_owned(), shader: Shader::Light, state }
    }
}
