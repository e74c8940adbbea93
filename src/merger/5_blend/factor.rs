//! The 17 blend factors.
//!
//! A color factor in the alpha equation means the alpha component. Sources: Vulkan, *Framebuffer / Blend Factors*;
//! D3D11.3 17.1; WebGPU, *GPUBlendFactor*.

use wgpu_types::BlendFactor;

use crate::model::Arithmetic;

/// What the blend equation reads, RGBA each.
#[derive(Clone, Debug)]
pub struct Operands<V> {
    /// The shader's output, clamped for the target class.
    pub src: [V; 4],
    /// The second source, likewise.
    pub src1: [V; 4],
    /// The blend constant, likewise.
    pub constant: [V; 4],
    /// The stored texel, decoded.
    pub dst: [V; 4],
}

/// The value of a factor for one channel (0 to 3 = R, G, B, A).
pub fn factor<A: Arithmetic>(
    arithmetic: &A,
    factor: BlendFactor,
    channel: usize,
    operands: &Operands<A::Value>,
) -> A::Value {
    let Operands { src, src1, constant, dst } = operands;
    let complement = |x: &A::Value| arithmetic.complement(x);
    match factor {
        BlendFactor::Zero => arithmetic.zero(),
        BlendFactor::One => arithmetic.one(),
        BlendFactor::Src => src[channel].clone(),
        BlendFactor::OneMinusSrc => complement(&src[channel]),
        BlendFactor::SrcAlpha => src[3].clone(),
        BlendFactor::OneMinusSrcAlpha => complement(&src[3]),
        BlendFactor::Dst => dst[channel].clone(),
        BlendFactor::OneMinusDst => complement(&dst[channel]),
        BlendFactor::DstAlpha => dst[3].clone(),
        BlendFactor::OneMinusDstAlpha => complement(&dst[3]),
        // min(source alpha, 1 - destination alpha) for color, 1 for alpha.
        BlendFactor::SrcAlphaSaturated if channel == 3 => arithmetic.one(),
        BlendFactor::SrcAlphaSaturated => arithmetic.saturate(&src[3], &complement(&dst[3])),
        BlendFactor::Constant => constant[channel].clone(),
        BlendFactor::OneMinusConstant => complement(&constant[channel]),
        BlendFactor::Src1 => src1[channel].clone(),
        BlendFactor::OneMinusSrc1 => complement(&src1[channel]),
        BlendFactor::Src1Alpha => src1[3].clone(),
        BlendFactor::OneMinusSrc1Alpha => complement(&src1[3]),
    }
}
