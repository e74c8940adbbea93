//! Equations that the driver shortens before it draws: nothing is multiplied by a constant 0, or by a constant 1 beside it.
//!
//! Only float targets can tell: no NaN, infinity or sign of a zero comes from a term that is left out.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState};

use super::SwiftShader;
use crate::format::TargetClass;
use crate::merger::blend::{Steps, component};
use crate::model::{Arithmetic, ColorInputs};

/// What a short equation stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Short {
    Zero,
    Source,
    Destination,
}

fn short(component: &BlendComponent) -> Option<Short> {
    match (component.src_factor, component.operation, component.dst_factor) {
        (F::Zero, Op::Add | Op::Subtract | Op::ReverseSubtract, F::Zero) => Some(Short::Zero),
        (F::One, Op::Add | Op::Subtract, F::Zero) => Some(Short::Source),
        (F::Zero, Op::Add | Op::ReverseSubtract, F::One) => Some(Short::Destination),
        _ => None,
    }
}

/// Whether the driver writes nothing at all: both equations keep the destination.
pub(super) fn keeps_destination(blend: &BlendState) -> bool {
    [blend.color, blend.alpha].iter().all(|component| short(component) == Some(Short::Destination))
}

/// Puts the results of short equations in place of the whole ones'.
pub(super) fn apply(inputs: &ColorInputs, mut steps: Steps<f32>) -> Steps<f32> {
    let class = inputs.format.class();
    let Some(blend) = inputs.blend.filter(|_| class == TargetClass::Float) else { return steps };
    for i in 0..4 {
        let value = match short(component(&blend, i)) {
            None => continue,
            Some(Short::Zero) => 0.0,
            Some(Short::Source) => steps.operands.src[i],
            Some(Short::Destination) => steps.operands.dst[i],
        };
        steps.result[i] = value;
        steps.clamped[i] = SwiftShader::default().clamp(&value, class);
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::ColorFormat;
    use crate::model::NumericModel;

    #[test]
    fn terms_with_constant_factors_leave_neither_signs_nor_nans() {
        let stored_in = |format, [color, alpha]: [BlendComponent; 2], src: f32, dst: u32| {
            let inputs = ColorInputs {
                format: ColorFormat::from_name(format).expect("a format"),
                blend: Some(BlendState { color, alpha }),
                constant: [0.0; 4],
                src: [src; 4],
                src1: [0.0; 4],
                dst: [dst; 4],
            };
            assert_eq!(
                SwiftShader::default().explain_color(&inputs).codes,
                SwiftShader::default().merge_color(&inputs),
                "explained alike"
            );
            SwiftShader::default().merge_color(&inputs)[0]
        };
        let stored = |src_factor, operation, dst_factor, src, dst| {
            stored_in("rgba16float", [BlendComponent { src_factor, operation, dst_factor }; 2], src, dst)
        };
        // Stored by the driver (`conform --level exhaustive`, units blend/rgba16float/zero and /one).
        assert_eq!(stored(F::Zero, Op::Add, F::Zero, -0.000_860_227_56, 0xb4f8), 0, "no negative zero");
        assert_eq!(stored(F::One, Op::Add, F::Zero, -1e-40, 0x0136), 0x8000, "the source's own sign");
        assert_eq!(stored(F::Zero, Op::Add, F::One, f32::NAN, 0x3c00), 0x3c00, "no NaN of the source");
        assert_eq!(stored(F::Zero, Op::ReverseSubtract, F::One, f32::INFINITY, 0xc400), 0xc400, "nor infinity");
        // Only both equations together keep a NaN, which no small float can be stored as.
        let keep = BlendComponent { src_factor: F::Zero, operation: Op::Add, dst_factor: F::One };
        assert_eq!(stored_in("rg11b10ufloat", [keep; 2], 0.5, 0x7ff), 0x7ff, "nothing is written");
        assert_eq!(stored_in("rg11b10ufloat", [keep, BlendComponent::REPLACE], 0.5, 0x7ff), 0, "red is stored again");
    }
}
