//! The mini fragment pipeline: scenes in, fragments in draw order out.
//!
//! - [`raster`]: triangles to covered pixels;
//! - [`texture`]: images, patterns, sampling;
//! - [`camera`], [`mesh`]: geometry; [`queue`]: drawing order;
//! - [`material`]: rendering modes, passes, the fragment shader;
//! - [`planned`]: what each draw needs, and what is left out.

pub mod bundled;
pub mod camera;
pub mod description;
pub mod display;
pub mod draw;
pub mod file;
pub mod history;
pub mod import;
pub mod layer;
pub mod material;
pub mod mesh;
pub(crate) mod number;
pub mod planned;
pub mod queue;
pub mod raster;
pub mod render;
pub mod shade;
pub mod sorted;
mod span;
mod split;
pub mod texture;

pub use description::Scene;
pub use display::{Picture, PictureAlpha};
pub use draw::Draw;
pub use file::SceneFileError;
pub use layer::{Hit, Layer};
pub use render::{DrawReport, Rendered, SceneError};
pub use shade::PixelFragment;

#[cfg(test)]
pub(crate) mod tests;
