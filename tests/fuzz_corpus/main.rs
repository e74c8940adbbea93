//! The fuzz targets' properties over their committed seeds, on the stable toolchain.
//!
//! `fuzz/seeds/TARGET` holds ordinary inputs, awkward ones, and every input that once failed (`found-*`).

#[path = "../../fuzz/src/lib.rs"]
mod property;

use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Every file of a folder through a property; panics name the file.
fn replay(name: &str, least: usize, check: fn(&[u8])) {
    let mut count = 0;
    for entry in std::fs::read_dir(folder(name)).unwrap_or_else(|error| panic!("{name}: {error}")) {
        let path = entry.expect("readable").path();
        let data = std::fs::read(&path).expect("readable");
        let outcome = std::panic::catch_unwind(|| check(&data));
        assert!(outcome.is_ok(), "the property fails for {}", path.display());
        count += 1;
    }
    assert!(count >= least, "{name}: {count} seeds, at least {least} are committed");
}

#[test]
fn shaderlab_seeds() {
    replay("fuzz/seeds/shaderlab", 4, property::shaderlab::check);
}

#[test]
fn webgpu_json_seeds() {
    replay("fuzz/seeds/webgpu_json", 4, property::webgpu_json::check);
}

#[test]
fn scene_seeds_and_bundled_scenes() {
    replay("fuzz/seeds/scene", 2, property::scene::check);
    replay("src/scene/bundled", 40, property::scene::check);
}

#[test]
fn vector_seeds() {
    replay("fuzz/seeds/vectors", 3, property::vectors::check);
}

#[test]
fn texture_seeds() {
    replay("fuzz/seeds/texture", 4, property::texture::check);
}

#[test]
fn merge_seeds() {
    replay("fuzz/seeds/merge", 8, property::merge::check);
}

#[test]
fn plan_seeds() {
    // The same bytes mean the same case.
    replay("fuzz/seeds/merge", 8, property::plan::check);
}

#[test]
fn kernel_seeds() {
    replay("fuzz/seeds/kernel", 8, property::kernel::check);
}

#[test]
fn raster_seeds() {
    replay("fuzz/seeds/raster", 4, property::raster::check);
}
