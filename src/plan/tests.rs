//! The laws of the plan: what it leaves out cannot be seen, and is not computed.

mod reasons;
mod strategy;

use std::sync::Mutex;

use proptest::prelude::*;
use wgpu_types::{
    BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthBiasState, DepthStencilState, StencilFaceState, StencilOperation, StencilState, TextureFormat as T,
};

use super::*;
use crate::format::Codes;
use crate::format::depth::DepthKind;
use crate::fragment::Fragment;
use crate::merger::Merger;
use crate::model::{ColorInputs, Explanation, Unsupported, registry};
use crate::target::{Extent, Framebuffer};
use strategy::{Case, case, models};

/// The framebuffer after the reference has merged all fragments; `None` where the model does not cover the state.
fn reference(case: &Case, model: &dyn NumericModel) -> Option<Framebuffer> {
    let mut framebuffer = case.framebuffer.clone();
    let merger = Merger::new(&case.state, model, &framebuffer).ok()?;
    for fragment in &case.fragments {
        merger.merge(fragment, 0, 0, &mut framebuffer);
    }
    Some(framebuffer)
}

/// A model that records what it is asked.
#[derive(Debug)]
struct Recorder<'a> {
    model: &'a dyn NumericModel,
    asked: Mutex<Asked>,
}

#[derive(Debug, Default)]
struct Asked {
    colors: Vec<ColorInputs>,
    depth_codes: usize,
    rewrites: usize,
}

impl<'a> Recorder<'a> {
    fn new(model: &'a dyn NumericModel) -> Self {
        Self { model, asked: Mutex::default() }
    }

    fn note(&self, note: impl FnOnce(&mut Asked)) {
        note(&mut self.asked.lock().expect("one thread"));
    }
}

impl NumericModel for Recorder<'_> {
    fn name(&self) -> String {
        self.model.name()
    }

    fn provenance(&self) -> String {
        self.model.provenance()
    }

    fn supports(&self, format: ColorFormat, blend: Option<&BlendState>) -> Result<(), Unsupported> {
        self.model.supports(format, blend)
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        self.note(|asked| asked.colors.push(*inputs));
        self.model.merge_color(inputs)
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        self.model.explain_color(inputs)
    }

    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        self.note(|asked| asked.depth_codes += 1);
        self.model.depth_code(kind, z, range)
    }

    fn rewrite_untouched(&self, format: ColorFormat, codes: Codes) -> Codes {
        self.note(|asked| asked.rewrites += 1);
        self.model.rewrite_untouched(format, codes)
    }

    fn rewrites_untouched(&self, format: ColorFormat) -> bool {
        self.model.rewrites_untouched(format)
    }

    fn drops_zero_destination(&self, format: ColorFormat, blend: &BlendState) -> bool {
        self.model.drops_zero_destination(format, blend)
    }
}

