//! Test vectors from a live device: what it stores for a line's inputs.

use wgpu_types::{
    BlendState, ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, StencilState, TextureFormat,
};

use super::{Batch, Device, Layer, Replay, ReplayError};
use crate::format::ColorFormat;
use crate::format::depth::DepthKind;
use crate::fragment::Fragment;
use crate::merger::depth_stencil::DepthStencil;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};
use crate::vectors::{ColorDraw, DepthLine, Line};

/// Texels side by side; the last row is filled up with the first texel's inputs.
const WIDTH: u32 = 256;

/// Why a device cannot answer a line; `None` if it can.
#[must_use]
pub fn refusal(device: &Device, line: &Line) -> Option<&'static str> {
    let blends = |format: ColorFormat, blend: Option<&BlendState>, has_src1: bool| {
        if !device.renders(format.texture_format()) {
            Some("the adapter does not render this format")
        } else if blend.is_some() && !device.blends(format) {
            Some("the adapter does not blend this format")
        } else if has_src1 && !device.has_second_source() {
            Some("the adapter has no second source")
        } else {
            None
        }
    };
    match line {
        Line::Color(line) => blends(line.format, line.blend.as_ref(), line.src1.is_some()),
        Line::Layers(line) => {
            line.layers.iter().find_map(|layer| blends(line.format, layer.blend.as_ref(), layer.src1.is_some()))
        }
        Line::Depth(line) => (!device.renders(line.format.texture_format()) || !device.renders(TextureFormat::R8Unorm))
            .then_some("the adapter does not render this format"),
    }
}

/// Fills in the line's results with what the device stores after it has drawn the line's fragments over its destinations.
///
/// # Errors
/// [`ReplayError`]; ask [`refusal`] first whether the adapter has what the line needs.
///
/// # Panics
/// On lines of 2^32 texels and more.
pub fn record(device: &Device, line: &mut Line) -> Result<(), ReplayError> {
    match line {
        Line::Color(line) => line.out = Some(draw(device, line.format, &[line.draw()], &line.dst)?),
        Line::Layers(line) => line.out = Some(draw(device, line.format, &line.layers, &line.dst)?),
        Line::Depth(line) => {
            let (out, passed) = test(device, line)?;
            (line.out, line.passed) = (Some(out), Some(passed));
        }
    }
    Ok(())
}

/// Room for this many texels.
fn extent(texels: usize) -> Result<Extent, ReplayError> {
    let texels = u32::try_from(texels).expect("a line has fewer than 2^32 texels");
    let width = texels.min(WIDTH);
    Ok(Extent::new(width, texels.div_ceil(width))?)
}

/// The texels after all draws, in one pass.
fn draw(device: &Device, format: ColorFormat, draws: &[ColorDraw], dst: &[u8]) -> Result<Vec<u8>, ReplayError> {
    let texels = dst.len() / format.bytes_per_texel();
    if texels == 0 {
        return Ok(Vec::new());
    }
    let extent = extent(texels)?;
    let layer = |draw: &ColorDraw| {
        let target = ColorTargetState { format: format.texture_format(), blend: draw.blend, write_mask: draw.mask };
        let mut state = MergerState::single(target);
        state.dynamic.blend_constant = draw.constant;
        let fragment = |i: usize| {
            let i = if i < texels { i } else { 0 };
            let fragment = Fragment::new(draw.src[i]);
            draw.src1.as_ref().map_or(fragment, |src1| fragment.with_src1(src1[i]))
        };
        Layer::new(state, (0..extent.sample_total()).map(fragment).collect())
    };
    let layers: Vec<Layer> = draws.iter().map(layer).collect();
    let state = layers.first().map(|layer| layer.state.clone()).unwrap_or_default();
    let mut initial = Framebuffer::for_state(extent, &state)?;
    if let Some(Some(target)) = initial.colors.first_mut() {
        target.bytes_mut()[..dst.len()].copy_from_slice(dst);
    }
    let result = Replay::new(device).run(&Batch { initial, layers })?;
    let bytes = result.colors.first().and_then(Option::as_ref).map_or(&[][..], |target| target.bytes());
    Ok(bytes[..dst.len()].to_vec())
}

