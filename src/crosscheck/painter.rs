//! Prepared layers recorded into one render pass over loaded targets.

use wgpu::{BufferUsages, LoadOp, StoreOp};

use super::batch::Layer;
use super::device::Device;
use super::pipeline::{PipelineKey, Pipelines};
use super::record::{Prepared, Vertex};
use super::shader::Shader;
use super::upload::Attachments;
use crate::state::{DynamicState, Rect};
use crate::target::{Extent, Framebuffer};

/// A prepared layer, what draws it, and its dynamic values.
#[derive(Debug)]
pub struct Ready {
    key: PipelineKey,
    prepared: Prepared,
    dynamic: DynamicState,
}

impl Ready {
    /// Prepares a layer that passed its checks for a pass over `targets`.
    #[must_use]
    pub fn new(layer: &Layer, targets: &Framebuffer) -> Self {
        let prepared = Prepared::new(layer, targets);
        let shader = Shader::Records(prepared.shader);
        Self {
            key: PipelineKey::new(&layer.state, layer.unclipped_depth, shader, targets),
            prepared,
            dynamic: layer.state.dynamic,
        }
    }

    /// Bytes of the fragments' records.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        4 * self.prepared.words.len() as u64
    }
}

/// Paints passes, keeping pipelines and buffers between them.
#[derive(Debug)]
pub struct Painter {
    pipelines: Pipelines,
    records: Growing,
    vertices: Growing,
}

impl Painter {
    /// A painter without pipelines yet.
    #[must_use]
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            pipelines: Pipelines::new(device),
            records: Growing { usage: BufferUsages::STORAGE, buffer: None },
            vertices: Growing { usage: BufferUsages::VERTEX, buffer: None },
        }
    }

    /// Draws `layers` in one pass over what `attachments` hold, and submits it.
    pub fn paint(&mut self, device: &Device, layers: &[Ready], attachments: &Attachments, extent: Extent) {
        let alignment = u64::from(device.device.limits().min_storage_buffer_offset_alignment);
        let mut words: Vec<u32> = Vec::new();
        let mut offsets = Vec::new();
        for layer in layers {
            words.resize((4 * words.len()).next_multiple_of(to_usize(alignment)) / 4, 0);
            offsets.push(4 * words.len());
            words.extend(&layer.prepared.words);
        }
        // Every binding is as long as the longest; the last one must still end inside the buffer.
        let longest = layers.iter().map(Ready::bytes).max().unwrap_or(0);
        let end = offsets.last().map_or(0, |last| *last as u64) + longest;
        let records = self.records.fill(device, bytemuck::cast_slice(&words), end);
        let corners: Vec<Vertex> =
            layers.iter().flat_map(|layer| &layer.prepared.draws).flat_map(|draw| &draw.vertices).copied().collect();
        if corners.is_empty() {
            return;
        }
        let vertices = self.vertices.fill(device, bytemuck::cast_slice(&corners), 0);
        let bindings = self.pipelines.bind(&records, longest);

        let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = begin(&mut encoder, attachments);
            pass.set_vertex_buffer(0, vertices.slice(..));
            let mut next = 0;
            for (layer, offset) in layers.iter().zip(offsets) {
                pass.set_pipeline(self.pipelines.get(&layer.key));
                pass.set_bind_group(0, &bindings, &[to_u32(offset)]);
                set_dynamic(&mut pass, &layer.dynamic, extent);
                for draw in &layer.prepared.draws {
                    let end = next + to_u32(draw.vertices.len());
                    pass.set_stencil_reference(draw.stencil_reference & 0xff);
                    pass.draw(next..end, 0..1);
                    next = end;
                }
            }
        }
        device.queue.submit([encoder.finish()]);
    }
}

/// A pass that loads and keeps every aspect of every attachment.
pub fn begin<'e>(encoder: &'e mut wgpu::CommandEncoder, attachments: &Attachments) -> wgpu::RenderPass<'e> {
    let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let colors: Vec<_> = attachments.colors.iter().map(|texture| texture.as_ref().map(view)).collect();
    let depth_stencil = attachments.depth_stencil.as_ref().map(view);
    let color_attachments: Vec<_> = colors
        .iter()
        .map(|view| {
            view.as_ref().map(|view| wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: LoadOp::Load, store: StoreOp::Store },
            })
        })
        .collect();
    let format = attachments.depth_stencil.as_ref().map(wgpu::Texture::format);
    let has_depth = format.is_some_and(|format| format.has_depth_aspect());
    let has_stencil = format.is_some_and(|format| format.has_stencil_aspect());
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("replay"),
        color_attachments: &color_attachments,
        depth_stencil_attachment: depth_stencil.as_ref().map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: has_depth.then_some(wgpu::Operations { load: LoadOp::Load, store: StoreOp::Store }),
            stencil_ops: has_stencil.then_some(wgpu::Operations { load: LoadOp::Load, store: StoreOp::Store }),
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// Sets everything per draw except the stencil reference.
pub fn set_dynamic(pass: &mut wgpu::RenderPass<'_>, dynamic: &DynamicState, extent: Extent) {
    pass.set_blend_constant(constant(dynamic.blend_constant));
    let [near, far] = dynamic.depth_range;
    pass.set_viewport(0.0, 0.0, exact(extent.width), exact(extent.height), near, far);
    let scissor = clip(dynamic.scissor, extent);
    pass.set_scissor_rect(scissor.x, scissor.y, scissor.width, scissor.height);
}

/// The part of a scissor rectangle inside the targets; the API refuses more.
fn clip(scissor: Option<Rect>, extent: Extent) -> Rect {
    let whole = Rect { x: 0, y: 0, width: extent.width, height: extent.height };
    let Some(asked) = scissor else { return whole };
    let (x, y) = (asked.x.min(extent.width), asked.y.min(extent.height));
    Rect { x, y, width: asked.width.min(extent.width - x), height: asked.height.min(extent.height - y) }
}

/// The blend constant; widening keeps every value.
fn constant(k: [f32; 4]) -> wgpu::Color {
    let [r, g, b, a] = k.map(f64::from);
    wgpu::Color { r, g, b, a }
}

/// A buffer replaced by a larger one when it gets too small.
#[derive(Debug)]
struct Growing {
    usage: BufferUsages,
    buffer: Option<wgpu::Buffer>,
}

impl Growing {
    /// A buffer of at least `least` bytes that begins with `bytes`.
    fn fill(&mut self, device: &Device, bytes: &[u8], least: u64) -> wgpu::Buffer {
        let size = (bytes.len() as u64).max(least).max(4);
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() >= size => buffer,
            _ => device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("replay"),
                size,
                usage: self.usage | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        };
        device.queue.write_buffer(&buffer, 0, bytes);
        self.buffer.insert(buffer).clone()
    }
}

#[expect(clippy::cast_precision_loss, reason = "dimensions are at most 2^13")]
fn exact(n: u32) -> f32 {
    n as f32
}

/// Offsets and counts within one pass stay far below 2^32.
fn to_u32(n: usize) -> u32 {
    u32::try_from(n).expect("a pass holds fewer than 2^32 bytes and vertices")
}

fn to_usize(n: u64) -> usize {
    usize::try_from(n).expect("an alignment fits the address space")
}
