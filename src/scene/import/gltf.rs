//! glTF 2.0: the default scene of a file as objects.
//!
//! `alphaMode` `OPAQUE`, `MASK` and `BLEND` become the modes Opaque, Cutout (with `alphaCutoff`) and Fade; `doubleSided`
//! becomes `Cull Off`; metallic and roughness become metallic and smoothness, `KHR_materials_unlit` unlit. Textures are
//! read from PNG images, as sRGB. Skins, morph targets, vertex colors and cameras are not read.

use std::path::Path;

use base64::Engine;
use glam::{DAffine3, DMat4, DVec2, DVec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::material::AlphaMode;
use gltf::mesh::Mode;
use gltf::texture::{MagFilter, MinFilter, WrappingMode};
use wgpu_types::{AddressMode, FilterMode, MipmapFilterMode};

use super::{ImportError, Model, read};
use crate::limit::Limits;
use crate::scene::description::Object;
use crate::scene::material::{Material, Pass, RenderingMode, Shading};
use crate::scene::mesh::{MAX_VERTICES, Mesh};
use crate::scene::texture::{ColorSpace, Sampler, Texture, png};

/// Nodes below one another, at most.
const MAX_DEPTH: usize = 64;
/// Objects a file may give.
const MAX_OBJECTS: usize = 4096;

/// Reads a file and the buffers and images it names.
///
/// # Errors
/// [`ImportError`].
pub fn load(path: &Path, limits: &Limits) -> Result<Model, ImportError> {
    parse(&read(path, limits)?, path, limits)
}

/// Reads the bytes of a `.gltf` or `.glb` file; others are looked for beside `path`.
///
/// # Errors
/// [`ImportError`].
pub fn parse(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Model, ImportError> {
    check_attributes(bytes, path)?;
    let file = gltf::Gltf::from_slice(bytes).map_err(|error| ImportError::content(path, error))?;
    let mut reader = Reader { path, limits, buffers: Vec::new(), primitives: Vec::new(), model: Model::default() };
    for buffer in file.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => {
                file.blob.clone().ok_or_else(|| reader.wrong("its binary chunk is missing"))?
            }
            gltf::buffer::Source::Uri(uri) => reader.resource(uri)?,
        };
        reader.buffers.push(bytes);
    }
    for texture in file.textures() {
        let texture = reader.texture(&texture)?;
        reader.model.textures.push(texture);
        // Many textures may share one small file.
        let bytes: u64 = reader.model.textures.iter().map(Texture::bytes).sum();
        reader.within("texture-bytes", bytes, limits.texture_bytes)?;
    }
    for material in file.materials() {
        let material = reader.material(&material)?;
        reader.model.materials.push(material);
    }
    reader.model.materials.push(Material::new("default", RenderingMode::Opaque));
    for mesh in file.meshes() {
        let primitives: Result<Vec<_>, _> = mesh.primitives().map(|primitive| reader.primitive(&primitive)).collect();
        reader.primitives.push(primitives?);
        let vertices: usize = reader.model.meshes.iter().map(|mesh| mesh.vertices.len()).sum();
        reader.within("vertices", vertices as u64, limits.vertices)?;
    }
    let scene = file.default_scene().or_else(|| file.scenes().next()).ok_or_else(|| reader.wrong("has no scene"))?;
    for node in scene.nodes() {
        reader.node(&node, DMat4::IDENTITY, 0)?;
    }
    Ok(reader.model)
}

/// The library looks up the accessor of positions before it has checked that there is one.
fn check_attributes(bytes: &[u8], path: &Path) -> Result<(), ImportError> {
    let json = match gltf::Glb::from_slice(bytes) {
        Ok(glb) => glb.json,
        Err(_) => bytes.into(),
    };
    // Other faults are the library's to report.
    let Ok(root) = gltf::json::Root::from_slice(&json) else { return Ok(()) };
    for (mesh, primitive) in
        root.meshes.iter().enumerate().flat_map(|(i, mesh)| mesh.primitives.iter().map(move |p| (i, p)))
    {
        if let Some(index) = primitive.attributes.values().find(|index| index.value() >= root.accessors.len()) {
            let count = root.accessors.len();
            return Err(ImportError::content(path, format!("mesh {mesh} names accessor {index} of {count}")));
        }
    }
    Ok(())
}

/// A file being read.
struct Reader<'a> {
    path: &'a Path,
    limits: &'a Limits,
    buffers: Vec<Vec<u8>>,
    /// Mesh and material of each primitive, by glTF mesh.
    primitives: Vec<Vec<(usize, usize)>>,
    model: Model,
}

