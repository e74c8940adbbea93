//! Random states, fragments and targets through the device and the model of its driver: every byte agrees.
//!
//! A failure is shrunk to the fewest draws and the plainest numbers. The number of cases keeps the file under a minute;
//! `PROPTEST_CASES` asks for more.

use std::cell::RefCell;

use outmerge::crosscheck::batch::state_reads_second_source;
use outmerge::crosscheck::{Batch, Device, Layer, Replay};
use outmerge::format::depth::DepthKind;
use outmerge::format::{ChannelKind, ColorFormat, FloatLayout, TargetClass};
use outmerge::model::NumericModel;
use outmerge::model::exact::Exact;
use outmerge::model::llvmpipe::Llvmpipe;
use outmerge::model::llvmpipe::generation::{SampleMask, SmallDenormals, ZeroFactor};
use outmerge::proptest::layers::{Layers, layers};
use outmerge::proptest::state::{blending_state, valid_state};
use outmerge::target::{ColorTarget, DepthStencilTarget};
use outmerge::vectors::same_codes;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use wgpu_types::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, CompareFunction, DepthBiasState, DepthStencilState,
    StencilState, TextureFormat,
};

use crate::harness::{bytes, draw, llvmpipe, model, options, single, targets};

/// The state without what this device cannot replay: several samples, and blending where it does not blend.
fn fit(device: &Device, mut state: MergerState) -> MergerState {
    state.multisample.count = 1;
    state.multisample.alpha_to_coverage_enabled = false;
    for target in state.targets.iter_mut().flatten() {
        let format = ColorFormat::new(target.format).expect("a color format");
        if !device.blends(format) {
            target.blend = None;
        }
    }
    // WebGPU takes min and max with factors one only.
    for target in state.targets.iter_mut().flatten() {
        let components = target.blend.iter_mut().flat_map(|blend| [&mut blend.color, &mut blend.alpha]);
        for component in components.filter(|c| matches!(c.operation, BlendOperation::Min | BlendOperation::Max)) {
            (component.src_factor, component.dst_factor) = (BlendFactor::One, BlendFactor::One);
        }
    }
    // wgpu turns a stencil test off when both its masks are zero, even one that never passes.
    if let Some(depth_stencil) = &mut state.depth_stencil
        && (depth_stencil.stencil.read_mask | depth_stencil.stencil.write_mask) & 0xff == 0
    {
        depth_stencil.stencil.read_mask = 0xff;
    }
    // Half and 11/10-bit targets with a test that fails spoil what follows in some generations; see the test of that below.
    if model(device).generation.rules().small_denormals == SmallDenormals::Kept
        && has_small_floats(&state)
        && let Some(depth_stencil) = &mut state.depth_stencil
    {
        depth_stencil.depth_compare = depth_stencil.depth_compare.map(|_| CompareFunction::Always);
        depth_stencil.stencil.front.compare = CompareFunction::Always;
        depth_stencil.stencil.back.compare = CompareFunction::Always;
    }
    // A zero factor against NaN or infinity has no one result on these: `outmerge conform` compares such texels as sets.
    if model(device).generation.rules().zero_factor == ZeroFactor::Undecided {
        for target in state.targets.iter_mut().flatten().filter(|target| target.format == TextureFormat::Rg11b10Ufloat)
        {
            let components = target.blend.iter_mut().flat_map(|blend| [&mut blend.color, &mut blend.alpha]);
            let factors = components.flat_map(|component| [&mut component.src_factor, &mut component.dst_factor]);
            factors.filter(|factor| is_zero(**factor)).for_each(|factor| *factor = BlendFactor::One);
        }
    }
    // A second source works with one target at location 0 only.
    if state_reads_second_source(&state) && (state.targets.len() != 1 || !device.has_second_source()) {
        state.targets.iter_mut().flatten().for_each(|target| target.blend = None);
    }
    state
}

/// Whether a factor is the constant zero on a target without alpha.
fn is_zero(factor: BlendFactor) -> bool {
    matches!(factor, BlendFactor::Zero | BlendFactor::OneMinusDstAlpha)
}

/// Whether a target stores floats of 16 bits or fewer.
fn has_small_floats(state: &MergerState) -> bool {
    let small = |kind: &ChannelKind| matches!(kind, ChannelKind::Float(layout) if *layout != FloatLayout::SINGLE);
    let formats = state.targets.iter().flatten().filter_map(|target| ColorFormat::new(target.format).ok());
    formats.into_iter().any(|format| format.channels().iter().any(small))
}

/// A device that no other test draws with, for what tests leave behind on it.
fn fresh() -> Option<&'static Device> {
    llvmpipe()?;
    Some(Box::leak(Box::new(Device::open(&options()).expect("the device opens again"))))
}

fn drawable(device: &Device, state: &MergerState) -> bool {
    let color = state.targets.iter().flatten().map(|target| target.format);
    color.chain(state.depth_stencil.iter().map(|state| state.format)).all(|format| device.renders(format))
}

