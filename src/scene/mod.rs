//! The mini fragment pipeline: scenes in, fragments in draw order out.
//!
//! - [`raster`]: triangles to covered pixels;

mod number;
pub mod raster;
