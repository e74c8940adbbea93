//! Meshes and models from other programs' files (feature `meshes`).
//!
//! - [`obj`]: Wavefront OBJ, one mesh a file, materials left out;
//! - [`gltf`]: glTF 2.0, `.gltf` or `.glb`: meshes, materials with their alpha modes, textures, node transforms.

#[cfg(feature = "meshes")]
pub mod gltf;
#[cfg(feature = "meshes")]
pub mod obj;
#[cfg(all(test, feature = "meshes"))]
mod tests;

use std::path::{Path, PathBuf};

use super::description::Object;
use super::material::Material;
use super::mesh::Mesh;
use super::texture::Texture;
use crate::limit::{self, Limits};

/// A mesh or model file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file could not be read.
    #[error("cannot read `{path}`: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The file is too large.
    #[error("`{path}` has more than {limit} bytes, the limit `import-bytes`")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit in bytes.
        limit: u64,
    },
    /// The file is malformed, or holds what this reader does not know.
    #[error("`{path}`: {message}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// This build reads no such files.
    #[error("`{path}` is a mesh or model file, which this build does not read; build outmerge with feature `meshes`")]
    NotBuilt {
        /// The file.
        path: PathBuf,
    },
}

impl ImportError {
    #[cfg(feature = "meshes")]
    fn content(path: &Path, message: impl std::fmt::Display) -> Self {
        Self::Content { path: path.into(), message: message.to_string() }
    }
}

/// What a model file holds; indices are into its own lists.
#[derive(Debug, Default)]
pub struct Model {
    /// Textures.
    pub textures: Vec<Texture>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Meshes.
    pub meshes: Vec<Mesh>,
    /// The objects.
    pub objects: Vec<Object>,
}

/// Reads a mesh file by its ending, `.obj`.
///
/// # Errors
/// [`ImportError`].
#[cfg_attr(not(feature = "meshes"), expect(unused_variables, reason = "nothing is read"))]
pub fn load_mesh(path: &Path, limits: &Limits) -> Result<Mesh, ImportError> {
    match ending(path).as_str() {
        #[cfg(feature = "meshes")]
        "obj" => obj::load(path, limits),
        #[cfg(not(feature = "meshes"))]
        "obj" => Err(ImportError::NotBuilt { path: path.into() }),
        _ => Err(ImportError::Content { path: path.into(), message: "mesh files must end in .obj".to_owned() }),
    }
}

/// Reads a model file by its ending, `.gltf` or `.glb`.
///
/// # Errors
/// [`ImportError`].
#[cfg_attr(not(feature = "meshes"), expect(unused_variables, reason = "nothing is read"))]
pub fn load_model(path: &Path, limits: &Limits) -> Result<Model, ImportError> {
    match ending(path).as_str() {
        #[cfg(feature = "meshes")]
        "gltf" | "glb" => gltf::load(path, limits),
        #[cfg(not(feature = "meshes"))]
        "gltf" | "glb" => Err(ImportError::NotBuilt { path: path.into() }),
        _ => {
            let message = "model files must end in .gltf or .glb".to_owned();
            Err(ImportError::Content { path: path.into(), message })
        }
    }
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The bytes of a file, up to the limit.
#[cfg_attr(not(feature = "meshes"), expect(dead_code, reason = "used by the readers"))]
fn read(path: &Path, limits: &Limits) -> Result<Vec<u8>, ImportError> {
    let limit = limits.import_bytes;
    let bytes = limit::read_file(path, limit).map_err(|source| ImportError::Read { path: path.into(), source })?;
    bytes.ok_or_else(|| ImportError::TooLarge { path: path.into(), limit })
}
