//! Stage 6: the blended values as codes of the target.
//!
//! Encoding comes before the write mask, because masked channels keep their stored bits. Sources: Vulkan,
//! *Fixed-Point Data Conversions*, *Floating-Point Format Conversions*; D3D11.3 3.2.

use crate::format::{ChannelKind, Codes, FloatLayout};
use crate::merger::blend::Steps;
use crate::model::{Arithmetic, ColorInputs};

/// Encodes all four channels; absent ones give 0.
///
/// With blending off, 32-bit float channels take the shader's bits unchanged (D3D11.3 3.1.3.2, pure moves).
pub fn encode<A: Arithmetic>(arithmetic: &A, inputs: &ColorInputs, steps: &Steps<A::Value>) -> Codes {
    let channels = inputs.format.channels();
    std::array::from_fn(|i| match channels[i] {
        ChannelKind::Absent => 0,
        ChannelKind::Float(FloatLayout::SINGLE) if inputs.blend.is_none() => inputs.src[i].to_bits(),
        kind => arithmetic.encode(&steps.clamped[i], kind),
    })
}
