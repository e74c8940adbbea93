//! `outmerge plan`.

use outmerge::model::registry;
use outmerge::plan::Part;
use outmerge::scene::Scene;

use super::outmerge;

/// Planned and unplanned mergers fill the targets of every bundled scene with the same bytes, and the plan never moves
/// more.
#[test]
fn no_omission_shows_in_any_bundled_scene_in_any_model() {
    for (name, scene) in Scene::bundled() {
        let scene = scene.expect("a bundled scene is valid");
        for model in registry::all() {
            let Ok(plan) = scene.plan(model.as_ref()) else {
                assert!(scene.render(model.as_ref()).is_err(), "{name}, {}: what renders has a plan", model.name());
                continue;
            };
            assert!(plan.same_bytes, "{name}, {}", model.name());
            for draw in &plan.draws {
                let (lean, full) = (draw.planned.traffic.total(), draw.everything.traffic.total());
                assert!(lean <= full, "{name}, {}, {}: {lean} of {full} bytes", model.name(), draw.object);
            }
        }
    }
}

#[test]
fn opaque_draws_need_no_destination_no_clip_and_no_sort() {
    let scene = Scene::bundled_by_name("fade-over-opaque").expect("bundled").expect("valid");
    let plan = scene.plan(registry::by_name("exact").expect("a model").as_ref()).expect("plans");
    let (opaque, fade) = (&plan.draws[0], &plan.draws[plan.draws.len() - 1]);
    let part = |draw: &outmerge::scene::planned::DrawPlan, part| {
        draw.merger.iter().find(|decision| decision.part == part).expect("listed").needed
    };
    let step = |draw: &outmerge::scene::planned::DrawPlan, part| {
        draw.pipeline.iter().find(|decision| decision.part == part).expect("listed").needed
    };
    assert!(!part(opaque, Part::DestinationRead) && !step(opaque, "clip") && !step(opaque, "sort"), "{opaque:?}");
    assert!(part(fade, Part::DestinationRead) && step(fade, "alpha") && step(fade, "sort"), "{fade:?}");
    assert!(opaque.planned.traffic.color_read == 0, "an opaque draw reads no color: {opaque:?}");
}

#[test]
fn the_text_names_parts_reasons_and_bytes() {
    let output = outmerge(&["plan", "fade-over-opaque"]).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for wanted in ["destination read", "left out", "blending is off", "bytes moved", "the same bytes either way"] {
        assert!(text.contains(wanted), "`{wanted}` in\n{text}");
    }
    outmerge(&["plan", "no-such-scene"]).assert().code(2);
    let json = outmerge(&["plan", "fade-over-opaque", "--json"]).output().expect("runs").stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(json["same_bytes"], true);
}
