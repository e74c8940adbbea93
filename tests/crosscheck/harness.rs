//! One device for all tests, and short ways to write batches.

use std::io::Write as _;
use std::sync::OnceLock;

use outmerge::crosscheck::{Batch, Device, Layer, OpenError, OpenOptions, Replay};
use outmerge::model::llvmpipe::Llvmpipe;
use outmerge::target::ColorTarget;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{BlendState, ColorTargetState, ColorWrites, TextureFormat};

/// The device under test; `None`, with a line on stderr, when there is no adapter and none is required.
pub fn device() -> Option<&'static Device> {
    static DEVICE: OnceLock<Result<Device, OpenError>> = OnceLock::new();
    match DEVICE.get_or_init(|| Device::open(&options())) {
        Ok(device) => Some(device),
        Err(OpenError::NoAdapter { .. }) if options().adapter.is_none() => {
            let test = std::thread::current().name().unwrap_or("test").to_owned();
            // Straight to stderr: the test runner would swallow a captured line of a passing test.
            let _ = writeln!(std::io::stderr(), "{test}: skipped: no Vulkan adapter");
            None
        }
        Err(error) => panic!("no device to check against: {error}"),
    }
}

/// The device, if it is llvmpipe; `None`, with a line on stderr, on any other: no model claims to be bit-exact there.
pub fn llvmpipe() -> Option<&'static Device> {
    let device = device()?;
    if device.report().name.contains("llvmpipe") {
        return Some(device);
    }
    let test = std::thread::current().name().unwrap_or("test").to_owned();
    let _ = writeln!(std::io::stderr(), "{test}: skipped: `{}` is not llvmpipe", device.report().name);
    None
}

/// The model of a llvmpipe device: of its version, vectors and processor.
pub fn model(device: &Device) -> Llvmpipe {
    device.report().drivers().llvmpipe
}

/// The options of [`device`], for tests that spoil their device.
pub fn options() -> OpenOptions {
    OpenOptions { adapter: std::env::var("OUTMERGE_REQUIRE_ADAPTER").ok(), ..OpenOptions::default() }
}

/// A state with one color target, nothing masked.
pub fn single(format: TextureFormat, blend: Option<BlendState>) -> MergerState {
    MergerState::single(ColorTargetState { format, blend, write_mask: ColorWrites::ALL })
}

/// Targets for `state`, each color target filled by `bytes(texel)`.
pub fn targets(state: &MergerState, width: u32, height: u32, bytes: impl Fn(usize) -> Vec<u8>) -> Framebuffer {
    let extent = Extent::new(width, height).expect("a legal extent");
    let mut framebuffer = Framebuffer::for_state(extent, state).expect("targets for the state");
    for color in framebuffer.colors.iter_mut().flatten() {
        fill(color, &bytes);
    }
    framebuffer
}

/// Fills a target texel by texel.
pub fn fill(color: &mut ColorTarget, bytes: impl Fn(usize) -> Vec<u8>) {
    let each = color.format().bytes_per_texel();
    for (texel, memory) in color.bytes_mut().chunks_exact_mut(each).enumerate() {
        memory.copy_from_slice(&bytes(texel)[..each]);
    }
}

/// One layer over `initial`, or the failure's message as a panic.
pub fn draw(device: &Device, initial: Framebuffer, state: MergerState, fragments: Vec<Fragment>) -> Framebuffer {
    run(device, Batch { initial, layers: vec![Layer::new(state, fragments)] })
}

/// A whole batch.
pub fn run(device: &Device, batch: Batch) -> Framebuffer {
    Replay::new(device).run(&batch).unwrap_or_else(|error| panic!("replay failed: {error}"))
}

/// The bytes of color target 0.
pub fn bytes(framebuffer: &Framebuffer) -> &[u8] {
    framebuffer.colors[0].as_ref().expect("target 0").bytes()
}
