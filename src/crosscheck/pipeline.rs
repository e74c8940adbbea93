//! Render pipelines of a replay, built once per distinct state.

use std::collections::HashMap;

use wgpu::{ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, MultisampleState};

use super::shader::{FRAGMENT_ENTRY, Shader, VERTEX_ENTRY};
use crate::state::MergerState;
use crate::target::Framebuffer;

/// Bytes of one vertex: a clip-space position.
pub const VERTEX_BYTES: u64 = 16;

/// What distinguishes two pipelines; dynamic values are not part of it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PipelineKey {
    /// Color targets as the pass has them.
    pub targets: Vec<Option<ColorTargetState>>,
    /// Depth and stencil as the pass has them.
    pub depth_stencil: Option<DepthStencilState>,
    /// Sample count, mask and alpha to coverage.
    pub multisample: MultisampleState,
    /// The shader.
    pub shader: Shader,
    /// Clamp depth to the viewport's range instead of clipping (wgpu's `unclipped_depth`).
    pub unclipped_depth: bool,
}

impl PipelineKey {
    /// The pipeline of a state in a pass over `targets`: attachments the state leaves out stay in the pass, masked and
    /// untested.
    #[must_use]
    pub fn new(state: &MergerState, unclipped_depth: bool, shader: Shader, targets: &Framebuffer) -> Self {
        let colors = targets.colors.iter().enumerate().map(|(location, color)| {
            let format = color.as_ref()?.format().texture_format();
            let own = state.targets.get(location).cloned().flatten();
            Some(own.unwrap_or(ColorTargetState { format, blend: None, write_mask: ColorWrites::empty() }))
        });
        let format = targets.depth_stencil.as_ref().map(|target| target.format().texture_format());
        Self {
            targets: colors.collect(),
            depth_stencil: state.depth_stencil.clone().or(format.map(pass_through)),
            multisample: state.multisample,
            shader,
            unclipped_depth,
        }
    }
}

/// A depth/stencil state under which every fragment passes and nothing is written.
#[must_use]
pub fn pass_through(format: wgpu::TextureFormat) -> DepthStencilState {
    DepthStencilState {
        format,
        depth_write_enabled: Some(false),
        depth_compare: Some(CompareFunction::Always),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// All pipelines built so far.
#[derive(Debug)]
pub struct Pipelines {
    device: wgpu::Device,
    bind_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    modules: HashMap<Shader, wgpu::ShaderModule>,
    built: HashMap<PipelineKey, wgpu::RenderPipeline>,
}

impl Pipelines {
    /// No pipeline yet.
    #[must_use]
    pub fn new(device: &wgpu::Device) -> Self {
        let bind_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("records"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only: true },
                    has_dynamic_offset: true,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("replay"),
            bind_group_layouts: &[Some(&bind_layout)],
            immediate_size: 0,
        });
        Self { device: device.clone(), bind_layout, layout, modules: HashMap::new(), built: HashMap::new() }
    }

    /// Bind group 0: `bytes` of `buffer` from the dynamic offset on.
    #[must_use]
    pub fn bind(&self, buffer: &wgpu::Buffer, bytes: u64) -> wgpu::BindGroup {
        let size = wgpu::BufferSize::new(bytes);
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("fragments"),
            layout: &self.bind_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size }),
            }],
        })
    }

    /// The pipeline of `key`, built on first use. Faults show at the device's next check.
    pub fn get(&mut self, key: &PipelineKey) -> &wgpu::RenderPipeline {
        if !self.built.contains_key(key) {
            let pipeline = self.build(key);
            self.built.insert(key.clone(), pipeline);
        }
        &self.built[key]
    }

    fn build(&mut self, key: &PipelineKey) -> wgpu::RenderPipeline {
        let module = self.modules.entry(key.shader.clone()).or_insert_with(|| {
            self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("hand over"),
                source: wgpu::ShaderSource::Wgsl(key.shader.wgsl().into()),
            })
        });
        let position = [wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x4, offset: 0, shader_location: 0 }];
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("replay"),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(VERTEX_ENTRY),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: VERTEX_BYTES,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &position,
                })],
            },
            primitive: wgpu::PrimitiveState { unclipped_depth: key.unclipped_depth, ..wgpu::PrimitiveState::default() },
            depth_stencil: key.depth_stencil.clone(),
            multisample: key.multisample,
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(FRAGMENT_ENTRY),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &key.targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
