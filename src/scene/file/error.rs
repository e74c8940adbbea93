//! What can be wrong with a scene file.

use std::fmt;
use std::path::PathBuf;

/// Where a field stands, e.g. `object[2].position`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FieldPath(pub(super) Vec<Segment>);

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Segment {
    /// A member of a table.
    Key(String),
    /// An element of an array.
    Index(usize),
}

impl FieldPath {
    /// A member of this table.
    #[must_use]
    pub(super) fn key(&self, key: &str) -> Self {
        self.with(Segment::Key(key.to_owned()))
    }

    /// An element of this array.
    #[must_use]
    pub(super) fn index(&self, index: usize) -> Self {
        self.with(Segment::Index(index))
    }

    fn with(&self, segment: Segment) -> Self {
        Self(self.0.iter().cloned().chain([segment]).collect())
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Key(key) if i == 0 => write!(f, "{key}")?,
                Segment::Key(key) => write!(f, ".{key}")?,
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// A field whose value will not do, before it is known on which line it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) field: FieldPath,
    pub(super) message: String,
}

impl Fault {
    pub(super) fn new(field: &FieldPath, message: impl fmt::Display) -> Self {
        Self { field: field.clone(), message: message.to_string() }
    }
}

/// A scene file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SceneFileError {
    /// The file could not be read.
    #[error("cannot read scene `{path}`: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The file is too large.
    #[error("scene `{path}` has more than {limit} bytes, the limit `scene-bytes`")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit in bytes.
        limit: u64,
    },
    /// The name's ending says neither TOML nor JSON.
    #[error("scene `{path}` must end in .toml or .json")]
    Ending {
        /// The file.
        path: PathBuf,
    },
    /// This build reads no JSON.
    #[error("scene `{path}` is JSON, which this build does not read; build outmerge with feature `json`")]
    NoJson {
        /// The file.
        path: PathBuf,
    },
    /// Something in it is wrong.
    #[error("{path}:{line}: {}{message}", Named(.field))]
    Field {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The field; empty where the text itself is malformed.
        field: String,
        /// What is wrong and what would be right.
        message: String,
    },
}

/// A field's name in front of a message, where there is one.
struct Named<'a>(&'a str);

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, "`{}`: ", self.0) }
    }
}
