//! A scene's draws in one render pass, with a log of their fragments.

use std::collections::HashMap;

use wgpu::{BufferUsages, ColorTargetState, DepthStencilState, MultisampleState, PrimitiveState, ShaderStages};
use wgpu::{TextureView, VertexFormat};

use super::log::{DrawnFragment, count, fragments, record_words};
use super::variant::{self, Constants, NAMES, UNIFORM_BYTES};
use super::{DrawError, image};
use crate::crosscheck::device::Device;
use crate::crosscheck::painter::{begin, set_dynamic};
use crate::crosscheck::readback::{Mapping, Readback};
use crate::crosscheck::replay::Replay;
use crate::crosscheck::upload::Attachments;
use crate::scene::description::Output;
use crate::scene::raster::assemble;
use crate::scene::{Draw, Scene, SceneError};
use crate::target::Framebuffer;

/// Words of a vertex: position, eight varyings, number of the triangle.
const VERTEX_WORDS: usize = 13;

/// What a device made of a scene.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The targets after the last draw.
    pub framebuffer: Framebuffer,
    /// Every fragment the shader ran for, by texel (rows from the top), draw and triangle.
    pub fragments: Vec<DrawnFragment>,
}

/// Draws scenes on one device, keeping pipelines between them.
#[derive(Debug)]
pub struct Drawer<'a> {
    device: &'a Device,
    bind_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    modules: HashMap<Vec<Output>, wgpu::ShaderModule>,
    pipelines: HashMap<Key, wgpu::RenderPipeline>,
}

/// What distinguishes two pipelines.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    targets: Vec<Option<ColorTargetState>>,
    depth_stencil: Option<DepthStencilState>,
    multisample: MultisampleState,
    primitive: PrimitiveState,
    outputs: Vec<Output>,
    constants: Constants,
}

