//! What a device's rasteriser makes of triangles: coverage, depth and varyings, for comparison with
//! [`crate::scene::raster`] (feature `scene`).
//!
//! Measured on llvmpipe (Mesa 22.3.6) by `cargo test --all-features --test crosscheck raster -- --nocapture`, all
//! bundled and example scenes and random triangles, cut ones among them: [`Rasteriser::Llvmpipe`] has the bits of every
//! count, facing, depth and varying, and with its driver's model those of biased and stored depth codes.
//!
//! The reference rasteriser covers every texel of the scenes equally often and faces alike. Of its depths 77 % have the
//! same bits, the mean difference is 4e-8, the largest 3.3e-5; of its varyings (between -11 and 8) 44 %, 6e-6 and 6e-3. The
//! large differences lie on steep slivers: llvmpipe interpolates from vertices as they are, the reference from vertices
//! snapped to the grid, as D3D11.3 3.4.1 has it. Evaluated at most one sub-pixel (1/256 of a pixel) away, the depths agree
//! to the last bit of the difference and the varyings to 1.1e-6 of their size (or of 1). Triangles that leave the target
//! are cut by llvmpipe at its edges and snapped again; up to 6 in 10000 of their texels are covered differently.

use wgpu::{BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, TextureFormat};
use wgpu::{BufferUsages, DepthStencilState, VertexFormat};

use super::batch::ReplayError;
use super::device::Device;
use super::painter::begin;
use super::readback::Readback;
use super::upload::Attachments;
use crate::model::llvmpipe::Generation;
use crate::scene::draw::{SceneVertex, VARYINGS};
use crate::scene::number::u32_to_f32;
use crate::scene::raster::{RasterState, Rasteriser};
use crate::state::MergerState;
use crate::target::{ColorTarget, Framebuffer};

/// The rasteriser of an llvmpipe on this machine: with fused multiply-add instructions where the processor has them, unless
/// Mesa is told by `GALLIUM_OVERRIDE_CPU_CAPS` to do without.
#[must_use]
pub fn of_llvmpipe_here(generation: Generation) -> Rasteriser {
    #[cfg(target_arch = "x86_64")]
    let fused = std::arch::is_x86_feature_detected!("fma");
    // AArch64 and others have them always.
    #[cfg(not(target_arch = "x86_64"))]
    let fused = true;
    if fused && std::env::var_os("GALLIUM_OVERRIDE_CPU_CAPS").is_none() {
        Rasteriser::Llvmpipe(generation)
    } else {
        Rasteriser::LlvmpipeUnfused(generation)
    }
}

/// What is known of one texel after all triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Covered {
    /// How many triangles cover it.
    pub count: u32,
    /// Window depth of the last of them.
    pub depth: f32,
    /// Whether the last of them faces the viewer.
    pub front_facing: bool,
    /// Varyings of the last of them.
    pub varyings: [f32; VARYINGS],
}

/// Position and two vectors of varyings.
type DeviceVertex = [[f32; 4]; 3];

const SHADER: &str = "
struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) a: vec4<f32>,
    @location(1) b: vec4<f32>,
}

@vertex
fn corner(@location(0) position: vec4<f32>, @location(1) a: vec4<f32>, @location(2) b: vec4<f32>) -> Corner {
    return Corner(position, a, b);
}

struct Record {
    @location(0) place: vec4<f32>,
    @location(1) a: vec4<f32>,
    @location(2) b: vec4<f32>,
    @location(3) count: f32,
}

@fragment
fn paint(corner: Corner) -> @location(0) vec4<f32> {
    return corner.a;
}

@fragment
fn record(corner: Corner, @builtin(front_facing) front: bool) -> Record {
    return Record(vec4(corner.position.z, select(0.0, 1.0, front), 0.0, 0.0), corner.a, corner.b, 1.0);
}
";

/// Draws the triangles in order and reads back what covered each texel, rows from the top. Depth is not tested, and the
/// depth bias not applied.
///
/// # Errors
/// [`ReplayError`].
pub fn rasterise(
    device: &Device,
    triangles: &[[SceneVertex; 3]],
    state: &RasterState,
) -> Result<Vec<Covered>, ReplayError> {
    let wide = TextureFormat::Rgba32Float;
    let target = |format, blend| Some(ColorTargetState { format, blend, write_mask: ColorWrites::ALL });
    let one =
        BlendComponent { src_factor: BlendFactor::One, dst_factor: BlendFactor::One, operation: BlendOperation::Add };
    let sum = BlendState { color: one, alpha: one };
    let targets =
        [target(wide, None), target(wide, None), target(wide, None), target(TextureFormat::R32Float, Some(sum))];
    let color = MergerState { targets: targets.to_vec(), ..MergerState::default() };
    Ok(decode(&draw(device, triangles, state, &color, Some("record"))?))
}

