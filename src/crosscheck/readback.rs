//! Target bytes back from the device, exactly.
//!
//! Color, stencil, 16-bit and float depth are copied bit for bit. 24-bit depth may not be copied in WebGPU: a compute
//! shader loads it as binary32, in which all 2^24 values k / (2^24 - 1) are distinct, and the host recovers k.

use std::sync::mpsc;

use wgpu::{Buffer, BufferUsages, CommandEncoder, SubmissionIndex, Texture, TextureAspect};

use super::device::{Device, DeviceError};
use super::upload::Attachments;
use crate::format::depth::DepthKind;
use crate::target::Framebuffer;

/// Row pitch of texture-to-buffer copies must be a multiple of this.
const ROW_ALIGNMENT: u64 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as u64;

/// The depth loader's workgroup is this many texels wide and high.
const GROUP: u32 = 8;

const LOAD_DEPTH: &str = "
@group(0) @binding(0) var depth: texture_depth_2d;
@group(0) @binding(1) var<storage, read_write> bits: array<u32>;
@compute @workgroup_size(8, 8) fn load_depth(@builtin(global_invocation_id) at: vec3<u32>) {
    let size = textureDimensions(depth);
    if at.x < size.x && at.y < size.y {
        bits[at.y * size.x + at.x] = bitcast<u32>(textureLoad(depth, at.xy, 0));
    }
}
";

/// One aspect of one attachment inside the read-back buffer.
#[derive(Clone, Copy, Debug)]
struct Segment {
    offset: u64,
    row_bytes: u64,
    pitch: u64,
    rows: u64,
}

impl Segment {
    /// The rows without padding.
    fn strip(self, bytes: &[u8]) -> Vec<u8> {
        let row = to_usize(self.row_bytes);
        let mut stripped = Vec::with_capacity(row * to_usize(self.rows));
        for padded in self.slice(bytes).chunks_exact(to_usize(self.pitch)) {
            stripped.extend_from_slice(&padded[..row]);
        }
        stripped
    }

    /// The rows with their padding.
    fn slice(self, bytes: &[u8]) -> &[u8] {
        let start = to_usize(self.offset);
        &bytes[start..start + to_usize(self.pitch * self.rows)]
    }
}

/// Copies all attachments into one buffer and from there into a [`Framebuffer`].
#[derive(Debug)]
pub struct Readback {
    colors: Vec<Option<Segment>>,
    depth: Option<Segment>,
    stencil: Option<Segment>,
    bytes: u64,
    buffer: Buffer,
    loader: Option<DepthLoader>,
    depth24: Depth24Load,
}

impl Readback {
    /// Room for every attachment of `framebuffer`, whose textures are `attachments`.
    #[must_use]
    pub fn new(device: &wgpu::Device, framebuffer: &Framebuffer, attachments: &Attachments) -> Self {
        let (width, rows) = (u64::from(framebuffer.extent.width), u64::from(framebuffer.extent.height));
        let mut bytes = 0;
        let mut place = |each: usize, padded: bool| {
            let row_bytes = width * each as u64;
            let pitch = if padded { row_bytes.next_multiple_of(ROW_ALIGNMENT) } else { row_bytes };
            let segment = Segment { offset: bytes, row_bytes, pitch, rows };
            bytes += (pitch * rows).next_multiple_of(ROW_ALIGNMENT);
            segment
        };
        let colors = framebuffer.colors.iter();
        let colors = colors.map(|c| c.as_ref().map(|c| place(c.format().bytes_per_texel(), true))).collect();
        let format = framebuffer.depth_stencil.as_ref().map(|target| target.format());
        let kind = format.and_then(|format| format.depth());
        let depth = kind.map(|kind| match kind {
            DepthKind::Unorm(16) => place(2, true),
            DepthKind::Unorm(_) => place(4, false),
            DepthKind::Float32 => place(4, true),
        });
        let stencil = format.filter(|format| format.has_stencil()).map(|_| place(1, true));
        let loader = match (kind, &attachments.depth_stencil) {
            (Some(DepthKind::Unorm(24)), Some(texture)) => Some(DepthLoader::new(device, texture)),
            _ => None,
        };
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: bytes.max(ROW_ALIGNMENT),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { colors, depth, stencil, bytes, buffer, loader, depth24: Depth24Load::of(device) }
    }