impl<'a> Drawer<'a> {
    /// A drawer without pipelines yet.
    #[must_use]
    pub fn new(device: &'a Device) -> Self {
        let gpu = &device.device;
        let buffer =
            |ty, dynamic| wgpu::BindingType::Buffer { ty, has_dynamic_offset: dynamic, min_binding_size: None };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let kinds = [
            buffer(wgpu::BufferBindingType::Uniform, true),
            texture,
            buffer(wgpu::BufferBindingType::Storage { read_only: false }, false),
        ];
        let entry =
            |(binding, ty)| wgpu::BindGroupLayoutEntry { binding, visibility: ShaderStages::FRAGMENT, ty, count: None };
        let entries: Vec<_> = (0..).zip(kinds).map(entry).collect();
        let bind_layout =
            gpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("scene"), entries: &entries });
        let layout = gpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&bind_layout)],
            immediate_size: 0,
        });
        Self { device, bind_layout, layout, modules: HashMap::new(), pipelines: HashMap::new() }
    }

    /// Draws a scene over its cleared targets.
    ///
    /// # Errors
    /// [`DrawError`].
    pub fn draw(&mut self, scene: &Scene) -> Result<Drawn, DrawError> {
        let draws = scene.draws();
        let mut framebuffer = scene.cleared().map_err(SceneError::from)?;
        let attachments = Replay::new(self.device).put(&framebuffer)?;
        let readback = Readback::new(&self.device.device, &framebuffer, &attachments);
        let outputs: Vec<Output> = scene.target.colors.iter().map(|color| color.output).collect();
        let expected = draws.iter().map(fragment_count).sum();
        let log = self.log(expected, outputs.len())?;

        let mut encoder = self.device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.record(&mut encoder, scene, &draws, &outputs, &attachments, &log);
        let noted = self.buffer("log read back", log.size(), BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        encoder.copy_buffer_to_buffer(&log, 0, &noted, 0, log.size());
        readback.record(&mut encoder, &attachments);
        let submission = self.device.queue.submit([encoder.finish()]);
        let (made, fragments) = Mapping::start(&noted)
            .finish(self.device, submission.clone(), |bytes| (count(bytes), fragments(bytes, outputs.len())))
            .map_err(crate::crosscheck::ReplayError::from)?;
        readback
            .fetch(self.device, submission, |bytes| readback.store(bytes, &mut framebuffer))
            .map_err(crate::crosscheck::ReplayError::from)?;
        if made > fragments.len() {
            return Err(DrawError::Overflow { made, expected });
        }
        Ok(Drawn { framebuffer, fragments })
    }

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        draws: &[Draw],
        outputs: &[Output],
        attachments: &Attachments,
        log: &wgpu::Buffer,
    ) {
        if draws.iter().all(|draw| draw.triangles.is_empty()) {
            return;
        }
        let vertices =
            self.filled("vertices", BufferUsages::VERTEX, &draws.iter().flat_map(vertex_words).collect::<Vec<_>>());
        let stride =
            UNIFORM_BYTES.next_multiple_of(self.device.device.limits().min_uniform_buffer_offset_alignment.into());
        let mut words: Vec<u32> = Vec::new();
        for (number, draw) in (0..).zip(draws) {
            words.extend(variant::uniform(scene, draw, number));
            words.resize(words.len().next_multiple_of(to_usize(stride / 4)), 0);
        }
        let uniforms = self.filled("draws", BufferUsages::UNIFORM, &words);
        let views: Vec<_> = scene.textures.iter().map(|texture| image::upload(self.device, texture)).collect();
        let white = image::white(self.device);
        let binding = |view: &TextureView| self.bind(&uniforms, view, log);
        let (bindings, plain): (Vec<_>, _) = (views.iter().map(binding).collect(), binding(&white));
        for draw in draws {
            self.build(scene, draw, outputs);
        }

        let mut pass = begin(encoder, attachments);
        pass.set_vertex_buffer(0, vertices.slice(..));
        let (mut first, mut offset) = (0, 0);
        for draw in draws {
            let end = first + to_u32(3 * draw.triangles.len());
            pass.set_pipeline(&self.pipelines[&key(scene, draw, outputs)]);
            pass.set_bind_group(0, draw.material.texture.map_or(&plain, |index| &bindings[index]), &[offset]);
            set_dynamic(&mut pass, &draw.state.dynamic, scene.target.extent);
            pass.set_stencil_reference(draw.state.dynamic.stencil_reference & 0xff);
            pass.draw(first..end, 0..1);
            first = end;
            offset += to_u32(to_usize(stride));
        }
    }

    /// A zeroed log with room for the expected fragments and some more.
    fn log(&self, expected: usize, outputs: usize) -> Result<wgpu::Buffer, DrawError> {
        let room = expected + expected / 8 + 64;
        let bytes = 4 * (1 + room as u64 * record_words(outputs) as u64);
        let limit = self.device.device.limits().max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(DrawError::TooLarge { bytes, limit });
        }
        // New buffers are zero in WebGPU.
        Ok(self.buffer("log", bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC))
    }

    fn buffer(&self, label: &str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        self.device.device.create_buffer(&descriptor)
    }

    fn filled(&self, label: &str, usage: BufferUsages, words: &[u32]) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(words);
        let buffer = self.buffer(label, bytes.len() as u64, usage | BufferUsages::COPY_DST);
        self.device.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn bind(&self, uniforms: &wgpu::Buffer, view: &TextureView, log: &wgpu::Buffer) -> wgpu::BindGroup {
        let size = wgpu::BufferSize::new(UNIFORM_BYTES);
        let values = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: uniforms, offset: 0, size });
        self.device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &self.bind_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: values },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(view) },
                wgpu::BindGroupEntry { binding: 2, resource: log.as_entire_binding() },
            ],
        })
    }

    /// Builds the pipeline of a draw unless there is one already.
    fn build(&mut self, scene: &Scene, draw: &Draw, outputs: &[Output]) {
        let key = key(scene, draw, outputs);
        if self.pipelines.contains_key(&key) {
            return;
        }
        let gpu = &self.device.device;
        let module = self.modules.entry(key.outputs.clone()).or_insert_with(|| {
            let source = wgpu::ShaderSource::Wgsl(variant::wgsl(outputs).into());
            gpu.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("scene"), source })
        });
        let attribute = |location: u32, format| wgpu::VertexAttribute {
            format,
            offset: u64::from(16 * location),
            shader_location: location,
        };
        let quad = VertexFormat::Float32x4;
        let attributes =
            [attribute(0, quad), attribute(1, quad), attribute(2, quad), attribute(3, VertexFormat::Uint32)];
        let constants: Vec<_> = NAMES.into_iter().zip(key.constants.map(f64::from)).collect();
        let compilation_options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..wgpu::PipelineCompilationOptions::default() };
        let pipeline = gpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("scene"),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("corner"),
                compilation_options: compilation_options.clone(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: 4 * VERTEX_WORDS as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &attributes,
                })],
            },
            primitive: key.primitive,
            depth_stencil: key.depth_stencil.clone(),
            multisample: key.multisample,
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some("shade"),
                compilation_options,
                targets: &key.targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        self.pipelines.insert(key, pipeline);
    }
}

fn key(scene: &Scene, draw: &Draw, outputs: &[Output]) -> Key {
    Key {
        targets: draw.state.targets.clone(),
        depth_stencil: draw.state.depth_stencil.clone(),
        multisample: draw.state.multisample,
        primitive: draw.raster.primitive,
        outputs: outputs.to_vec(),
        constants: variant::constants(scene, draw),
    }
}

/// Fragments the model's rasteriser makes of a draw.
fn fragment_count(draw: &Draw) -> usize {
    let primitives = draw.triangles.iter().flat_map(|triangle| assemble(*triangle, &draw.raster));
    primitives.map(|primitive| primitive.spans().map(|span| (span.end - span.start) as usize).sum::<usize>()).sum()
}

/// The vertices of a draw as words, each with the number of its triangle.
fn vertex_words(draw: &Draw) -> Vec<u32> {
    let mut words = Vec::with_capacity(3 * VERTEX_WORDS * draw.triangles.len());
    for (number, triangle) in (0..).zip(draw.triangles.iter()) {
        for vertex in triangle {
            words.extend(vertex.position.iter().chain(&vertex.varyings).map(|value| value.to_bits()));
            words.push(number);
        }
    }
    words
}

fn to_u32(n: usize) -> u32 {
    u32::try_from(n).expect("vertices and offsets of a scene fit 32 bits")
}

fn to_usize(n: u64) -> usize {
    usize::try_from(n).expect("an alignment fits the address space")
}
