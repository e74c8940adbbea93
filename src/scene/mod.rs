//! The mini fragment pipeline: scenes in, fragments in draw order out.
//!
//! - [`raster`]: triangles to covered pixels;
//! - [`texture`]: images, patterns, sampling;
//! - [`camera`], [`mesh`]: geometry; [`queue`]: drawing order;
//! - [`material`]: rendering modes, passes, the fragment shader.

pub mod camera;
pub mod material;
pub mod mesh;
mod number;
pub mod queue;
pub mod raster;
pub mod texture;