impl Reader<'_> {
    fn wrong(&self, message: impl std::fmt::Display) -> ImportError {
        ImportError::content(self.path, message)
    }

    fn within(&self, name: &str, amount: u64, limit: u64) -> Result<(), ImportError> {
        if amount <= limit {
            return Ok(());
        }
        Err(self.wrong(format!("{amount} are needed so far, and the limit `{name}` is {limit}")))
    }

    /// The bytes behind a URI: base64 data, or a file beside this one.
    fn resource(&self, uri: &str) -> Result<Vec<u8>, ImportError> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (_, encoded) =
                data.split_once(";base64,").ok_or_else(|| self.wrong("has a data URI without base64"))?;
            return base64::engine::general_purpose::STANDARD.decode(encoded).map_err(|error| self.wrong(error));
        }
        if uri.contains("://") {
            return Err(self.wrong(format!("`{uri}` is not a file; outmerge reads nothing from the network")));
        }
        read(&self.path.with_file_name(uri), self.limits)
    }

    /// The part of a buffer that a view names.
    fn view(&self, view: &gltf::buffer::View<'_>) -> Result<&[u8], ImportError> {
        let buffer = self.buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end))
            .ok_or_else(|| self.wrong(format!("buffer view {} reaches beyond its buffer", view.index())))
    }

    fn texture(&self, texture: &gltf::Texture<'_>) -> Result<Texture, ImportError> {
        let bytes = match texture.source().source() {
            gltf::image::Source::View { view, .. } => self.view(&view)?.to_vec(),
            gltf::image::Source::Uri { uri, .. } => self.resource(uri)?,
        };
        let image = png::decode(&bytes, self.path, ColorSpace::Srgb).map_err(|error| self.wrong(error))?;
        let sampler = texture.sampler();
        let address = |mode| match mode {
            WrappingMode::ClampToEdge => AddressMode::ClampToEdge,
            WrappingMode::MirroredRepeat => AddressMode::MirrorRepeat,
            WrappingMode::Repeat => AddressMode::Repeat,
        };
        let filter =
            if sampler.mag_filter() == Some(MagFilter::Nearest) { FilterMode::Nearest } else { FilterMode::Linear };
        let mips = match sampler.min_filter() {
            Some(MinFilter::Nearest | MinFilter::Linear) => None,
            Some(MinFilter::NearestMipmapNearest | MinFilter::LinearMipmapNearest) => Some(MipmapFilterMode::Nearest),
            Some(MinFilter::NearestMipmapLinear | MinFilter::LinearMipmapLinear) => Some(MipmapFilterMode::Linear),
            // The file leaves it to us.
            None => (filter == FilterMode::Linear).then_some(MipmapFilterMode::Linear),
        };
        let address = [address(sampler.wrap_s()), address(sampler.wrap_t())];
        Ok(Texture::new(image, Sampler { filter, address, mips }))
    }

    fn material(&self, file: &gltf::Material<'_>) -> Result<Material, ImportError> {
        let mode = match file.alpha_mode() {
            AlphaMode::Opaque => RenderingMode::Opaque,
            AlphaMode::Mask => RenderingMode::Cutout,
            AlphaMode::Blend => RenderingMode::Fade,
        };
        let name = file.name().map_or_else(|| format!("material {}", self.model.materials.len()), str::to_owned);
        let mut material = Material::new(&name, mode);
        let surface = file.pbr_metallic_roughness();
        material.tint = surface.base_color_factor();
        material.texture = surface.base_color_texture().map(|info| info.texture().index());
        material.cutoff = file.alpha_cutoff().unwrap_or(0.5);
        if !file.unlit() {
            let (metallic, smoothness) = (surface.metallic_factor(), 1.0 - surface.roughness_factor());
            material.shading =
                Shading::Lit { metallic: metallic.clamp(0.0, 1.0), smoothness: smoothness.clamp(0.0, 1.0) };
        }
        if file.double_sided() {
            let mut passes: Vec<Pass> = material.passes();
            passes.iter_mut().for_each(|pass| pass.state.cull = None);
            material.passes = Some(passes);
        }
        let numbers = material.tint.iter().chain([&material.cutoff]);
        if numbers.into_iter().any(|x| !x.is_finite())
            || material.texture.is_some_and(|i| i >= self.model.textures.len())
        {
            return Err(self.wrong(format!("material `{name}` has a number that is not finite or a missing texture")));
        }
        Ok(material)
    }

    /// Reads a primitive into a mesh; gives mesh and material.
    fn primitive(&mut self, primitive: &gltf::Primitive<'_>) -> Result<(usize, usize), ImportError> {
        if primitive.mode() != Mode::Triangles {
            return Err(self.wrong(format!("primitives of mode {:?} are not read, triangles only", primitive.mode())));
        }
        for (semantic, accessor) in primitive.attributes() {
            let expected = match semantic {
                gltf::Semantic::Positions | gltf::Semantic::Normals => Dimensions::Vec3,
                gltf::Semantic::TexCoords(0) => Dimensions::Vec2,
                _ => continue,
            };
            let float = accessor.data_type() == DataType::F32 || expected == Dimensions::Vec2;
            if accessor.dimensions() != expected || !float {
                return Err(self.wrong(format!("accessor {} has the wrong type for {semantic:?}", accessor.index())));
            }
            self.check(&accessor)?;
        }
        if let Some(accessor) = primitive.indices() {
            self.check(&accessor)?;
        }
        let reader = primitive.reader(|buffer| self.buffers.get(buffer.index()).map(Vec::as_slice));
        let vector = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), y.into(), z.into());
        let positions: Vec<DVec3> =
            reader.read_positions().ok_or_else(|| self.wrong("a primitive has no positions"))?.map(vector).collect();
        let normals: Vec<DVec3> = reader.read_normals().map(|list| list.map(vector).collect()).unwrap_or_default();
        let uvs: Vec<DVec2> = reader
            .read_tex_coords(0)
            .map(|list| list.into_f32().map(|[u, v]| DVec2::new(u.into(), v.into())).collect())
            .unwrap_or_default();
        let count = u32::try_from(positions.len()).unwrap_or(u32::MAX);
        let indices: Vec<u32> =
            reader.read_indices().map_or_else(|| (0..count).collect(), |list| list.into_u32().collect());
        if indices.len() > MAX_VERTICES {
            return Err(self.wrong(format!("a primitive has more than {MAX_VERTICES} corners")));
        }
        let mut mesh = Mesh::default();
        for corners in indices.chunks_exact(3) {
            let corner = |index: u32| {
                let i = index as usize;
                let uv = uvs.get(i).copied().unwrap_or_default();
                let position = positions.get(i).copied().filter(|position| position.is_finite() && uv.is_finite());
                let position =
                    position.ok_or_else(|| self.wrong(format!("vertex {index} is missing or not finite")))?;
                Ok::<_, ImportError>((position, normals.get(i).copied().and_then(DVec3::try_normalize), uv))
            };
            mesh.push_triangle([corner(corners[0])?, corner(corners[1])?, corner(corners[2])?]);
        }
        let default = self.model.materials.len() - 1;
        let material = primitive.material().index().unwrap_or(default).min(default);
        self.model.meshes.push(mesh);
        Ok((self.model.meshes.len() - 1, material))
    }

    /// Fails unless an accessor stays within its buffer view.
    fn check(&self, accessor: &gltf::Accessor<'_>) -> Result<(), ImportError> {
        let view = match (accessor.view(), accessor.sparse()) {
            (Some(view), None) => view,
            _ => return Err(self.wrong(format!("accessor {} is sparse, which is not read", accessor.index()))),
        };
        let length = self.view(&view)?.len();
        let stride = view.stride().unwrap_or(accessor.size());
        let last = accessor.count().checked_sub(1).and_then(|count| count.checked_mul(stride));
        let end = last.and_then(|last| last.checked_add(accessor.offset())?.checked_add(accessor.size()));
        if stride < accessor.size() || end.is_none_or(|end| end > length) {
            return Err(self.wrong(format!("accessor {} reaches beyond its buffer view", accessor.index())));
        }
        Ok(())
    }

    /// Adds the objects of a node and those below it.
    fn node(&mut self, node: &gltf::Node<'_>, parent: DMat4, depth: usize) -> Result<(), ImportError> {
        if depth > MAX_DEPTH || self.model.objects.len() > MAX_OBJECTS {
            return Err(self.wrong(format!("has nodes more than {MAX_DEPTH} deep or more than {MAX_OBJECTS} objects")));
        }
        let local = DMat4::from_cols_array_2d(&node.transform().matrix().map(|column| column.map(f64::from)));
        let transform = parent * local;
        if !transform.is_finite() {
            return Err(self.wrong(format!("node {} has a transform that is not finite", node.index())));
        }
        if let Some(mesh) = node.mesh() {
            let primitives = self.primitives.get(mesh.index()).cloned().unwrap_or_default();
            for (mesh, material) in primitives {
                let number = self.model.objects.len();
                let name = format!("{} {number}", node.name().unwrap_or("node"));
                self.model.objects.push(Object { name, mesh, material, transform: DAffine3::from_mat4(transform) });
            }
        }
        for child in node.children() {
            self.node(&child, transform, depth + 1)?;
        }
        Ok(())
    }
}
