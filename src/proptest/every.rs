//! Iterators over everything of a kind, for tests that need no luck.

use wgpu_types::{BlendComponent, BlendState, StencilFaceState};

use crate::format::ColorFormat;
use crate::format::layout::FORMATS;
use crate::merger::blend::operation::ignores_factors;
use crate::state::spelling::{blend_factors, blend_operations, compare_functions, stencil_operations};

/// Every color format outmerge models, 23 of them.
pub fn formats() -> impl Iterator<Item = ColorFormat> + Clone {
    FORMATS.into_iter().filter_map(|(_, format)| ColorFormat::new(format).ok())
}

/// Every combination of factors and operation: 17 * 17 * 5 = 1445.
pub fn components() -> impl Iterator<Item = BlendComponent> {
    blend_operations().flat_map(|operation| {
        blend_factors().flat_map(move |src_factor| {
            blend_factors().map(move |dst_factor| BlendComponent { src_factor, dst_factor, operation })
        })
    })
}

/// Every combination that has an effect of its own and that WebGPU accepts: min and max only once, 869.
pub fn distinct_components() -> impl Iterator<Item = BlendComponent> {
    components().filter(|c| {
        !ignores_factors(c.operation)
            || (c.src_factor, c.dst_factor) == (wgpu_types::BlendFactor::One, wgpu_types::BlendFactor::One)
    })
}

/// Every blend state with one equation for color and alpha, [`distinct_components`].
pub fn uniform_blend_states() -> impl Iterator<Item = BlendState> {
    distinct_components().map(|both| BlendState { color: both, alpha: both })
}

/// Every blend state there is, [`distinct_components`] for color and for alpha: 869 * 869 = 755,161.
pub fn blend_states() -> impl Iterator<Item = BlendState> {
    distinct_components().flat_map(|color| distinct_components().map(move |alpha| BlendState { color, alpha }))
}

/// Every stencil face: 8 comparisons and three operations of 8, 4096.
pub fn stencil_faces() -> impl Iterator<Item = StencilFaceState> {
    compare_functions().flat_map(|compare| {
        stencil_operations().flat_map(move |fail_op| {
            stencil_operations().flat_map(move |depth_fail_op| {
                stencil_operations().map(move |pass_op| StencilFaceState { compare, fail_op, depth_fail_op, pass_op })
            })
        })
    })
}
