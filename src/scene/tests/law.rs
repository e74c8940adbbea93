//! Laws of single techniques, over random materials, lights and alphas.

use std::collections::BTreeMap;

use proptest::prelude::*;
use wgpu_types::CompareFunction;

use super::property::{head, object, parse, place, tint};
use super::*;
use crate::format::ColorFormat;
use crate::merger::Merger;
use crate::model::ColorInputs;
use crate::scene::description::Order;
use crate::scene::material::{MODES, RenderingMode, Shader, Shading};
use crate::state::AlphaTest;
use crate::state::preset;

/// Red, green and blue of one texel of an rgba32float target.
fn float_texel(rendered: &Rendered, x: u32, y: u32) -> [f64; 3] {
    let codes = texel(rendered, x, y);
    std::array::from_fn(|i| f64::from(f32::from_bits(codes[i])))
}

/// The scene with a target that rounds nothing away.
fn in_floats(mut scene: Scene) -> Scene {
    scene.target.colors[0].format = ColorFormat::from_name("rgba32float").expect("a format");
    scene
}

/// Every texel's fragments, in drawing order.
fn hits(scene: &Scene, draws: &[Draw]) -> BTreeMap<(u32, u32), Vec<Hit>> {
    let mut hits = BTreeMap::<_, Vec<Hit>>::new();
    for (index, draw) in draws.iter().enumerate() {
        scene.shade_each(draw, None, |triangle, pixel| {
            let hit = Hit { draw: index, triangle, fragment: pixel.fragment };
            hits.entry((pixel.x, pixel.y)).or_default().push(hit);
        });
    }
    hits
}

/// Base pass plus light passes is what one pass with all the light would merge: `adds x (base + lights) + keeps x
/// destination`, with the mode's factors.
#[test]
fn light_passes_add_up_to_all_light_in_one_pass_in_every_mode() {
    let scene = in_floats(bundled("light-passes"));
    assert!(scene.lighting.lights.len() >= 3, "a main light and several more");
    let (draws, rendered) = (scene.draws(), exact(&scene));
    let mut checked = BTreeMap::<String, usize>::new();
    for ((x, y), hits) in hits(&scene, &draws) {
        let [behind, rest @ ..] = hits.as_slice() else { continue };
        let Some(front) = rest.first().filter(|hit| !hit.fragment.discarded) else { continue };
        // Spheres in front of the tiles only; opaque ones are drawn first.
        let (behind, passes) =
            if draws[behind.draw].object == "tiles" { (Some(behind), rest) } else { (None, &hits[..]) };
        let front = if behind.is_some() { front } else { &passes[0] };
        let mode = draws[front.draw].material.mode;
        let passes: Vec<_> = passes.iter().filter(|hit| draws[hit.draw].object == draws[front.draw].object).collect();
        assert_eq!(passes.len(), 3, "base and two lights at ({x}, {y})");
        assert_eq!(draws[passes[2].draw].shader, Shader::Light, "light passes come last");
        let alpha = f64::from(front.fragment.outputs[0][3]);
        let (adds, keeps) = match mode {
            RenderingMode::Opaque | RenderingMode::Cutout => (1.0, 0.0),
            RenderingMode::Fade => (alpha, 1.0 - alpha),
            RenderingMode::Transparent => (1.0, 1.0 - alpha),
        };
        for (i, got) in float_texel(&rendered, x, y).into_iter().enumerate() {
            let light: f64 = passes.iter().map(|hit| f64::from(hit.fragment.outputs[0][i])).sum();
            let under = behind.map_or(0.0, |hit| f64::from(hit.fragment.outputs[0][i]));
            let expected = adds * light + keeps * under;
            assert!((got - expected).abs() < 1e-6, "{mode:?} ({x}, {y}) channel {i}: {got} for {expected}");
        }
        *checked.entry(format!("{mode:?}")).or_default() += 1;
    }
    assert!(checked.values().all(|&count| count > 100) && checked.len() == 4, "every mode: {checked:?}");
}