fn needed(plan: &Plan, part: Part) -> bool {
    let mut found = plan.decisions.iter().filter(|decision| decision.part == part).peekable();
    assert!(found.peek().is_some(), "the plan decides on {}", part.name());
    found.any(|decision| decision.needed)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn planned_equals_the_reference_byte_for_byte(case in case(3)) {
        for model in models() {
            let Some(expected) = reference(&case, model.as_ref()) else { continue };
            let mut planned = case.framebuffer.clone();
            let merger = Planned::new(&case.state, model.as_ref(), &planned).expect("the reference takes it");
            let mut everything = case.framebuffer.clone();
            let all = Planned::everything(&case.state, model.as_ref(), &everything).expect("the reference takes it");
            for fragment in &case.fragments {
                merger.merge(fragment, 0, 0, &mut planned);
                all.merge(fragment, 0, 0, &mut everything);
            }
            prop_assert_eq!(&planned, &expected, "{}: {:?}", model.name(), merger.plan());
            prop_assert_eq!(&everything, &expected, "{}, nothing left out", model.name());
        }
    }

    #[test]
    fn nothing_left_out_is_computed_read_or_written(case in case(1)) {
        for model in models() {
            let recorder = Recorder::new(model.as_ref());
            let mut framebuffer = case.framebuffer.clone();
            let Ok(merger) = Planned::new(&case.state, &recorder, &framebuffer) else { continue };
            let mut memory = Counted::new(&mut framebuffer);
            for fragment in &case.fragments {
                merger.merge(fragment, 0, 0, &mut memory);
            }
            let (plan, traffic) = (merger.plan(), memory.traffic);
            let asked = std::mem::take(&mut *recorder.asked.lock().expect("one thread"));
            let name = model.name();
            for (part, bytes) in [
                (Part::DestinationRead, traffic.color_read),
                (Part::ColorWrite, traffic.color_written),
                (Part::DepthRead, traffic.depth_read),
                (Part::DepthWrite, traffic.depth_written),
                (Part::StencilRead, traffic.stencil_read),
                (Part::StencilWrite, traffic.stencil_written),
            ] {
                prop_assert!(needed(plan, part) || bytes == 0, "{name}: {} moved {bytes} bytes", part.name());
            }
            let depth = needed(plan, Part::DepthRead) || needed(plan, Part::DepthWrite);
            prop_assert!(depth || asked.depth_codes == 0, "{name}: {} depth codes", asked.depth_codes);
            prop_assert!(
                needed(plan, Part::ColorWrite) || asked.colors.is_empty() && asked.rewrites == 0,
                "{name}: {asked:?}"
            );
            for inputs in &asked.colors {
                prop_assert!(needed(plan, Part::Blend) || inputs.blend.is_none(), "{name}: blended");
                prop_assert!(needed(plan, Part::SecondSource) || inputs.src1 == [0.0; 4], "{name}: second source");
                prop_assert!(needed(plan, Part::BlendConstant) || inputs.constant == [0.0; 4], "{name}: constant");
            }
        }
    }

    /// What a shader need not compute may be any number, here NaN.
    #[test]
    fn unread_source_channels_second_source_and_constant_do_not_show(case in case(2)) {
        for model in models() {
            let Some(expected) = reference(&case, model.as_ref()) else { continue };
            let plan = Plan::for_model(&case.state, model.as_ref()).expect("the reference takes it");
            let mut other = case.clone();
            let reads = |pick: fn(&Reads) -> bool| plan.targets.iter().flatten().any(|target| pick(&target.reads));
            if !reads(|reads| reads.constant) {
                other.state.dynamic.blend_constant = [f32::NAN; 4];
            }
            for fragment in &mut other.fragments {
                if !reads(|reads| reads.second_source) {
                    fragment.src1 = [f32::NAN; 4];
                }
                for (index, output) in fragment.outputs.iter_mut().enumerate() {
                    let source = plan.targets.get(index).copied().flatten().map_or([false; 4], |target| target.reads.source);
                    for i in 0..4 {
                        let tested = index == 0 && i == 3 && plan.reads_source_alpha();
                        if !source[i] && !tested {
                            output[i] = f32::NAN;
                        }
                    }
                }
            }
            prop_assert_eq!(reference(&other, model.as_ref()), Some(expected), "{}: {:?}", model.name(), plan);
        }
    }

    /// A plan without a model leaves out no more than the plan for any model does.
    #[test]
    fn what_holds_for_any_model_holds_for_each(case in case(2)) {
        let any = Plan::for_any_model(&case.state).expect("formats of their roles");
        for model in models() {
            let one = Plan::for_model(&case.state, model.as_ref()).expect("formats of their roles");
            for (any, one) in any.targets.iter().flatten().zip(one.targets.iter().flatten()) {
                prop_assert!(any.read || !one.read, "{}: destination read", model.name());
                prop_assert!(any.blend || !one.blend, "{}: blend", model.name());
                prop_assert_eq!(any.write, one.write, "{}: write", model.name());
            }
        }
    }
}

fn blend(src_factor: F, dst_factor: F, operation: Op) -> Option<BlendState> {
    let component = BlendComponent { src_factor, dst_factor, operation };
    Some(BlendState { color: component, alpha: component })
}

fn target(format: T, blend: Option<BlendState>) -> MergerState {
    MergerState::single(ColorTargetState { format, blend, write_mask: ColorWrites::ALL })
}

fn plan(state: &MergerState, model: &str) -> Plan {
    let model = registry::by_name(model).expect("a model");
    Plan::for_model(state, model.as_ref()).expect("formats of their roles")
}

#[test]
fn one_zero_on_normalised_targets_needs_neither_destination_nor_blending() {
    for (name, format) in crate::format::layout::FORMATS {
        let state = target(format, blend(F::One, F::Zero, Op::Add));
        let plan = Plan::for_any_model(&state).expect("a color format");
        let float = name.contains("float");
        assert_eq!(needed(&plan, Part::DestinationRead), float, "{name}: read");
        assert_eq!(needed(&plan, Part::Blend), float, "{name}: blend");
    }
}

