//! What one pass of a material has to evaluate: the "keywords" a shader variant is compiled with.
//!
//! A keyword that is off costs nothing: [`super::surface`] asks here before it evaluates anything, and [`Work`] counts
//! what was evaluated.

use std::fmt;

use wgpu_types::{BlendFactor, BlendState, ColorWrites};

use super::{Material, Pass, Shader, Shading};
use crate::state::AlphaTest;

/// The parts of the fragment shader that one pass needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[expect(clippy::struct_excessive_bools, reason = "each is one compile-time switch of a shader variant")]
pub struct Keywords {
    /// The color reaches a target.
    pub color: bool,
    /// Alpha is evaluated: something reads it.
    pub alpha: bool,
    /// Alpha below the cutoff discards.
    pub clip: bool,
    /// The texture is read.
    pub texture: bool,
    /// Light is evaluated.
    pub light: bool,
    /// Diffuse color is multiplied by alpha, and reflectivity covers.
    pub premultiply: bool,
}

impl Keywords {
    /// What `pass` of `material` needs on this many color targets.
    #[must_use]
    pub fn new(material: &Material, pass: &Pass, targets: usize) -> Self {
        let settings = material.mode.settings();
        let flat = pass.shader == Shader::Flat;
        let masks = || pass.state.write_mask.iter().take(targets);
        let color = masks().any(|mask| mask.intersects(ColorWrites::COLOR));
        let alpha_read = pass.state.alpha_test != AlphaTest::Off
            || masks().any(|mask| mask.contains(ColorWrites::ALPHA))
            || masks()
                .zip(pass.state.blend)
                .any(|(mask, blend)| !mask.is_empty() && blend.is_some_and(reads_source_alpha));
        let clip = settings.clips;
        let premultiply = settings.premultiplies && (color || alpha_read);
        let alpha = clip || premultiply || settings.outputs_alpha && alpha_read;
        let light = color && !flat && matches!(material.shading, Shading::Lit { .. });
        let texture_read = color && !flat || alpha && !material.smoothness_in_alpha;
        let texture = material.texture.is_some() && texture_read;
        Self { color, alpha, clip, texture, light, premultiply }
    }

    /// The keywords that are on, by name.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let all = [
            (self.color, "color"),
            (self.alpha, "alpha"),
            (self.clip, "clip"),
            (self.texture, "texture"),
            (self.light, "light"),
            (self.premultiply, "premultiply"),
        ];
        all.into_iter().filter_map(|(on, name)| on.then_some(name))
    }
}

impl fmt::Display for Keywords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.names().collect();
        f.write_str(if names.is_empty() { "none" } else { "" })?;
        f.write_str(&names.join(" "))
    }
}

fn reads_source_alpha(blend: BlendState) -> bool {
    use BlendFactor as F;
    let alpha_factor = |factor| matches!(factor, F::SrcAlpha | F::OneMinusSrcAlpha | F::SrcAlphaSaturated);
    [blend.color, blend.alpha].iter().any(|part| alpha_factor(part.src_factor) || alpha_factor(part.dst_factor))
}

/// How often the fragment shader evaluated what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Work {
    /// Fragments shaded, discarded ones included.
    pub fragments: u64,
    /// Texture samples taken.
    pub texture_samples: u64,
    /// Alphas evaluated.
    pub alphas: u64,
    /// Clips evaluated.
    pub clips: u64,
    /// Lights evaluated.
    pub lights: u64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.fragments += other.fragments;
        self.texture_samples += other.texture_samples;
        self.alphas += other.alphas;
        self.clips += other.clips;
        self.lights += other.lights;
    }
}
