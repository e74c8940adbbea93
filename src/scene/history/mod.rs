//! Pixel history: every fragment that reached one pixel, in order, what each stage did with it and what it left behind.
//!
//! - [`stage`]: each test of a fragment with its numbers and its verdict;
//! - [`stack`]: what each layer contributes to the final color, in real arithmetic.

pub mod stack;
pub mod stage;
#[cfg(test)]
mod tests;

pub use stack::{Share, Stack};
pub use stage::{Stage, Verdict};

use super::description::Scene;
use super::display::value;
use super::layer::Hit;
use super::material::Shader;
use super::render::SceneError;
use crate::merger::{Fate, Merger};
use crate::model::{ColorInputs, NumericModel};
use crate::target::Framebuffer;

/// A pixel whose history cannot be told.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// The pixel lies outside.
    #[error(
        "pixel {x},{y} lies outside the {width} x {height} target; columns and rows count from 0, rows from the top"
    )]
    Outside {
        /// Column asked for.
        x: u32,
        /// Row asked for.
        y: u32,
        /// Width of the target.
        width: u32,
        /// Height of the target.
        height: u32,
    },
    /// The scene cannot be rendered.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// What happened at one pixel.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct History {
    /// Name of the numeric model.
    pub model: String,
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Draws of the scene, those that do not cover the pixel included.
    pub draws: usize,
    /// The pixel of the cleared targets.
    pub cleared: Contents,
    /// The fragments, in order.
    pub events: Vec<Event>,
    /// The pixel after the last.
    pub last: Contents,
}

/// One fragment's way through the output merger.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Event {
    /// Index of the draw, in drawing order.
    pub draw: usize,
    /// Name of the object.
    pub object: String,
    /// Name of the pass.
    pub pass: String,
    /// Index of the light that the pass adds, where it adds one; index 0 is the main light.
    pub light: Option<usize>,
    /// Index of the triangle within the draw, in the order of the object's faces; a face of more than three corners is
    /// a fan of triangles.
    pub triangle: usize,
    /// Triangles of the draw.
    pub triangles: usize,
    /// What the shader wrote, by target, RGBA.
    pub outputs: Vec<[f32; 4]>,
    /// Depth, before clamp and conversion.
    pub depth: f32,
    /// Whether the primitive faces the viewer.
    pub front_facing: bool,
    /// Each stage's verdict, in order, up to the one that ended the fragment.
    pub stages: Vec<Stage>,
    /// How it ended.
    #[cfg_attr(feature = "json", serde(serialize_with = "fate_name"))]
    pub fate: Fate,
    /// The pixel before.
    pub before: Contents,
    /// The pixel after.
    pub after: Contents,
    /// What the blender saw, by target; nothing where the fragment ended before.
    #[cfg_attr(feature = "json", serde(skip))]
    pub inputs: Vec<Option<ColorInputs>>,
}

/// What the targets hold at a pixel.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Contents {
    /// The color targets.
    pub colors: Vec<Color>,
    /// Depth code and its value, if there is a depth aspect.
    pub depth: Option<(u32, f64)>,
    /// Stencil value, if there is a stencil aspect.
    pub stencil: Option<u8>,
}

/// A texel of a color target.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Color {
    /// The codes, RGBA; 0 for channels the format lacks.
    pub codes: [u32; 4],
    /// What they stand for; linear for sRGB.
    pub values: [f64; 4],
}

impl Scene {
    /// The history of pixel (x, y) in a numeric model.
    ///
    /// # Errors
    /// [`HistoryError`].
    pub fn history(&self, model: &dyn NumericModel, x: u32, y: u32) -> Result<History, HistoryError> {
        let extent = self.target.extent;
        if x >= extent.width || y >= extent.height {
            return Err(HistoryError::Outside { x, y, width: extent.width, height: extent.height });
        }
        let mut targets = self.cleared().map_err(SceneError::from)?;
        let cleared = Contents::at(&targets, x, y);
        let draws = self.draws();
        let mut events: Vec<Event> = Vec::new();
        for Hit { draw: index, triangle, fragment } in self.fragments_at(&draws, x, y) {
            let draw = &draws[index];
            let failed = |source| SceneError::Merger { index, draw: draw.label(), source };
            let merger = Merger::new(&draw.state, model, &targets).map_err(failed)?;
            let before = Contents::at(&targets, x, y);
            let mut trace = merger.trace(&fragment, x, y, &mut targets);
            let sample = trace.samples.swap_remove(0);
            events.push(Event {
                draw: index,
                object: draw.object.clone(),
                pass: draw.pass.clone(),
                light: (draw.shader == Shader::Light).then_some(draw.light),
                triangle,
                triangles: draw.triangles.len(),
                outputs: fragment.outputs[..self.target.colors.len()].to_vec(),
                depth: fragment.depth,
                front_facing: fragment.front_facing,
                stages: stage::stages(draw, &fragment, &sample),
                fate: sample.fate,
                before,
                after: Contents::at(&targets, x, y),
                inputs: sample.colors.iter().map(|color| color.as_ref().map(|(inputs, _)| *inputs)).collect(),
            });
        }
        let last = Contents::at(&targets, x, y);
        Ok(History { model: model.name(), x, y, draws: draws.len(), cleared, events, last })
    }
}

impl Contents {
    /// Sample 0 of a pixel.
    fn at(targets: &Framebuffer, x: u32, y: u32) -> Self {
        let color = |target: &crate::target::ColorTarget| {
            let (codes, channels) = (target.codes(x, y, 0), target.format().channels());
            Color { codes, values: std::array::from_fn(|i| value(channels[i], codes[i])) }
        };
        let index = targets.extent.index(x, y, 0);
        let depth_stencil = targets.depth_stencil.as_ref();
        let depth = depth_stencil.and_then(|target| {
            let (kind, code) = (target.format().depth()?, *target.depth().get(index)?);
            Some((code, kind.value(code)))
        });
        Self {
            colors: targets.colors.iter().flatten().map(color).collect(),
            depth,
            stencil: depth_stencil.and_then(|target| target.stencil().get(index).copied()),
        }
    }
}

/// A fate in words.
#[must_use]
pub fn describe(fate: Fate) -> &'static str {
    match fate {
        Fate::NotCovered => "not covered",
        Fate::Discarded => "discarded by the shader",
        Fate::AlphaTestFailed => "failed the alpha test",
        Fate::AlphaToCoverage => "dropped by alpha to coverage",
        Fate::StencilFailed => "failed the stencil test",
        Fate::DepthFailed => "failed the depth test",
        Fate::Merged => "merged",
    }
}

#[cfg(feature = "json")]
fn fate_name<S: serde::Serializer>(fate: &Fate, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(describe(*fate))
}
