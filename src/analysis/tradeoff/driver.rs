//! A real driver as one more point: the same stacks drawn by its output merger.

use std::ops::ControlFlow;
use std::time::Instant;

use wgpu_types::{BlendState, ColorWrites};

use super::clock::Time;
use super::input::{Input, Stack};
use super::{Row, STATES, Sums, Survey, state};
use crate::crosscheck::{Destination, Device, Job, ReplayError, Sources, Sweep, vector};
use crate::format::ColorFormat;
use crate::model::exact::Exact;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};
use crate::vectors::{ColorDraw, LayersLine, Line};

/// Side of the square target that is timed.
const SIDE: u32 = 512;
/// Draws that are timed.
const DRAWS: u32 = 32;

/// The adapter's name, as points have it.
#[must_use]
pub fn name(device: &Device) -> String {
    let report = device.report().to_string();
    let name = report.split(['(', '[']).next().unwrap_or_default().trim();
    format!("driver {name}")
}

/// Errors of the driver's results against `exact`, for every format it blends. `done` is called after each stack.
///
/// # Errors
/// [`ReplayError`].
pub fn survey(device: &Device, survey: &Survey<'_>, done: &dyn Fn()) -> Result<Vec<Row>, ReplayError> {
    let mut rows = Vec::new();
    for format in formats(device, survey.formats) {
        for (name, text) in STATES {
            for &(layers, texels) in survey.layers {
                for input in Input::ALL {
                    let blend = state(text);
                    let stacks: Vec<Stack> =
                        (0..texels).map(|texel| survey.inputs.stack(input, format, &blend, texel, layers)).collect();
                    let errors = errors(device, format, blend, &stacks)?;
                    rows.push(Row {
                        model: self::name(device),
                        format: format.name(),
                        state: name,
                        layers,
                        input,
                        errors,
                    });
                    done();
                }
            }
        }
    }
    Ok(rows)
}

fn formats(device: &Device, names: &[&str]) -> Vec<ColorFormat> {
    let known = names.iter().filter_map(|name| ColorFormat::from_name(name).ok());
    known.filter(|format| device.renders(format.texture_format()) && device.blends(*format)).collect()
}

fn errors(
    device: &Device,
    format: ColorFormat,
    blend: BlendState,
    stacks: &[Stack],
) -> Result<super::Errors, ReplayError> {
    let each = format.bytes_per_texel();
    let mut dst = vec![0; stacks.len() * each];
    stacks.iter().zip(dst.chunks_exact_mut(each)).for_each(|(stack, texel)| format.pack(stack.dst, texel));
    let draw = |layer: usize| ColorDraw {
        blend: Some(blend),
        mask: ColorWrites::ALL,
        constant: [0.0; 4],
        src: stacks.iter().map(|stack| stack.layers[layer]).collect(),
        src1: None,
    };
    let layers = (0..stacks.first().map_or(0, |stack| stack.layers.len())).map(draw).collect();
    let mut line = Line::Layers(LayersLine { format, layers, dst, out: None });
    vector::record(device, &mut line)?;
    let Line::Layers(LayersLine { out: Some(out), .. }) = line else { return Ok(super::Errors::default()) };
    let job = super::Job { format, blend, layers: 0, texels: 0, input: Input::Random };
    let mut sums = Sums::default();
    for (stack, texel) in stacks.iter().zip(out.chunks_exact(each)) {
        sums.add(format.channels(), format.unpack(texel), job.draw(&Exact::default(), stack));
    }
    Ok(sums.errors())
}

/// Nanoseconds a fragment through the driver: draws over a whole target, fragments already uploaded, each result read
/// back.
///
/// # Errors
/// [`ReplayError`].
pub fn times(device: &Device, what: &Survey<'_>) -> Result<Vec<Time>, ReplayError> {
    let mut times = Vec::new();
    for format in formats(device, what.formats) {
        let blend = |text| state(text);
        for (name, text) in STATES {
            let target = wgpu_types::ColorTargetState {
                format: format.texture_format(),
                blend: Some(blend(text)),
                write_mask: ColorWrites::ALL,
            };
            let state = MergerState::single(target);
            let initial = Framebuffer::for_state(Extent::new(SIDE, SIDE)?, &state)?;
            let mut sweep = Sweep::new(device, initial)?;
            let colors = (0..SIDE * SIDE)
                .map(|texel| what.inputs.stack(Input::Random, format, &blend(text), texel % 4096, 1).layers[0]);
            let sources = Sources { outputs: vec![colors.collect()], ..Sources::default() };
            let fragments = sweep.upload(&sources)?;
            let job = || Job {
                state: &state,
                fragments: &fragments,
                first: 0,
                destination: Destination::LeftOver,
                unclipped_depth: false,
            };
            // The first draw builds the pipeline.
            sweep.run([job()], |_, _| ControlFlow::Continue(()))?;
            let started = Instant::now();
            sweep.run((0..DRAWS).map(|_| job()), |_, _| ControlFlow::Continue(()))?;
            let ns = started.elapsed().as_secs_f64() * 1e9 / f64::from(DRAWS * SIDE * SIDE);
            times.push(Time {
                model: self::name(device),
                format: format.name(),
                state: name,
                ns_per_fragment: ns,
                kernel_ns_per_fragment: None,
            });
        }
    }
    Ok(times)
}
