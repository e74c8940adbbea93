//! State in: what the output merger is told, in `wgpu-types`' own words.
//!
//! [`MergerState`] gathers the part of a render pipeline that the output merger reads (color targets,
//! depth and stencil, multisampling) with the values set per draw ([`DynamicState`]). The one thing WebGPU lacks
//! is the fixed-function [`AlphaTest`] of older APIs.

pub mod block;
pub mod preset;
pub mod shaderlab;
pub mod spelling;
#[cfg(test)]
mod strategy;
pub mod text;
pub mod validate;
#[cfg(feature = "json")]
pub mod webgpu;

pub use block::StateBlock;

use wgpu_types::{BlendComponent, BlendState, ColorTargetState, CompareFunction, DepthStencilState, MultisampleState};

/// Color targets a pass may have at most (WebGPU's guaranteed `maxColorAttachments`).
pub const MAX_COLOR_TARGETS: usize = 8;

/// Everything the output merger is told about one draw.
///
/// `Default` is a state without targets: no fragment leaves a trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MergerState {
    /// Color targets by fragment output location; `None` leaves a location unused. At most [`MAX_COLOR_TARGETS`].
    pub targets: Vec<Option<ColorTargetState>>,
    /// Depth and stencil state; `None` means no attachment, and both tests pass.
    pub depth_stencil: Option<DepthStencilState>,
    /// Sample count (1 or 4), sample mask and alpha to coverage.
    pub multisample: MultisampleState,
    /// The fixed-function alpha test, run on the alpha of output 0.
    pub alpha_test: AlphaTest,
    /// Values set per draw rather than per pipeline.
    pub dynamic: DynamicState,
}

/// Whether a factor of the state names the second source.
#[must_use]
pub fn reads_second_source(blend: &BlendState) -> bool {
    [blend.color, blend.alpha].iter().any(component_reads_second_source)
}

/// The same of one equation.
pub(crate) fn component_reads_second_source(component: &BlendComponent) -> bool {
    component.src_factor.ref_second_blend_source() || component.dst_factor.ref_second_blend_source()
}

/// Values a render pass sets per draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicState {
    /// Blend constant, RGBA, any value. WebGPU starts every pass with zeros.
    pub blend_constant: [f32; 4],
    /// Stencil reference; the low 8 bits are used. WebGPU starts every pass with 0.
    pub stencil_reference: u32,
    /// Depth range of the viewport, `[min, max]` with `0 <= min <= max <= 1`; fragment depth is clamped to it.
    pub depth_range: [f32; 2],
    /// Scissor rectangle in texels; `None` admits the whole target.
    pub scissor: Option<Rect>,
}

impl Default for DynamicState {
    fn default() -> Self {
        Self { blend_constant: [0.0; 4], stencil_reference: 0, depth_range: [0.0, 1.0], scissor: None }
    }
}

/// A rectangle of texels: `x <= px < x + width`, `y <= py < y + height`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Left edge.
    pub x: u32,
    /// Top edge.
    pub y: u32,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
}

/// The fixed-function alpha test (Direct3D 9, OpenGL 1 to 2.1, ShaderLab's `AlphaTest`).
///
/// A fragment lives when `alpha compare reference` holds. Comparisons with NaN are false, except
/// [`CompareFunction::NotEqual`] and [`CompareFunction::Always`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaTest {
    /// No test: every fragment lives.
    #[default]
    Off,
    /// Compare the fragment's alpha (left) with a reference (right).
    On {
        /// The comparison that must hold.
        compare: CompareFunction,
        /// The reference value, usually in `[0, 1]`.
        reference: f32,
    },
}

impl MergerState {
    /// A state with one color target and nothing else.
    #[must_use]
    pub fn single(target: ColorTargetState) -> Self {
        Self { targets: vec![Some(target)], ..Self::default() }
    }
}
