//! From the file as written to a checked scene: target, camera, light, objects.

use std::path::Path;

use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};
use wgpu_types::TextureFormat;

use super::appearance;
use super::check::{at_most, distinct, finite, named, positive, within, within_limit};
use super::error::{Fault, FieldPath};
use super::schema::{FileCamera, FileColor, FileLight, FileModel, FileObject, FileScene, FileTarget};
use crate::format::{ColorFormat, DepthFormat};
use crate::limit::Limits;
use crate::scene::camera::{Camera, Projection};
use crate::scene::description::{ColorSpec, DepthSpec, Object, Output, Replacement, Scene, TargetSpec};
use crate::scene::import;
use crate::scene::material::{Light, Lighting, Material};
use crate::scene::mesh::Mesh;
use crate::scene::raster::{MAX_SUBPIXEL_BITS, MIN_SUBPIXEL_BITS};
use crate::state::MAX_COLOR_TARGETS;
use crate::target::{Extent, MAX_DIMENSION};

/// Coordinates, distances and scales may reach this: far from where binary32 overflows.
const MAX_LENGTH: f64 = 1e9;

/// Checks a file and builds the scene; `folder` is where relative file names start.
pub(super) fn build(file: &FileScene, folder: &Path, limits: &Limits) -> Result<Scene, Fault> {
    let root = FieldPath::default();
    for (section, count) in [
        ("light", file.light.len()),
        ("texture", file.texture.len()),
        ("mesh", file.mesh.len()),
        ("material", file.material.len()),
        ("model", file.model.len()),
    ] {
        within_limit(&root.key(section), "entries", count as u64, limits.entries)?;
    }
    within_limit(&root.key("object"), "objects", file.object.len() as u64, limits.objects)?;
    let lights = file.light.iter().enumerate().map(|(i, file)| light(file, &root.key("light").index(i)));
    let ambient = Vec3::from(finite(&root.key("ambient"), file.ambient)?);
    let (mesh_names, meshes) = appearance::meshes(&file.mesh, &root.key("mesh"), folder, limits)?;
    let textures = appearance::textures(&file.texture, &root.key("texture"), folder, limits)?;
    let materials = appearance::materials(&file.material, &file.texture, &root.key("material"), limits)?;
    let mut scene = Scene {
        title: file.title.clone(),
        explanation: file.explanation.split_whitespace().collect::<Vec<_>>().join(" "),
        technique: file.technique.clone(),
        target: target(&file.target, &root.key("target"), limits)?,
        camera: camera(&file.camera, &root.key("camera"))?,
        lighting: Lighting { ambient, lights: lights.collect::<Result<_, _>>()? },
        textures,
        meshes,
        materials,
        objects: Vec::new(),
        order: file.order,
        reference: file.reference,
        replacement: None,
    };
    for (i, object) in file.object.iter().enumerate() {
        let object = self::object(object, i, &root.key("object").index(i), &mesh_names, &scene)?;
        scene.objects.push(object);
    }
    for (i, model) in file.model.iter().enumerate() {
        let field = root.key("model").index(i);
        self::model(model, &field, folder, limits, &mut scene)?;
        within_limit(&field, "vertices", appearance::vertices(&scene.meshes), limits.vertices)?;
        within_limit(&field, "texture-bytes", appearance::texture_bytes(&scene.textures), limits.texture_bytes)?;
    }
    within_limit(&root.key("model"), "objects", scene.objects.len() as u64, limits.objects)?;
    distinct(&root.key("object"), scene.objects.iter().map(|object| object.name.as_str()))?;
    if let Some(replacement) = &file.replacement {
        scene.replacement = Some(Replacement {
            render_type: replacement.render_type.clone(),
            color: finite(&root.key("replacement").key("color"), replacement.color)?,
            keep_others: replacement.keep_others,
        });
    }
    Ok(scene)
}

