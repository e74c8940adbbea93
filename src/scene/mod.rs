//! The mini fragment pipeline: scenes in, fragments in draw order out.
//!
//! - [`raster`]: triangles to covered pixels;
//! - [`texture`]: images, patterns, sampling;
//! - [`camera`], [`mesh`]: geometry; [`queue`]: drawing order.

pub mod camera;
pub mod mesh;
mod number;
pub mod queue;
pub mod raster;
pub mod texture;
