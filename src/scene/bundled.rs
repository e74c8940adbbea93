//! The scenes that come with the crate: one or more for every technique, as text files.

use std::path::Path;

use super::description::Scene;
use super::file::{SceneFileError, Syntax};

macro_rules! scenes {
    ($($name:literal),+ $(,)?) => {
        /// Name and text of every bundled scene, in the order they are shown.
        pub const SCENES: &[(&str, &str)] = &[$(($name, include_str!(concat!("bundled/", $name, ".toml")))),+];
    };
}

scenes! {
    "alpha-tint-texture",
    "alpha-smoothness-switch",
    "cutout-quad",
    "cutout-cutoffs",
    "stencil-cutout",
    "fade-over-opaque",
    "fade-highlight",
    "transparent-highlight",
    "opaque-at-alpha-one",
    "transparent-at-alpha-one",
    "light-passes",
    "four-modes",
    "queue-custom",
    "queue-offsets",
    "queue-order",
    "replacement-cutout",
    "replacement-keep",
    "overlap-zwrite-on",
    "overlap-zwrite-off",
    "order-flip-left",
    "order-flip-right",
    "order-opaque-first",
    "order-transparent-first",
    "order-far-first",
    "order-near-first",
    "cyclic-sorted",
    "cyclic-split",
    "intersecting-sorted",
    "intersecting-split",
    "self-overlap",
    "depth-prepass",
    "cube-cull-off",
    "cube-cull-front-back",
    "alpha-test-comparisons",
    "vegetation-three-trees",
    "vegetation-grass",
    "lit-metallic-smoothness",
    "fire-and-smoke",
    "precision-straight",
    "precision-premultiplied",
    "precision-round-trip",
    "several-targets",
    "target-srgb",
    "target-half",
    "texture-addressing",
    "texture-mips",
    "floor-mips",
    "reversed-depth",
}

impl Scene {
    /// The bundled scenes, read one by one.
    #[must_use]
    pub fn bundled() -> impl ExactSizeIterator<Item = (&'static str, Result<Self, SceneFileError>)> {
        SCENES.iter().map(|(name, text)| (*name, Self::parse_bundled(name, text)))
    }

    /// The bundled scene of this name; `None` if there is none.
    #[must_use]
    pub fn bundled_by_name(name: &str) -> Option<Result<Self, SceneFileError>> {
        SCENES.iter().find(|(known, _)| *known == name).map(|(name, text)| Self::parse_bundled(name, text))
    }

    fn parse_bundled(name: &str, text: &str) -> Result<Self, SceneFileError> {
        Self::parse(text, Syntax::Toml, Path::new(&format!("{name}.toml")))
    }
}
