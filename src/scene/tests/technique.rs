//! What each technique must show, read off its bundled scenes.

use std::collections::BTreeMap;

use super::*;
use crate::scene::description::Order;
use crate::state::AlphaTest;
use crate::target::Framebuffer;

/// Texels at which color target 0 of two renderings differs.
fn differing(a: &Framebuffer, b: &Framebuffer) -> usize {
    let [a, b] = [a, b].map(|f| f.colors[0].as_ref().expect("scenes have a color target"));
    let size = a.format().bytes_per_texel();
    a.bytes().chunks_exact(size).zip(b.bytes().chunks_exact(size)).filter(|(a, b)| a != b).count()
}

/// Names of the drawn objects, in order.
fn drawn(rendered: &Rendered) -> Vec<&str> {
    rendered.draws.iter().map(|draw| draw.object.as_str()).collect()
}

/// Fragments of one draw.
fn fragments(scene: &Scene, draw: usize) -> Vec<PixelFragment> {
    let mut all = Vec::new();
    scene.shade(&scene.draws()[draw], None, |fragments| all.extend_from_slice(fragments));
    all
}

#[test]
fn get_alpha_fades_at_the_blobs_edge_only_while_the_texture_holds_alpha() {
    let range = |name: &str| {
        let alphas = fragments(&bundled(name), 1).into_iter().map(|pixel| pixel.fragment.outputs[0][3]);
        alphas.fold((f32::MAX, f32::MIN), |(low, high), a| (low.min(a), high.max(a)))
    };
    let (low, high) = range("alpha-tint-texture");
    assert!(low == 0.0 && high > 0.79 && high <= 0.8, "0 at the edge to 0.8 in the middle, not {low} to {high}");
    assert_eq!(range("alpha-smoothness-switch"), (0.8, 0.8), "the tint's alpha everywhere");
}

#[test]
fn cutoffs_keep_the_bar_that_equals_them() {
    let scene = bundled("cutout-cutoffs");
    for (draw, kept) in [(0, 6), (1, 4), (2, 2)] {
        let pixels = fragments(&scene, draw);
        let row = pixels[0].y;
        let shown = pixels.iter().filter(|pixel| pixel.y == row && !pixel.fragment.discarded).count();
        let width = pixels.iter().filter(|pixel| pixel.y == row).count();
        assert!(width > 100, "the quad is wide enough to tell bars apart: {width}");
        let bars = (shown * 8 + width / 2) / width;
        assert_eq!(bars, kept, "{}: bars kept", scene.draws()[draw].object);
    }
}

#[test]
fn a_stencil_marked_by_a_cutout_is_marked_where_alpha_passes_and_nowhere_else() {
    let scene = bundled("stencil-cutout");
    let rendered = exact(&scene);
    let stencil = rendered.framebuffer.depth_stencil.as_ref().expect("has a stencil").stencil().to_vec();
    let (mut kept, mut dropped) = (0, 0);
    for pixel in fragments(&scene, 0) {
        let marked = stencil[scene.target.extent.index(pixel.x, pixel.y, 0)];
        assert_eq!(marked, u8::from(!pixel.fragment.discarded), "stencil at ({}, {})", pixel.x, pixel.y);
        if pixel.fragment.discarded { dropped += 1 } else { kept += 1 }
    }
    assert!(kept > 1000 && dropped > 1000, "both happen: {kept} kept, {dropped} dropped");
}

#[test]
fn the_highlight_is_brighter_in_transparent_mode_than_in_fade_mode() {
    let brightest = |name: &str| {
        let rendered = exact(&bundled(name));
        (30..98).flat_map(|y| (30..98).map(move |x| (x, y))).map(|(x, y)| texel(&rendered, x, y)[0]).max()
    };
    assert_eq!(brightest("transparent-highlight"), Some(255), "on glass the highlight saturates");
    assert!(brightest("fade-highlight") < Some(250), "faded it does not: {:?}", brightest("fade-highlight"));
}

#[test]
fn transparent_at_alpha_one_equals_opaque_byte_for_byte() {
    for model in registry::all() {
        let render = |name: &str| bundled(name).render(model.as_ref()).expect("renders").framebuffer;
        let different = differing(&render("opaque-at-alpha-one"), &render("transparent-at-alpha-one"));
        assert_eq!(different, 0, "texels that differ in {}", model.name());
    }
}

