use proptest::prelude::*;

use super::*;
use crate::model::registry;
use crate::scene::draw::VARYINGS;
use crate::scene::raster::{Primitive, assemble};

fn bundled(name: &str) -> Scene {
    Scene::bundled_by_name(name).expect("a bundled scene").expect("bundled scenes are correct")
}

fn exact() -> Box<dyn NumericModel> {
    registry::by_name("exact").expect("a model")
}

#[test]
fn a_pixel_outside_is_an_error_that_names_the_size() {
    let scene = bundled("fade-over-opaque");
    let (width, height) = (scene.target.extent.width, scene.target.extent.height);
    let error = scene.history(&*exact(), width, 0).expect_err("outside");
    assert!(error.to_string().contains(&format!("{width} x {height}")), "{error}");
    assert!(scene.history(&*exact(), 0, height).is_err(), "below");
}

#[test]
fn every_event_starts_where_the_one_before_ended() {
    for (name, scene) in Scene::bundled() {
        let scene = scene.expect("correct");
        let (x, y) = (scene.target.extent.width / 2, scene.target.extent.height / 2);
        let history = scene.history(&*exact(), x, y).expect("inside");
        let mut now = &history.cleared;
        for event in &history.events {
            assert_eq!(&event.before, now, "{name}");
            now = &event.after;
            if event.fate != Fate::Merged {
                assert_eq!(event.before.colors, event.after.colors, "{name}: {:?}", event.fate);
                assert_eq!(event.stages.last().map(|stage| stage.verdict), Some(Verdict::Failed), "{name}");
            }
        }
        assert_eq!(&history.last, now, "{name}");
    }
}

#[test]
fn a_hole_behind_a_fragment_that_wrote_depth_is_told_by_the_depth_stage() {
    let scene = bundled("overlap-zwrite-on");
    let extent = scene.target.extent;
    let failed = (0..extent.height).step_by(3).flat_map(|y| (0..extent.width).step_by(3).map(move |x| (x, y)));
    let told = failed
        .filter_map(|(x, y)| {
            let history = scene.history(&*exact(), x, y).expect("inside");
            let event = history.events.into_iter().find(|event| event.fate == Fate::DepthFailed)?;
            event.stages.last().cloned()
        })
        .next()
        .expect("some fragment fails the depth test");
    assert_eq!((told.name, told.verdict), ("depth", Verdict::Failed), "{told:?}");
    assert!(told.detail.contains("<="), "{told:?}");
}

#[test]
fn the_triangle_named_is_one_that_covers_the_pixel_at_that_depth() {
    let mut differing = 0;
    for (name, scene) in Scene::bundled() {
        let scene = scene.expect("correct");
        let draws = scene.draws();
        let extent = scene.target.extent;
        for (x, y) in [(extent.width / 2, extent.height / 2), (extent.width / 3, extent.height / 3)] {
            for event in scene.history(&*exact(), x, y).expect("inside").events {
                let draw = &draws[event.draw];
                assert_eq!(event.triangles, draw.triangles.len(), "{name}: triangles of the draw");
                let parts = assemble(draw.triangles[event.triangle], &draw.raster);
                let covers = |part: &Primitive<VARYINGS>| {
                    let spans = part.spans().any(|span| span.y == y && (span.start..span.end).contains(&x));
                    spans && part.depth(x, y).to_bits() == event.depth.to_bits()
                };
                assert!(
                    parts.iter().any(covers),
                    "{name}, {}: triangle {} at ({x}, {y})",
                    event.object,
                    event.triangle
                );
                differing += usize::from(event.triangle > 0);
            }
        }
    }
    assert!(differing > 20, "not always the first triangle: {differing}");
}

#[test]
fn shares_of_opaque_and_fade_add_up_to_what_is_stored() {
    let scene = bundled("fade-over-opaque");
    let (x, y) = (scene.target.extent.width / 2, scene.target.extent.height / 2);
    let history = scene.history(&*exact(), x, y).expect("inside");
    let stack = history.stacks(&scene.draws()).swap_remove(0);
    assert!(stack.shares.len() >= 3, "cleared target, opaque and faded layer: {stack:?}");
    for i in 0..3 {
        assert_eq!(stack.shares[0].weight[i], 0.0, "the opaque layer leaves nothing of the cleared target");
        let weights: f64 = stack.shares.iter().map(|share| share.weight[i]).sum();
        assert!((weights - 1.0).abs() < 1e-6, "over is a weighted mean: {weights}");
        assert!((stack.sum[i] - stack.stored[i]).abs() <= 1.0 / 255.0, "within a rounding a layer: {stack:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The history ends in the pixel of the rendered picture, in every model, at any pixel of any bundled scene.
    #[test]
    fn histories_end_in_the_rendered_bytes(pick in any::<prop::sample::Index>(), x in 0.0..1.0, y in 0.0..1.0) {
        let scenes: Vec<_> = Scene::bundled().collect();
        let scene = pick.get(&scenes).1.as_ref().expect("correct");
        let at = |share: f64, size: u32| (0..size).rev().find(|i| f64::from(*i) <= share * f64::from(size)).unwrap_or(0);
        let (x, y) = (at(x, scene.target.extent.width), at(y, scene.target.extent.height));
        for model in registry::all() {
            let Ok(rendered) = scene.render(&*model) else { continue };
            let history = scene.history(&*model, x, y).expect("what renders has a history");
            prop_assert_eq!(history.last, Contents::at(&rendered.framebuffer, x, y), "{}", model.name());
        }
    }
}
