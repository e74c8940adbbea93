//! What a scene is made of, after reading and checking.

use glam::{DAffine3, DVec3, Vec3};
use wgpu_types::TextureFormat;

use super::camera::Camera;
use super::material::{Lighting, Material};
use super::mesh::Mesh;
use super::number::f64_to_f32;
use super::queue::SortKey;
use super::raster::Rasteriser;
use super::texture::Texture;
use crate::format::ColorFormat;
use crate::target::Extent;

/// A scene: everything needed to make fragments and merge them.
///
/// Indices are in range and numbers finite in scenes that were read from a file.
#[derive(Clone, Debug)]
pub struct Scene {
    /// A short name for people.
    pub title: String,
    /// What it shows, in a sentence or two.
    pub explanation: String,
    /// The technique it belongs to: scenes of one technique are shown side by side.
    pub technique: String,
    /// Where it is drawn.
    pub target: TargetSpec,
    /// Where it is seen from.
    pub camera: Camera,
    /// Its light.
    pub lighting: Lighting,
    /// Its textures.
    pub textures: Vec<Texture>,
    /// Its meshes.
    pub meshes: Vec<Mesh>,
    /// Its materials.
    pub materials: Vec<Material>,
    /// Its objects.
    pub objects: Vec<Object>,
    /// How the drawing order is found.
    pub order: Order,
    /// A picture that reports show beside the scene's, if any.
    pub reference: Option<Reference>,
    /// Replacement shading, if any.
    pub replacement: Option<Replacement>,
}

/// One object.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name, for reports.
    pub name: String,
    /// Index of its mesh.
    pub mesh: usize,
    /// Index of its material.
    pub material: usize,
    /// Object space to world space.
    pub transform: DAffine3,
}

/// The targets of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSpec {
    /// Their size.
    pub extent: Extent,
    /// The color targets, by output location; at least one.
    pub colors: Vec<ColorSpec>,
    /// The depth/stencil target, if any.
    pub depth: Option<DepthSpec>,
    /// How stored values are shown.
    pub display: Display,
    /// Bits of a pixel's grid that vertices are snapped to, 4 to 8: Vulkan's `subPixelPrecisionBits`.
    pub subpixel_bits: u8,
    /// Whose clipping and interpolation.
    pub rasteriser: Rasteriser,
}

impl TargetSpec {
    /// The format of the only color target, where there is one.
    pub(super) fn single_format(&self) -> Option<TextureFormat> {
        match &self.colors[..] {
            [color] => Some(color.format.texture_format()),
            _ => None,
        }
    }
}

/// One color target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorSpec {
    /// Its format.
    pub format: ColorFormat,
    /// What it is cleared to, RGBA.
    pub clear: [f32; 4],
    /// What the fragment shader writes to it.
    pub output: Output,
}

/// The depth/stencil target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthSpec {
    /// Its format.
    pub format: TextureFormat,
    /// What depth is cleared to, 0 to 1.
    pub clear: f32,
    /// What stencil is cleared to.
    pub clear_stencil: u8,
}

/// What the fragment shader writes to a color target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// The shaded color.
    #[default]
    Color,
    /// The world-space normal, `n / 2 + 1/2`, with the color's alpha.
    Normal,
}

/// How stored values become pixels of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Display {
    /// As they are stored; sRGB formats show their codes.
    #[default]
    Stored,
    /// Linear values are encoded as sRGB.
    Srgb,
}

/// How the drawing order is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// By render queue and distance.
    #[default]
    Queue,
    /// As the objects stand in the file.
    Listed,
    /// By render queue and distance, after the faces of blended objects were split where they cross each other.
    Split,
}

/// What a scene should have looked like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reference {
    /// Every pixel's fragments merged from far to near, see [`Scene::render_sorted_per_pixel`].
    Sorted,
}

/// Replacement shading: objects with a render type tag are drawn in one flat color.
#[derive(Clone, Debug, PartialEq)]
pub struct Replacement {
    /// The render type tag.
    pub render_type: String,
    /// The color, RGB; alpha and holes stay the material's.
    pub color: [f32; 3],
    /// Whether objects with other tags are drawn as they are rather than left out.
    pub keep_others: bool,
}

impl Scene {
    /// The camera's position as the fragment shader has it.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        Vec3::from_array(self.camera.eye.to_array().map(f64_to_f32))
    }

    /// Middle of an object in world space.
    #[must_use]
    pub fn centre(&self, object: &Object) -> DVec3 {
        object.transform.transform_point3(self.meshes[object.mesh].centre())
    }

    /// What decides an object's place in the drawing order.
    #[must_use]
    pub fn sort_key(&self, object: &Object) -> SortKey {
        let queue = self.materials[object.material].queue();
        SortKey { queue, distance: self.camera.sort_key(self.centre(object)) }
    }
}