/// The destinations that make `One Zero` observable on float targets, model by model.
#[test]
fn one_zero_on_float_targets_shows_the_destination_where_the_plan_reads_it() {
    let (nan, inf, minus_one, one, huge) = (0x7e00, 0x7c00, 0xbc00, 0x3c00, 0x7bff);
    for (format, model, source, [a, b], differ) in [
        (T::Rgba16Float, "f32", 0.5, [one, nan], true),
        (T::Rgba16Float, "f32", 0.5, [one, inf], true),
        (T::Rgba16Float, "exact", 0.5, [one, nan], true),
        (T::Rgba16Float, "exact", -0.0, [one, minus_one], true),
        (T::Rgba16Float, "f16", -0.0, [one, minus_one], true),
        (T::Rgba16Float, "llvmpipe", 0.5, [one, nan], false),
        (T::Rgba16Float, "llvmpipe", -0.0, [one, minus_one], false),
        (T::R16Float, "llvmpipe", 1e-4, [0, huge], true),
    ] {
        let state = target(format, blend(F::One, F::Zero, Op::Add));
        let model_name = model;
        let model = registry::by_name(model).expect("a model");
        let inputs = |dst| ColorInputs {
            format: ColorFormat::new(format).expect("a color format"),
            blend: state.targets[0].as_ref().and_then(|target| target.blend),
            constant: [0.0; 4],
            src: [source; 4],
            src1: [0.0; 4],
            dst: [dst; 4],
        };
        let differs = model.merge_color(&inputs(a)) != model.merge_color(&inputs(b));
        assert_eq!(differs, differ, "{format:?}, {model_name}: source {source}, destinations {a:#x} and {b:#x}");
        // What llvmpipe does to discarded fragments' texels is another reason to read, not this one.
        let read = plan(&state, model_name).targets[0].as_ref().expect("a target").read;
        assert_eq!(read, differ, "{format:?}, {model_name}: read");
    }
}

#[test]
fn missing_alpha_is_one_and_needs_no_read() {
    let state = target(T::Rg8Unorm, blend(F::DstAlpha, F::OneMinusDstAlpha, Op::Add));
    assert!(!needed(&plan(&state, "exact"), Part::DestinationRead), "S 1 + D (1 - 1)");
    let state = target(T::Rgba8Unorm, blend(F::DstAlpha, F::OneMinusDstAlpha, Op::Add));
    assert!(needed(&plan(&state, "exact"), Part::DestinationRead), "alpha is stored");
}

#[test]
fn source_alpha_is_needed_only_where_something_reads_it() {
    let mut state = target(T::R8Unorm, None);
    assert!(!plan(&state, "exact").reads_source_alpha(), "one channel stores no alpha");
    state.alpha_test = AlphaTest::On { compare: CompareFunction::Greater, reference: 0.5 };
    assert!(plan(&state, "exact").reads_source_alpha(), "the alpha test reads it");
    state = target(T::R8Unorm, blend(F::SrcAlpha, F::One, Op::Add));
    assert!(plan(&state, "exact").reads_source_alpha(), "the factor reads it");
    state = target(T::R8Unorm, blend(F::SrcAlpha, F::One, Op::Max));
    assert!(!plan(&state, "exact").reads_source_alpha(), "maximum ignores factors");
    state = target(T::Rgba8Unorm, None);
    assert!(plan(&state, "exact").reads_source_alpha(), "it is stored");
    state.targets[0].as_mut().expect("there").write_mask = ColorWrites::COLOR;
    assert!(!plan(&state, "exact").reads_source_alpha(), "it is masked");
}

#[test]
fn a_masked_target_is_left_alone_unless_the_model_rewrites_it() {
    let mut state = target(T::Rgba16Float, blend(F::SrcAlpha, F::One, Op::Add));
    state.targets[0].as_mut().expect("there").write_mask = ColorWrites::empty();
    for (model, rewrites) in [("exact", false), ("f32", false), ("llvmpipe", true)] {
        assert_eq!(needed(&plan(&state, model), Part::ColorWrite), rewrites, "{model}");
        assert_eq!(plan(&state, model).leaves_a_trace(), rewrites, "{model}");
    }
    state.targets[0].as_mut().expect("there").format = T::Rgba8Unorm;
    assert!(!plan(&state, "llvmpipe").leaves_a_trace(), "unorm texels have one encoding");
}

fn depth_state(format: T, compare: CompareFunction, write: bool) -> MergerState {
    let mut state = target(T::Rgba8Unorm, None);
    state.depth_stencil = Some(DepthStencilState {
        format,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: StencilState::default(),
        bias: DepthBiasState::default(),
    });
    state
}

