//! Blend states on random and special inputs.

use std::ops::ControlFlow;

use wgpu_types::{BlendState, ColorTargetState, ColorWrites};

use super::level::{States, component_name, equal_states};
use super::run::{Subject, Tally, compare, texel};
use crate::crosscheck::{Destination, Device, Job, ReplayError, Sources, Sweep};
use crate::format::ColorFormat;
use crate::merger::write_mask;
use crate::model::{ColorInputs, agreement};
use crate::state::{MergerState, reads_second_source};
use crate::target::{Extent, Framebuffer};
use crate::vectors::{Generator, VectorLine};

/// The extent that holds this many texels, rows of at least 256.
fn extent(texels: u32) -> Result<Extent, ReplayError> {
    let width = if texels >= 1 << 20 { 2048 } else { 256 };
    Ok(Extent::new(width, texels.div_ceil(width).max(1))?)
}

/// Runs a unit's states.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: ColorFormat,
    states: States,
    texels: u32,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let extent = extent(texels)?;
    // States with a second source, on a device without one.
    let mut left_out = 0_u64;
    match states {
        States::Random { seed, count } => {
            for i in 0..u64::from(count) {
                let mut line = Generator::new(seed << 32 | i).line(format, extent.sample_total());
                if !device.blends(format) {
                    (line.blend, line.src1) = (None, None);
                }
                if line.src1.is_some() && !device.has_second_source() {
                    left_out += 1;
                    continue;
                }
                let states = [(line.blend, line.mask, line.constant)];
                run_states(device, subjects, &line, &states, tally)?;
            }
        }
        States::Equal { factor: src_factor, part } => {
            let mut generator = Generator::new(0x5eed + u64::from(part));
            let mut line = generator.line(format, extent.sample_total());
            line.src1 = None;
            if device.has_second_source() {
                line.src1 = Some((0..line.len()).map(|_| std::array::from_fn(|_| generator.input(format))).collect());
            }
            let constant = |generator: &mut Generator| std::array::from_fn(|_| generator.input(format));
            let states: Vec<_> = equal_states(src_factor)
                .into_iter()
                .map(|state| (Some(state), ColorWrites::ALL, constant(&mut generator)))
                .filter(|(state, ..)| {
                    let kept = device.has_second_source() || !state.is_some_and(|state| reads_second_source(&state));
                    left_out += u64::from(!kept);
                    kept
                })
                .collect();
            if !states.is_empty() {
                run_states(device, subjects, &line, &states, tally)?;
            }
        }
    }
    if left_out > 0 {
        tally.left_out = Some(format!("{left_out} states with a second source, which the adapter lacks"));
    }
    Ok(())
}

/// Runs several states on one line's inputs.
pub(super) fn run_states(
    device: &Device,
    subjects: &[Subject],
    line: &VectorLine,
    states: &[(Option<BlendState>, ColorWrites, [f32; 4])],
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let format = line.format;
    let texels = u32::try_from(line.len()).expect("units have at most 2^22 texels");
    let merger_state = |(blend, write_mask, constant): &(Option<BlendState>, ColorWrites, [f32; 4])| {
        let target = ColorTargetState { format: format.texture_format(), blend: *blend, write_mask: *write_mask };
        let mut state = MergerState::single(target);
        state.dynamic.blend_constant = *constant;
        state
    };
    let merger_states: Vec<MergerState> = states.iter().map(merger_state).collect();
    let mut destination = Framebuffer::for_state(extent(texels)?, &merger_states[0])?;
    if let Some(Some(target)) = destination.colors.first_mut() {
        target.bytes_mut().copy_from_slice(&line.dst);
    }
    let mut sweep = Sweep::new(device, destination)?;
    let sources = Sources { outputs: vec![line.src.clone()], second_source: line.src1.clone(), ..Sources::default() };
    let fragments = sweep.upload(&sources)?;
    let jobs = merger_states.iter().map(|state| Job {
        state,
        fragments: &fragments,
        first: 0,
        destination: Destination::Restored,
        unclipped_depth: false,
    });
    sweep.run(jobs, |number, outcome| {
        let (blend, mask, constant) = states[number];
        let got = outcome.color(0);
        let inputs = |i| ColorInputs { blend, constant, ..line.inputs(i) };
        tally.texels += line.len() as u64;
        tally.states += 1;
        for (s, subject) in subjects.iter().enumerate() {
            let model = subject.model.as_ref();
            if let Err(reason) = model.supports(format, blend.as_ref()) {
                tally.models[s].not_run.get_or_insert_with(|| reason.reason.to_owned());
                continue;
            }
            let expected = |i| {
                let inputs: ColorInputs = inputs(i);
                write_mask::select(mask, inputs.dst, model.merge_color(&inputs))
            };
            let compared = compare(line.len(), |i| agreement(model, &inputs(i), mask, texel(format, got, i)));
            tally.add(s, compared, |i| {
                let (expected, got) = (expected(i), texel(format, got, i));
                format!("{}: expected {expected:x?}, got {got:x?}", describe(blend, mask, &inputs(i)))
            });
        }
        for bench in &mut tally.benches {
            let judge = bench.judge;
            let verdict = |i| judge.judge(&inputs(i), mask, texel(format, got, i)).verdict;
            bench.hear(line.len(), verdict, |i| {
                let inputs: ColorInputs = inputs(i);
                let why = judge.counterexample(&inputs, mask, texel(format, got, i));
                format!("{}: {why}", describe(blend, mask, &inputs))
            });
            bench.close();
        }
        ControlFlow::Continue(())
    })
}

/// A state and a fragment in words.
fn describe(blend: Option<BlendState>, mask: ColorWrites, inputs: &ColorInputs) -> String {
    let state = blend.map_or("blending off".to_owned(), |b| {
        format!("color {}, alpha {}", component_name(&b.color), component_name(&b.alpha))
    });
    format!(
        "{state}, mask {}, constant {:?}: source {:?}, second source {:?}, stored {:x?}",
        mask.bits(),
        inputs.constant,
        inputs.src,
        inputs.src1,
        inputs.dst
    )
}