/// Depth codes that a draw can put there and a read-back tells apart: the last two of 24 bits load alike.
fn reachable(target: &mut DepthStencilTarget) {
    let Some(kind) = target.format().depth() else { return };
    for code in target.depth_mut() {
        *code = match kind {
            DepthKind::Unorm(24) if *code == 0x00ff_fffe => 0x00ff_ffff,
            DepthKind::Float32 => Llvmpipe::default().depth_code(kind, f32::from_bits(*code), [0.0, 1.0]),
            DepthKind::Unorm(_) => *code,
        };
    }
}

/// The first difference, in words; any NaN equals any NaN.
fn difference(model: &Framebuffer, device: &Framebuffer) -> Option<String> {
    let extent = model.extent;
    for (location, (a, b)) in model.colors.iter().zip(&device.colors).enumerate() {
        let (Some(a), Some(b)) = (a, b) else { continue };
        for (x, y) in (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| (x, y))) {
            let (expected, got) = (a.codes(x, y, 0), b.codes(x, y, 0));
            if !same_codes(a.format(), expected, got) {
                let name = a.format().name();
                return Some(format!(
                    "target {location} ({name}), texel ({x}, {y}): model {expected:x?}, device {got:x?}"
                ));
            }
        }
    }
    let (Some(a), Some(b)) = (&model.depth_stencil, &device.depth_stencil) else { return None };
    let depth = a.depth().iter().zip(b.depth()).position(|(a, b)| a != b);
    let stencil = a.stencil().iter().zip(b.stencil()).position(|(a, b)| a != b);
    depth
        .map(|i| format!("depth of texel {i}: model {:#x}, device {:#x}", a.depth()[i], b.depth()[i]))
        .or(stencil.map(|i| format!("stencil of texel {i}: model {}, device {}", a.stencil()[i], b.stencil()[i])))
}

fn same_bytes(replay: &RefCell<Replay<'_>>, model: &dyn NumericModel, case: &Layers) -> Result<(), TestCaseError> {
    let mut case = case.clone();
    if let Some(target) = &mut case.before.depth_stencil {
        reachable(target);
    }
    let mut predicted = case.run(model).map_err(|error| TestCaseError::reject(error.to_string()))?;
    if let Some(target) = &mut predicted.depth_stencil {
        reachable(target);
    }
    let layers = case.draws.iter().map(|draw| Layer::new(draw.state.clone(), draw.fragments.clone())).collect();
    let drawn = replay.borrow_mut().run(&Batch { initial: case.before, layers });
    let drawn = drawn.map_err(|error| TestCaseError::fail(error.to_string()))?;
    difference(&predicted, &drawn).map_or(Ok(()), |difference| Err(TestCaseError::fail(difference)))
}

fn config(cases: u32) -> Config {
    let asked = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok());
    // Pipelines are built for every state tried, so shrinking is bounded as well.
    Config { cases: asked.unwrap_or(cases), max_shrink_iters: 600, failure_persistence: None, ..Config::default() }
}

/// A case that fails, with the difference, shrunk.
type Failed = Box<(String, Layers)>;

fn run(
    device: &Device,
    model: &dyn NumericModel,
    mut runner: TestRunner,
    strategy: &impl Strategy<Value = Layers>,
) -> Result<(), Failed> {
    let replay = RefCell::new(Replay::new(device));
    match runner.run(strategy, |case| same_bytes(&replay, model, &case)) {
        Ok(()) => Ok(()),
        Err(TestError::Abort(reason)) => panic!("gave up: {reason}"),
        Err(TestError::Fail(_, mut case)) => {
            // Draws that do not matter go first; proptest shrinks within draws before it tries to leave any out.
            for i in (0..case.draws.len()).rev() {
                let mut fewer = case.clone();
                fewer.draws.remove(i);
                if same_bytes(&replay, model, &fewer).is_err() {
                    case = fewer;
                }
            }
            let reason = same_bytes(&replay, model, &case).expect_err("it failed before");
            Err(Box::new((reason.to_string(), case)))
        }
    }
}

/// Runs this many random cases; a failure tells the states and every fragment that is not plain.
fn holds(device: &Device, cases: u32, strategy: &impl Strategy<Value = Layers>) {
    let Err(failed) = run(device, &model(device), TestRunner::new(config(cases)), strategy) else { return };
    let (reason, case) = *failed;
    let mut text = format!("{reason}\n");
    for (location, color) in case.before.colors.iter().enumerate() {
        text += &format!("target {location} before: {:02x?}\n", color.as_ref().map(ColorTarget::bytes));
    }
    if let Some(target) = &case.before.depth_stencil {
        text += &format!("depth before {:x?}, stencil before {:02x?}\n", target.depth(), target.stencil());
    }
    for (i, draw) in case.draws.iter().enumerate() {
        text += &format!("draw {i}: {:?}\n", draw.state);
        for (texel, fragment) in draw.fragments.iter().enumerate().filter(|(_, f)| **f != Fragment::default()) {
            text += &format!("  fragment {texel}: {fragment:?}\n");
        }
    }
    panic!("{text}");
}

