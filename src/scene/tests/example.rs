//! The scenes in `examples/scenes` and their picture.

use std::path::PathBuf;

use super::*;
use crate::scene::texture::pattern::PatternImage;
use crate::scene::texture::{ColorSpace, Pattern, png};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/scenes")
}

/// The picture is the leaf pattern; `OUTMERGE_BLESS=1 cargo test --all-features leaf_png` writes it anew.
#[test]
fn leaf_png_is_the_leaf_pattern() {
    let leaf = PatternImage {
        pattern: Pattern::Leaf,
        size: [32, 32],
        colors: [[0.35, 0.65, 0.2, 1.0], [0.8, 0.9, 0.5, 1.0]],
        cells: 1,
    };
    let path = folder().join("leaf.png");
    if std::env::var_os("OUTMERGE_BLESS").is_some() {
        let rgba = (0..32).flat_map(|y| (0..32).flat_map(move |x| leaf.codes(x, y))).collect();
        let png = Picture { width: 32, height: 32, rgba }.to_png().expect("a small picture");
        std::fs::write(&path, png).expect("the examples folder is writable");
    }
    let expected = leaf.draw(ColorSpace::Srgb).expect("32 x 32 is legal");
    assert_eq!(png::load(&path, ColorSpace::Srgb).expect("the file is there"), expected, "{}", path.display());
}

#[test]
fn the_example_scene_finds_its_picture_and_shows_it() {
    let scene = Scene::load(&folder().join("png-leaf.toml")).unwrap_or_else(|error| panic!("{error}"));
    let rendered = exact(&scene);
    let [red, green, blue, alpha] = texel(&rendered, 64, 40);
    assert!(green > red && green > blue && alpha == 255, "green in the middle: {red} {green} {blue}");
    assert_eq!(texel(&rendered, 8, 8), texel(&rendered, 0, 0), "a corner of the quad is cut out");
}

#[cfg(feature = "meshes")]
#[test]
fn alpha_modes_of_a_gltf_file_show_the_quad_cut_it_and_blend_it() {
    let scene = Scene::load(&folder().join("gltf-alpha-modes.toml")).unwrap_or_else(|error| panic!("{error}"));
    let draws = scene.draws();
    let order: Vec<_> = draws.iter().map(|draw| (draw.object.as_str(), draw.key.queue.number())).collect();
    let expected = [("leaves: opaque 0", 2000), ("tiles", 2000), ("leaves: mask 1", 2450), ("leaves: blend 2", 3000)];
    assert_eq!(order, expected, "front to back, cut out, blended");
    for (draw, cuts, blends) in [(0, false, false), (2, true, false), (3, false, true)] {
        let (mut discarded, mut soft) = (0, 0);
        scene.shade(&draws[draw], None, |fragments| {
            for PixelFragment { fragment, .. } in fragments {
                discarded += usize::from(fragment.discarded);
                soft += usize::from(!fragment.discarded && fragment.outputs[0][3] < 1.0);
            }
        });
        let name = expected[draw].0;
        assert_eq!((discarded > 500, soft > 500), (cuts, blends), "{name}: {discarded} discarded, {soft} soft");
        let blend = draws[draw].state.targets[0].as_ref().and_then(|target| target.blend);
        assert_eq!(blend.is_some(), blends, "{name}: blending");
    }
}

#[cfg(feature = "meshes")]
#[test]
fn models_from_obj_and_gltf_files_are_drawn_in_the_modes_they_ask_for() {
    let scene = Scene::load(&folder().join("gltf-model.toml")).unwrap_or_else(|error| panic!("{error}"));
    let rendered = exact(&scene);
    let order: Vec<_> = rendered.draws.iter().map(|draw| (draw.object.as_str(), draw.queue)).collect();
    assert_eq!(order, [("pyramid", 2000), ("leaf: leaf 0", 2450)], "alphaMode MASK is Cutout");
    let mut fates = [0, 0];
    scene.shade(&scene.draws()[1], None, |fragments| {
        fragments.iter().for_each(|pixel| fates[usize::from(pixel.fragment.discarded)] += 1);
    });
    assert!(fates.iter().all(|&count| count > 200), "the leaf is cut out of its quad: {fates:?}");
}
