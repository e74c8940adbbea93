//! Stage 5: the blend equation, written once, over any arithmetic.
//!
//! result = operation(source * source factor, destination * destination factor), R, G and B by one equation and A by
//! another. [`blend`] keeps every intermediate value, so that explanations and results are the same computation.
//! Sources: Vulkan, *Framebuffer / Blending*; D3D11.3 17; WebGPU, *Blend State*.

pub mod clamp;
pub(crate) mod describe;
mod explain;
pub mod factor;
pub mod operation;

pub use explain::explain;
pub use factor::Operands;

use wgpu_types::BlendState;

use super::load::load;
use crate::model::{Arithmetic, ColorInputs};

/// Every value of one texel's way through the blender, RGBA.
#[derive(Clone, Debug)]
pub struct Steps<V> {
    /// What the equation reads.
    pub operands: Operands<V>,
    /// Factors, products and operation; `None` with blending off.
    pub equation: Option<Equation<V>>,
    /// The result before the clamp to the target's range.
    pub result: [V; 4],
    /// The result clamped for the target's class.
    pub clamped: [V; 4],
}

/// The inner values of the blend equation, RGBA.
#[derive(Clone, Debug)]
pub struct Equation<V> {
    /// Source factors.
    pub src_factors: [V; 4],
    /// Destination factors.
    pub dst_factors: [V; 4],
    /// Source and destination as the operation takes them: multiplied by their factors, or raw for min and max.
    pub terms: [(V, V); 4],
}

/// Runs the equation on one texel.
pub fn blend<A: Arithmetic>(arithmetic: &A, inputs: &ColorInputs) -> Steps<A::Value> {
    let class = inputs.format.class();
    let take_in = |color: [f32; 4]| -> [A::Value; 4] {
        std::array::from_fn(|i| arithmetic.take_in(clamp::clamp_input(color[i], class), inputs.format, i))
    };
    let operands = Operands {
        src: take_in(inputs.src),
        src1: take_in(inputs.src1),
        constant: std::array::from_fn(|i| arithmetic.take_in_constant(inputs.constant[i], inputs.format, i)),
        dst: load(arithmetic, inputs.format, inputs.dst),
    };
    let equation = inputs.blend.map(|state| equation(arithmetic, &state, &operands, inputs));
    let result: [A::Value; 4] = std::array::from_fn(|i| match (&equation, &inputs.blend) {
        (Some(equation), Some(state)) => {
            let (src, dst) = &equation.terms[i];
            operation::apply(arithmetic, component(state, i).operation, src, dst)
        }
        _ => operands.src[i].clone(),
    });
    let clamped = std::array::from_fn(|i| arithmetic.clamp(&result[i], class));
    Steps { operands, equation, result, clamped }
}

/// Factors and terms of all four channels.
pub(crate) fn equation<A: Arithmetic>(
    arithmetic: &A,
    state: &BlendState,
    operands: &Operands<A::Value>,
    inputs: &ColorInputs,
) -> Equation<A::Value> {
    let class = inputs.format.class();
    let factor = |name, i| {
        let factor = factor::factor(arithmetic, name, i, operands);
        arithmetic.factor(arithmetic.clamp_factor(factor, class))
    };
    let src_factors: [A::Value; 4] = std::array::from_fn(|i| factor(component(state, i).src_factor, i));
    let dst_factors: [A::Value; 4] = std::array::from_fn(|i| factor(component(state, i).dst_factor, i));
    let terms = std::array::from_fn(|i| {
        let (src, dst) = (&operands.src[i], &operands.dst[i]);
        if operation::ignores_factors(component(state, i).operation) {
            (src.clone(), dst.clone())
        } else {
            (arithmetic.multiply(src, &src_factors[i]), arithmetic.multiply(dst, &dst_factors[i]))
        }
    });
    Equation { src_factors, dst_factors, terms }
}

/// The equation of a channel: color for R, G, B, alpha for A.
#[must_use]
pub fn component(state: &BlendState, channel: usize) -> &wgpu_types::BlendComponent {
    if channel == 3 { &state.alpha } else { &state.color }
}