#[test]
fn every_mode_draws_a_base_pass_and_one_pass_for_each_further_light() {
    let rendered = exact(&bundled("light-passes"));
    for object in ["opaque", "cutout", "fade", "transparent"] {
        let passes: Vec<_> =
            rendered.draws.iter().filter(|draw| draw.object == object).map(|draw| draw.pass.as_str()).collect();
        assert_eq!(passes, ["base", "light", "light"], "{object}");
    }
}

#[test]
fn keywords_follow_the_mode_and_no_pass_does_more() {
    let rendered = exact(&bundled("four-modes"));
    for (object, keywords) in [
        ("opaque", vec!["color", "texture"]),
        ("cutout", vec!["color", "alpha", "clip", "texture"]),
        ("fade", vec!["color", "alpha", "texture"]),
        ("transparent", vec!["color", "alpha", "texture", "premultiply"]),
    ] {
        let draw = rendered.draws.iter().find(|draw| draw.object == object).expect("each mode is drawn");
        assert_eq!(draw.keywords, keywords, "{object}");
        let evaluated = |keyword| if keywords.contains(&keyword) { draw.work.fragments } else { 0 };
        assert_eq!(draw.work.alphas, evaluated("alpha"), "{object}: alphas");
        assert_eq!(draw.work.clips, evaluated("clip"), "{object}: clips");
        assert_eq!(draw.work.texture_samples, evaluated("texture"), "{object}: texture samples");
    }
}

#[test]
fn queues_come_before_distance() {
    assert_eq!(drawn(&exact(&bundled("queue-offsets"))), ["middle blue", "near red", "far green"], "by offset");
    let order = ["near wall", "far wall", "grid", "far glass", "near glass"];
    assert_eq!(drawn(&exact(&bundled("queue-order"))), order, "front to back, then back to front");
}

#[test]
fn a_custom_queue_overrides_the_modes_and_minus_one_keeps_it() {
    let scene = bundled("queue-custom");
    let rendered = exact(&scene);
    let queues: Vec<_> = rendered.draws.iter().map(|draw| (draw.object.as_str(), draw.queue)).collect();
    assert_eq!(queues, [("early", 2000), ("own queue", 2450), ("glass", 3000), ("late", 3100)], "in drawing order");
    let kept = |draw: usize| {
        let pixels = fragments(&scene, draw);
        let middle = pixels.iter().find(|pixel| pixel.y == 64 && !pixel.fragment.discarded).expect("bars stay");
        (texel(&rendered, middle.x, middle.y), middle.fragment.outputs[0].map(|c| (f64::from(c) * 255.0).round()))
    };
    for (draw, seen) in [(0, false), (1, false), (3, true)] {
        let (stored, color) = kept(draw);
        let pure = stored[..3].iter().zip(color).all(|(code, color)| f64::from(*code) == color);
        assert_eq!(pure, seen, "{}: untinted by the glass, stored {stored:?} for {color:?}", queues[draw].0);
    }
}

#[test]
fn replacement_shading_draws_one_render_type_in_one_color() {
    let scene = bundled("replacement-cutout");
    let rendered = exact(&scene);
    assert_eq!(drawn(&rendered), ["leaf", "grid"], "only TransparentCutout objects");
    for draw in 0..2 {
        for pixel in fragments(&scene, draw).iter().filter(|pixel| !pixel.fragment.discarded) {
            assert_eq!(pixel.fragment.outputs[0], [0.95, 0.05, 0.05, 1.0], "flat red at ({}, {})", pixel.x, pixel.y);
        }
        assert!(fragments(&scene, draw).iter().any(|pixel| pixel.fragment.discarded), "holes stay holes");
    }
    assert_eq!(exact(&bundled("replacement-keep")).draws.len(), 4, "with `keep-others` all are drawn");
}

#[test]
fn the_drawing_order_of_two_quads_flips_as_the_camera_moves() {
    assert_eq!(drawn(&exact(&bundled("order-flip-left"))), ["blue", "red"], "from the left red is nearer");
    assert_eq!(drawn(&exact(&bundled("order-flip-right"))), ["red", "blue"], "from the right blue is nearer");
}

