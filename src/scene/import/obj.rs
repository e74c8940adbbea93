//! Wavefront OBJ: all groups of a file as one mesh of triangles; materials are the scene's business.

use std::io::Cursor;
use std::path::Path;

use glam::{DVec2, DVec3};
use tobj::LoadOptions;

use super::{ImportError, read};
use crate::limit::Limits;
use crate::scene::mesh::{MAX_VERTICES, Mesh};

/// Reads a file. Missing normals are the faces' own; v points down, as images do.
///
/// # Errors
/// [`ImportError`].
pub fn load(path: &Path, limits: &Limits) -> Result<Mesh, ImportError> {
    parse(&read(path, limits)?, path)
}

/// Reads the text of a file; `path` serves messages.
///
/// # Errors
/// [`ImportError`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<Mesh, ImportError> {
    let options = LoadOptions { triangulate: true, single_index: true, ..LoadOptions::default() };
    let no_materials = |_: &Path| Ok((Vec::new(), Default::default()));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials)
        .map_err(|error| ImportError::content(path, error))?;
    let mut mesh = Mesh::default();
    for model in &models {
        append(&mut mesh, &model.mesh).map_err(|message| ImportError::content(path, message))?;
    }
    if mesh.faces.is_empty() {
        return Err(ImportError::content(path, "has no faces"));
    }
    Ok(mesh)
}

fn append(mesh: &mut Mesh, part: &tobj::Mesh) -> Result<(), String> {
    if mesh.vertices.len() + part.indices.len() > MAX_VERTICES {
        return Err(format!("has more than {MAX_VERTICES} corners"));
    }
    let vector =
        |list: &[f32], i: usize| list.get(3 * i..3 * i + 3).map(|v| DVec3::new(v[0].into(), v[1].into(), v[2].into()));
    for corners in part.indices.chunks_exact(3) {
        let corner = |index: u32| {
            let i = index as usize;
            let position = vector(&part.positions, i).ok_or_else(|| format!("vertex {index} does not exist"))?;
            let uv = part
                .texcoords
                .get(2 * i..2 * i + 2)
                .map_or(DVec2::ZERO, |t| DVec2::new(t[0].into(), 1.0 - f64::from(t[1])));
            if !(position.is_finite() && uv.is_finite()) {
                return Err(format!("vertex {index} is not finite"));
            }
            Ok((position, vector(&part.normals, i).and_then(DVec3::try_normalize), uv))
        };
        let triangle = [corner(corners[0])?, corner(corners[1])?, corner(corners[2])?];
        mesh.push_triangle(triangle);
    }
    Ok(())
}
