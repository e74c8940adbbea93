//! Fragments in: what a fragment shader hands to the output merger for one pixel.

use crate::state::MAX_COLOR_TARGETS;

/// One fragment: the shader's outputs for one pixel, before any test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Output colors by location, RGBA, any `f32`.
    pub outputs: [[f32; 4]; MAX_COLOR_TARGETS],
    /// Second source of dual-source blending (WGSL `@blend_src(1)`), RGBA.
    pub src1: [f32; 4],
    /// Depth, interpolated or written by the shader; any `f32`, clamped to the viewport's range before the test.
    pub depth: f32,
    /// Samples the primitive covers, bit i = sample i. Bits beyond the sample count are ignored.
    pub coverage: u32,
    /// Whether the primitive faces the viewer: selects the stencil face.
    pub front_facing: bool,
    /// The shader discarded this fragment (`clip`, `discard`).
    pub discarded: bool,
}

impl Default for Fragment {
    fn default() -> Self {
        Self {
            outputs: [[0.0; 4]; MAX_COLOR_TARGETS],
            src1: [0.0; 4],
            depth: 0.0,
            coverage: !0,
            front_facing: true,
            discarded: false,
        }
    }
}

impl Fragment {
    /// A fully covering, front-facing fragment at depth 0 with `color` as output 0.
    #[must_use]
    pub fn new(color: [f32; 4]) -> Self {
        let mut fragment = Self::default();
        fragment.outputs[0] = color;
        fragment
    }

    /// The same fragment at another depth.
    #[must_use]
    pub fn at_depth(self, depth: f32) -> Self {
        Self { depth, ..self }
    }

    /// The same fragment with a second source.
    #[must_use]
    pub fn with_src1(self, src1: [f32; 4]) -> Self {
        Self { src1, ..self }
    }
}
