//! From the file as written to meshes, textures and materials.

use std::path::Path;

use glam::{DVec2, DVec3};
use wgpu_types::{AddressMode, BlendFactor, FilterMode};

use super::build::{built_in_meshes, point};
use super::check::{at_most, distinct, finite, named, within, within_limit};
use super::error::{Fault, FieldPath};
use super::schema::{FileMaterial, FileMesh, FilePass, FileQueue, FileTexture};
use crate::limit::Limits;
use crate::scene::import;
use crate::scene::material::{Material, Pass, Shader, Shading};
use crate::scene::mesh::{MAX_VERTICES, Mesh, MeshVertex};
use crate::scene::queue::RenderQueue;
use crate::scene::texture::pattern::PatternImage;
use crate::scene::texture::{MAX_TEXTURE_SIZE, Sampler, Storage, Texture, png};
use crate::state::shaderlab::{self, Properties, PropertyValue};

/// Cutoff of materials that give none.
const DEFAULT_CUTOFF: f32 = 0.5;

/// Built-in meshes and those of the file, with their names.
pub(super) fn meshes(
    files: &[FileMesh],
    field: &FieldPath,
    folder: &Path,
    limits: &Limits,
) -> Result<(Vec<String>, Vec<Mesh>), Fault> {
    let (mut names, mut meshes): (Vec<_>, Vec<_>) =
        built_in_meshes().into_iter().map(|(name, mesh)| (name.to_owned(), mesh)).unzip();
    for (i, file) in files.iter().enumerate() {
        let field = field.index(i);
        meshes.push(mesh(file, &field, folder, limits)?);
        within_limit(&field, "vertices", vertices(&meshes), limits.vertices)?;
        if names.contains(&file.name) {
            return Err(Fault::new(&field.key("name"), format!("`{}` is defined twice", file.name)));
        }
        names.push(file.name.clone());
    }
    Ok((names, meshes))
}

/// Vertices of all meshes.
pub(super) fn vertices(meshes: &[Mesh]) -> u64 {
    meshes.iter().map(|mesh| mesh.vertices.len() as u64).sum()
}

/// Bytes of all textures in memory, mip levels included.
pub(super) fn texture_bytes(textures: &[Texture]) -> u64 {
    textures.iter().map(Texture::bytes).sum()
}

fn mesh(file: &FileMesh, field: &FieldPath, folder: &Path, limits: &Limits) -> Result<Mesh, Fault> {
    match (file.sphere_segments, &file.file, file.faces.is_empty()) {
        (Some(segments), None, true) => Ok(Mesh::sphere(within(&field.key("sphere-segments"), segments, 4..=512)?)),
        (None, Some(name), true) => {
            import::load_mesh(&folder.join(name), limits).map_err(|error| Fault::new(&field.key("file"), error))
        }
        (None, None, false) => faces(file, field),
        _ => Err(Fault::new(field, "give one of `sphere-segments`, `file`, or `positions` and `faces`")),
    }
}

fn faces(file: &FileMesh, field: &FieldPath) -> Result<Mesh, Fault> {
    at_most(&field.key("positions"), file.positions.len(), MAX_VERTICES)?;
    if !file.uvs.is_empty() && file.uvs.len() != file.positions.len() {
        let message = format!("{} texture coordinates for {} positions", file.uvs.len(), file.positions.len());
        return Err(Fault::new(&field.key("uvs"), message));
    }
    let mut mesh = Mesh::default();
    for (i, indices) in file.faces.iter().enumerate() {
        let field = field.key("faces").index(i);
        if !(3..=64).contains(&indices.len()) {
            return Err(Fault::new(&field, "a face has 3 to 64 corners"));
        }
        // Each face has vertices of its own, so that its normal is its own.
        let start = u32::try_from(mesh.vertices.len()).unwrap_or(u32::MAX);
        at_most(&field, mesh.vertices.len() + indices.len(), MAX_VERTICES)?;
        for index in indices {
            let position = file.positions.get(*index as usize);
            let position = *position.ok_or_else(|| {
                Fault::new(
                    &field,
                    format!("index {index} is out of range; there are {} positions", file.positions.len()),
                )
            })?;
            let uv = file.uvs.get(*index as usize).copied().unwrap_or_default();
            mesh.vertices.push(MeshVertex {
                position: point(&field, position)?,
                normal: DVec3::Z,
                uv: DVec2::from(finite(&field, uv)?),
            });
        }
        let count = u32::try_from(indices.len()).unwrap_or(u32::MAX);
        mesh.faces.push((start..start + count).collect());
        let corners = &mut mesh.vertices[start as usize..];
        let normal = plane_normal(corners)
            .ok_or_else(|| Fault::new(&field, "the corners must span a plane, all lie in it, and turn one way only"))?;
        corners.iter_mut().for_each(|vertex| vertex.normal = normal);
    }
    Ok(mesh)
}

