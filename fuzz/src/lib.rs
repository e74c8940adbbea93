//! What the fuzz targets assert: one file a target, each with `check(data)`, which panics when its property fails.
//!
//! The same functions run over `fuzz/seeds` on the stable toolchain (`tests/fuzz_corpus`).

mod case;
mod input;

pub mod kernel;
pub mod merge;
pub mod plan;
pub mod raster;
pub mod scene;
pub mod shaderlab;
pub mod texture;
pub mod vectors;
pub mod webgpu_json;
