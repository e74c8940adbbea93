//! Fragment depth of `f32` bit patterns, converted and stored by the depth stage.

use std::ops::ControlFlow;

use wgpu_types::{CompareFunction, DepthBiasState, DepthStencilState, StencilState, TextureFormat};

use super::run::{Compared, Subject, Tally, compare};
use super::spec::Bench;
use crate::admissible::{Api, DepthStencilCase, channel_kind, depth_codes, judge_depth_stencil};
use crate::crosscheck::{Destination, Device, Input, Job, Program, ReplayError, Sweep};
use crate::format::DepthFormat;
use crate::merger::depth_stencil::DepthStencil;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// Runs a depth unit: pattern number n is n * stride.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: TextureFormat,
    stride: u32,
    tally: &mut Tally<'_>,
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
    let Ok(depth_format) = DepthFormat::new(format) else { return Ok(()) };
    let Some(kind) = depth_format.depth() else { return Ok(()) };
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
        for bench in &mut tally.benches {
            if stride == 1 {
                bench.leave_out("too slow for all 2^32 depths; judged at the other levels");
                continue;
            }
            let judge = bench.judge;
            let case = |i: usize| DepthStencilCase {
                state: state.depth_stencil.as_ref().expect("set above"),
                format: depth_format,
                front_facing: true,
                reference: 0,
                z: depth(i),
                range: [0.0, 1.0],
                // Any: the test always passes.
                stored: DepthStencil { depth: 0, stencil: 0 },
            };
            let verdict = |i: usize| judge_depth_stencil(judge, &case(i), DepthStencil { depth: got[i], stencil: 0 });
            bench.hear(got.len(), verdict, |i| {
                let codes = |api: &Api| depth_codes(*api, kind, depth(i), [0.0, 1.0]).codes(channel_kind(kind), 4);
                let admitted: Vec<Vec<u32>> = judge.spec.apis().iter().map(codes).collect();
                format!(
                    "depth {} (bits {:#x}): admitted {admitted:x?}, got {:#x}",
                    depth(i),
                    depth(i).to_bits(),
                    got[i]
                )
            });
        }
        ControlFlow::Continue(())
    })?;
    tally.benches.iter_mut().for_each(Bench::close);
    tally.states += 1;
    for (s, found) in totals.into_iter().enumerate() {
        tally.add(s, found, |_| firsts[s].clone().unwrap_or_default());
    }
    Ok(())
}