#[test]
fn the_four_order_cases_differ_as_they_should() {
    let middle = |name: &str| texel(&exact(&bundled(name)), 64, 64);
    let near_alone = texel(&exact(&bundled("order-transparent-first")), 30, 40);
    assert_eq!(middle("order-transparent-first"), near_alone, "the background shows where the quad should");
    assert_ne!(middle("order-opaque-first"), near_alone, "the opaque quad shows through the glass");
    let ([far_r, _, far_b, _], [near_r, _, near_b, _]) = (middle("order-far-first"), middle("order-near-first"));
    assert!(far_r > far_b && near_b > near_r, "the last drawn quad dominates: {far_r} {far_b}, {near_r} {near_b}");
}

#[test]
fn splitting_repairs_what_no_order_can() {
    let model = Exact::default();
    for (sorted, split) in [("cyclic-sorted", "cyclic-split"), ("intersecting-sorted", "intersecting-split")] {
        let reference = bundled(sorted).render_sorted_per_pixel(&model).expect("a small scene");
        let wrong = differing(&exact(&bundled(sorted)).framebuffer, &reference);
        let repaired = differing(&exact(&bundled(split)).framebuffer, &reference);
        assert!(wrong > 50, "{sorted} is wrong somewhere: {wrong} texels");
        assert_eq!(repaired, 0, "{split} is right everywhere");
    }
}

#[test]
fn no_order_of_cyclic_bars_is_right() {
    let model = Exact::default();
    let mut scene = bundled("cyclic-sorted");
    let reference = scene.render_sorted_per_pixel(&model).expect("a small scene");
    scene.order = Order::Listed;
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let bars = scene.objects.clone();
        scene.objects = order.map(|i| bars[i].clone()).to_vec();
        let wrong = differing(&exact(&scene).framebuffer, &reference);
        assert!(wrong > 50, "order {order:?}: {wrong} texels differ");
        scene.objects = bars;
    }
}

#[test]
fn a_depth_prepass_leaves_one_layer_of_a_mesh_that_overlaps_itself() {
    let scene = bundled("depth-prepass");
    let rendered = exact(&scene);
    let prepass = &rendered.draws[1];
    assert_eq!(prepass.pass, "depth", "the first pass of the cards");
    assert!(prepass.keywords.is_empty(), "it needs no shader: {:?}", prepass.keywords);
    // Card color over tile color, once: 0.5 s + 0.5 d.
    let (mut tiles, mut cards) = (BTreeMap::new(), BTreeMap::<_, Vec<_>>::new());
    for pixel in fragments(&scene, 0) {
        tiles.insert((pixel.x, pixel.y), pixel.fragment.outputs[0]);
    }
    for pixel in fragments(&scene, 2) {
        cards.entry((pixel.x, pixel.y)).or_default().push(pixel.fragment.outputs[0]);
    }
    let (mut single, mut overlapping) = (0, 0);
    for ((x, y), colors) in cards {
        if colors.len() > 1 {
            overlapping += 1
        } else {
            single += 1
        }
        let Some(tile) = tiles.get(&(x, y)) else { continue };
        for i in 0..3 {
            let behind = (f64::from(tile[i]) * 255.0).round();
            let expected = 0.5 * f64::from(colors[0][i]) * 255.0 + 0.5 * behind;
            let got = f64::from(texel(&rendered, x, y)[i]);
            assert!((got - expected).abs() <= 0.501, "({x}, {y}) channel {i}: {got} for {expected}");
        }
    }
    assert!(single > 1000 && overlapping > 500, "both kinds of pixels: {single} single, {overlapping} overlapping");
    assert!(differing(&exact(&bundled("self-overlap")).framebuffer, &rendered.framebuffer) > 500, "without: wrong");
}

#[test]
fn inner_faces_before_outer_faces_is_right_for_a_cube_and_cull_off_is_not() {
    let two_passes = bundled("cube-cull-front-back");
    // Sorting cannot take passes, so the reference comes from the single-pass scene.
    let reference = bundled("cube-cull-off").render_sorted_per_pixel(&Exact::default()).expect("a small scene");
    assert_eq!(differing(&exact(&two_passes).framebuffer, &reference), 0, "two passes equal per-pixel sorting");
    assert!(differing(&exact(&bundled("cube-cull-off")).framebuffer, &reference) > 100, "one pass does not");
}

