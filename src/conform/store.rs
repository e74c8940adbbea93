//! Unblended stores of `f32` bit patterns.
//!
//! Texel number n carries the patterns 4n to 4n + 3 (times the stride) in its channels; four rotations bring every
//! pattern to every channel.

use std::ops::ControlFlow;

use super::run::{Subject, Tally, compare, same_codes, texel};
use crate::crosscheck::{Destination, Device, Input, Job, Program, ReplayError, Sweep};
use crate::format::{Codes, ColorFormat};
use crate::model::ColorInputs;
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
    tally: &mut Tally,
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
    let channels = format.channels();
    let mut compared = vec![super::run::Compared::default(); subjects.len()];
    let mut firsts: Vec<Option<String>> = vec![None; subjects.len()];
    sweep.run(jobs, |number, outcome| {
        let got = outcome.color(0);
        let start = first(number as u64);
        // The last job may go on past the end; its texels wrap around to patterns seen before.
        tally.texels += each;
        for (s, subject) in subjects.iter().enumerate() {
            let source = |i: usize| -> [f32; 4] {
                let n = start.wrapping_add(u32::try_from(i).unwrap_or(u32::MAX));
                program.outputs[0].map(|input| input.value(n, &[]))
            };
            let expected: Box<dyn Fn(usize) -> Codes + Sync> = match subject.llvmpipe {
                Some(model) => Box::new(move |i| model.store(format, source(i))),
                None if stride == 1 && !subject.exhaustive => {
                    let reason = "too slow for all 2^32 stores; compared at the other levels";
                    tally.models[s].not_run = Some(reason.to_owned());
                    continue;
                }
                None => Box::new(move |i| {
                    let zeros = [0.0; 4];
                    let src = source(i);
                    let inputs = ColorInputs { format, blend: None, constant: zeros, src, src1: zeros, dst: [0; 4] };
                    subject.model.merge_color(&inputs)
                }),
            };
            if let Err(reason) = subject.model.supports(format, None) {
                tally.models[s].not_run = Some(reason.reason.to_owned());
                continue;
            }
            let found = compare(got.len() / format.bytes_per_texel(), |i| {
                same_codes(channels, texel(format, got, i), expected(i))
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
        ControlFlow::Continue(())
    })?;
    tally.states += 1;
    for (s, found) in compared.into_iter().enumerate() {
        if tally.models[s].not_run.is_none() {
            tally.add(s, found, |_| firsts[s].clone().unwrap_or_default());
        }
    }
    Ok(())
}
