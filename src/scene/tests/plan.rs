//! The bytes that plans count, by hand.

use super::*;
use crate::plan::Traffic;

fn plan_of(target: &str, materials: &[&str]) -> planned::ScenePlan {
    quads(target, materials).plan(&Exact::default()).expect("planned")
}

#[test]
fn an_opaque_quad_and_a_faded_one_before_it_move_these_bytes() {
    let plan = plan_of("", &[OPAQUE, FADE]);
    assert!(plan.same_bytes, "nobody can see it");
    assert_eq!((plan.depth_target.needed, plan.depth_target_bytes), (true, 4 * 16 * 16), "a code a pixel");
    let [opaque, fade] = &plan.draws[..] else { panic!("two draws: {plan:?}") };
    let (far, near) = (opaque.fragments, fade.fragments);
    assert!(far > 0 && near >= far, "the near quad covers the far one: {far}, {near}");
    // 8-bit RGBA and 24-bit depth are four bytes each. Every fragment passes.
    let written = Traffic { color_written: 4 * far, depth_read: 4 * far, depth_written: 4 * far, ..Traffic::default() };
    assert_eq!(opaque.planned.traffic, written, "an opaque draw reads no color");
    assert_eq!(opaque.everything.traffic, Traffic { color_read: 4 * far, ..written });
    let blended = Traffic { color_read: 4 * near, color_written: 4 * near, depth_read: 4 * near, ..Traffic::default() };
    assert_eq!(fade.planned.traffic, blended, "ZWrite Off");
    assert_eq!(fade.everything.traffic, blended, "and blending needs the rest");
    assert_eq!(opaque.planned.traffic.total(), 12 * far);
}

#[test]
fn depth_is_neither_kept_nor_touched_where_nothing_reads_it() {
    let pass = format!("{OPAQUE}\n[[material.pass]]\nstate = \"ZTest Always ZWrite Off\"");
    let plan = plan_of("format = \"rgba16float\"", &[&pass]);
    assert_eq!(
        (plan.depth_target.needed, plan.depth_target_bytes),
        (false, 4 * 16 * 16),
        "it would be there for nothing"
    );
    let draw = &plan.draws[0];
    let written = Traffic { color_written: 8 * draw.fragments, ..Traffic::default() };
    assert_eq!(draw.planned.traffic, written, "a half-float texel is eight bytes");
    assert_eq!(draw.everything.traffic.total(), (8 + 8 + 4) * draw.fragments, "all that the state names: {draw:?}");
}

#[test]
fn masked_and_failing_draws_move_nothing() {
    let masked = format!("{OPAQUE}\n[[material.pass]]\nstate = \"ColorMask 0 ZWrite Off\"");
    let never = format!("{OPAQUE}\n[[material.pass]]\nstate = \"ZTest Never\"");
    for draw in plan_of("", &[&masked, &never]).draws {
        assert_eq!(draw.planned.traffic, Traffic::default(), "{}", draw.object);
        assert!(draw.everything.traffic.total() > 0 || draw.object == "o0", "{draw:?}");
    }
}