    /// Bytes read back, padding included.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Records the copies of all attachments.
    pub fn record(&self, encoder: &mut CommandEncoder, attachments: &Attachments) {
        for (segment, texture) in self.colors.iter().zip(&attachments.colors) {
            if let (Some(segment), Some(texture)) = (segment, texture) {
                self.copy(encoder, texture, TextureAspect::All, *segment);
            }
        }
        let Some(texture) = &attachments.depth_stencil else { return };
        if let Some(segment) = self.stencil {
            self.copy(encoder, texture, TextureAspect::StencilOnly, segment);
        }
        self.record_depth(encoder, texture);
    }

    /// Records the copy of the depth aspect alone.
    pub fn record_depth(&self, encoder: &mut CommandEncoder, texture: &Texture) {
        match (self.depth, &self.loader) {
            (Some(segment), Some(loader)) => {
                loader.record(encoder);
                encoder.copy_buffer_to_buffer(&loader.bits, 0, &self.buffer, segment.offset, loader.bits.size());
            }
            (Some(segment), None) => self.copy(encoder, texture, TextureAspect::DepthOnly, segment),
            (None, _) => {}
        }
    }

    /// Waits for `submission` and hands the buffer's bytes to `consume`.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn fetch<T>(
        &self,
        device: &Device,
        submission: SubmissionIndex,
        consume: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, DeviceError> {
        Mapping::start(&self.buffer).finish(device, submission, consume)
    }

    /// Stores everything read back in `framebuffer`.
    pub fn store(&self, bytes: &[u8], framebuffer: &mut Framebuffer) {
        for (segment, color) in self.colors.iter().zip(&mut framebuffer.colors) {
            if let (Some(segment), Some(color)) = (segment, color) {
                color.bytes_mut().copy_from_slice(&segment.strip(bytes));
            }
        }
        let Some(target) = &mut framebuffer.depth_stencil else { return };
        if let Some(segment) = self.stencil {
            target.stencil_mut().copy_from_slice(&segment.strip(bytes));
        }
        if let Some(kind) = target.format().depth() {
            target.depth_mut().copy_from_slice(&self.depth_codes(bytes, kind));
        }
    }

    /// A color target's rows, padding included; empty where there is no such target.
    #[must_use]
    pub fn color_bytes<'b>(&self, bytes: &'b [u8], location: usize) -> &'b [u8] {
        self.colors.get(location).copied().flatten().map_or(&[], |segment| segment.slice(bytes))
    }

    /// The stencil rows, padding included; empty without a stencil aspect.
    #[must_use]
    pub fn stencil_bytes<'b>(&self, bytes: &'b [u8]) -> &'b [u8] {
        self.stencil.map_or(&[], |segment| segment.slice(bytes))
    }

    /// The depth codes read back; empty without a depth aspect.
    #[must_use]
    pub fn depth_codes(&self, bytes: &[u8], kind: DepthKind) -> Vec<u32> {
        let Some(segment) = self.depth else { return Vec::new() };
        let bytes = segment.strip(bytes);
        let words = || bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        match kind {
            DepthKind::Unorm(16) => {
                bytes.chunks_exact(2).map(|pair| u32::from(u16::from_le_bytes([pair[0], pair[1]]))).collect()
            }
            DepthKind::Unorm(_) => words().map(|bits| self.depth24.code(bits)).collect(),
            DepthKind::Float32 => words().collect(),
        }
    }

    fn copy(&self, encoder: &mut CommandEncoder, texture: &Texture, aspect: TextureAspect, segment: Segment) {
        copy_texture(encoder, texture, aspect, &self.buffer, segment.offset, segment.pitch);
    }
}

/// Records the copy of a whole texture aspect into `buffer`, rows `pitch` bytes apart.
pub fn copy_texture(
    encoder: &mut CommandEncoder,
    texture: &Texture,
    aspect: TextureAspect,
    buffer: &Buffer,
    offset: u64,
    pitch: u64,
) {
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { texture, mip_level: 0, origin: wgpu::Origin3d::ZERO, aspect },
        wgpu::TexelCopyBufferInfo {
            buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset,
                bytes_per_row: u32::try_from(pitch).ok(),
                rows_per_image: Some(texture.height()),
            },
        },
        texture.size(),
    );
}