/// One target that blends, many texels: the arithmetic.
fn blended(device: &'static Device) -> impl Strategy<Value = Layers> {
    let states = blending_state().prop_filter("formats the device renders", |state| drawable(device, state));
    layers(states, Extent::new(16, 16).expect("legal"), 0..=1, |state| fit(device, state))
}

#[test]
fn random_equations_on_many_texels_give_the_models_bytes() {
    let Some(device) = fresh() else { return };
    holds(device, 160, &blended(device));
}

/// Any valid state: up to three targets of different formats, masks, blending on and off, depth and stencil, alpha test.
#[test]
fn random_whole_states_give_the_models_bytes() {
    let Some(device) = fresh() else { return };
    let states = valid_state().prop_filter("formats the device renders", |state| drawable(device, state));
    holds(device, 240, &layers(states, Extent::new(4, 4).expect("legal"), 0..=2, |state| fit(device, state)));
}

#[test]
fn another_model_fails_and_the_case_shrinks_to_one_draw() {
    let Some(device) = llvmpipe() else { return };
    let unorm = |state: &MergerState| {
        let format = state.targets[0].as_ref().and_then(|target| ColorFormat::new(target.format).ok());
        format.is_some_and(|format| format.class() == TargetClass::Unorm) && drawable(device, state)
    };
    let states = blending_state().prop_filter("a normalised target", unorm);
    let strategy = layers(states, Extent::new(4, 4).expect("legal"), 0..=3, |state| fit(device, state));
    let runner = TestRunner::new_with_rng(config(64), TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let (reason, case) = *run(device, &Exact::default(), runner, &strategy).expect_err("the driver is not exact");
    assert!(reason.contains("target 0"), "{reason}");
    assert_eq!(case.draws.len(), 1, "one draw is enough to tell: {reason}");
}

/// Vulkan and WebGPU look at bit 0 of the mask on single-sampled targets; the oldest llvmpipe asks only whether the mask is
/// empty.
#[test]
fn a_sample_mask_without_bit_0_draws_on_single_sampled_targets_in_the_oldest_generation_alone() {
    let Some(device) = llvmpipe() else { return };
    let ignored = model(device).generation.rules().sample_mask == SampleMask::Ignored;
    for (mask, drawn) in [(0, 0), (2, if ignored { 255 } else { 0 }), (1, 255)] {
        let mut state = single(TextureFormat::R8Unorm, None);
        state.multisample.mask = mask;
        let result = draw(device, targets(&state, 2, 2, |_| vec![0]), state, vec![Fragment::new([1.0; 4]); 4]);
        assert_eq!(bytes(&result), [drawn; 4], "mask {mask}");
    }
}

/// Whether a device flushes denormals: on r32float, max of -1 and one is 0 then.
fn flushes(replay: &mut Replay<'_>) -> bool {
    let max = BlendComponent { operation: BlendOperation::Max, ..BlendComponent::REPLACE };
    let max = BlendComponent { dst_factor: BlendFactor::One, ..max };
    let state = single(TextureFormat::R32Float, Some(BlendState { color: max, alpha: max }));
    let initial = targets(&state, 16, 16, |_| 3_u32.to_le_bytes().to_vec());
    let layers = vec![Layer::new(state, vec![Fragment::new([-1.0; 4]); 256])];
    let drawn = replay.run(&Batch { initial, layers }).expect("drawn");
    bytes(&drawn).iter().all(|byte| *byte == 0)
}

/// The oldest llvmpipe turns denormals on for half and 11/10-bit targets and off again afterwards, but not where every fragment
/// of a block fails the depth test: then the thread goes on without flushing, in later passes too, until the next such target
/// sets it right. Newer ones leave nothing behind.
#[test]
fn blocks_that_fail_the_depth_test_on_half_targets_leave_denormals_on_in_the_oldest_generation_alone() {
    let Some(device) = fresh() else { return };
    let mut replay = Replay::new(device);
    assert!(flushes(&mut replay), "a fresh device flushes");
    let rejected = |format| {
        let mut state = single(format, None);
        state.depth_stencil = Some(DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(false),
            depth_compare: Some(CompareFunction::Never),
            stencil: StencilState::default(),
            bias: DepthBiasState::default(),
        });
        let initial = targets(&state, 16, 16, |_| vec![0; 16]);
        Batch { initial, layers: vec![Layer::new(state, vec![Fragment::new([0.25; 4]); 256])] }
    };
    // Threads share the work by chance, so some of several attempts see it.
    let mut after = |format| {
        (0..20).any(|_| {
            replay.run(&rejected(format)).expect("drawn");
            !flushes(&mut replay)
        })
    };
    assert!(!after(TextureFormat::Rgba8Unorm), "8-bit targets leave nothing behind");
    let leaves = model(device).generation.rules().small_denormals == SmallDenormals::Kept;
    assert_eq!(after(TextureFormat::Rgba16Float), leaves, "half targets do in the oldest generation");
}
