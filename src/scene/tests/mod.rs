mod example;
mod law;
mod plan;
mod property;
mod technique;

use std::path::Path;

use wgpu_types::BlendFactor;

use super::file::Syntax;
use super::*;
use crate::model::exact::Exact;
use crate::model::{NumericModel, registry};

fn bundled(name: &str) -> Scene {
    Scene::bundled_by_name(name).expect("a bundled scene").expect("bundled scenes are correct")
}

/// A small scene of quads from far to near, each with the text of its material; `target` may go on with other tables.
pub(crate) fn quads(target: &str, materials: &[&str]) -> Scene {
    let mut text = format!("version = 1\ntitle = \"t\"\n[target]\nwidth = 16\nheight = 16\n{target}\n");
    for (i, material) in materials.iter().enumerate() {
        text += &format!("[[material]]\nname = \"m{i}\"\n{material}\n");
    }
    for i in 0..materials.len() {
        text += &format!("[[object]]\nname = \"o{i}\"\nmesh = \"quad\"\nmaterial = \"m{i}\"\n");
        text += &format!("position = [0.0, 0.0, {:?}]\nscale = [1.5, 1.5, 1.0]\n", i as f64 * 0.5 - 2.0);
    }
    Scene::parse(&text, Syntax::Toml, Path::new("generated.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Materials of such quads.
pub(crate) const OPAQUE: &str = "mode = \"opaque\"\ntint = [0.3, 0.5, 0.7, 1.0]";
pub(crate) const FADE: &str = "mode = \"fade\"\ntint = [0.9, 0.2, 0.1, 0.5]";

/// Codes of one texel of color target 0 in the exact model.
fn texel(rendered: &Rendered, x: u32, y: u32) -> [u32; 4] {
    rendered.framebuffer.colors[0].as_ref().expect("scenes have a color target").codes(x, y, 0)
}

fn exact(scene: &Scene) -> Rendered {
    scene.render(&Exact::default()).expect("bundled scenes render")
}

#[test]
fn every_bundled_scene_renders_and_explains_itself() {
    for (name, scene) in Scene::bundled() {
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        assert!(!scene.title.is_empty() && !scene.technique.is_empty(), "{name} has a title and a technique");
        let sentences = scene.explanation.matches(['.', '?']).count();
        assert!(scene.explanation.len() > 60 && sentences >= 1, "{name} is explained: {}", scene.explanation);
        let rendered = exact(&scene);
        let target = rendered.framebuffer.colors[0].as_ref().expect("scenes have a color target");
        assert!(rendered.fragments > 1000, "{name} covers something: {} fragments", rendered.fragments);
        let first = target.codes(0, 0, 0);
        let extent = target.extent();
        let differs = (0..extent.height).any(|y| (0..extent.width).any(|x| target.codes(x, y, 0) != first));
        assert!(differs, "{name} is not a single color");
    }
}

#[test]
fn every_bundled_scene_renders_in_every_model_that_covers_its_formats() {
    let all = registry::all();
    for (name, scene) in Scene::bundled() {
        let scene = scene.expect("bundled scenes are correct");
        let covers = |model: &&dyn NumericModel| {
            scene.target.colors.iter().all(|color| model.supports(color.format, None).is_ok())
        };
        let models: Vec<_> = all.iter().map(AsRef::as_ref).filter(covers).collect();
        assert!(models.len() >= 3, "{name}: exact, f32 and f16 cover every format");
        let rendered = scene.render_models(&models).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(rendered.iter().all(|r| r.fragments == rendered[0].fragments), "{name}: the same fragments");
        let alone = exact(&scene);
        assert_eq!(rendered[0].framebuffer, alone.framebuffer, "{name}: together as alone");
    }
}

#[test]
fn planned_and_reference_rendering_leave_the_same_bytes_in_every_scene_and_model() {
    for (name, scene) in Scene::bundled() {
        let scene = scene.expect("bundled scenes are correct");
        for model in registry::all() {
            let Ok(reference) = scene.render_reference(model.as_ref()) else { continue };
            let planned = scene.render(model.as_ref()).expect("what the reference renders, the plan does");
            assert!(planned.framebuffer == reference.framebuffer, "{name}, {}", model.name());
        }
    }
}

#[test]
fn a_depth_target_that_no_draw_touches_is_left_out_and_nothing_else_changes() {
    let text = include_str!("../bundled/overlap-zwrite-off.toml");
    let model = Exact::default();
    let planned = |scene: &Scene| scene.plan(&model).expect("it can be planned").depth_target.needed;
    let tested = bundled("overlap-zwrite-off");
    assert!(planned(&tested) && exact(&tested).framebuffer.depth_stencil.is_some(), "its draws test depth");
    let text = text.replace("ZWrite Off\"", "ZWrite Off ZTest Always\"");
    let scene = Scene::parse(&text, Syntax::Toml, Path::new("test.toml")).expect("a scene");
    assert!(!planned(&scene), "ZTest Always, ZWrite Off");
    let lean = exact(&scene).framebuffer;
    let full = scene.render_reference(&model).expect("it renders").framebuffer;
    assert!(lean.depth_stencil.is_none() && full.depth_stencil.is_some(), "only the reference has one");
    assert_eq!(lean.colors, full.colors, "the same colors");
    assert_eq!(full.depth_stencil, scene.cleared().expect("it fits").depth_stencil, "which nobody touched");
}

#[test]
fn layers_merge_to_the_same_bytes_and_hold_each_texel_once() {
    let model = Exact::default();
    for (name, scene) in Scene::bundled() {
        let scene = scene.expect("bundled scenes are correct");
        let draws = scene.draws();
        let mut framebuffer = scene.cleared().expect("bundled scenes fit");
        for layer in scene.layers(&draws).expect("bundled scenes are small") {
            let merger =
                crate::merger::Merger::new(&draws[layer.draw].state, &model, &framebuffer.clone()).expect("fits");
            let mut seen = std::collections::BTreeSet::new();
            for pixel in &layer.fragments {
                assert!(seen.insert((pixel.x, pixel.y)), "{name}: texel ({}, {}) twice in a layer", pixel.x, pixel.y);
                merger.merge(&pixel.fragment, pixel.x, pixel.y, &mut framebuffer);
            }
        }
        assert_eq!(framebuffer, exact(&scene).framebuffer, "{name}: layers against whole draws");
    }
}

#[test]
fn one_pixels_fragments_are_those_of_the_layers() {
    let scene = bundled("overlap-zwrite-off");
    let draws = scene.draws();
    let found = scene.fragments_at(&draws, 64, 64);
    assert_eq!(found.iter().map(|hit| hit.draw).collect::<Vec<_>>(), [0, 1], "both quads cover the middle");
    for layer in scene.layers(&draws).expect("a small scene") {
        let pixel = layer.fragments.iter().find(|pixel| (pixel.x, pixel.y) == (64, 64)).expect("covered");
        let hit = |hit: &Hit| (hit.draw, hit.fragment) == (layer.draw, pixel.fragment);
        assert!(found.iter().any(hit), "draw {}", layer.draw);
    }
}

#[test]
fn cutout_leaves_discarded_texels_cleared_in_color_and_depth() {
    let scene = bundled("cutout-quad");
    let (cleared, rendered) = (scene.cleared().expect("fits"), exact(&scene));
    let draws = scene.draws();
    let mut discarded = 0;
    scene.shade(&draws[0], None, |fragments| {
        for pixel in fragments.iter().filter(|pixel| pixel.fragment.discarded) {
            discarded += 1;
            let at = scene.target.extent.index(pixel.x, pixel.y, 0);
            let depth = |f: &crate::target::Framebuffer| f.depth_stencil.as_ref().expect("has depth").depth()[at];
            assert_eq!(depth(&rendered.framebuffer), depth(&cleared), "depth at ({}, {})", pixel.x, pixel.y);
            let color =
                |f: &crate::target::Framebuffer| f.colors[0].as_ref().expect("has color").codes(pixel.x, pixel.y, 0);
            assert_eq!(color(&rendered.framebuffer), color(&cleared), "color at ({}, {})", pixel.x, pixel.y);
        }
    });
    assert!(discarded > 1000, "the leaf leaves much of its quad out: {discarded}");
}

#[test]
fn fade_over_opaque_is_the_weighted_sum() {
    let scene = bundled("fade-over-opaque");
    let rendered = exact(&scene);
    assert_eq!(rendered.draws[0].object, "tiles", "opaque first, though the file lists it last");
    let draws = scene.draws();
    assert_eq!(
        draws[1].state.targets[0].as_ref().and_then(|t| t.blend).map(|b| b.color.src_factor),
        Some(BlendFactor::SrcAlpha)
    );
    for x in 20..108 {
        let fragments = scene.fragments_at(&draws, x, 64);
        let [behind, front] = fragments.as_slice() else { panic!("two layers at column {x}") };
        let [s, d] = [front.fragment.outputs[0], behind.fragment.outputs[0]].map(|color| color.map(f64::from));
        for i in 0..3 {
            let stored = (d[i] * 255.0).round() / 255.0;
            let expected = s[i] * s[3] + stored * (1.0 - s[3]);
            let got = f64::from(texel(&rendered, x, 64)[i]);
            assert!((got - expected * 255.0).abs() <= 0.501, "column {x}, channel {i}: {got} for {}", expected * 255.0);
        }
    }
}

#[test]
fn depth_write_on_a_blended_draw_cuts_a_hole_into_what_lies_behind() {
    let (on, off) = (exact(&bundled("overlap-zwrite-on")), exact(&bundled("overlap-zwrite-off")));
    let only_red = texel(&on, 30, 40);
    assert_eq!(texel(&on, 64, 64), only_red, "ZWrite On: the overlap shows the near quad alone");
    assert_ne!(texel(&off, 64, 64), only_red, "ZWrite Off: the far quad is blended in");
    for (x, y) in [(30, 40), (100, 100), (2, 2)] {
        assert_eq!(texel(&on, x, y), texel(&off, x, y), "outside the overlap nothing changes at ({x}, {y})");
    }
}
