//! Materials: what a surface looks like and how its fragments reach the target.
//!
//! - [`mode`]: the four rendering modes as a table of data;
//! - [`pass`]: the draws a material asks for and their state;
//! - [`keyword`]: what one pass has to evaluate, and nothing else;
//! - [`light`], [`surface`]: the fragment shader.

pub mod keyword;
pub mod light;
pub mod mode;
pub mod pass;
pub mod surface;
#[cfg(test)]
mod tests;

pub use keyword::{Keywords, Work};
pub use light::{Light, Lighting};
pub use mode::{MODES, ModeSettings, RenderingMode};
pub use pass::{Pass, Shader};
pub use surface::{SurfaceInput, SurfaceOutput};

use super::queue::RenderQueue;

/// How a surface meets light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    /// The color is the tint times the texture.
    Unlit,
    /// Ambient, Lambert and a specular highlight, after the metallic workflow.
    Lit {
        /// 0 for dielectrics, 1 for metals.
        metallic: f32,
        /// 0 rough, 1 a sharp highlight.
        smoothness: f32,
    },
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the scene.
    pub name: String,
    /// Its rendering mode.
    pub mode: RenderingMode,
    /// Multiplies the texture, RGBA.
    pub tint: [f32; 4],
    /// Index of the texture; white without one.
    pub texture: Option<usize>,
    /// Whether the texture's colors are already multiplied by its alpha.
    pub premultiplied_texture: bool,
    /// The texture's alpha is the smoothness: alpha is then the tint's alone.
    pub smoothness_in_alpha: bool,
    /// Fragments with an alpha below this are clipped in modes that clip.
    pub cutoff: f32,
    /// How it meets light.
    pub shading: Shading,
    /// Its render queue; `None` takes the mode's.
    pub queue: Option<RenderQueue>,
    /// Its render type tag; `None` takes the mode's.
    pub render_type: Option<String>,
    /// Its passes; `None` takes the mode's.
    pub passes: Option<Vec<Pass>>,
}

impl Material {
    /// A white, unlit material of this mode without texture; cutoff 1/2.
    #[must_use]
    pub fn new(name: &str, mode: RenderingMode) -> Self {
        Self {
            name: name.to_owned(),
            mode,
            tint: [1.0; 4],
            texture: None,
            premultiplied_texture: false,
            smoothness_in_alpha: false,
            cutoff: 0.5,
            shading: Shading::Unlit,
            queue: None,
            render_type: None,
            passes: None,
        }
    }

    /// The queue it is drawn in.
    #[must_use]
    pub fn queue(&self) -> RenderQueue {
        self.queue.unwrap_or(self.mode.settings().queue)
    }

    /// Its render type tag.
    #[must_use]
    pub fn render_type(&self) -> &str {
        self.render_type.as_deref().unwrap_or(self.mode.settings().render_type)
    }

    /// Its passes in drawing order. Without passes of its own: a base pass, and for lit materials one that adds each
    /// further light.
    #[must_use]
    pub fn passes(&self) -> Vec<Pass> {
        match &self.passes {
            Some(passes) => passes.clone(),
            None => {
                let lit = matches!(self.shading, Shading::Lit { .. });
                let additive = lit.then(|| Pass::additive(self.mode));
                std::iter::once(Pass::base(self.mode)).chain(additive).collect()
            }
        }
    }
}