fn target(file: &FileTarget, field: &FieldPath, limits: &Limits) -> Result<TargetSpec, Fault> {
    let side = |name: &str, value: i64| {
        let side = within(&field.key(name), value, 1..=i64::from(MAX_DIMENSION))?;
        Ok(u32::try_from(side).unwrap_or(MAX_DIMENSION))
    };
    let (width, height) = (side("width", file.width)?, side("height", file.height)?);
    let extent = Extent::new(width, height).map_err(|error| Fault::new(field, error))?;
    let color = |file: &FileColor, field: &FieldPath| {
        let format = ColorFormat::from_name(&file.format).map_err(|error| Fault::new(&field.key("format"), error))?;
        Ok(ColorSpec { format, clear: finite(&field.key("clear"), file.clear)?, output: file.output })
    };
    at_most(&field.key("color"), file.color.len(), MAX_COLOR_TARGETS)?;
    let colors = if file.color.is_empty() {
        let format = file.format.clone().unwrap_or_else(|| "rgba8unorm".to_owned());
        let single = FileColor { format, clear: file.clear.unwrap_or_default(), output: Output::Color };
        vec![color(&single, field)?]
    } else if file.format.is_some() || file.clear.is_some() {
        return Err(Fault::new(field, "give either `format` and `clear`, or `[[target.color]]` with a format each"));
    } else {
        let list = field.key("color");
        file.color.iter().enumerate().map(|(i, file)| color(file, &list.index(i))).collect::<Result<_, _>>()?
    };
    let depth = match file.depth.as_deref() {
        Some("none") => None,
        name => Some(DepthSpec {
            format: depth_format(name.unwrap_or("depth24plus"), &field.key("depth"))?,
            clear: within(&field.key("clear-depth"), file.clear_depth.unwrap_or(1.0), 0.0..=1.0)?,
            clear_stencil: file.clear_stencil.unwrap_or(0),
        }),
    };
    let texel: usize = colors.iter().map(|color| color.format.bytes_per_texel()).sum();
    // A depth code takes 4 bytes and a stencil value 1, whatever the format.
    let texel = texel + if depth.is_some() { 5 } else { 0 };
    within_limit(field, "target-bytes", (texel as u64) * (extent.sample_total() as u64), limits.target_bytes)?;
    let bits = file.subpixel_bits.unwrap_or(MAX_SUBPIXEL_BITS);
    let subpixel_bits = within(&field.key("subpixel-bits"), bits, MIN_SUBPIXEL_BITS..=MAX_SUBPIXEL_BITS)?;
    Ok(TargetSpec { extent, colors, depth, display: file.display, subpixel_bits, rasteriser: file.rasteriser })
}

fn depth_format(name: &str, field: &FieldPath) -> Result<TextureFormat, Fault> {
    use TextureFormat as T;
    let format = match name {
        "depth16unorm" => T::Depth16Unorm,
        "depth24plus" => T::Depth24Plus,
        "depth24plus-stencil8" => T::Depth24PlusStencil8,
        "depth32float" => T::Depth32Float,
        "depth32float-stencil8" => T::Depth32FloatStencil8,
        "stencil8" => T::Stencil8,
        _ => {
            let known =
                "none, depth16unorm, depth24plus, depth24plus-stencil8, depth32float, depth32float-stencil8, stencil8";
            return Err(Fault::new(field, format!("`{name}` is not a depth/stencil format; use {known}")));
        }
    };
    DepthFormat::new(format).map_err(|error| Fault::new(field, error))?;
    Ok(format)
}

fn camera(file: &FileCamera, field: &FieldPath) -> Result<Camera, Fault> {
    let vector = |name: &str, value: Option<[f64; 3]>, default: DVec3| match value {
        Some(value) => point(&field.key(name), value),
        None => Ok(default),
    };
    let eye = vector("eye", file.eye, DVec3::new(0.0, 0.0, 5.0))?;
    let target = vector("look-at", file.look_at, DVec3::ZERO)?;
    let up = vector("up", file.up, DVec3::Y)?;
    let forward = (target - eye).try_normalize().ok_or_else(|| {
        Fault::new(&field.key("look-at"), "the camera looks at its own position; `eye` and `look-at` must differ")
    })?;
    if up.try_normalize().is_none_or(|up| forward.cross(up).length() < 1e-6) {
        return Err(Fault::new(&field.key("up"), "must not be zero nor point along the view direction"));
    }
    let projection = match (file.fov_y, file.height) {
        (Some(_), Some(_)) => {
            return Err(Fault::new(field, "give either `fov-y` (perspective) or `height` (orthographic)"));
        }
        (Some(fov_y), None) => Projection::Perspective { fov_y: within(&field.key("fov-y"), fov_y, 1.0..=170.0)? },
        (None, height) => {
            let field = field.key("height");
            let height = positive(&field, height.unwrap_or(2.0))?;
            Projection::Orthographic { height: within(&field, height, 0.0..=MAX_LENGTH)? }
        }
    };
    let near = positive(&field.key("near"), file.near.unwrap_or(0.1))?;
    let far = within(&field.key("far"), file.far.unwrap_or(100.0), 0.0..=MAX_LENGTH)?;
    if far <= near {
        return Err(Fault::new(
            &field.key("far"),
            format!("the far plane at {far} must lie behind the near one at {near}"),
        ));
    }
    Ok(Camera { eye, target, up, projection, near, far, reversed: file.reversed_depth })
}