/// Draws the triangles in order into one color target, the first four varyings as color, not blended.
///
/// # Errors
/// [`ReplayError`].
pub fn rasterise_color(
    device: &Device,
    triangles: &[[SceneVertex; 3]],
    state: &RasterState,
    format: TextureFormat,
) -> Result<Framebuffer, ReplayError> {
    let target = ColorTargetState { format, blend: None, write_mask: ColorWrites::ALL };
    let color = MergerState { targets: vec![Some(target)], ..MergerState::default() };
    draw(device, triangles, state, &color, Some("paint"))
}

/// Draws the triangles in order into a depth target by `depth_stencil`, depth bias included, and gives the target.
///
/// # Errors
/// [`ReplayError`].
pub fn rasterise_depth(
    device: &Device,
    triangles: &[[SceneVertex; 3]],
    state: &RasterState,
    depth_stencil: DepthStencilState,
) -> Result<Framebuffer, ReplayError> {
    let depth = MergerState { depth_stencil: Some(depth_stencil), ..MergerState::default() };
    draw(device, triangles, state, &depth, None)
}

/// Draws with the fragment shader of this name, if any.
fn draw(
    device: &Device,
    triangles: &[[SceneVertex; 3]],
    state: &RasterState,
    merger: &MergerState,
    shader: Option<&str>,
) -> Result<Framebuffer, ReplayError> {
    let initial = Framebuffer::for_state(state.extent, merger)?;
    let gpu = &device.device;
    let attachments = Attachments::new(gpu, &initial);
    attachments.upload(&device.queue, &initial);
    let readback = Readback::new(gpu, &initial, &attachments);
    let mut encoder = gpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    if !triangles.is_empty() {
        let vertices = vertex_buffer(device, triangles);
        let mut pass = begin(&mut encoder, &attachments);
        let [near, far] = state.depth_range;
        let [width, height] = [state.extent.width, state.extent.height].map(u32_to_f32);
        pass.set_viewport(0.0, 0.0, width, height, near, far);
        pass.set_pipeline(&pipeline(gpu, state, merger, shader));
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.draw(0..u32::try_from(3 * triangles.len()).unwrap_or(u32::MAX), 0..1);
    }
    readback.record(&mut encoder, &attachments);
    let submission = device.queue.submit([encoder.finish()]);
    let mut result = initial;
    readback.fetch(device, submission, |bytes| readback.store(bytes, &mut result))?;
    Ok(result)
}

fn vertex_buffer(device: &Device, triangles: &[[SceneVertex; 3]]) -> wgpu::Buffer {
    let vertex = |vertex: &SceneVertex| -> DeviceVertex {
        let [a, b] = [0, 4].map(|start| std::array::from_fn(|i| vertex.varyings[start + i]));
        [vertex.position, a, b]
    };
    let vertices: Vec<DeviceVertex> = triangles.iter().flatten().map(vertex).collect();
    let bytes: &[u8] = bytemuck::cast_slice(&vertices);
    let buffer = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("triangles"),
        size: bytes.len() as u64,
        usage: BufferUsages::VERTEX | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    device.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

fn pipeline(
    gpu: &wgpu::Device,
    state: &RasterState,
    merger: &MergerState,
    shader: Option<&str>,
) -> wgpu::RenderPipeline {
    let module = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("rasteriser probe"),
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let attributes = [0, 1, 2].map(|location: u32| wgpu::VertexAttribute {
        format: VertexFormat::Float32x4,
        offset: u64::from(16 * location),
        shader_location: location,
    });
    gpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("rasteriser probe"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<DeviceVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
        },
        primitive: state.primitive,
        depth_stencil: merger.depth_stencil.clone(),
        multisample: wgpu::MultisampleState::default(),
        fragment: shader.map(|entry_point| wgpu::FragmentState {
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &merger.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn decode(framebuffer: &Framebuffer) -> Vec<Covered> {
    let floats = |target: &Option<ColorTarget>| -> Vec<f32> {
        let bytes = target.as_ref().map_or(&[][..], ColorTarget::bytes);
        bytes.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
    };
    let [place, a, b, count] = [0, 1, 2, 3].map(|i| floats(&framebuffer.colors[i]));
    let texel = |i: usize| {
        let vector = |list: &[f32], j: usize| list[4 * i + j];
        Covered {
            count: to_count(count[i]),
            depth: vector(&place, 0),
            front_facing: vector(&place, 1) > 0.5,
            varyings: std::array::from_fn(|j| if j < 4 { vector(&a, j) } else { vector(&b, j - 4) }),
        }
    };
    (0..count.len()).map(texel).collect()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of triangles")]
fn to_count(x: f32) -> u32 {
    x as u32
}
