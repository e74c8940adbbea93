//! Error against run time: every model on representative formats, states, depths of stacks and inputs.
//!
//! [`survey`] draws the same fragments in every model and compares the final codes with those of `exact`; [`clock`]
//! times the merger and its row kernels; [`front`] marks the points that no other beats in both; [`fixed`] sweeps the fixed-point family. With the
//! feature `gpu`, `driver` adds a real output merger.

pub mod clock;
#[cfg(feature = "gpu")]
pub mod driver;
pub mod fixed;
pub mod front;
pub mod input;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use serde::Serialize;
use wgpu_types::BlendState;

use crate::format::{ChannelKind, Codes, ColorFormat};
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel};
use crate::report::difference::signed_distance;
use crate::state::shaderlab::Properties;
use crate::state::text;
use input::{Input, Inputs};

/// Formats of the survey: each kind of channel once.
pub const FORMATS: [&str; 6] =
    ["rgba8unorm", "rgba8unorm-srgb", "rgb10a2unorm", "rg11b10ufloat", "rgba16float", "rgba32float"];

/// States of the survey: a name, and the text that makes it.
pub const STATES: [(&str, &str); 5] = [
    ("straight over", "src-alpha one-minus-src-alpha"),
    ("premultiplied over", "one one-minus-src-alpha"),
    ("additive", "one one"),
    ("multiply", "dst zero"),
    ("separate alpha", "src-alpha one-minus-src-alpha one one-minus-src-alpha"),
];

/// How deep stacks are, and how many texels of each are drawn at full effort.
pub const LAYERS: [(u32, u32); 4] = [(1, 2048), (10, 512), (100, 96), (1000, 24)];

/// One model on one format, state, depth and input.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The numeric model.
    pub model: String,
    /// The format.
    pub format: &'static str,
    /// The state's name.
    pub state: &'static str,
    /// Layers drawn.
    pub layers: u32,
    /// The input.
    pub input: Input,
    /// The errors.
    #[serde(flatten)]
    pub errors: Errors,
}

/// Errors against `exact`, in codes of the target: integers stored, or representable numbers for floats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// The largest of a channel.
    pub max: f64,
    /// Mean magnitude.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Mean with sign: the bias; positive is too bright.
    pub bias: f64,
    /// Share of pixels with any channel other than `exact`'s, 0 to 1; for one layer, those not correctly rounded.
    pub pixels_off: f64,
    /// Pixels compared.
    pub pixels: u64,
}

/// Sums that make [`Errors`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    max: f64,
    magnitudes: f64,
    squares: f64,
    signed: f64,
    channels: f64,
    pixels: u64,
    pixels_off: u64,
}

impl Sums {
    /// Adds one pixel.
    pub(crate) fn add(&mut self, channels: [ChannelKind; 4], mine: Codes, exact: Codes) {
        let mut off = false;
        for i in (0..4).filter(|&i| channels[i] != ChannelKind::Absent) {
            let error = signed_distance(channels[i], mine[i], exact[i]);
            off |= error != 0.0;
            self.max = self.max.max(error.abs());
            self.magnitudes += error.abs();
            self.squares += error * error;
            self.signed += error;
            self.channels += 1.0;
        }
        self.pixels += 1;
        self.pixels_off += u64::from(off);
    }

    /// The means.
    pub(crate) fn errors(&self) -> Errors {
        let n = self.channels.max(1.0);
        #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
        let pixels_off = self.pixels_off as f64 / self.pixels.max(1) as f64;
        Errors {
            max: self.max,
            mean: self.magnitudes / n,
            rms: (self.squares / n).sqrt(),
            bias: self.signed / n,
            pixels_off,
            pixels: self.pixels,
        }
    }
}

/// What [`survey`] covers.
#[derive(Clone, Debug)]
pub struct Survey<'a> {
    /// The models; `exact` compares with itself.
    pub models: &'a [&'a dyn NumericModel],
    /// The inputs.
    pub inputs: &'a Inputs,
    /// The formats, by name; unknown ones are left out.
    pub formats: &'a [&'a str],
    /// Depths and texels, as [`LAYERS`].
    pub layers: &'a [(u32, u32)],
}

/// The state of one of [`STATES`]' texts.
///
/// # Panics
/// On another text that is no state.
#[must_use]
pub fn state(text: &str) -> BlendState {
    text::parse(text, &Properties::new()).ok().and_then(|block| block.blend[0]).expect("the survey's states parse")
}

/// Jobs of a survey: the number of calls of `done`.
#[must_use]
pub fn jobs(survey: &Survey<'_>) -> usize {
    survey.formats.len() * STATES.len() * survey.layers.len() * Input::ALL.len()
}

/// Draws everything in every model and compares with `exact`. `done` is called after each job, from any thread.
#[must_use]
pub fn survey(survey: &Survey<'_>, done: &(dyn Fn() + Sync)) -> Vec<Row> {
    let mut questions = Vec::new();
    for format in survey.formats.iter().filter_map(|name| ColorFormat::from_name(name).ok()) {
        for (name, text) in STATES {
            for &(layers, texels) in survey.layers {
                for input in Input::ALL {
                    questions.push((format, name, state(text), layers, texels, input));
                }
            }
        }
    }
    let answer =
        |(format, state, blend, layers, texels, input): &(ColorFormat, &'static str, BlendState, u32, u32, Input)| {
            let job = Job { format: *format, blend: *blend, layers: *layers, texels: *texels, input: *input };
            let rows = job.run(survey.models, survey.inputs).into_iter().map(|(model, errors)| Row {
                model,
                format: format.name(),
                state,
                layers: *layers,
                input: *input,
                errors,
            });
            let rows: Vec<Row> = rows.collect();
            done();
            rows
        };
    questions.par_iter().flat_map_iter(answer).collect()
}

/// One format, state, depth and input.
pub(crate) struct Job {
    pub(crate) format: ColorFormat,
    pub(crate) blend: BlendState,
    pub(crate) layers: u32,
    pub(crate) texels: u32,
    pub(crate) input: Input,
}

impl Job {
    /// The errors of every model that covers it.
    pub(crate) fn run(&self, models: &[&dyn NumericModel], inputs: &Inputs) -> Vec<(String, Errors)> {
        let exact = Exact::default();
        let covering: Vec<&dyn NumericModel> =
            models.iter().copied().filter(|model| model.supports(self.format, Some(&self.blend)).is_ok()).collect();
        let mut sums = vec![Sums::default(); covering.len()];
        for texel in 0..self.texels {
            let stack = inputs.stack(self.input, self.format, &self.blend, texel, self.layers);
            let truth = self.draw(&exact, &stack);
            for (sums, model) in sums.iter_mut().zip(&covering) {
                let mine = if model.name() == "exact" { truth } else { self.draw(*model, &stack) };
                sums.add(self.format.channels(), mine, truth);
            }
        }
        covering.iter().zip(&sums).map(|(model, sums)| (model.name(), sums.errors())).collect()
    }

    pub(crate) fn draw(&self, model: &dyn NumericModel, stack: &input::Stack) -> Codes {
        stack.layers.iter().fold(stack.dst, |dst, src| {
            model.merge_color(&ColorInputs {
                format: self.format,
                blend: Some(self.blend),
                constant: [0.0; 4],
                src: *src,
                src1: [0.0; 4],
                dst,
            })
        })
    }
}