#[test]
fn alpha_test_draws_the_bars_its_comparison_admits() {
    let scene = bundled("alpha-test-comparisons");
    let rendered = exact(&scene);
    let cleared = texel(&rendered, 0, 0);
    let draws = scene.draws();
    for (name, admitted) in [
        ("off", "111111111"),
        ("never", "000000000"),
        ("less", "111100000"),
        ("equal", "000010000"),
        ("lequal", "111110000"),
        ("greater", "000001111"),
        ("notequal", "111101111"),
        ("gequal", "000011111"),
        ("always", "111111111"),
    ] {
        let index = draws.iter().position(|draw| draw.object == name).expect("nine quads");
        assert_eq!(draws[index].state.alpha_test == AlphaTest::Off, name == "off", "{name}");
        let pixels = fragments(&scene, index);
        let (left, right) = (pixels.iter().map(|p| p.x).min(), pixels.iter().map(|p| p.x).max());
        let (Some(left), Some(right)) = (left, right) else { panic!("{name} covers nothing") };
        let shown: String = (0..9)
            .map(|bar| {
                let x = left + (2 * bar + 1) * (right - left + 1) / 18;
                if texel(&rendered, x, pixels[pixels.len() / 2].y) == cleared { '0' } else { '1' }
            })
            .collect();
        assert_eq!(shown, admitted, "{name}: bars drawn");
    }
}

#[test]
fn two_pass_vegetation_keeps_what_blending_alone_hides_and_softens_what_testing_alone_cuts() {
    let scene = bundled("vegetation-three-trees");
    let draws = scene.draws();
    let mut blended = scene.clone();
    blended.objects.retain(|object| object.name.starts_with("blended") || object.name == "tiles");
    let reference = blended.render_sorted_per_pixel(&Exact::default()).expect("a small scene");
    let wrong = differing(&exact(&blended).framebuffer, &reference);
    assert!(wrong > 100, "the blended tree in front hides the one behind with invisible texels: {wrong}");
    let passes = |name: &str| draws.iter().filter(|draw| draw.object == name).count();
    assert_eq!(passes("both front"), 2, "tested, then soft");
    // No fragment is merged by both passes: Greater and LEqual share no alpha.
    let both: Vec<_> = draws.iter().filter(|draw| draw.object == "both front").collect();
    let alphas = |i: usize| {
        let mut passed = Vec::new();
        scene.shade(both[i], None, |fragments| {
            let test = both[i].state.alpha_test;
            passed.extend(fragments.iter().filter(|p| test.passes(p.fragment.outputs[0][3])).map(|p| (p.x, p.y)));
        });
        passed.into_iter().collect::<std::collections::BTreeSet<_>>()
    };
    let (solid, soft) = (alphas(0), alphas(1));
    assert!(solid.is_disjoint(&soft) && !solid.is_empty() && !soft.is_empty(), "each fragment goes one way");
}

#[test]
fn fire_adds_light_and_smoke_takes_it_away_in_one_draw() {
    let scene = bundled("fire-and-smoke");
    let rendered = exact(&scene);
    let mut sky_only = scene.clone();
    sky_only.objects.retain(|object| object.name == "sky");
    let sky = exact(&sky_only);
    let sum = |rendered: &Rendered, x, y| texel(rendered, x, y)[..3].iter().sum::<u32>();
    assert!(sum(&rendered, 64, 84) > sum(&sky, 64, 84) + 200, "the flame is brighter than the sky behind it");
    assert!(sum(&rendered, 64, 34) + 200 < sum(&sky, 64, 34), "the smoke is darker than the sky behind it");
    let flame = scene.fragments_at(&scene.draws(), 64, 88);
    let [.., Hit { fragment, .. }] = flame.as_slice() else { panic!("the fire covers the flame") };
    assert!(fragment.outputs[0][3] < 0.05, "the flame adds without covering: alpha {}", fragment.outputs[0][3]);
}

#[test]
fn premultiplied_storage_loses_levels_at_low_alpha() {
    let levels = |name: &str| {
        let mut colors: Vec<_> = fragments(&bundled(name), 0)
            .iter()
            .map(|pixel| {
                let [r, g, b, _] = pixel.fragment.outputs[0];
                [r, g, b].map(f32::to_bits)
            })
            .collect();
        colors.sort_unstable();
        colors.dedup();
        colors.len()
    };
    let (straight, premultiplied, back) =
        (levels("precision-straight"), levels("precision-premultiplied"), levels("precision-round-trip"));
    assert!(premultiplied < straight / 2, "colors left: {premultiplied} of {straight}");
    assert!(back <= 3 * premultiplied, "dividing brings none back: {back} after {premultiplied}");
}
