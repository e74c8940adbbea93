//! How long a fragment takes in the reference merger, stages and target memory included.

use std::time::Instant;

use serde::Serialize;
use wgpu_types::BlendState;

use super::input::{Input, Inputs};
use super::{STATES, state};
use crate::format::ColorFormat;
use crate::fragment::Fragment;
use crate::merger::{Merger, MergerError};
use crate::model::NumericModel;
use crate::state::block::StateBlock;
use crate::target::{Extent, Framebuffer};

/// One model on one format and state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Time {
    /// The numeric model.
    pub model: String,
    /// The format.
    pub format: &'static str,
    /// The state's name.
    pub state: &'static str,
    /// Nanoseconds a fragment, the fastest of several runs.
    pub ns_per_fragment: f64,
}

/// Side of the square target.
const SIDE: u32 = 32;

/// Runs; the fastest counts, as the others were disturbed.
const RUNS: u32 = 5;

/// Times every model on every format and state, one after the other on this thread.
///
/// # Errors
/// [`MergerError`] if a target cannot be made for a state, which the survey's always can.
pub fn times(models: &[&dyn NumericModel], formats: &[&str], inputs: &Inputs) -> Result<Vec<Time>, MergerError> {
    let mut times = Vec::new();
    for format in formats.iter().filter_map(|name| ColorFormat::from_name(name).ok()) {
        for (name, text) in STATES {
            let blend = state(text);
            for model in models.iter().filter(|model| model.supports(format, Some(&blend)).is_ok()) {
                let ns_per_fragment = time(*model, format, blend, inputs)?;
                times.push(Time { model: model.name(), format: format.name(), state: name, ns_per_fragment });
            }
        }
    }
    Ok(times)
}

/// Nanoseconds a fragment of one model on one format and state; random fragments.
///
/// # Errors
/// As [`times`].
///
/// # Panics
/// When there is no memory for a few texels.
pub fn time(
    model: &dyn NumericModel,
    format: ColorFormat,
    blend: BlendState,
    inputs: &Inputs,
) -> Result<f64, MergerError> {
    let state = StateBlock::with_blend(Some(blend)).to_merger_state(&[format.texture_format()], None);
    let extent = Extent::new(SIDE, SIDE).expect("a small extent");
    let mut targets = Framebuffer::for_state(extent, &state).expect("memory for a few texels");
    let merger = Merger::new(&state, model, &targets)?;
    let texels = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let stacks: Vec<_> = texels().map(|(x, y)| inputs.stack(Input::Random, format, &blend, y * SIDE + x, 1)).collect();
    let mut fastest = f64::INFINITY;
    for _ in 0..RUNS {
        if let Some(Some(target)) = targets.colors.first_mut() {
            texels().zip(&stacks).for_each(|((x, y), stack)| target.set_codes(x, y, 0, stack.dst));
        }
        let started = Instant::now();
        for ((x, y), stack) in texels().zip(&stacks) {
            merger.merge(&Fragment::new(stack.layers[0]), x, y, &mut targets);
        }
        fastest = fastest.min(started.elapsed().as_secs_f64());
    }
    Ok(fastest * 1e9 / f64::from(SIDE * SIDE))
}
