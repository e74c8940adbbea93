//! A renderer's own wgpu test, checked without a reference image: a layered draw through a real Vulkan driver, its target
//! read back, and `assert_conforms!` against the model's prediction of the same fragments.
//!
//!     cargo run --features gpu,testkit --example wgpu_check

use outmerge::assert_conforms;
use outmerge::crosscheck::{Batch, Device, Layer, OpenError, OpenOptions, Replay};
use outmerge::model::registry;
use outmerge::state::preset;
use outmerge::testkit::{Actual, Draw, Prediction};
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{ColorTargetState, TextureFormat};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = OpenOptions { adapter: std::env::var("OUTMERGE_REQUIRE_ADAPTER").ok(), ..OpenOptions::default() };
    let device = match Device::open(&options) {
        Ok(device) => device,
        Err(error @ OpenError::NoAdapter { .. }) if options.adapter.is_none() => {
            println!("not run: {error}");
            return Ok(());
        }
        Err(error) => return Err(error.into()),
    };
    let blend = preset::by_name("transparent").ok_or("a preset")?.blend;
    let state = MergerState::single(ColorTargetState { blend, ..TextureFormat::Rgba8Unorm.into() });
    let initial = Framebuffer::for_state(Extent::new(16, 16)?, &state)?;
    let colors = [[0.25, 0.125, 0.0, 0.25], [0.0, 0.3, 0.1, 0.4], [0.05, 0.0, 0.2, 0.6]];
    let texels = initial.extent.sample_total();

    // What the driver writes. A renderer would draw with its own pipeline here.
    let layers = colors.map(|color| Layer::new(state.clone(), vec![Fragment::new(color); texels]));
    let result = Replay::new(&device).run(&Batch { initial: initial.clone(), layers: layers.into() })?;
    let read_back = result.colors[0].as_ref().ok_or("a target")?.bytes();
    let actual = Actual::new(TextureFormat::Rgba8Unorm, 16, 16, read_back)?;

    // What it may write: the results of any named model.
    let draw = |(i, color): (usize, &[f32; 4])| {
        Draw::covering(&format!("layer {i}"), state.clone(), initial.extent, Fragment::new(*color))
    };
    let draws = colors.iter().enumerate().map(draw).collect();
    let exact = registry::by_name("exact")?;
    let expected = Prediction::of_draws(&initial, draws, exact.as_ref())?.or_any_model()?;
    assert_conforms!(actual, expected, "three_layers");
    println!("{}: the read-back image is one that a named model predicts", device.report().name);
    Ok(())
}
