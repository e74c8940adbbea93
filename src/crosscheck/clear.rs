//! What `LoadOp::Clear` stores: drivers convert clear colors by other routines than shader outputs.

use wgpu::{BufferUsages, LoadOp, Operations, StoreOp, TextureFormat, TextureUsages};
use wgpu_types::{DepthBiasState, DepthStencilState, StencilState};

use super::batch::ReplayError;
use super::device::Device;
use super::readback::{Mapping, Readback};
use super::upload::Attachments;
use crate::format::{Codes, ColorFormat};
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// Distance of two results in the buffer they are copied to: a row of a copy.
const PITCH: u64 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as u64;

/// Clears recorded into one submission.
const CHUNK: usize = 2048;

/// The codes that a pass leaves which clears a target of `format` to each of these colors, and draws nothing.
///
/// # Errors
/// [`ReplayError::NotRendered`], or a fault of the device.
pub fn clear(device: &Device, format: ColorFormat, colors: &[[f64; 4]]) -> Result<Vec<Codes>, ReplayError> {
    if !device.renders(format.texture_format()) {
        let adapter = device.report().name.clone();
        return Err(ReplayError::NotRendered { adapter, format: format.texture_format() });
    }
    let texture = device.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("cleared"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: format.texture_format(),
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let mut codes = Vec::with_capacity(colors.len());
    for chunk in colors.chunks(CHUNK) {
        clear_chunk(device, format, &texture, chunk, &mut codes)?;
    }
    Ok(codes)
}

/// The depth codes that a pass leaves which clears a depth target of `format` to each of these values, 0 to 1, and draws
/// nothing.
///
/// # Errors
/// [`ReplayError`] when the format is none of depth, or the device fails.
pub fn clear_depth(device: &Device, format: TextureFormat, values: &[f32]) -> Result<Vec<u32>, ReplayError> {
    let state = MergerState {
        depth_stencil: Some(DepthStencilState {
            format,
            depth_write_enabled: None,
            depth_compare: None,
            stencil: StencilState::default(),
            bias: DepthBiasState::default(),
        }),
        ..MergerState::default()
    };
    let mut target = Framebuffer::for_state(Extent::new(1, 1)?, &state)?;
    let attachments = Attachments::new(&device.device, &target);
    let readback = Readback::new(&device.device, &target, &attachments);
    let Some(texture) = &attachments.depth_stencil else { return Ok(Vec::new()) };
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut codes = Vec::with_capacity(values.len());
    for value in values {
        let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let attachment = wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(Operations { load: LoadOp::Clear(*value), store: StoreOp::Store }),
            stencil_ops: None,
        };
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear depth"),
            depth_stencil_attachment: Some(attachment),
            ..wgpu::RenderPassDescriptor::default()
        }));
        readback.record_depth(&mut encoder, texture);
        let submission = device.queue.submit([encoder.finish()]);
        readback.fetch(device, submission, |bytes| readback.store(bytes, &mut target))?;
        codes.extend(target.depth_stencil.as_ref().and_then(|depth| depth.depth().first()));
    }
    Ok(codes)
}

fn clear_chunk(
    device: &Device,
    format: ColorFormat,
    texture: &wgpu::Texture,
    colors: &[[f64; 4]],
    codes: &mut Vec<Codes>,
) -> Result<(), ReplayError> {
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let buffer = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("cleared texels"),
        size: PITCH * colors.len() as u64,
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for (offset, [r, g, b, a]) in (0_u64..).step_by(256).zip(colors.iter().copied()) {
        let load = LoadOp::Clear(wgpu::Color { r, g, b, a });
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load, store: StoreOp::Store },
        };
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear"),
            color_attachments: &[Some(attachment)],
            ..wgpu::RenderPassDescriptor::default()
        }));
        super::readback::copy_texture(&mut encoder, texture, wgpu::TextureAspect::All, &buffer, offset, PITCH);
    }
    let submission = device.queue.submit([encoder.finish()]);
    let texel = |row: &[u8]| format.unpack(row);
    let read = |bytes: &[u8]| bytes.chunks_exact(256).map(texel).collect::<Vec<_>>();
    codes.extend(Mapping::start(&buffer).finish(device, submission, read)?);
    Ok(())
}
