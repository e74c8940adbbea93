//! Fragment depth of `f32` bit patterns, converted and stored by the depth stage.

use std::ops::ControlFlow;

use wgpu_types::{CompareFunction, DepthBiasState, DepthStencilState, StencilState, TextureFormat};

use super::run::{Compared, Subject, Tally, compare};
use crate::crosscheck::{Destination, Device, Input, Job, Program, ReplayError, Sweep};
use crate::format::DepthFormat;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// Runs a depth unit: pattern number n is n * stride.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: TextureFormat,
    stride: u32,
    tally: &mut Tally,
) -> Result<(), ReplayError> {
    let state = MergerState {
        depth_stencil: Some(DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Always),
            stencil: StencilState::default(),
            bias: DepthBiasState::default(),
        }),
        ..MergerState::default()
    };
    let Some(kind) = DepthFormat::new(format).ok().and_then(DepthFormat::depth) else { return Ok(()) };
    let texels = (1_u64 << 32).div_ceil(u64::from(stride));
    let extent = Extent::new(2048, 2048)?;
    let each = extent.sample_total() as u64;
    let mut sweep = Sweep::new(device, Framebuffer::for_state(extent, &state)?)?;
    let input = Input::Number { stride, add: 0 };
    let fragments = sweep.program(Program { depth: Some(input), ..Program::default() }, &[])?;
    // Numbers beyond 2^32 wrap around.
    let first = |number: u64| u32::try_from((number * each) & u64::from(u32::MAX)).expect("masked");
    let jobs = (0..texels.div_ceil(each)).map(|number| Job {
        state: &state,
        fragments: &fragments,
        first: first(number),
        destination: Destination::LeftOver,
        unclipped_depth: false,
    });
    let mut totals = vec![Compared::default(); subjects.len()];
    let mut firsts: Vec<Option<String>> = vec![None; subjects.len()];
    sweep.run(jobs, |number, outcome| {
        let got = outcome.depth();
        let start = first(number as u64);
        let depth = |i: usize| input.value(start.wrapping_add(u32::try_from(i).unwrap_or(u32::MAX)), &[]);
        tally.texels += each;
        for (s, subject) in subjects.iter().enumerate() {
            let expected = |i| subject.model.depth_code(kind, depth(i), [0.0, 1.0]);
            let found = compare(got.len(), |i| got[i] == expected(i));
            totals[s].mismatches += found.mismatches;
            if let (None, Some(i)) = (&firsts[s], found.first) {
                totals[s].first = Some(i);
                let (z, expected) = (depth(i), expected(i));
                firsts[s] =
                    Some(format!("depth {z} (bits {:#x}): expected {expected:#x}, got {:#x}", z.to_bits(), got[i]));
            }
        }
        ControlFlow::Continue(())
    })?;
    tally.states += 1;
    for (s, found) in totals.into_iter().enumerate() {
        tally.add(s, found, |_| firsts[s].clone().unwrap_or_default());
    }
    Ok(())
}