fn light(file: &FileLight, field: &FieldPath) -> Result<Light, Fault> {
    let color = Vec3::from(finite(&field.key("color"), file.color.unwrap_or([1.0; 3]))?);
    match (file.direction, file.position) {
        (Some(direction), None) => {
            let direction = Vec3::from(finite(&field.key("direction"), direction)?);
            let toward = (-direction).try_normalize();
            let toward = toward.ok_or_else(|| Fault::new(&field.key("direction"), "must not be zero"))?;
            Ok(Light::Directional { toward, color })
        }
        (None, Some(position)) => {
            let position = Vec3::from(finite(&field.key("position"), position)?);
            let range = within(&field.key("range"), file.range.unwrap_or(10.0), 1e-3..=1e6)?;
            Ok(Light::Point { position, color, range })
        }
        _ => Err(Fault::new(field, "give either `direction` or `position`")),
    }
}

fn object(
    file: &FileObject,
    index: usize,
    field: &FieldPath,
    mesh_names: &[String],
    scene: &Scene,
) -> Result<Object, Fault> {
    let mesh = named(&field.key("mesh"), "mesh", &file.mesh, mesh_names.iter().map(String::as_str))?;
    let materials = scene.materials.iter().map(|material| material.name.as_str());
    let material = named(&field.key("material"), "material", &file.material, materials)?;
    let transform = transform(field, file.position, file.rotation, file.scale)?;
    let name = file.name.clone().unwrap_or_else(|| format!("{} {index}", file.mesh));
    Ok(Object { name, mesh, material, transform })
}

/// Scale, then rotation, then position.
fn transform(
    field: &FieldPath,
    position: Option<[f64; 3]>,
    rotation: Option<[f64; 3]>,
    scale: Option<[f64; 3]>,
) -> Result<DAffine3, Fault> {
    let position = point(&field.key("position"), position.unwrap_or_default())?;
    let scale = point(&field.key("scale"), scale.unwrap_or([1.0; 3]))?;
    let [x, y, z] = finite(&field.key("rotation"), rotation.unwrap_or_default())?.map(f64::to_radians);
    // About x first, then y, then z: the matrix product z y x.
    let rotation = DQuat::from_euler(EulerRot::ZYX, z, y, x);
    let transform = DAffine3::from_scale_rotation_translation(scale, rotation, position);
    if transform.matrix3.determinant() == 0.0 {
        return Err(Fault::new(&field.key("scale"), "must not be zero in any direction"));
    }
    Ok(transform)
}

/// Adds what a model file holds to the scene.
fn model(file: &FileModel, field: &FieldPath, folder: &Path, limits: &Limits, scene: &mut Scene) -> Result<(), Fault> {
    let place = transform(field, file.position, file.rotation, file.scale)?;
    let model =
        import::load_model(&folder.join(&file.file), limits).map_err(|error| Fault::new(&field.key("file"), error))?;
    let (textures, meshes, materials) = (scene.textures.len(), scene.meshes.len(), scene.materials.len());
    scene.textures.extend(model.textures);
    scene.meshes.extend(model.meshes);
    scene.materials.extend(model.materials.into_iter().map(|material| Material {
        name: format!("{}: {}", file.name, material.name),
        texture: material.texture.map(|i| i + textures),
        ..material
    }));
    scene.objects.extend(model.objects.into_iter().map(|object| Object {
        name: format!("{}: {}", file.name, object.name),
        mesh: object.mesh + meshes,
        material: object.material + materials,
        transform: place * object.transform,
    }));
    Ok(())
}

/// A point or vector of a sensible size.
pub(super) fn point(field: &FieldPath, value: [f64; 3]) -> Result<DVec3, Fault> {
    let point = DVec3::from(finite(field, value)?);
    if point.abs().max_element() > MAX_LENGTH {
        return Err(Fault::new(field, format!("coordinates may reach {MAX_LENGTH} at most")));
    }
    Ok(point)
}

/// The meshes every scene has.
pub(super) fn built_in_meshes() -> [(&'static str, Mesh); 3] {
    [("quad", Mesh::quad()), ("cube", Mesh::cube()), ("sphere", Mesh::sphere(48))]
}