/// The normal of a planar convex polygon; `None` if it is neither.
fn plane_normal(corners: &[MeshVertex]) -> Option<DVec3> {
    let at = |i: usize| corners[i % corners.len()].position;
    let turn = |i: usize| (at(i + 1) - at(i)).cross(at(i + 2) - at(i + 1));
    let normal = (0..corners.len()).map(turn).sum::<DVec3>().try_normalize()?;
    let size = corners.iter().map(|corner| (corner.position - at(0)).length()).fold(0.0, f64::max);
    let planar = corners.iter().all(|corner| (corner.position - at(0)).dot(normal).abs() <= 1e-6 * size);
    let convex = (0..corners.len()).all(|i| turn(i).dot(normal) >= -1e-9 * size * size);
    (planar && convex).then_some(normal)
}

pub(super) fn textures(
    files: &[FileTexture],
    field: &FieldPath,
    folder: &Path,
    limits: &Limits,
) -> Result<Vec<Texture>, Fault> {
    distinct(field, files.iter().map(|file| file.name.as_str()))?;
    let mut textures = Vec::new();
    for (i, file) in files.iter().enumerate() {
        let field = field.index(i);
        textures.push(texture(file, &field, folder, limits)?);
        within_limit(&field, "texture-bytes", texture_bytes(&textures), limits.texture_bytes)?;
    }
    Ok(textures)
}

fn texture(file: &FileTexture, field: &FieldPath, folder: &Path, limits: &Limits) -> Result<Texture, Fault> {
    let image = match (&file.file, file.pattern) {
        (Some(name), None) => {
            let path = folder.join(name);
            png::load_within(&path, file.space, limits).map_err(|error| Fault::new(&field.key("file"), error))?
        }
        (None, Some(pattern)) => {
            let [width, height] = file.size.unwrap_or([64, 64]);
            let side = |value| {
                let side = within(&field.key("size"), value, 1..=i64::from(MAX_TEXTURE_SIZE))?;
                Ok(u32::try_from(side).unwrap_or(MAX_TEXTURE_SIZE))
            };
            at_most(&field.key("colors"), file.colors.len(), 2)?;
            let color = |i: usize, default| match file.colors.get(i) {
                Some(color) => finite(&field.key("colors").index(i), *color),
                None => Ok(default),
            };
            let colors = [color(0, [1.0; 4])?, color(1, [0.0; 4])?];
            let cells = within(&field.key("cells"), file.cells.unwrap_or(8), 1..=1024)?;
            let picture = PatternImage { pattern, size: [side(width)?, side(height)?], colors, cells };
            picture.draw(file.space).map_err(|error| Fault::new(field, error))?
        }
        _ => return Err(Fault::new(field, "give either `file` or `pattern`")),
    };
    let sampler = Sampler {
        filter: file.filter.unwrap_or(FilterMode::Linear),
        address: file.address.unwrap_or([AddressMode::Repeat; 2]),
        mips: file.mips,
    };
    Ok(Texture::new(file.storage.store(image, file.space), sampler))
}

pub(super) fn materials(
    files: &[FileMaterial],
    textures: &[FileTexture],
    field: &FieldPath,
    limits: &Limits,
) -> Result<Vec<Material>, Fault> {
    distinct(field, files.iter().map(|file| file.name.as_str()))?;
    files.iter().enumerate().map(|(i, file)| material(file, textures, &field.index(i), limits)).collect()
}

