//! Every reason that a plan gives, each of a state that has it.

use wgpu_types::MultisampleState;

use super::*;
use crate::state::Rect;

/// The decision on a part of target 0, or of the whole draw.
fn said(state: &MergerState, model: &str, part: Part) -> (bool, &'static str) {
    let plan = plan(state, model);
    let mut found = plan.decisions.iter().filter(|d| d.part == part && d.target.is_none_or(|target| target == 0));
    let decision = found.next().unwrap_or_else(|| panic!("no word about {}", part.name()));
    assert!(found.next().is_none(), "{} twice", part.name());
    (decision.needed, decision.reason)
}

fn with_mask(mut state: MergerState, mask: ColorWrites) -> MergerState {
    state.targets[0].as_mut().expect("a target").write_mask = mask;
    state
}

fn with_test(mut state: MergerState, compare: CompareFunction, reference: f32) -> MergerState {
    state.alpha_test = AlphaTest::On { compare, reference };
    state
}

const NOTHING: ColorWrites = ColorWrites::empty();
const NO_TRACE: &str = "nothing is written, so no outcome shows";

#[test]
fn alpha_test_and_alpha_to_coverage() {
    use CompareFunction as C;
    let opaque = target(T::Rgba8Unorm, None);
    let test = |state: &MergerState| said(state, "exact", Part::AlphaTest);
    assert_eq!(test(&opaque), (false, "it is off"));
    assert_eq!(test(&with_test(opaque.clone(), C::Greater, 0.5)), (true, "its outcome depends on alpha"));
    assert_eq!(test(&with_test(opaque.clone(), C::Always, 0.5)), (false, "it always passes, NaN included"));
    assert_eq!(test(&with_test(opaque.clone(), C::Never, 0.5)), (false, "it never passes, whatever the alpha"));
    let nan = with_test(opaque.clone(), C::NotEqual, f32::NAN);
    assert_eq!(test(&nan), (false, "every alpha differs from a NaN reference"));
    for compare in [C::Less, C::Equal, C::GreaterEqual] {
        let never = with_test(opaque.clone(), compare, f32::NAN);
        assert_eq!(test(&never), (false, "it never passes, whatever the alpha"), "{compare:?} a NaN reference");
    }
    let masked = with_mask(with_test(opaque.clone(), C::Greater, 0.5), NOTHING);
    assert_eq!(test(&masked), (false, NO_TRACE));

    let covers = |state: &MergerState| said(state, "exact", Part::AlphaToCoverage);
    assert_eq!(covers(&opaque), (false, "it is off"));
    let mut on = opaque;
    on.multisample = MultisampleState { count: 4, alpha_to_coverage_enabled: true, ..MultisampleState::default() };
    assert_eq!(covers(&on), (true, "it drops samples by alpha"));
    assert_eq!(said(&on, "exact", Part::SourceAlpha), (true, "a test reads it"));
    assert_eq!(covers(&with_mask(on, NOTHING)), (false, NO_TRACE));
}

#[test]
fn depth() {
    use CompareFunction as C;
    let read = |state: &MergerState| said(state, "exact", Part::DepthRead);
    let write = |state: &MergerState| said(state, "exact", Part::DepthWrite);
    let depth = |compare, write| depth_state(T::Depth24Plus, compare, write);
    let absent = target(T::Rgba8Unorm, None);
    assert_eq!(read(&absent), (false, "there is no depth attachment"));
    assert_eq!(write(&absent), (false, "there is no depth attachment"));
    assert_eq!(read(&depth(C::Less, true)), (true, "the test compares with what is stored"));
    assert_eq!(write(&depth(C::Less, true)), (true, "fragments that pass store their depth"));
    assert_eq!(read(&depth(C::Always, true)), (false, "the test always passes"));
    assert_eq!(read(&depth(C::Never, true)), (false, "the test never passes"));
    assert_eq!(write(&depth(C::Less, false)), (false, "depth write is off"));
    assert_eq!(write(&depth(C::Equal, true)), (false, "the test passes only where the same code is stored already"));
    assert_eq!(write(&depth(C::Never, true)), (false, "no fragment passes the depth test"));
    assert_eq!(read(&with_mask(depth(C::Less, false), NOTHING)), (false, NO_TRACE));
    let never = with_test(depth(C::Less, true), C::Never, 0.5);
    assert_eq!(read(&never), (false, "no fragment passes the alpha test"));
    assert_eq!(write(&never), (false, "no fragment passes the alpha test"));
}

