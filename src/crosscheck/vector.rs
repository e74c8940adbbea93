//! Test vectors from a live device: the bytes it writes for a line's inputs.

use wgpu_types::ColorTargetState;

use super::{Batch, Device, Layer, Replay, ReplayError};
use crate::fragment::Fragment;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};
use crate::vectors::VectorLine;

/// Texels side by side; the last row is filled up with the first texel's inputs.
const WIDTH: u32 = 256;

/// Why a device cannot answer a line; `None` if it can.
#[must_use]
pub fn refusal(device: &Device, line: &VectorLine) -> Option<&'static str> {
    if !device.renders(line.format.texture_format()) {
        Some("the adapter does not render this format")
    } else if line.blend.is_some() && !device.blends(line.format) {
        Some("the adapter does not blend this format")
    } else if line.src1.is_some() && !device.has_second_source() {
        Some("the adapter has no second source")
    } else {
        None
    }
}

/// The texels after the device has drawn the line's fragments over its destinations, as in the line's `out`.
///
/// # Errors
/// [`ReplayError`]; ask [`refusal`] first whether the adapter has what the line needs.
///
/// # Panics
/// On lines of 2^32 texels and more.
pub fn record(device: &Device, line: &VectorLine) -> Result<Vec<u8>, ReplayError> {
    if line.is_empty() {
        return Ok(Vec::new());
    }
    let texels = u32::try_from(line.len()).expect("a line has fewer than 2^32 texels");
    let width = texels.min(WIDTH);
    let extent = Extent::new(width, texels.div_ceil(width))?;
    let mut state = MergerState::single(ColorTargetState {
        format: line.format.texture_format(),
        blend: line.blend,
        write_mask: line.mask,
    });
    state.dynamic.blend_constant = line.constant;
    let mut initial = Framebuffer::for_state(extent, &state)?;
    if let Some(Some(target)) = initial.colors.first_mut() {
        target.bytes_mut()[..line.dst.len()].copy_from_slice(&line.dst);
    }
    let fragment = |i: usize| {
        let inputs = line.inputs(if i < line.len() { i } else { 0 });
        Fragment { src1: inputs.src1, ..Fragment::new(inputs.src) }
    };
    let fragments = (0..extent.sample_total()).map(fragment).collect();
    let result = Replay::new(device).run(&Batch { initial, layers: vec![Layer::new(state, fragments)] })?;
    let bytes = result.colors.first().and_then(Option::as_ref).map_or(&[][..], |target| target.bytes());
    Ok(bytes[..line.dst.len()].to_vec())
}
