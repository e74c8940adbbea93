//! Scene files: versioned text, TOML for people or the same members as JSON for programs.
//!
//! Reading goes text, `schema` (what serde checks: names and types), `build` (what only outmerge can check), scene.
//! Every error names file, line and field. Unknown members, numbers that are not finite and sizes beyond the limits are
//! errors.

mod appearance;
mod build;
mod check;
mod error;
mod position;
mod schema;
#[cfg(test)]
mod tests;
mod tuple;

pub use error::{FieldPath, SceneFileError};

use std::path::Path;

use error::Fault;
use position::Node;
use schema::FileScene;

use super::description::Scene;
use crate::limit::{self, Limits};

/// The version of the format this crate reads.
pub const VERSION: i64 = 1;

/// How a scene file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Syntax {
    /// TOML.
    Toml,
    /// JSON with the same members.
    Json,
}

impl Scene {
    /// Reads a scene file within the default [`Limits`]; textures are looked for beside it.
    ///
    /// # Errors
    /// [`SceneFileError`].
    pub fn load(path: &Path) -> Result<Self, SceneFileError> {
        Self::load_within(path, &Limits::default())
    }

    /// Reads a scene file; textures are looked for beside it.
    ///
    /// # Errors
    /// [`SceneFileError`].
    pub fn load_within(path: &Path, limits: &Limits) -> Result<Self, SceneFileError> {
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        let syntax = match ending.as_deref() {
            Some("toml") => Syntax::Toml,
            Some("json") => Syntax::Json,
            _ => return Err(SceneFileError::Ending { path: path.into() }),
        };
        let read = |source| SceneFileError::Read { path: path.into(), source };
        let bytes = limit::read_file(path, limits.scene_bytes).map_err(read)?;
        let bytes = bytes.ok_or_else(|| SceneFileError::TooLarge { path: path.into(), limit: limits.scene_bytes })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            read(std::io::Error::new(std::io::ErrorKind::InvalidData, format!("not UTF-8 text: {error}")))
        })?;
        Self::parse_within(&text, syntax, path, limits)
    }

    /// Reads the text of a scene file within the default [`Limits`]; `path` serves messages, and its folder is where
    /// textures are looked for.
    ///
    /// # Errors
    /// [`SceneFileError`].
    pub fn parse(text: &str, syntax: Syntax, path: &Path) -> Result<Self, SceneFileError> {
        Self::parse_within(text, syntax, path, &Limits::default())
    }

    /// Reads the text of a scene file; `path` serves messages, and its folder is where textures are looked for.
    ///
    /// # Errors
    /// [`SceneFileError`].
    pub fn parse_within(text: &str, syntax: Syntax, path: &Path, limits: &Limits) -> Result<Self, SceneFileError> {
        if text.len() as u64 > limits.scene_bytes {
            return Err(SceneFileError::TooLarge { path: path.into(), limit: limits.scene_bytes });
        }
        let error = |offset: usize, field: String, message: String| SceneFileError::Field {
            path: path.into(),
            line: position::line(text, offset),
            field,
            message,
        };
        let (tree, file) = match syntax {
            Syntax::Toml => read_toml(text).map_err(|(offset, field, message)| error(offset, field, message))?,
            #[cfg(feature = "json")]
            Syntax::Json => read_json(text).map_err(|(offset, field, message)| error(offset, field, message))?,
            #[cfg(not(feature = "json"))]
            Syntax::Json => return Err(SceneFileError::NoJson { path: path.into() }),
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        build::build(&file, folder, limits)
            .map_err(|Fault { field, message }| error(tree.offset(&field), field.to_string(), message))
    }
}

/// Byte, field and message of what serde finds.
type Malformed = (usize, String, String);

fn read_toml(text: &str) -> Result<(Node, FileScene), Malformed> {
    let syntax = |error: &toml::de::Error, field: String| {
        (error.span().map_or(0, |span| span.start), field, error.message().to_owned())
    };
    let document = toml::de::DeTable::parse(text).map_err(|error| syntax(&error, String::new()))?;
    let tree = Node::from_toml(document.get_ref(), document.span());
    let version = document.get_ref().get("version").and_then(|version| version.get_ref().as_integer());
    check_version(version.and_then(|version| i64::from_str_radix(version.as_str(), version.radix()).ok()), &tree)?;
    let file = FileScene::deserialize_toml(document).map_err(|error| {
        let field = error.span().map(|span| tree.field_at(span.start).to_string());
        syntax(&error, field.unwrap_or_default())
    })?;
    Ok((tree, file))
}

impl FileScene {
    fn deserialize_toml(document: toml::Spanned<toml::de::DeTable<'_>>) -> Result<Self, toml::de::Error> {
        serde::Deserialize::deserialize(toml::de::Deserializer::from(document))
    }
}

#[cfg(feature = "json")]
fn read_json(text: &str) -> Result<(Node, FileScene), Malformed> {
    let offset = |error: &serde_json::Error| {
        let start = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum::<usize>();
        start + error.column().saturating_sub(1)
    };
    let bare = |error: &serde_json::Error| {
        let message = error.to_string();
        message.split(" at line ").next().unwrap_or_default().to_owned()
    };
    let value: serde_json::Value =
        serde_json::from_str(text).map_err(|error| (offset(&error), String::new(), bare(&error)))?;
    let tree = Node::from_json(text);
    check_version(value.get("version").and_then(serde_json::Value::as_i64), &tree)?;
    let file = serde_json::from_str(text).map_err(|error| {
        let offset = offset(&error);
        (offset, tree.field_at(offset).to_string(), bare(&error))
    })?;
    Ok((tree, file))
}

/// Comes before everything else: another version may have other members.
fn check_version(version: Option<i64>, tree: &Node) -> Result<(), Malformed> {
    let message = match version {
        Some(VERSION) => return Ok(()),
        Some(other) => format!("this build reads scene version {VERSION}, not {other}"),
        None => format!("a scene starts with `version = {VERSION}`"),
    };
    let field = FieldPath::default().key("version");
    Err((tree.offset(&field), field.to_string(), message))
}