#[test]
fn further_lights_add_up_in_any_order() {
    let scene = in_floats(bundled("light-passes"));
    let mut swapped = scene.clone();
    swapped.lighting.lights.swap(1, 2);
    let (one, other) = (exact(&scene), exact(&swapped));
    let mut lit = 0;
    for (x, y) in (0..160).flat_map(|y| (0..160).map(move |x| (x, y))) {
        let (a, b) = (float_texel(&one, x, y), float_texel(&other, x, y));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "({x}, {y}): {a:?}, {b:?}");
        lit += usize::from(a != [f64::from(0.9_f32); 3]);
    }
    assert!(lit > 10_000, "there is something to see: {lit} texels");
}

#[test]
fn metal_takes_diffuse_light_away_and_smoothness_sharpens_the_highlight() {
    let scene = bundled("lit-metallic-smoothness");
    // Outputs of each sphere, by metallic and smoothness.
    let mut spheres = BTreeMap::<(u8, u8), Vec<f32>>::new();
    for draw in scene.draws() {
        let Shading::Lit { metallic, smoothness } = draw.material.shading else { continue };
        // Values come in steps of a half and of 0.3.
        let step = |x: f32, size: f32| (0..4).find(|i| (x - size * f32::from(*i)).abs() < 0.01).expect("on the grid");
        let outputs = spheres.entry((step(metallic, 0.5), step(smoothness, 0.3))).or_default();
        scene.shade(&draw, None, |fragments| outputs.extend(fragments.iter().map(|p| p.fragment.outputs[0][2])));
    }
    assert_eq!(spheres.len(), 12, "three metals by four smoothnesses");
    let brightest = |key| spheres[&key].iter().copied().fold(0.0, f32::max);
    let median = |key| {
        let mut all = spheres[&key].clone();
        all.sort_by(f32::total_cmp);
        all[all.len() / 2]
    };
    for metal in 0..3 {
        for (rough, smooth) in [(0, 1), (1, 2), (2, 3)] {
            let (before, after) = (brightest((metal, rough)), brightest((metal, smooth)));
            assert!(after > before, "metal {metal}: highlight {after} at smoothness {smooth}, {before} at {rough}");
        }
    }
    for metal in 0..2 {
        // Smooth spheres are dark but for the highlight, the more so the more metallic.
        let (less, more) = (median((metal, 3)), median((metal + 1, 3)));
        assert!(more < 0.7 * less, "diffuse blue falls from {less} to {more}");
    }
}

