//! Unblended stores of `f32` bit patterns.
//!
//! Texel number n carries the patterns 4n to 4n + 3 (times the stride) in its channels; four rotations bring every
//! pattern to every channel.

use std::ops::ControlFlow;

use wgpu_types::ColorWrites;

use super::run::{Subject, Tally, compare, texel};
use super::spec::Bench;
use crate::crosscheck::{Destination, Device, Input, Job, Program, ReplayError, Sweep};
use crate::format::{Codes, ColorFormat};
use crate::model::{ColorInputs, same_codes};
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// The pattern in a channel is n * 4 * stride + offset * stride.
fn program(stride: u32, rotation: u32) -> Program {
    let channel =
        |i: u32| Input::Number { stride: stride.wrapping_mul(4), add: ((i + rotation) % 4).wrapping_mul(stride) };
    Program { outputs: vec![[0, 1, 2, 3].map(channel)], ..Program::default() }
}

/// Runs a store unit.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: ColorFormat,
    stride: u32,
    rotation: u32,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let state = MergerState::single(format.texture_format().into());
    // All patterns, four a texel.
    let texels = (1_u64 << 30).div_ceil(u64::from(stride));
    let extent = if texels >= 1 << 22 { Extent::new(2048, 2048)? } else { Extent::new(512, 512)? };
    let each = extent.sample_total() as u64;
    let mut sweep = Sweep::new(device, Framebuffer::for_state(extent, &state)?)?;
    let program = program(stride, rotation);
    let fragments = sweep.program(program.clone(), &[])?;
    let first = |number: u64| u32::try_from(number * each).expect("at most 2^30 texels");
    let jobs = (0..texels.div_ceil(each)).map(|number| Job {
        state: &state,
        fragments: &fragments,
        first: first(number),
        destination: Destination::LeftOver,
        unclipped_depth: false,
    });
    let mut compared = vec![super::run::Compared::default(); subjects.len()];
    let mut firsts: Vec<Option<String>> = vec![None; subjects.len()];
    sweep.run(jobs, |number, outcome| {
        let got = outcome.color(0);
        let start = first(number as u64);
        let source = |i: usize| -> [f32; 4] {
            let n = start.wrapping_add(u32::try_from(i).unwrap_or(u32::MAX));
            program.outputs[0].map(|input| input.value(n, &[]))
        };
        let inputs = |src| ColorInputs { format, blend: None, constant: [0.0; 4], src, src1: [0.0; 4], dst: [0; 4] };
        // The last job may go on past the end; its texels wrap around to patterns seen before.
        tally.texels += each;
        for (s, subject) in subjects.iter().enumerate() {
            let expected: Box<dyn Fn(usize) -> Codes + Sync> = match &subject.llvmpipe {
                Some(model) => Box::new(|i| model.store(format, source(i))),
                None if stride == 1 && !subject.exhaustive => {
                    let reason = "too slow for all 2^32 stores; compared at the other levels";
                    tally.models[s].not_run = Some(reason.to_owned());
                    continue;
                }
                None => Box::new(|i| subject.model.merge_color(&inputs(source(i)))),
            };
            if let Err(reason) = subject.model.supports(format, None) {
                tally.models[s].not_run = Some(reason.reason.to_owned());
                continue;
            }
            let found = compare(got.len() / format.bytes_per_texel(), |i| {
                same_codes(format, texel(format, got, i), expected(i))
            });
            compared[s].mismatches += found.mismatches;
            if let (None, Some(i)) = (&firsts[s], found.first) {
                let bits = source(i).map(f32::to_bits);
                let got = texel(format, got, i);
                compared[s].first = Some(i);
                firsts[s] = Some(format!(
                    "store of {:?} (bits {bits:x?}): expected {:x?}, got {got:x?}",
                    source(i),
                    expected(i)
                ));
            }
        }
        for bench in &mut tally.benches {
            if stride == 1 {
                bench.leave_out("too slow for all 2^32 stores; judged at the other levels");
                continue;
            }
            let judge = bench.judge;
            let verdict = |i| judge.judge(&inputs(source(i)), ColorWrites::ALL, texel(format, got, i)).verdict;
            bench.hear(got.len() / format.bytes_per_texel(), verdict, |i| {
                let why = judge.counterexample(&inputs(source(i)), ColorWrites::ALL, texel(format, got, i));
                format!("store of {:?}: {why}", source(i))
            });
        }
        ControlFlow::Continue(())
    })?;
    tally.benches.iter_mut().for_each(Bench::close);
    tally.states += 1;
    for (s, found) in compared.into_iter().enumerate() {
        if tally.models[s].not_run.is_none() {
            tally.add(s, found, |_| firsts[s].clone().unwrap_or_default());
        }
    }
    Ok(())
}