/// What is stored after the tests, and which fragments passed: those that turned a black texel white.
fn test(device: &Device, line: &DepthLine) -> Result<(Vec<DepthStencil>, Vec<bool>), ReplayError> {
    if line.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let extent = extent(line.len())?;
    let target = ColorTargetState { format: TextureFormat::R8Unorm, blend: None, write_mask: ColorWrites::ALL };
    let mut state = MergerState { depth_stencil: Some(line.state.clone()), ..MergerState::single(target) };
    state.dynamic.stencil_reference = u32::from(line.reference);
    state.dynamic.depth_range = line.range;
    let mut initial = Framebuffer::for_state(extent, &state)?;
    if let Some(target) = &mut initial.depth_stencil {
        for (stored, texel) in target.depth_mut().iter_mut().zip(&line.dst) {
            *stored = texel.depth;
        }
        for (stored, texel) in target.stencil_mut().iter_mut().zip(&line.dst) {
            *stored = texel.stencil;
        }
    }
    let fragment = |i: usize| {
        let i = if i < line.len() { i } else { 0 };
        Fragment { front_facing: line.front(i), ..Fragment::new([1.0; 4]).at_depth(line.z[i]) }
    };
    let layer = Layer::new(state, (0..extent.sample_total()).map(fragment).collect());
    let mut replay = Replay::new(device);
    let result = replay.run(&Batch { initial: initial.clone(), layers: vec![layer.clone()] })?;
    let passed = white(&result, line.len());
    let mut out = vec![DepthStencil::default(); line.len()];
    if let Some(target) = &result.depth_stencil {
        for (texel, depth) in out.iter_mut().zip(target.depth()) {
            texel.depth = *depth;
        }
        for (texel, stencil) in out.iter_mut().zip(target.stencil()) {
            texel.stencil = *stencil;
        }
    }
    if line.format.depth() == Some(DepthKind::Unorm(24)) && out.iter().any(|texel| texel.depth == LAST_CODE) {
        let below = below_one(&mut replay, initial, layer)?;
        for (texel, _) in out.iter_mut().zip(below).filter(|(texel, below)| texel.depth == LAST_CODE && *below) {
            texel.depth = LAST_CODE - 1;
        }
    }
    Ok((out, passed))
}

/// The largest 24-bit code, which reads back like the one before it on some drivers.
const LAST_CODE: u32 = 0x00ff_ffff;

/// Where depth 1 is greater than what the layer leaves: the depth test tells the last two codes apart.
fn below_one(replay: &mut Replay<'_>, initial: Framebuffer, mut layer: Layer) -> Result<Vec<bool>, ReplayError> {
    for target in layer.state.targets.iter_mut().flatten() {
        target.write_mask = ColorWrites::empty();
    }
    let mut probe = Layer::new(layer.state.clone(), vec![Fragment::new([1.0; 4]).at_depth(1.0); layer.fragments.len()]);
    probe.state.dynamic.depth_range = [0.0, 1.0];
    probe.state.targets.iter_mut().flatten().for_each(|target| target.write_mask = ColorWrites::ALL);
    probe.state.depth_stencil = layer.state.depth_stencil.clone().map(|state| DepthStencilState {
        depth_compare: Some(CompareFunction::Greater),
        depth_write_enabled: Some(false),
        stencil: StencilState::default(),
        ..state
    });
    let texels = layer.fragments.len();
    Ok(white(&replay.run(&Batch { initial, layers: vec![layer, probe] })?, texels))
}

/// Which of the first texels of color target 0 are not black.
fn white(framebuffer: &Framebuffer, texels: usize) -> Vec<bool> {
    let bytes = framebuffer.colors.first().and_then(Option::as_ref).map_or(&[][..], |target| target.bytes());
    bytes.iter().take(texels).map(|byte| *byte > 0).collect()
}
