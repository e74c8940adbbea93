//! The stencil test. Sources: V, *Stencil Test*; D 17.12-17.14; W, *Depth/stencil state*.

use outmerge::format::DepthFormat;
use outmerge::merger::depth_stencil::{DepthStencil, Tested, test};
use wgpu_types::{
    CompareFunction as C, DepthBiasState, DepthStencilState, StencilFaceState, StencilOperation as Op, StencilState,
    TextureFormat,
};

const FACE: StencilFaceState =
    StencilFaceState { compare: C::Always, fail_op: Op::Keep, depth_fail_op: Op::Keep, pass_op: Op::Keep };

fn state(front: StencilFaceState, back: StencilFaceState, read_mask: u32, write_mask: u32) -> DepthStencilState {
    DepthStencilState {
        format: TextureFormat::Depth24PlusStencil8,
        depth_write_enabled: Some(true),
        depth_compare: Some(C::Less),
        stencil: StencilState { front, back, read_mask, write_mask },
        bias: DepthBiasState::default(),
    }
}

/// Tests a front-facing fragment whose depth is nearer (`depth_passes`) or farther than the stored one.
fn run(state: &DepthStencilState, reference: u32, stored: u8, depth_passes: bool) -> Tested {
    run_facing(state, reference, stored, depth_passes, true)
}

fn run_facing(state: &DepthStencilState, reference: u32, stored: u8, depth_passes: bool, front: bool) -> Tested {
    let format = DepthFormat::new(state.format).expect("a depth/stencil format");
    let code = if depth_passes { 10 } else { 30 };
    test(state, format, front, reference, code, DepthStencil { depth: 20, stencil: stored })
}

#[test]
fn the_masked_reference_is_on_the_left() {
    let state = |compare| state(StencilFaceState { compare, ..FACE }, FACE, 0x0f, 0xff);
    // Reference 0xf1 and stored 0x32 are 1 and 2 under the read mask.
    for (compare, passes) in [
        (C::Never, false),
        (C::Less, true),
        (C::Equal, false),
        (C::LessEqual, true),
        (C::Greater, false),
        (C::NotEqual, true),
        (C::GreaterEqual, false),
        (C::Always, true),
    ] {
        assert_eq!(run(&state(compare), 0xf1, 0x32, true).stencil_passed, passes, "1 {compare:?} 2");
    }
}

#[test]
fn the_operation_is_chosen_by_both_tests() {
    let face = StencilFaceState { fail_op: Op::Zero, depth_fail_op: Op::Invert, pass_op: Op::Replace, ..FACE };
    let failing = StencilFaceState { compare: C::Never, ..face };
    let after = |face, depth_passes| run(&state(face, FACE, !0, !0), 9, 5, depth_passes).stored.stencil;
    assert_eq!(after(failing, true), 0, "failOp when stencil fails, whatever depth does");
    assert_eq!(after(failing, false), 0, "failOp");
    assert_eq!(after(face, false), !5, "depthFailOp");
    assert_eq!(after(face, true), 9, "passOp");
}

#[test]
fn operations_work_on_the_unmasked_stored_value() {
    type Rule = fn(u8) -> u8;
    let table: [(Op, Rule); 8] = [
        (Op::Keep, |s| s),
        (Op::Zero, |_| 0),
        (Op::Replace, |_| 0xa5),
        (Op::Invert, |s| 255 - s),
        (Op::IncrementClamp, |s| if s == 255 { 255 } else { s + 1 }),
        (Op::DecrementClamp, |s| if s == 0 { 0 } else { s - 1 }),
        (Op::IncrementWrap, |s| if s == 255 { 0 } else { s + 1 }),
        (Op::DecrementWrap, |s| if s == 0 { 255 } else { s - 1 }),
    ];
    for (pass_op, expected) in table {
        let state = state(StencilFaceState { pass_op, ..FACE }, FACE, 0x0f, 0xff);
        for stored in 0..=255 {
            assert_eq!(run(&state, 0xa5, stored, true).stored.stencil, expected(stored), "{pass_op:?} of {stored}");
        }
    }
}

#[test]
fn the_write_mask_keeps_the_other_bits_also_on_failure() {
    let face = StencilFaceState { compare: C::Never, fail_op: Op::Replace, ..FACE };
    let after = run(&state(face, FACE, !0, 0x3c), 0xff, 0x42, true);
    assert!(!after.passed(), "the fragment ends");
    assert_eq!(after.stored.stencil, 0x7e, "(0x42 and not 0x3c) or (0xff and 0x3c)");
}

#[test]
fn reference_and_mask_bits_above_8_are_dropped() {
    let face = StencilFaceState { compare: C::Equal, pass_op: Op::Replace, ..FACE };
    let after = run(&state(face, FACE, 0xffff_ff00 | 0xf0, 0xffff_ffff), 0x1234_5678, 0x70, true);
    assert!(after.stencil_passed, "0x78 and 0x70 agree under 0xf0");
    assert_eq!(after.stored.stencil, 0x78, "the low byte is written");
}

#[test]
fn the_face_the_fragment_shows_chooses_the_state() {
    let front = StencilFaceState { pass_op: Op::IncrementWrap, ..FACE };
    let back = StencilFaceState { pass_op: Op::DecrementWrap, ..FACE };
    let state = state(front, back, !0, !0);
    assert_eq!(run_facing(&state, 0, 7, true, true).stored.stencil, 8, "front");
    assert_eq!(run_facing(&state, 0, 7, true, false).stored.stencil, 6, "back");
}

#[test]
fn without_a_depth_aspect_depth_counts_as_passed() {
    let mut state = state(StencilFaceState { pass_op: Op::Replace, ..FACE }, FACE, !0, !0);
    state.format = TextureFormat::Stencil8;
    state.depth_compare = None;
    let after = run(&state, 9, 5, false);
    assert!(after.depth_passed, "no depth aspect");
    assert_eq!(after.stored.stencil, 9, "passOp");
}

#[test]
fn without_a_stencil_aspect_stencil_counts_as_passed() {
    let mut state = state(StencilFaceState { compare: C::Never, ..FACE }, FACE, !0, !0);
    state.format = TextureFormat::Depth24Plus;
    let after = run(&state, 9, 5, true);
    assert!(after.passed(), "no stencil aspect");
    assert_eq!(after.stored, DepthStencil { depth: 10, stencil: 5 }, "depth written, stencil left alone");
}

#[test]
fn depth_is_written_only_when_both_tests_pass() {
    let failing = StencilFaceState { compare: C::Never, ..FACE };
    assert_eq!(run(&state(FACE, FACE, !0, !0), 0, 0, true).stored.depth, 10, "both pass");
    assert_eq!(run(&state(FACE, FACE, !0, !0), 0, 0, false).stored.depth, 20, "depth fails");
    assert_eq!(run(&state(failing, FACE, !0, !0), 0, 0, true).stored.depth, 20, "stencil fails");
}
