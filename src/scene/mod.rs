//! The mini fragment pipeline: scenes in, fragments in draw order out.
//!
//! - [`raster`]: triangles to covered pixels;
//! - [`texture`]: images, patterns, sampling.

mod number;
pub mod raster;
pub mod texture;
