//! Signed normalised targets without blending; wgpu offers no blending on them here.
//!
//! 8 bits: min(x, 1) * 127 to nearest even, saturated to -128..=127, so that values below -1 store the spare code -128,
//! which Vulkan and D3D never produce; NaN stores -128 too. 16 bits: clamped to [-1, 1] with NaN as -1, then to nearest even.

use super::steps::Steps;
use crate::format::{ChannelKind, snorm};
use crate::model::ColorInputs;

/// Signed normalised targets with blending off.
pub(super) fn store(inputs: &ColorInputs) -> Steps {
    let channels = inputs.format.channels();
    let code = |i: usize| match channels[i] {
        ChannelKind::Snorm(bits) => store_code(inputs.src[i], bits),
        _ => 0,
    };
    Steps {
        rule: "scaled in binary32",
        steps: None,
        src: inputs.src.map(f64::from),
        dst: [0.0; 4],
        equation: [None; 4],
        result: inputs.src.map(f64::from),
        codes: std::array::from_fn(code),
    }
}

/// The bits stored for a shader output.
pub(super) fn store_code(x: f32, bits: u32) -> u32 {
    snorm::stored_code(quantize(x, bits), bits)
}

/// The signed code of a shader output.
fn quantize(x: f32, bits: u32) -> i32 {
    let steps = snorm::steps(bits);
    // x86 MINPS and MAXPS give the second operand where NaN does not compare.
    let (lowest, x) = if bits == 8 {
        (-steps - 1, if x > 1.0 { 1.0 } else { x })
    } else {
        (-steps, if x > -1.0 { x.min(1.0) } else { -1.0 })
    };
    #[expect(clippy::cast_precision_loss, reason = "127 and 32767 are exact")]
    let scaled = (x * steps as f32).round_ties_even();
    if scaled.is_nan() {
        return lowest;
    }
    #[expect(clippy::cast_possible_truncation, reason = "an integer; `as` saturates, and the clamp follows")]
    let code = scaled as i32;
    code.clamp(lowest, steps)
}