/// Depth codes of a scene's fragments by texel, nearest first.
fn codes_by_texel(scene: &Scene, draw: usize) -> BTreeMap<(u32, u32), Vec<u32>> {
    let mut codes = BTreeMap::<_, Vec<u32>>::new();
    let kind = crate::format::DepthFormat::new(scene.target.depth.expect("has depth").format).expect("known").depth();
    scene.shade(&scene.draws()[draw], None, |fragments| {
        for pixel in fragments {
            let code = Exact::default().depth_code(kind.expect("has depth"), pixel.fragment.depth, [0.0, 1.0]);
            codes.entry((pixel.x, pixel.y)).or_default().push(code);
        }
    });
    codes.values_mut().for_each(|list| list.sort_unstable());
    codes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// However often a mesh overlaps itself, behind a prepass each texel is blended once.
    #[test]
    fn a_depth_prepass_blends_every_texel_once(color in tint(0.1_f32..0.9), (position, rotation, scale) in place()) {
        let passes = "[[material.pass]]\nstate = 'ZWrite On ColorMask 0 Cull Off'\n\
                      [[material.pass]]\nstate = 'Blend SrcAlpha OneMinusSrcAlpha ZWrite Off Cull Off'\n";
        let mut text = head("fade", passes, &[color]);
        object(&mut text, "cube", 0, position, rotation, scale);
        let scene = parse(&text);
        let rendered = exact(&scene);
        let cleared = texel(&Rendered { framebuffer: scene.cleared().expect("fits"), ..rendered.clone() }, 0, 0);
        let once = Exact::default().merge_color(&ColorInputs {
            format: scene.target.colors[0].format,
            blend: scene.draws()[1].state.targets[0].as_ref().expect("a target").blend,
            constant: [0.0; 4],
            src: color,
            src1: [0.0; 4],
            dst: cleared,
        });
        let depths = codes_by_texel(&scene, 1);
        for (x, y) in (0..24).flat_map(|y| (0..24).map(move |x| (x, y))) {
            let stored = texel(&rendered, x, y);
            match depths.get(&(x, y)).map(Vec::as_slice) {
                None => prop_assert_eq!(stored, cleared, "({}, {}) is not covered", x, y),
                // Two faces at one depth code both pass LEqual, as on any GPU.
                Some([first, second, ..]) if first == second => {}
                Some(_) => prop_assert_eq!(stored, once, "({}, {})", x, y),
            }
        }
    }

    /// Cutout keeps a fragment exactly if its alpha is not below the cutoff, whatever the numbers.
    #[test]
    fn cutout_keeps_what_is_not_below_the_cutoff(alpha in 0.0_f32..=1.0, cutoff in 0.0_f32..=1.0, equal in any::<bool>()) {
        let cutoff = if equal { alpha } else { cutoff };
        let text = head("cutout", &format!("cutoff = {cutoff:?}\n"), &[[0.5, 0.5, 0.5, alpha]]);
        let mut text = text;
        object(&mut text, "quad", 0, [0.0; 3], [0.0; 3], 1.0);
        let scene = parse(&text);
        let hits = scene.fragments_at(&scene.draws(), 12, 12);
        prop_assert_eq!(hits.len(), 1);
        prop_assert_eq!(hits[0].fragment.discarded, alpha < cutoff);
    }

    /// What the two passes of vegetation rest on: every alpha goes one way, and NaN neither.
    #[test]
    fn greater_and_lequal_split_every_alpha(alpha in any::<f32>(), cutoff in 0.0_f32..=1.0, equal in any::<bool>()) {
        let alpha = if equal { cutoff } else { alpha };
        let passes = |compare| AlphaTest::On { compare, reference: cutoff }.passes(alpha);
        let (solid, soft) = (passes(CompareFunction::Greater), passes(CompareFunction::LessEqual));
        prop_assert_eq!(solid ^ soft, !alpha.is_nan());
    }

    /// Each comparison is the opposite of another one, and Off lets everything live.
    #[test]
    fn the_eight_alpha_tests_are_four_pairs_of_opposites(alpha in -1.0_f32..2.0, reference in -1.0_f32..2.0, equal in any::<bool>()) {
        use CompareFunction as C;
        let reference = if equal { alpha } else { reference };
        let passes = |compare| AlphaTest::On { compare, reference }.passes(alpha);
        for (one, other) in [(C::Never, C::Always), (C::Less, C::GreaterEqual), (C::Equal, C::NotEqual), (C::LessEqual, C::Greater)] {
            prop_assert_ne!(passes(one), passes(other), "{:?} and {:?}", one, other);
        }
        prop_assert_eq!(passes(C::LessEqual), passes(C::Less) || passes(C::Equal));
        prop_assert!(AlphaTest::Off.passes(alpha));
    }

    /// Fire and smoke: under One, OneMinusSrcAlpha what has no alpha only brightens, what has no color only darkens. So
    /// it is in real arithmetic, and no model's rounding may turn it round.
    #[test]
    fn premultiplied_sources_without_alpha_brighten_and_without_color_darken(
        color in prop::array::uniform3(0.0_f32..=1.0), alpha in 0.0_f32..=1.0, dst in prop::array::uniform4(0_u32..=255)
    ) {
        let format = ColorFormat::from_name("rgba8unorm").expect("a format");
        let blend = preset::by_name("premultiplied").expect("a preset").blend;
        prop_assert!(blend.is_some());
        let [r, g, b] = color;
        for model in registry::all() {
            let merge = |src| {
                model.merge_color(&ColorInputs { format, blend, constant: [0.0; 4], src, src1: [0.0; 4], dst })
            };
            let (fire, smoke) = (merge([r, g, b, 0.0]), merge([0.0, 0.0, 0.0, alpha]));
            for i in 0..3 {
                prop_assert!(fire[i] >= dst[i], "{}: fire darkens {} to {}", model.name(), dst[i], fire[i]);
                prop_assert!(smoke[i] <= dst[i], "{}: smoke brightens {} to {}", model.name(), dst[i], smoke[i]);
            }
        }
    }

    /// Without depth writes no transparent surface can hide another: every fragment is merged, in either order.
    #[test]
    fn without_depth_writes_no_transparent_surface_hides_another(
        tints in prop::collection::vec(tint(0.1_f32..0.9), 2), places in prop::collection::vec(place(), 2), fade in any::<bool>()
    ) {
        let mode = if fade { "fade" } else { "transparent" };
        let mut text = head(mode, "", &tints);
        for (i, (position, rotation, scale)) in places.iter().enumerate() {
            object(&mut text, "quad", i, *position, *rotation, *scale);
        }
        let (mut scene, model) = (parse(&text), Exact::default());
        for _ in 0..2 {
            let draws = scene.draws();
            prop_assert!(draws.iter().all(|draw| draw.state.depth_stencil.as_ref().is_some_and(|d| d.depth_write_enabled == Some(false))));
            let mut framebuffer = scene.cleared().expect("fits");
            let blank = framebuffer.clone();
            for draw in &draws {
                let merger = Merger::new(&draw.state, &model, &blank).expect("fits");
                let mut hidden = 0;
                scene.shade(draw, None, |fragments| {
                    for pixel in fragments {
                        let trace = merger.trace(&pixel.fragment, pixel.x, pixel.y, &mut framebuffer);
                        hidden += usize::from(trace.samples[0].fate != crate::merger::Fate::Merged);
                    }
                });
                prop_assert_eq!(hidden, 0, "fragments that failed a test");
            }
            scene.objects.reverse();
            scene.order = Order::Listed;
        }
    }

    /// Replacement shading draws the objects of its render type, all of them and no others, in its color.
    #[test]
    fn replacement_draws_exactly_the_objects_of_its_render_type(modes in prop::collection::vec(0_usize..4, 1..6), asked in 0_usize..3) {
        let types = ["Opaque", "TransparentCutout", "Transparent"];
        let mut text = head("opaque", "", &[]);
        for (i, mode) in modes.iter().enumerate() {
            let name = format!("{:?}", MODES[*mode].mode).to_lowercase();
            text += &format!("[[material]]\nname = \"m{i}\"\nmode = \"{name}\"\ntint = [0.1, 0.2, 0.3, 0.9]\n");
        }
        for i in 0..modes.len() {
            object(&mut text, "quad", i, [0.0; 3], [0.0; 3], 1.0);
        }
        text += &format!("[replacement]\nrender-type = \"{}\"\ncolor = [1.0, 0.0, 0.0]\n", types[asked]);
        let scene = parse(&text);
        let draws = scene.draws();
        let expected = modes.iter().filter(|mode| MODES[**mode].render_type == types[asked]).count();
        prop_assert_eq!(draws.len(), expected);
        for hit in scene.fragments_at(&draws, 12, 12) {
            let [r, g, b, a] = hit.fragment.outputs[0];
            // Transparent multiplies by alpha; else the color is the replacement's.
            let full = if draws[hit.draw].keywords.premultiply { a } else { 1.0 };
            prop_assert_eq!([r, g, b], [full, 0.0, 0.0]);
        }
    }
}
