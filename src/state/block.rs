//! A state block: the render state a scene's pass or a `--state` text names, before formats are known.

use wgpu_types::{
    BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction, DepthBiasState,
    DepthStencilState, Face, StencilState, TextureFormat,
};

use super::{AlphaTest, MAX_COLOR_TARGETS, MergerState};
use crate::format::DepthFormat;

/// Render state without formats: what ShaderLab's commands set.
#[derive(Clone, Debug, PartialEq)]
pub struct StateBlock {
    /// Blend state by target; `None` is blending off.
    pub blend: [Option<BlendState>; MAX_COLOR_TARGETS],
    /// Write mask by target.
    pub write_mask: [ColorWrites; MAX_COLOR_TARGETS],
    /// `ZWrite`.
    pub depth_write: bool,
    /// `ZTest`.
    pub depth_compare: CompareFunction,
    /// `Cull`; `None` is off.
    pub cull: Option<Face>,
    /// `Offset`.
    pub depth_bias: DepthBiasState,
    /// `AlphaTest`.
    pub alpha_test: AlphaTest,
    /// `Stencil`, with its reference; `None` is off.
    pub stencil: Option<(StencilState, u32)>,
    /// `Tags`, in order.
    pub tags: Vec<(String, String)>,
}

impl Default for StateBlock {
    /// ShaderLab's defaults: no blending, depth test less-equal with writes, back faces culled.
    fn default() -> Self {
        Self {
            blend: [None; MAX_COLOR_TARGETS],
            write_mask: [ColorWrites::ALL; MAX_COLOR_TARGETS],
            depth_write: true,
            depth_compare: CompareFunction::LessEqual,
            cull: Some(Face::Back),
            depth_bias: DepthBiasState::default(),
            alpha_test: AlphaTest::Off,
            stencil: None,
            tags: Vec::new(),
        }
    }
}

impl StateBlock {
    /// The default block with this blend state on every target.
    #[must_use]
    pub fn with_blend(blend: Option<BlendState>) -> Self {
        Self { blend: [blend; MAX_COLOR_TARGETS], ..Self::default() }
    }

    /// The value of a tag; names of tags are compared without case, as in Unity.
    #[must_use]
    pub fn tag(&self, name: &str) -> Option<&str> {
        self.tags.iter().find(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, value)| value.as_str())
    }

    /// Sets the factors of min and max to one: every API ignores them there, and WebGPU accepts no others.
    pub fn ignore_extreme_factors(&mut self) {
        for blend in self.blend.iter_mut().flatten() {
            for component in [&mut blend.color, &mut blend.alpha] {
                if matches!(component.operation, BlendOperation::Min | BlendOperation::Max) {
                    component.src_factor = BlendFactor::One;
                    component.dst_factor = BlendFactor::One;
                }
            }
        }
    }

    /// The merger state for targets of these formats.
    ///
    /// Depth and stencil take effect as far as the depth format has the aspect.
    #[must_use]
    pub fn to_merger_state(&self, colors: &[TextureFormat], depth: Option<TextureFormat>) -> MergerState {
        let target = |(i, format): (usize, &TextureFormat)| {
            Some(ColorTargetState { format: *format, blend: self.blend[i], write_mask: self.write_mask[i] })
        };
        let mut state = MergerState {
            targets: colors.iter().take(MAX_COLOR_TARGETS).enumerate().map(target).collect(),
            alpha_test: self.alpha_test,
            ..MergerState::default()
        };
        if let Some(format) = depth {
            let layout = DepthFormat::new(format).ok();
            let has_depth = layout.is_some_and(|layout| layout.depth().is_some());
            let has_stencil = layout.is_some_and(DepthFormat::has_stencil);
            let (stencil, reference) = self.stencil.clone().filter(|_| has_stencil).unwrap_or_default();
            state.dynamic.stencil_reference = reference;
            state.depth_stencil = Some(DepthStencilState {
                format,
                depth_write_enabled: has_depth.then_some(self.depth_write),
                depth_compare: has_depth.then_some(self.depth_compare),
                stencil,
                bias: self.depth_bias,
            });
        }
        state
    }
}

/// A `Queue` tag that does not parse.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown render queue `{0}`; write Background, Geometry, AlphaTest, GeometryLast, Transparent or Overlay, with an offset such as `Transparent+1` if wanted"
)]
pub struct QueueError(pub String);

/// The named render queues.
pub const QUEUES: [(&str, i32); 6] = [
    ("Background", 1000),
    ("Geometry", 2000),
    ("AlphaTest", 2450),
    ("GeometryLast", 2500),
    ("Transparent", 3000),
    ("Overlay", 4000),
];

/// The number of a queue: `Transparent+1` is 3001.
///
/// # Errors
/// [`QueueError`] for an unknown name or a malformed offset.
pub fn queue_number(text: &str) -> Result<i32, QueueError> {
    let error = || QueueError(text.chars().take(60).collect());
    let split = text.find(['+', '-']).unwrap_or(text.len());
    let (name, offset) = text.split_at(split);
    let (_, base) = QUEUES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name.trim())).ok_or_else(error)?;
    if offset.is_empty() {
        return Ok(*base);
    }
    let offset: i32 = offset.replace(' ', "").parse().map_err(|_| error())?;
    base.checked_add(offset).ok_or_else(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queues_take_offsets() {
        assert_eq!(queue_number("Transparent+1"), Ok(3001), "with offset");
        assert_eq!(queue_number("geometry - 20"), Ok(1980), "below");
        assert_eq!(queue_number("AlphaTest"), Ok(2450), "plain");
        assert!(queue_number("Transparent+x").is_err() && queue_number("Sky").is_err(), "malformed");
        assert!(queue_number("Overlay+99999999999").is_err(), "too large");
    }
}
