//! The fragment shader: albedo, alpha, clip, light, premultiplication. binary32, in the order written.

use glam::{Vec3, Vec4};

use super::light::{self, LitPoint};
use super::{Keywords, Lighting, Material, Shader, Shading, Work};
use crate::scene::texture::{Footprint, Texture};

/// What the rasteriser hands to the shader for one fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceInput {
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Interpolated normal in world space, any length.
    pub normal: Vec3,
    /// World position.
    pub position: Vec3,
    /// Whether the triangle faces the viewer; a back face is lit from its other side.
    pub front_facing: bool,
}

/// What the shader hands to the output merger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOutput {
    /// The color, RGBA; zeros where nothing reads it.
    pub color: [f32; 4],
    /// Whether the fragment was clipped.
    pub discarded: bool,
}

/// Everything that stays the same for all fragments of a draw.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceShader<'a> {
    /// The material.
    pub material: &'a Material,
    /// Its texture.
    pub texture: Option<&'a Texture>,
    /// What the pass needs.
    pub keywords: Keywords,
    /// What the pass computes.
    pub shader: Shader,
    /// The scene's light.
    pub lighting: &'a Lighting,
    /// The light a [`Shader::Light`] pass adds.
    pub light: usize,
    /// The camera's position.
    pub eye: Vec3,
}

impl SurfaceShader<'_> {
    /// Shades one fragment and counts what that took; `footprint` serves the choice of mip level.
    #[must_use]
    pub fn shade(&self, input: &SurfaceInput, footprint: impl FnOnce() -> Footprint, work: &mut Work) -> SurfaceOutput {
        work.fragments += 1;
        let (material, keywords) = (self.material, self.keywords);
        let texel = match self.texture.filter(|_| keywords.texture) {
            Some(texture) => {
                work.texture_samples += 1;
                Vec4::from(texture.sample(input.uv, footprint))
            }
            None => Vec4::ONE,
        };
        let alpha = if keywords.alpha { self.alpha(texel, work) } else { 1.0 };
        if keywords.clip {
            work.clips += 1;
            // clip(alpha - cutoff): only a negative difference discards, so alpha = cutoff stays, and so does NaN.
            if alpha - material.cutoff < 0.0 {
                return SurfaceOutput { color: [0.0; 4], discarded: true };
            }
        }
        if !keywords.color {
            return SurfaceOutput { color: [0.0, 0.0, 0.0, self.alpha_output(alpha)], discarded: false };
        }
        let tint = Vec4::from(material.tint).truncate();
        let albedo = if self.shader == Shader::Flat { tint } else { tint * texel.truncate() };
        let color = match material.shading {
            Shading::Lit { metallic, smoothness } if keywords.light => {
                let smoothness = if material.smoothness_in_alpha { smoothness * texel.w } else { smoothness };
                self.lit(input, albedo, alpha, metallic, smoothness, work)
            }
            _ if self.shader == Shader::Light => Vec3::ZERO,
            _ => albedo * self.premultiplier(alpha),
        };
        SurfaceOutput { color: color.extend(self.alpha_output(alpha)).into(), discarded: false }
    }

    /// Tint alpha times texture alpha, unless the texture's alpha means something else.
    fn alpha(&self, texel: Vec4, work: &mut Work) -> f32 {
        work.alphas += 1;
        let tint = self.material.tint[3];
        if self.material.smoothness_in_alpha { tint } else { tint * texel.w }
    }

    /// What the merger sees as alpha: 1 where the mode has none, with reflectivity where it premultiplies.
    fn alpha_output(&self, alpha: f32) -> f32 {
        match self.material.shading {
            _ if !self.material.mode.settings().outputs_alpha => 1.0,
            Shading::Lit { metallic, .. } if self.keywords.premultiply && self.shader != Shader::Flat => {
                // 1 - R + aR, written so that a = 1 gives exactly 1.
                1.0 - light::one_minus_reflectivity(metallic) * (1.0 - alpha)
            }
            _ => alpha,
        }
    }

    /// What the diffuse color is multiplied by: alpha where the mode premultiplies; the tint's part of it where the
    /// texture already holds its own.
    fn premultiplier(&self, alpha: f32) -> f32 {
        let holds_own = self.material.premultiplied_texture && self.shader != Shader::Flat;
        match (self.keywords.premultiply, holds_own) {
            (false, _) => 1.0,
            (true, false) => alpha,
            (true, true) => self.material.tint[3],
        }
    }

    /// Color under the light of this pass.
    fn lit(
        &self,
        input: &SurfaceInput,
        albedo: Vec3,
        alpha: f32,
        metallic: f32,
        smoothness: f32,
        work: &mut Work,
    ) -> Vec3 {
        let side = if input.front_facing { 1.0 } else { -1.0 };
        let normal = input.normal.try_normalize().unwrap_or(Vec3::Z) * side;
        let view = (self.eye - input.position).try_normalize().unwrap_or(normal);
        let rough = 1.0 - smoothness;
        let point = LitPoint { position: input.position, normal, view, roughness: rough * rough };
        let reflectance = light::diffuse_and_specular_from_metallic(albedo, metallic);
        let diffuse_color = reflectance.diffuse * self.premultiplier(alpha);
        let (ambient, light) = match self.shader {
            Shader::Light => (Vec3::ZERO, self.lighting.lights.get(self.light)),
            _ => (self.lighting.ambient, self.lighting.lights.first()),
        };
        let [diffuse, specular] = match light {
            Some(light) => {
                work.lights += 1;
                light.reflect(&point)
            }
            None => [Vec3::ZERO; 2],
        };
        diffuse_color * (ambient + diffuse) + reflectance.specular * specular
    }
}