fn material(
    file: &FileMaterial,
    textures: &[FileTexture],
    field: &FieldPath,
    limits: &Limits,
) -> Result<Material, Fault> {
    let texture = match &file.texture {
        Some(name) => {
            let names = textures.iter().map(|texture| texture.name.as_str());
            Some(named(&field.key("texture"), "texture", name, names)?)
        }
        None => None,
    };
    let unit = |name: &str, value: Option<f32>| within(&field.key(name), value.unwrap_or(0.0), 0.0..=1.0);
    let shading = match (file.metallic, file.smoothness) {
        (None, None) => Shading::Unlit,
        (metallic, smoothness) => {
            Shading::Lit { metallic: unit("metallic", metallic)?, smoothness: unit("smoothness", smoothness)? }
        }
    };
    let premultiplied = |texture: &FileTexture| {
        use Storage::{Premultiplied, Premultiplied8, Premultiplied16};
        texture.premultiplied || matches!(texture.storage, Premultiplied | Premultiplied8 | Premultiplied16)
    };
    within_limit(&field.key("pass"), "passes", file.pass.len() as u64, limits.passes)?;
    let passes = file.pass.iter().enumerate().map(|(i, pass)| self::pass(pass, i, file, &field.key("pass").index(i)));
    let passes: Vec<_> = passes.collect::<Result<_, _>>()?;
    let tagged_queue = tag(&passes, "Queue").map(|name| FileQueue::Name(name.to_owned()));
    Ok(Material {
        name: file.name.clone(),
        mode: file.mode,
        tint: finite(&field.key("tint"), file.tint.unwrap_or([1.0; 4]))?,
        texture,
        premultiplied_texture: texture.is_some_and(|i| premultiplied(&textures[i])),
        smoothness_in_alpha: file.smoothness_in_alpha,
        cutoff: finite(&field.key("cutoff"), [file.cutoff.unwrap_or(DEFAULT_CUTOFF)])?[0],
        shading,
        queue: queue(file.queue.as_ref().or(tagged_queue.as_ref()), &field.key("queue"))?,
        render_type: file.render_type.clone().or(tag(&passes, "RenderType").map(str::to_owned)),
        passes: (!passes.is_empty()).then_some(passes),
    })
}

/// The queue a material sets; -1 stands for the mode's.
fn queue(file: Option<&FileQueue>, field: &FieldPath) -> Result<Option<RenderQueue>, Fault> {
    let queue = match file {
        None | Some(FileQueue::Number(-1)) => return Ok(None),
        Some(FileQueue::Number(number)) => RenderQueue::new(*number),
        Some(FileQueue::Name(name)) => name.parse(),
    };
    queue.map(Some).map_err(|error| Fault::new(field, error))
}

/// A pass with the state of its text, or the mode's without one.
fn pass(file: &FilePass, index: usize, material: &FileMaterial, field: &FieldPath) -> Result<Pass, Fault> {
    let preset = match file.shader {
        Shader::Light => Pass::additive(material.mode),
        Shader::Base | Shader::Flat => Pass::base(material.mode),
    };
    let mut name = file.name.clone();
    let state = match &file.state {
        None => preset.state,
        Some(text) => {
            let field = field.key("state");
            let mut passes =
                shaderlab::parse(text, &properties(material)).map_err(|error| Fault::new(&field, error))?;
            let (Some(pass), true) = (passes.pop(), passes.is_empty()) else {
                return Err(Fault::new(&field, "holds several passes; write a `[[material.pass]]` for each"));
            };
            name = name.or(pass.name);
            pass.state
        }
    };
    Ok(Pass {
        name: name.unwrap_or_else(|| format!("pass {index}")),
        shader: file.shader,
        state,
        blend_constant: finite(&field.key("blend-constant"), file.blend_constant.unwrap_or_default())?,
    })
}

/// What `[_Property]` references in state texts stand for: the mode's factors and depth write, and the cutoff.
fn properties(material: &FileMaterial) -> Properties {
    let settings = material.mode.settings();
    let name = |factor: BlendFactor| PropertyValue::Name(format!("{factor:?}"));
    let cutoff = f64::from(material.cutoff.unwrap_or(DEFAULT_CUTOFF));
    [
        ("_SrcBlend", name(settings.src_blend)),
        ("_DstBlend", name(settings.dst_blend)),
        ("_ZWrite", PropertyValue::Number(if settings.depth_write { 1.0 } else { 0.0 })),
        ("_Cutoff", PropertyValue::Number(cutoff)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// A tag of the passes; the first that has it counts.
fn tag<'a>(passes: &'a [Pass], name: &str) -> Option<&'a str> {
    passes.iter().find_map(|pass| pass.state.tag(name))
}
