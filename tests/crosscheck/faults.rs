//! Faults of a device: what was measured stays, the rest says why it was not run, and nothing panics or waits for ever.

use std::ops::ControlFlow;
use std::time::Duration;

use outmerge::conform::result::UnitOutcome;
use outmerge::conform::run::Subject;
use outmerge::conform::{Level, Panel, Unit, level, run};
use outmerge::crosscheck::raster::rasterise;
use outmerge::crosscheck::{Batch, Device, DeviceError, Layer, OpenError, OpenOptions, Replay, ReplayError};
use outmerge::scene::draw::{SceneVertex, VARYINGS};
use outmerge::scene::raster::RasterState;
use outmerge::{Extent, Fragment};
use wgpu_types::{BlendState, Features, TextureFormat};

use crate::harness::{bytes, llvmpipe, options, single, targets};

/// A device of this test's own, to be spoilt.
fn spoilt(options: OpenOptions) -> Option<Device> {
    llvmpipe()?;
    Some(Device::open(&options).expect("a second device"))
}

/// The quick level's random units of a few formats.
fn units(formats: &[&str]) -> Vec<Unit> {
    let wanted = |unit: &Unit| {
        let id = unit.id();
        id.contains("/random-") && formats.iter().any(|format| id.starts_with(&format!("blend/{format}/")))
    };
    level::units(Level::Quick).into_iter().filter(wanted).collect()
}

fn sweep(device: &Device, units: &[Unit], after_each: impl Fn()) -> Vec<UnitOutcome> {
    let panel = Panel::from(vec![Subject::new("llvmpipe", device.report().drivers()).expect("a model")]);
    let mut outcomes = Vec::new();
    run(device, &panel, units, |outcome| {
        outcomes.push(outcome);
        after_each();
        ControlFlow::Continue(())
    });
    outcomes
}

fn batch() -> Batch {
    let state = single(TextureFormat::Rgba8Unorm, None);
    let layers = vec![Layer::new(state.clone(), vec![Fragment::new([1.0; 4]); 16])];
    Batch { initial: targets(&state, 4, 4, |_| vec![0; 4]), layers }
}

/// Has the driver draw more and more until the wait for it, of no length, comes before its end.
///
/// The scheduler may hold this thread back between submission and wait until the driver is done; then the answer was in
/// time, and the driver gets twice the work. What this thread does in between stays the same, however much is drawn, so
/// that the driver is the slower one at the latest when its work takes longer than any pause of this thread.
fn first_wait_in_vain(device: &Device) -> Option<ReplayError> {
    let extent = Extent::new(1024, 1024).expect("a legal extent");
    let corner = |x, y| SceneVertex { position: [x, y, 0.5, 1.0], varyings: [1.0; VARYINGS] };
    let triangle = [corner(-1.0, -1.0), corner(3.0, -1.0), corner(-1.0, 3.0)];
    // The last takes the driver minutes.
    let mut work = (0..16).map(|doublings| vec![triangle; 1 << doublings]);
    work.find_map(|triangles| rasterise(device, &triangles, &RasterState::new(extent)).err())
}

#[test]
fn a_device_lost_in_mid_sweep_keeps_what_was_measured_and_says_what_was_not_run() {
    let Some(device) = spoilt(options()) else { return };
    let units = units(&["r8unorm", "rgba8unorm", "rgba16float"]);
    let outcomes = sweep(&device, &units, || device.lose());
    assert_eq!(outcomes.len(), units.len(), "every unit has an outcome");
    assert_eq!(outcomes[0].not_run, None, "the first was finished");
    let compared: Vec<_> = outcomes[0].models.values().collect();
    assert!(
        matches!(compared[..], [outcome] if outcome.mismatches == 0 && outcome.states > 0),
        "and holds: {compared:?}"
    );
    for outcome in &outcomes[1..] {
        let reason = outcome.not_run.as_deref().unwrap_or_default();
        assert!(reason.contains("lost"), "{}: {reason}", outcome.unit);
    }
    let error = Replay::new(&device).run(&batch()).expect_err("it stays lost");
    assert!(matches!(error, ReplayError::Device(DeviceError::Lost(_))), "{error}");
}

#[test]
fn a_driver_that_does_not_answer_in_time_ends_the_sweep() {
    let Some(device) = spoilt(OpenOptions { timeout: Duration::from_nanos(1), ..options() }) else { return };
    let hung = ReplayError::Device(DeviceError::Timeout(Duration::from_nanos(1)));
    assert_eq!(first_wait_in_vain(&device).as_ref(), Some(&hung), "the driver took longer than a nanosecond");
    let mut replay = Replay::new(&device);
    assert_eq!(replay.run(&batch()).expect_err("no answer"), hung, "a hung device is not asked again");
    let outcomes = sweep(&device, &units(&["r8unorm", "rgba8unorm"]), || ());
    for outcome in &outcomes {
        let reason = outcome.not_run.as_deref().unwrap_or_default();
        assert!(reason.contains("did not finish"), "{}: {reason}", outcome.unit);
    }
    assert_eq!(outcomes.len(), 2, "both units say so");
}

#[test]
fn what_a_poorer_device_lacks_is_left_out_by_name_and_the_rest_is_run() {
    let declined = Features::TEXTURE_FORMAT_16BIT_NORM;
    let Some(device) = spoilt(OpenOptions { declined_features: declined, ..options() }) else { return };
    let outcomes = sweep(&device, &units(&["r16unorm", "rgba8unorm"]), || ());
    let reason = |format: &str| {
        let outcome = outcomes.iter().find(|outcome| outcome.format == format).expect("every unit has an outcome");
        outcome.not_run.clone()
    };
    assert_eq!(reason("r16unorm").as_deref(), Some("the adapter does not render to r16unorm"), "no such feature");
    assert_eq!(reason("rgba8unorm"), None, "the rest is run");
    let required = OpenOptions { required_features: Features::all_webgpu_mask(), ..options() };
    match Device::open(&required) {
        Ok(_) => {}
        Err(OpenError::MissingFeatures { features, .. }) => assert!(!features.is_empty(), "they are named"),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn a_refused_pipeline_spoils_its_own_batch_alone() {
    let Some(device) = spoilt(options()) else { return };
    let mut replay = Replay::new(&device);
    let mut bad = batch();
    let target = bad.layers[0].state.targets[0].as_mut().expect("a target");
    let min = wgpu_types::BlendComponent {
        src_factor: wgpu_types::BlendFactor::Zero,
        dst_factor: wgpu_types::BlendFactor::One,
        operation: wgpu_types::BlendOperation::Min,
    };
    target.blend = Some(BlendState { color: min, alpha: min });
    for attempt in 0..2 {
        let error = replay.run(&bad).expect_err("WebGPU wants factors one with min");
        let ReplayError::Device(DeviceError::Validation(text)) = &error else { panic!("{error}") };
        assert!(text.contains("create_render_pipeline"), "attempt {attempt} names the cause: {text}");
    }
    assert_eq!(bytes(&replay.run(&batch()).expect("the next batch"))[0], 255, "drawn");
}
