//! How long a fragment takes: in the reference merger, stages and target memory included, and in the row kernel where
//! the model has one for the format.

use std::time::Instant;

use serde::Serialize;
use wgpu_types::{BlendState, ColorTargetState, ColorWrites};

use super::input::{Input, Inputs};
use super::{STATES, state};
use crate::format::ColorFormat;
use crate::fragment::Fragment;
use crate::kernel::Kernel;
use crate::merger::{Merger, MergerError};
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel};
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
    /// Nanoseconds a fragment in the reference merger, the fastest of several runs.
    pub ns_per_fragment: f64,
    /// The same in the row kernel, sources as codes or halves; `None` where there is none, and the reference runs.
    pub kernel_ns_per_fragment: Option<f64>,
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
                let kernel_ns_per_fragment = kernel_time(*model, format, blend, inputs);
                let (model, format) = (model.name(), format.name());
                times.push(Time { model, format, state: name, ns_per_fragment, kernel_ns_per_fragment });
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

/// Texels of a row that is timed: they stay in the nearest caches, so that this is the arithmetic.
const ROW: u32 = 4096;

/// Nanoseconds a fragment of the row kernel on random sources of its width; `None` where the model has none for the format.
fn kernel_time(model: &dyn NumericModel, format: ColorFormat, blend: BlendState, inputs: &Inputs) -> Option<f64> {
    let target = ColorTargetState { format: format.texture_format(), blend: Some(blend), write_mask: ColorWrites::ALL };
    let kernel = Kernel::new(&target, [0.0; 4], model)?;
    let unblended = |src| ColorInputs { format, blend: None, constant: [0.0; 4], src, src1: [0.0; 4], dst: [0; 4] };
    let texel = kernel.texel();
    let (mut src, mut before) = (vec![0; texel * ROW as usize], vec![0; texel * ROW as usize]);
    for (i, (src, dst)) in (0..).zip(src.chunks_exact_mut(texel).zip(before.chunks_exact_mut(texel))) {
        let stack = inputs.stack(Input::Random, format, &blend, i, 1);
        format.pack(Exact::default().merge_color(&unblended(stack.layers[0])), src);
        format.pack(stack.dst, dst);
    }
    let mut fastest = f64::INFINITY;
    for _ in 0..20 * RUNS {
        let mut dst = before.clone();
        let started = Instant::now();
        kernel.merge_row(&src, None, None, &mut dst);
        fastest = fastest.min(started.elapsed().as_secs_f64());
        std::hint::black_box(&dst);
    }
    Some(fastest * 1e9 / f64::from(ROW))
}