#[test]
fn depth_memory_is_touched_only_as_far_as_it_can_show() {
    use CompareFunction as C;
    for (format, compare, write, expected) in [
        (T::Depth16Unorm, C::Less, true, (true, true)),
        (T::Depth16Unorm, C::Less, false, (true, false)),
        (T::Depth16Unorm, C::Always, true, (false, true)),
        (T::Depth16Unorm, C::Always, false, (false, false)),
        (T::Depth16Unorm, C::Never, true, (false, false)),
        (T::Depth16Unorm, C::Equal, true, (true, false)),
        // -0 and +0 are equal and have different bits.
        (T::Depth32Float, C::Equal, true, (true, true)),
    ] {
        let plan = plan(&depth_state(format, compare, write), "exact");
        let got = (needed(&plan, Part::DepthRead), needed(&plan, Part::DepthWrite));
        assert_eq!(got, expected, "{format:?}, {compare:?}, write {write}");
    }
    let mut invisible = depth_state(T::Depth16Unorm, C::Less, false);
    invisible.targets[0].as_mut().expect("there").write_mask = ColorWrites::empty();
    assert!(!plan(&invisible, "exact").leaves_a_trace(), "nothing is written, so nothing is tested");
}

/// Every comparison and pass operation, both faces unlike each other, against every stored value.
#[test]
fn planned_stencil_equals_the_reference_for_every_stored_value() {
    let model = registry::by_name("exact").expect("a model");
    let operations = strategy::STENCIL_OPERATIONS;
    for (compare, depth_compare) in strategy::COMPARISONS
        .into_iter()
        .flat_map(|c| [CompareFunction::Always, CompareFunction::Never, CompareFunction::Less].map(|depth| (c, depth)))
    {
        for (i, pass_op) in operations.into_iter().enumerate() {
            let (fail_op, depth_fail_op) = (operations[(i + 3) % 8], operations[(i + 5) % 8]);
            for (reference, read_mask, write_mask) in
                [(0, 255, 255), (255, 255, 255), (7, 6, 0x3c), (1, 0, 255), (0x1ff, 255, 0)]
            {
                for back in
                    [StencilFaceState::IGNORE, StencilFaceState { compare, fail_op: pass_op, depth_fail_op, pass_op }]
                {
                    let front = StencilFaceState { compare, fail_op, depth_fail_op, pass_op };
                    let mut state = depth_state(T::Depth24PlusStencil8, depth_compare, true);
                    state.dynamic.stencil_reference = reference;
                    let depth_stencil = state.depth_stencil.as_mut().expect("there");
                    depth_stencil.stencil = StencilState { front, back, read_mask, write_mask };
                    let extent = Extent::new(16, 16).expect("small");
                    let mut start = Framebuffer::for_state(extent, &state).expect("small");
                    let attached = start.depth_stencil.as_mut().expect("there");
                    for (value, stored) in (0..=255).zip(attached.stencil_mut()) {
                        *stored = value;
                    }
                    attached.depth_mut().fill(1 << 23);
                    let (mut expected, mut planned) = (start.clone(), start.clone());
                    let reference = Merger::new(&state, model.as_ref(), &start).expect("fits");
                    let merger = Planned::new(&state, model.as_ref(), &start).expect("fits");
                    for at in 0..256 {
                        let fragment = Fragment {
                            front_facing: at % 2 == 0,
                            depth: if at % 3 == 0 { 0.25 } else { 0.75 },
                            ..Fragment::new([0.5; 4])
                        };
                        reference.merge(&fragment, at % 16, at / 16, &mut expected);
                        merger.merge(&fragment, at % 16, at / 16, &mut planned);
                    }
                    assert_eq!(planned, expected, "{state:?}");
                }
            }
        }
    }
}

#[test]
fn replacing_always_writes_stencil_without_reading_it() {
    let mut state = depth_state(T::Depth24PlusStencil8, CompareFunction::Always, false);
    let replace = StencilFaceState { pass_op: StencilOperation::Replace, ..StencilFaceState::IGNORE };
    let set = |state: &mut MergerState, back| {
        let depth_stencil = state.depth_stencil.as_mut().expect("there");
        depth_stencil.stencil = StencilState { front: replace, back, read_mask: 255, write_mask: 255 };
    };
    let parts = |state: &MergerState| {
        let plan = plan(state, "exact");
        (needed(&plan, Part::StencilRead), needed(&plan, Part::StencilWrite))
    };
    set(&mut state, replace);
    assert_eq!(parts(&state), (false, true), "both faces store the reference");
    set(&mut state, StencilFaceState::IGNORE);
    assert_eq!(parts(&state), (true, true), "back faces keep what is stored");
}

#[test]
fn every_decision_has_a_reason_and_every_part_a_decision() {
    let state = depth_state(T::Depth24PlusStencil8, CompareFunction::LessEqual, true);
    let plan = plan(&state, "exact");
    assert_eq!(plan.decisions.len(), 12, "twelve parts with one target: {:?}", plan.decisions);
    assert!(plan.decisions.iter().all(|decision| !decision.reason.is_empty()), "with reasons");
}