#[test]
fn stencil() {
    let read = |state: &MergerState| said(state, "exact", Part::StencilRead);
    let write = |state: &MergerState| said(state, "exact", Part::StencilWrite);
    let depth_only = depth_state(T::Depth24Plus, CompareFunction::Less, true);
    assert_eq!(read(&depth_only), (false, "there is no stencil attachment"));
    assert_eq!(write(&depth_only), (false, "there is no stencil attachment"));
    let with = |compare, pass_op| {
        let mut state = depth_state(T::Depth24PlusStencil8, CompareFunction::Always, false);
        let face = StencilFaceState { compare, pass_op, ..StencilFaceState::IGNORE };
        let stencil = StencilState { front: face, back: face, read_mask: 255, write_mask: 255 };
        state.depth_stencil.as_mut().expect("there").stencil = stencil;
        state
    };
    let compares = with(CompareFunction::Equal, StencilOperation::Keep);
    assert_eq!(read(&compares), (true, "the test or the new value depends on what is stored"));
    assert_eq!(write(&compares), (false, "every operation that can be reached keeps the value"));
    let replaces = with(CompareFunction::Always, StencilOperation::Replace);
    assert_eq!(read(&replaces), (false, "the test's outcome and the value written are always the same"));
    assert_eq!(write(&replaces), (true, "an operation that can be reached changes the value"));
    let nothing = with(CompareFunction::Always, StencilOperation::Keep);
    let reason = "the test's outcome is always the same or shows nowhere, and no value changes";
    assert_eq!(read(&nothing), (false, reason));
    let never = with(CompareFunction::Never, StencilOperation::Keep);
    assert_eq!(said(&never, "exact", Part::ColorWrite), (false, "no fragment passes the stencil test"));
}

#[test]
fn source_alpha() {
    let alpha = |state: &MergerState| said(state, "exact", Part::SourceAlpha);
    let fade = target(T::Rgba8Unorm, blend(F::SrcAlpha, F::OneMinusSrcAlpha, Op::Add));
    assert_eq!(alpha(&fade), (true, "the blend equation reads it"));
    let opaque = target(T::Rgba8Unorm, None);
    assert_eq!(alpha(&opaque), (true, "it is stored"));
    assert_eq!(alpha(&with_test(opaque.clone(), CompareFunction::Less, 0.5)), (true, "a test reads it"));
    let masked = "the write mask names no channel that the format stores";
    assert_eq!(alpha(&with_mask(opaque.clone(), NOTHING)), (false, masked));
    let no_alpha = "the format has no alpha, and no factor and no test reads it";
    assert_eq!(alpha(&target(T::Rg8Unorm, None)), (false, no_alpha));
    let unread = "alpha is masked or multiplied by zero, and no factor and no test reads it";
    assert_eq!(alpha(&with_mask(opaque, ColorWrites::COLOR)), (false, unread));
    // A test on the first target's alpha is no reason to compute the second's.
    let mut two = with_test(with_mask(fade, ColorWrites::COLOR), CompareFunction::Less, 0.5);
    two.targets.push(Some(ColorTargetState { format: T::Rg8Unorm, blend: None, write_mask: ColorWrites::ALL }));
    let plan = plan(&two, "exact");
    let second = plan.decisions.iter().find(|d| d.part == Part::SourceAlpha && d.target == Some(1));
    assert_eq!(second.map(|d| (d.needed, d.reason)), Some((false, no_alpha)));
}

#[test]
fn second_source_and_constant() {
    for (part, factor) in [(Part::SecondSource, F::Src1Alpha), (Part::BlendConstant, F::OneMinusConstant)] {
        let reads = target(T::Rgba8Unorm, blend(factor, F::One, Op::Add));
        assert_eq!(said(&reads, "exact", part), (true, "a blend factor reads it"));
        let masked = "the write mask names no channel that the format stores";
        assert_eq!(said(&with_mask(reads, NOTHING), "exact", part), (false, masked));
        let extreme = target(T::Rgba8Unorm, blend(F::One, F::One, Op::Add));
        assert_eq!(said(&extreme, "exact", part), (false, "no blend factor that counts reads it"));
    }
}

