//! Every bundled and example scene, its fragments drawn by the device: the bytes must be those of the `llvmpipe` model.

use outmerge::Framebuffer;
use outmerge::crosscheck::{Batch, Replay};
use outmerge::scene::Scene;

use crate::harness::{llvmpipe, model};

/// The first texel at which two framebuffers differ, in any target, and how many do.
fn difference(expected: &Framebuffer, got: &Framebuffer) -> Option<String> {
    let extent = expected.extent;
    let place = |i: usize| (i % extent.width as usize, i / extent.width as usize);
    let mut found = Vec::new();
    for (index, (expected, got)) in expected.colors.iter().flatten().zip(got.colors.iter().flatten()).enumerate() {
        let each = expected.format().bytes_per_texel();
        let texels = || expected.bytes().chunks_exact(each).zip(got.bytes().chunks_exact(each)).enumerate();
        let differing: Vec<_> = texels().filter(|(_, (a, b))| a != b).collect();
        if let Some((i, (a, b))) = differing.first() {
            let count = differing.len();
            found.push(format!("color {index}: {count} texels, first {:?}: model {a:?}, device {b:?}", place(*i)));
        }
    }
    if let (Some(expected), Some(got)) = (&expected.depth_stencil, &got.depth_stencil) {
        let widened = |stencil: &[u8]| stencil.iter().map(|&value| u32::from(value)).collect::<Vec<_>>();
        for (name, expected, got) in [
            ("depth", expected.depth().to_vec(), got.depth().to_vec()),
            ("stencil", widened(expected.stencil()), widened(got.stencil())),
        ] {
            let differing: Vec<_> = (0..expected.len()).filter(|&i| expected[i] != got[i]).collect();
            if let Some(&i) = differing.first() {
                let (count, model, device) = (differing.len(), expected[i], got[i]);
                found.push(format!("{name}: {count} texels, first {:?}: model {model}, device {device}", place(i)));
            }
        }
    }
    (!found.is_empty()).then(|| found.join("; "))
}

/// Bundled scenes and, with the feature that reads their files, those of `examples/scenes`.
pub fn all() -> Vec<(String, Scene)> {
    let scene = |(name, scene): (&str, Result<Scene, _>)| match scene {
        Ok(scene) => (name.to_owned(), scene),
        Err(error) => panic!("{error}"),
    };
    let mut scenes: Vec<_> = Scene::bundled().map(scene).collect();
    if cfg!(feature = "meshes") {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let mut files: Vec<_> = entries.map(|entry| entry.expect("a directory entry").path()).collect();
        files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
        files.sort();
        assert!(files.len() >= 3, "scenes with pictures, meshes and models of their own: {files:?}");
        let load = |file: &std::path::PathBuf| Scene::load(file).unwrap_or_else(|error| panic!("{error}"));
        scenes.extend(files.iter().map(|file| (file.display().to_string(), load(file))));
    }
    scenes
}

#[test]
fn every_scene_is_bit_exact_on_lavapipe() {
    let Some(device) = llvmpipe() else { return };
    let mut replay = Replay::new(device);
    let mut wrong = Vec::new();
    for (name, scene) in all() {
        let expected = scene.render(&model(device)).unwrap_or_else(|error| panic!("{name}: {error}")).framebuffer;
        let batch = Batch::of_scene(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let got = replay.run(&batch).unwrap_or_else(|error| panic!("{name}: {error}"));
        wrong.extend(difference(&expected, &got).map(|difference| format!("{name}: {difference}")));
    }
    assert!(wrong.is_empty(), "{} scenes differ:\n{}", wrong.len(), wrong.join("\n"));
}
