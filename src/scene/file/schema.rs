//! The scene file as it is written, version 1: the same members in TOML and JSON. Every member but those without a
//! default may be left out.

use serde::Deserialize;
use serde::de::{Deserializer, Error, Visitor};
use wgpu_types::{AddressMode, FilterMode, MipmapFilterMode};

use super::tuple;
use crate::scene::description::{Display, Order, Output, Reference};
use crate::scene::material::{RenderingMode, Shader};
use crate::scene::raster::Rasteriser;
use crate::scene::texture::{ColorSpace, Pattern, Storage};

/// A whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileScene {
    /// Checked before the rest is read.
    #[serde(rename = "version")]
    pub(super) _version: i64,
    pub(super) title: String,
    #[serde(default)]
    pub(super) explanation: String,
    #[serde(default)]
    pub(super) technique: String,
    pub(super) target: FileTarget,
    #[serde(default)]
    pub(super) camera: FileCamera,
    #[serde(default, deserialize_with = "tuple::one")]
    pub(super) ambient: [f32; 3],
    #[serde(default)]
    pub(super) light: Vec<FileLight>,
    #[serde(default)]
    pub(super) texture: Vec<FileTexture>,
    #[serde(default)]
    pub(super) mesh: Vec<FileMesh>,
    #[serde(default)]
    pub(super) material: Vec<FileMaterial>,
    #[serde(default)]
    pub(super) object: Vec<FileObject>,
    #[serde(default)]
    pub(super) model: Vec<FileModel>,
    #[serde(default)]
    pub(super) order: Order,
    pub(super) reference: Option<Reference>,
    pub(super) replacement: Option<FileReplacement>,
}

/// `[target]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileTarget {
    pub(super) width: i64,
    pub(super) height: i64,
    /// One color target; or use `[[target.color]]`.
    pub(super) format: Option<String>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) clear: Option<[f32; 4]>,
    #[serde(default)]
    pub(super) color: Vec<FileColor>,
    /// A depth/stencil format or `none`.
    pub(super) depth: Option<String>,
    pub(super) clear_depth: Option<f32>,
    pub(super) clear_stencil: Option<u8>,
    #[serde(default)]
    pub(super) display: Display,
    pub(super) subpixel_bits: Option<u8>,
    #[serde(default)]
    pub(super) rasteriser: Rasteriser,
}

/// `[[target.color]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileColor {
    pub(super) format: String,
    #[serde(default, deserialize_with = "tuple::one")]
    pub(super) clear: [f32; 4],
    #[serde(default)]
    pub(super) output: Output,
}

/// `[camera]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileCamera {
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) eye: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) look_at: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) up: Option<[f64; 3]>,
    /// Degrees; makes the camera perspective.
    pub(super) fov_y: Option<f64>,
    /// World units; makes it orthographic.
    pub(super) height: Option<f64>,
    pub(super) near: Option<f64>,
    pub(super) far: Option<f64>,
    #[serde(default)]
    pub(super) reversed_depth: bool,
}

/// `[[light]]`: directional with `direction`, a point light with `position` and `range`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileLight {
    /// The way the light travels.
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) direction: Option<[f32; 3]>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) position: Option<[f32; 3]>,
    pub(super) range: Option<f32>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) color: Option<[f32; 3]>,
}

/// `[[texture]]`: either `file` or `pattern`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileTexture {
    pub(super) name: String,
    /// A PNG file, relative to the scene's.
    pub(super) file: Option<String>,
    pub(super) pattern: Option<Pattern>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) size: Option<[i64; 2]>,
    #[serde(default, deserialize_with = "tuple::list")]
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) cells: Option<u32>,
    /// What the stored values mean; no default, since guessing wrong changes every pixel.
    pub(super) space: ColorSpace,
    #[serde(default)]
    pub(super) storage: Storage,
    /// The file's colors are already multiplied by alpha.
    #[serde(default)]
    pub(super) premultiplied: bool,
    pub(super) filter: Option<FilterMode>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) address: Option<[AddressMode; 2]>,
    pub(super) mips: Option<MipmapFilterMode>,
}

/// `[[mesh]]`: a sphere with another number of segments, faces by their corners, or an OBJ file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileMesh {
    pub(super) name: String,
    pub(super) sphere_segments: Option<u32>,
    /// An OBJ file, relative to the scene's.
    pub(super) file: Option<String>,
    #[serde(default, deserialize_with = "tuple::list")]
    pub(super) positions: Vec<[f64; 3]>,
    #[serde(default, deserialize_with = "tuple::list")]
    pub(super) uvs: Vec<[f64; 2]>,
    /// Planar convex polygons, counter-clockwise from outside, as indices into `positions`.
    #[serde(default)]
    pub(super) faces: Vec<Vec<u32>>,
}

/// `[[material]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileMaterial {
    pub(super) name: String,
    #[serde(default)]
    pub(super) mode: RenderingMode,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) tint: Option<[f32; 4]>,
    pub(super) texture: Option<String>,
    pub(super) cutoff: Option<f32>,
    #[serde(default)]
    pub(super) smoothness_in_alpha: bool,
    /// Either makes the material lit.
    pub(super) metallic: Option<f32>,
    pub(super) smoothness: Option<f32>,
    pub(super) queue: Option<FileQueue>,
    pub(super) render_type: Option<String>,
    #[serde(default)]
    pub(super) pass: Vec<FilePass>,
}

/// `[[material.pass]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FilePass {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) shader: Shader,
    /// ShaderLab state commands, with ShaderLab's defaults; without them the mode's state.
    pub(super) state: Option<String>,
    /// RGBA; all zero as WebGPU has it.
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) blend_constant: Option<[f32; 4]>,
}

/// `[[object]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileObject {
    pub(super) name: Option<String>,
    /// `quad`, `cube`, `sphere` or the name of a `[[mesh]]`.
    pub(super) mesh: String,
    pub(super) material: String,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) position: Option<[f64; 3]>,
    /// Degrees about x, y and z, applied in that order.
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) rotation: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) scale: Option<[f64; 3]>,
}

/// `[[model]]`: a glTF file with its materials, as objects.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileModel {
    pub(super) name: String,
    /// A `.gltf` or `.glb` file, relative to the scene's.
    pub(super) file: String,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) position: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) rotation: Option<[f64; 3]>,
    #[serde(default, deserialize_with = "tuple::optional")]
    pub(super) scale: Option<[f64; 3]>,
}

/// `[replacement]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct FileReplacement {
    pub(super) render_type: String,
    #[serde(deserialize_with = "tuple::one")]
    pub(super) color: [f32; 3],
    #[serde(default)]
    pub(super) keep_others: bool,
}

/// A queue by number or name; -1 is the mode's own.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FileQueue {
    Number(i64),
    Name(String),
}

impl<'de> Deserialize<'de> for FileQueue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberOrName;
        impl Visitor<'_> for NumberOrName {
            type Value = FileQueue;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a render queue, e.g. 3000, \"Transparent+1\", or -1 for the mode's own")
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<FileQueue, E> {
                Ok(FileQueue::Number(number))
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<FileQueue, E> {
                Ok(FileQueue::Number(i64::try_from(number).unwrap_or(i64::MAX)))
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<FileQueue, E> {
                Ok(FileQueue::Name(name.to_owned()))
            }
        }
        deserializer.deserialize_any(NumberOrName)
    }
}