/// A buffer on its way to the host.
#[derive(Debug)]
pub struct Mapping {
    buffer: Buffer,
    outcome: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Mapping {
    /// Asks for the whole buffer; call after the submission that fills it.
    #[must_use]
    pub fn start(buffer: &Buffer) -> Self {
        let (send, outcome) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone only when the wait has failed already.
            let _ = send.send(result);
        });
        Self { buffer: buffer.clone(), outcome }
    }

    /// Waits for `submission`, hands the bytes to `consume` and gives the buffer back to the device.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn finish<T>(
        self,
        device: &Device,
        submission: SubmissionIndex,
        consume: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, DeviceError> {
        device.finish(submission)?;
        // Another thread's poll may have taken the callback and be about to run it.
        match self.outcome.recv_timeout(device.timeout()) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(DeviceError::Internal(error.to_string())),
            Err(_) => return Err(DeviceError::Internal("a finished submission left its buffer unmapped".to_owned())),
        }
        let view = self.buffer.get_mapped_range(..).map_err(|error| DeviceError::Internal(error.to_string()))?;
        let result = consume(&view);
        drop(view);
        self.buffer.unmap();
        Ok(result)
    }
}

/// Loads a depth texture as binary32 bits into a buffer.
#[derive(Debug)]
struct DepthLoader {
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    bits: Buffer,
    groups: (u32, u32),
}

impl DepthLoader {
    fn new(device: &wgpu::Device, texture: &Texture) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("load depth"),
            source: wgpu::ShaderSource::Wgsl(LOAD_DEPTH.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("load depth"),
            layout: None,
            module: &module,
            entry_point: Some("load_depth"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let extent = texture.size();
        let bits = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("depth bits"),
            size: u64::from(extent.width) * u64::from(extent.height) * 4,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            aspect: TextureAspect::DepthOnly,
            ..wgpu::TextureViewDescriptor::default()
        });
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("load depth"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: bits.as_entire_binding() },
            ],
        });
        let groups = (extent.width.div_ceil(GROUP), extent.height.div_ceil(GROUP));
        Self { pipeline, bindings, bits, groups }
    }

    fn record(&self, encoder: &mut CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.dispatch_workgroups(self.groups.0, self.groups.1, 1);
    }
}

/// How a driver turns a 24-bit depth code c into the binary32 number a shader loads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Depth24Load {
    /// c / (2^24 - 1), rounded well enough to tell codes apart.
    Divides,
    /// c times the binary32 number next to 1 / (2^24 - 1), as llvmpipe does: up to one code too large. All codes differ
    /// but the last two, which both load as 1 (measured: Mesa 22.3.6).
    Multiplies,
}

impl Depth24Load {
    const STEPS: f32 = 16_777_215.0;

    fn of(device: &wgpu::Device) -> Self {
        if device.adapter_info().name.contains("llvmpipe") { Self::Multiplies } else { Self::Divides }
    }

    /// The code that loads as these bits; of two the larger.
    fn code(self, bits: u32) -> u32 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "in [0, 2^24), checked by the clamp"
        )]
        fn to_code(x: f64) -> u32 {
            x as u32
        }
        #[expect(clippy::cast_precision_loss, reason = "24 bits are exact in binary32")]
        fn multiplied(code: u32) -> f32 {
            code as f32 * (1.0 / Depth24Load::STEPS)
        }
        let loaded = f32::from_bits(bits);
        let nearest = to_code((f64::from(loaded) * f64::from(Self::STEPS) + 0.5).floor().clamp(0.0, 16_777_215.0));
        match self {
            Self::Divides => nearest,
            Self::Multiplies => {
                let candidates = [nearest, nearest.saturating_sub(1)];
                candidates.into_iter().find(|&code| multiplied(code).to_bits() == bits).unwrap_or(nearest)
            }
        }
    }
}

/// Buffer sizes fit the address space they are mapped into.
fn to_usize(x: u64) -> usize {
    usize::try_from(x).expect("a mapped buffer fits the address space")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_24_bit_code_survives_loading_but_the_last_two_that_load_alike() {
        for code in (0..0x00ff_ffff_u32).step_by(101).chain(0x00ff_ff00..0x0100_0000) {
            #[expect(clippy::cast_precision_loss, reason = "24 bits are exact in binary32")]
            let exact = code as f32;
            let multiplied = exact * (1.0 / Depth24Load::STEPS);
            let expected = if code == 0x00ff_fffe { 0x00ff_ffff } else { code };
            assert_eq!(Depth24Load::Multiplies.code(multiplied.to_bits()), expected, "multiplied");
            assert_eq!(Depth24Load::Divides.code((exact / Depth24Load::STEPS).to_bits()), code, "divided");
        }
    }
}
