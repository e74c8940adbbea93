//! Random states, fragments and targets through the device and the model of its driver: every byte agrees.
//!
//! A failure is shrunk to the fewest draws and the plainest numbers. The number of cases keeps the file under a minute;
//! `PROPTEST_CASES` asks for more.

use std::cell::RefCell;

use outmerge::crosscheck::batch::state_reads_second_source;
use outmerge::crosscheck::{Batch, Device, Layer, Replay};
use outmerge::format::depth::DepthKind;
use outmerge::format::{ColorFormat, TargetClass};
use outmerge::model::NumericModel;
use outmerge::model::exact::Exact;
use outmerge::model::llvmpipe::Llvmpipe;
use outmerge::proptest::layers::{Layers, layers};
use outmerge::proptest::state::{blending_state, valid_state};
use outmerge::target::DepthStencilTarget;
use outmerge::vectors::same_codes;
use outmerge::{Extent, Framebuffer, MergerState};
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, TestCaseError, TestError, TestRunner};

use crate::harness::llvmpipe;

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
    // A second source works with one target at location 0 only.
    if state_reads_second_source(&state) && (state.targets.len() != 1 || !device.has_second_source()) {
        state.targets.iter_mut().flatten().for_each(|target| target.blend = None);
    }
    state
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
    Config { cases: asked.unwrap_or(cases), max_shrink_iters: 2000, failure_persistence: None, ..Config::default() }
}

fn run(
    device: &Device,
    model: &dyn NumericModel,
    cases: u32,
    strategy: &impl Strategy<Value = Layers>,
) -> Result<(), TestError<Layers>> {
    let replay = RefCell::new(Replay::new(device));
    TestRunner::new(config(cases)).run(strategy, |case| same_bytes(&replay, model, &case))
}

/// Whole states: several targets, depth, stencil, alpha test, discard, scissor, masks, one to four draws.
fn whole_states(device: &'static Device) -> impl Strategy<Value = Layers> {
    let states = valid_state().prop_filter("formats the device renders", |state| drawable(device, state));
    layers(states, Extent::new(4, 4).expect("legal"), 0..=3, |state| fit(device, state))
}

/// One target that blends, many texels: the arithmetic.
fn blended(device: &'static Device) -> impl Strategy<Value = Layers> {
    let states = blending_state().prop_filter("formats the device renders", |state| drawable(device, state));
    layers(states, Extent::new(16, 16).expect("legal"), 0..=1, |state| fit(device, state))
}

#[test]
fn random_states_over_random_targets_give_the_models_bytes() {
    let Some(device) = llvmpipe() else { return };
    if let Err(error) = run(device, &Llvmpipe::default(), 160, &whole_states(device)) {
        panic!("{error}");
    }
}

#[test]
fn random_equations_on_many_texels_give_the_models_bytes() {
    let Some(device) = llvmpipe() else { return };
    if let Err(error) = run(device, &Llvmpipe::default(), 160, &blended(device)) {
        panic!("{error}");
    }
}

#[test]
fn another_model_fails_and_shrinks_to_few_draws() {
    let Some(device) = llvmpipe() else { return };
    let unorm = |state: &MergerState| {
        let format = state.targets[0].as_ref().and_then(|target| ColorFormat::new(target.format).ok());
        format.is_some_and(|format| format.class() == TargetClass::Unorm) && drawable(device, state)
    };
    let states = blending_state().prop_filter("a normalised target", unorm);
    let strategy = layers(states, Extent::new(4, 4).expect("legal"), 0..=3, |state| fit(device, state));
    let failed = run(device, &Exact::default(), 64, &strategy).expect_err("the driver is not exact");
    let TestError::Fail(_, case) = failed else { panic!("not a failure: {failed}") };
    assert_eq!(case.draws.len(), 1, "one draw is enough to tell: {case:?}");
}
