//! The five blend operations.
//!
//! Sources: Vulkan, *Framebuffer / Blend Operations*; D3D11.3 17.1; WebGPU, *GPUBlendOperation*.

use wgpu_types::BlendOperation;

use crate::model::Arithmetic;

/// Whether the operation takes source and destination raw, without their factors.
#[must_use]
pub fn ignores_factors(operation: BlendOperation) -> bool {
    matches!(operation, BlendOperation::Min | BlendOperation::Max)
}

/// Combines the source and destination terms.
pub fn apply<A: Arithmetic>(arithmetic: &A, operation: BlendOperation, src: &A::Value, dst: &A::Value) -> A::Value {
    match operation {
        BlendOperation::Add => arithmetic.add(src, dst),
        BlendOperation::Subtract => arithmetic.subtract(src, dst),
        BlendOperation::ReverseSubtract => arithmetic.subtract(dst, src),
        BlendOperation::Min => arithmetic.minimum(src, dst),
        BlendOperation::Max => arithmetic.maximum(src, dst),
    }
}
