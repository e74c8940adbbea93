//! Stage 3: stencil and depth test of one sample, and what they write, in their entangled order.
//!
//! Stencil is tested first; its operation is chosen by both tests' outcome and is written even on failure. Depth is
//! written only when both pass. Sources: Vulkan, *Fragment Operations / Stencil Test, Depth Test*; D3D11.3 17.9-17.13.
//! (WebGPU's algorithm text writes depth without asking the stencil test: a defect of the text, not followed here.)

use wgpu_types::{DepthStencilState, StencilFaceState, StencilOperation, StencilState};

use super::discard::compare;
use crate::format::DepthFormat;
use crate::format::depth::DepthKind;

/// Depth code and stencil value of one sample; 0 where the format has no such aspect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DepthStencil {
    /// Depth code.
    pub depth: u32,
    /// Stencil value.
    pub stencil: u8,
}

/// Outcome of both tests for one sample, and what the sample then holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tested {
    /// The stencil test passed, or there is none.
    pub stencil_passed: bool,
    /// The depth test passed, or there is none.
    pub depth_passed: bool,
    /// What is stored afterwards.
    pub stored: DepthStencil,
}

impl Tested {
    /// Whether the fragment goes on to the blender.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.stencil_passed && self.depth_passed
    }
}

/// Tests a fragment's depth `code` and the stencil `reference` against what is `stored`.
#[must_use]
pub fn test(
    state: &DepthStencilState,
    format: DepthFormat,
    front_facing: bool,
    reference: u32,
    code: u32,
    stored: DepthStencil,
) -> Tested {
    let face = if front_facing { &state.stencil.front } else { &state.stencil.back };
    let stencil_passed = !format.has_stencil() || stencil_passes(&state.stencil, face, reference, stored.stencil);
    let depth_passed = format.depth().is_none_or(|kind| {
        let function = state.depth_compare.unwrap_or_default();
        match kind {
            DepthKind::Unorm(_) => compare(function, &code, &stored.depth),
            DepthKind::Float32 => compare(function, &f32::from_bits(code), &f32::from_bits(stored.depth)),
        }
    });

    let mut after = stored;
    if format.has_stencil() {
        after.stencil = stencil_after(&state.stencil, face, reference, stored.stencil, (stencil_passed, depth_passed));
    }
    if stencil_passed && depth_passed && format.depth().is_some() && state.depth_write_enabled == Some(true) {
        after.depth = code;
    }
    Tested { stencil_passed, depth_passed, stored: after }
}

/// Whether a stencil state can stop a fragment or change a value. Masks of 0 switch no test off: it then compares 0 with 0.
#[must_use]
pub fn stencil_matters(state: &StencilState) -> bool {
    [state.front, state.back].iter().any(|face| *face != StencilFaceState::IGNORE)
}

/// The stencil test of one face.
#[must_use]
pub fn stencil_passes(state: &StencilState, face: &StencilFaceState, reference: u32, stored: u8) -> bool {
    let mask = low_byte(state.read_mask);
    compare(face.compare, &(low_byte(reference) & mask), &(stored & mask))
}

/// What the stencil holds afterwards, by the outcome of the stencil and the depth test.
#[must_use]
pub fn stencil_after(
    state: &StencilState,
    face: &StencilFaceState,
    reference: u32,
    stored: u8,
    (stencil_passed, depth_passed): (bool, bool),
) -> u8 {
    let new = operate(choose(face, stencil_passed, depth_passed), stored, low_byte(reference));
    let mask = low_byte(state.write_mask);
    (stored & !mask) | (new & mask)
}

/// The operation the two outcomes select.
fn choose(face: &StencilFaceState, stencil_passed: bool, depth_passed: bool) -> StencilOperation {
    match (stencil_passed, depth_passed) {
        (false, _) => face.fail_op,
        (true, false) => face.depth_fail_op,
        (true, true) => face.pass_op,
    }
}

/// The new value, from the *unmasked* stored value and reference.
fn operate(operation: StencilOperation, stored: u8, reference: u8) -> u8 {
    match operation {
        StencilOperation::Keep => stored,
        StencilOperation::Zero => 0,
        StencilOperation::Replace => reference,
        StencilOperation::Invert => !stored,
        StencilOperation::IncrementClamp => stored.saturating_add(1),
        StencilOperation::DecrementClamp => stored.saturating_sub(1),
        StencilOperation::IncrementWrap => stored.wrapping_add(1),
        StencilOperation::DecrementWrap => stored.wrapping_sub(1),
    }
}

/// Stencil references and masks have 8 bits; higher ones are dropped.
fn low_byte(x: u32) -> u8 {
    x.to_le_bytes()[0]
}