#[test]
fn destination_read() {
    let read = |state: &MergerState, model: &str| said(state, model, Part::DestinationRead);
    let replace = |format| target(format, blend(F::One, F::Zero, Op::Add));
    let off = target(T::Rgba8Unorm, None);
    assert_eq!(read(&off, "exact"), (false, "blending is off and every stored channel is written"));
    let kept = "the write mask leaves channels out, which keep their bits";
    assert_eq!(read(&with_mask(off.clone(), ColorWrites::RED), "exact"), (true, kept));
    let masked = "the write mask names no channel that the format stores";
    assert_eq!(read(&with_mask(off, NOTHING), "exact"), (false, masked));
    let reads = target(T::Rgba8Unorm, blend(F::One, F::One, Op::Add));
    assert_eq!(read(&reads, "exact"), (true, "the blend equation reads it"));
    let normalised = "the factor is zero, and a normalised target holds no NaN or infinity";
    assert_eq!(read(&replace(T::Rgba8Unorm), "exact"), (false, normalised));
    let shows =
        "the factor is zero, but zero times NaN, infinity or a negative number of a float target shows in the result";
    assert_eq!(read(&replace(T::Rgba16Float), "exact"), (true, shows));
    let adds = target(T::Rgba16Float, blend(F::One, F::One, Op::Add));
    assert_eq!(read(&adds, "exact"), (true, "the blend equation reads it"), "no factor is zero");
    let scales = target(T::Rgba16Float, blend(F::Zero, F::Src, Op::Add));
    assert_eq!(read(&scales, "exact"), (true, "the blend equation reads it"), "the source's factor is zero");
}

#[test]
fn blend_and_color_write() {
    let fade = target(T::Rgba8Unorm, blend(F::SrcAlpha, F::OneMinusSrcAlpha, Op::Add));
    let blends = |state: &MergerState| said(state, "exact", Part::Blend);
    let writes = |state: &MergerState, model: &str| said(state, model, Part::ColorWrite);
    let masked = "the write mask names no channel that the format stores";
    assert_eq!(blends(&fade), (true, "the result is not the source alone"));
    assert_eq!(blends(&target(T::Rgba8Unorm, None)), (false, "blending is off"));
    assert_eq!(blends(&with_mask(fade.clone(), NOTHING)), (false, masked));
    let replace = target(T::Rgba8Unorm, blend(F::One, F::Zero, Op::Add));
    assert_eq!(blends(&replace), (false, "source times one and destination times zero is the source"));
    assert_eq!(writes(&fade, "exact"), (true, "fragments that pass store their color"));
    assert_eq!(writes(&with_mask(fade, NOTHING), "exact"), (false, masked));
    let float = with_mask(target(T::Rgba16Float, None), NOTHING);
    let rewrites = "the model decodes and encodes covered texels even where nothing may change";
    assert_eq!(writes(&float, "llvmpipe"), (true, rewrites));
    let mut outside = target(T::Rgba8Unorm, None);
    outside.multisample.mask = 0;
    let uncovered = "no sample can be covered: the scissor is empty or the sample mask has no bit";
    assert_eq!(writes(&outside, "exact"), (false, uncovered));
    let scissor = |width, height| {
        let mut state = target(T::Rgba8Unorm, None);
        state.dynamic.scissor = Some(Rect { x: 0, y: 0, width, height });
        writes(&state, "exact")
    };
    assert_eq!((scissor(0, 4), scissor(4, 0)), ((false, uncovered), (false, uncovered)), "empty");
    assert_eq!(scissor(1, 1), (true, "fragments that pass store their color"));
    // Whether the mask is whole is told of targets that are not written too.
    let whole =
        |mask| plan(&with_test(with_mask(target(T::Rg8Unorm, None), mask), CompareFunction::Never, 0.0), "exact");
    let whole = |mask| whole(mask).targets[0].expect("a target").whole;
    assert!(whole(ColorWrites::RED | ColorWrites::GREEN) && !whole(ColorWrites::RED | ColorWrites::ALPHA));
}

#[test]
fn parts_have_their_names() {
    let names = [
        (Part::AlphaTest, "alpha test"),
        (Part::AlphaToCoverage, "alpha to coverage"),
        (Part::StencilRead, "stencil read"),
        (Part::StencilWrite, "stencil write"),
        (Part::DepthRead, "depth read"),
        (Part::DepthWrite, "depth write"),
        (Part::SourceAlpha, "source alpha"),
        (Part::SecondSource, "second source"),
        (Part::BlendConstant, "blend constant"),
        (Part::DestinationRead, "destination read"),
        (Part::Blend, "blend"),
        (Part::ColorWrite, "color write"),
    ];
    assert!(names.iter().all(|(part, name)| part.name() == *name), "in words");
    // In the order of the pipeline, as a plan lists them.
    let plan = plan(&depth_state(T::Depth24PlusStencil8, CompareFunction::LessEqual, true), "exact");
    assert_eq!(plan.decisions.iter().map(|d| d.part).collect::<Vec<_>>(), names.map(|(part, _)| part));
}
