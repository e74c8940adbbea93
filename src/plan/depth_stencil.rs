//! What the depth and stencil tests of a state can do, by trying every stencil value and both outcomes of the depth test.

use wgpu_types::{CompareFunction, DepthStencilState, StencilFaceState};

use crate::format::DepthFormat;
use crate::format::depth::DepthKind;
use crate::merger::depth_stencil::{stencil_after, stencil_passes};

/// What the tests can come to, whatever is stored and drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcomes {
    /// A fragment can pass both tests.
    pub can_pass: bool,
    /// The depth test: `None` if its outcome varies, else what it always is. Passes without a depth aspect.
    pub depth: Option<bool>,
}

/// What the state needs of depth and stencil memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "one independent fact each")]
pub struct Access {
    /// The stored depth is read.
    pub depth_read: bool,
    /// Depth is written.
    pub depth_write: bool,
    /// The stored stencil value is read.
    pub stencil_read: bool,
    /// Stencil is written.
    pub stencil_write: bool,
}

fn stencil_values() -> impl Iterator<Item = u8> {
    0..=u8::MAX
}

/// What a state's tests can come to. Without a state both pass.
#[must_use]
pub fn outcomes(state: Option<(&DepthStencilState, DepthFormat)>, reference: u32) -> Outcomes {
    let Some((state, format)) = state else { return Outcomes { can_pass: true, depth: Some(true) } };
    let depth = match state.depth_compare.unwrap_or_default() {
        _ if format.depth().is_none() => Some(true),
        CompareFunction::Always => Some(true),
        CompareFunction::Never => Some(false),
        _ => None,
    };
    let passes = |face| stencil_values().any(|stored| stencil_passes(&state.stencil, face, reference, stored));
    let stencil = !format.has_stencil() || faces(state).into_iter().any(passes);
    Outcomes { can_pass: stencil && depth != Some(false), depth }
}

/// What memory a state's tests need. `color_written`: whether a fragment that passes changes a color target.
#[must_use]
pub fn access(state: &DepthStencilState, format: DepthFormat, reference: u32, color_written: bool) -> Access {
    let Outcomes { can_pass, depth } = outcomes(Some((state, format)), reference);
    // Where the test asks for equal codes, writing the code changes nothing; floats may be -0 and +0.
    let rewrites = state.depth_compare == Some(CompareFunction::Equal) && format.depth() == Some(DepthKind::Float32);
    let equal = state.depth_compare == Some(CompareFunction::Equal) && !rewrites;
    let mut access = Access {
        depth_write: can_pass && format.depth().is_some() && state.depth_write_enabled == Some(true) && !equal,
        ..Access::default()
    };
    let pass_shows = can_pass && (color_written || access.depth_write);
    let depth_outcomes: &[bool] = match depth {
        Some(true) => &[true],
        Some(false) => &[false],
        None => &[true, false],
    };
    // The depth test matters where its outcome lets something be written or chooses another stencil value.
    let mut depth_matters = pass_shows;
    if format.has_stencil() {
        let mut constant_values = true;
        for face in faces(state) {
            let passed = |stored| stencil_passes(&state.stencil, face, reference, stored);
            let after = |stored, depth| stencil_after(&state.stencil, face, reference, stored, (passed(stored), depth));
            let varies = stencil_values().any(|stored| passed(stored) != passed(0));
            let changes = |depth: &bool| stencil_values().any(|stored| after(stored, *depth) != stored);
            let constant = |depth: &bool| stencil_values().all(|stored| after(stored, *depth) == after(0, *depth));
            access.stencil_write |= depth_outcomes.iter().any(changes);
            access.stencil_read |= varies && pass_shows;
            constant_values &= depth_outcomes.iter().all(constant);
            depth_matters |= stencil_values().any(|stored| after(stored, true) != after(stored, false));
        }
        // Written without being read only if every outcome of either face stores one value.
        access.stencil_read |= access.stencil_write && !constant_values;
    }
    access.depth_read = depth.is_none() && depth_matters;
    access
}

fn faces(state: &DepthStencilState) -> [&StencilFaceState; 2] {
    [&state.stencil.front, &state.stencil.back]
}
