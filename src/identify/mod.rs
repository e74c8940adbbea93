//! Which numeric model is this? From samples of an unknown blender to the models that reproduce it.
//!
//! [`fit()`] ranks every candidate on given samples; [`interrogate()`] chooses the samples itself, each batch the one that
//! tells the remaining candidates apart best, and [`examine()`] holds those that are left against many more states and all
//! formats. Candidates are the named models, every generation of the modelled drivers among them, and a [`family`] of
//! fixed-point blenders. A blender that none of them reproduces is called that, with the best fits and their mismatch rates.
//!
//! A verdict claims no more than was asked: it names the formats, states and numbers that it rests on.
//!
//! - [`question`]: inputs that look for trouble;
//! - [`mod@candidates`]: the models and the family;
//! - [`clears`]: colors to clear to;
//! - [`score`]: samples against candidates;
//! - [`mod@telling`]: questions that two models answer differently, found by search;
//! - [`mod@interrogate`]: the conversation on one format;
//! - [`mod@examine`]: the conversation on all of them, and what the verdict rests on.

pub mod candidates;
pub mod clears;
pub mod examine;
pub mod interrogate;
pub mod question;
pub mod score;
pub mod telling;

pub use candidates::{Candidate, candidates, family};
pub use examine::{Blender, Examination, Question, examine};
pub use interrogate::{Interrogation, Options, interrogate, propose};
pub use question::Questions;
pub use score::{Fit, fit};
pub use telling::telling;

use crate::format::Codes;
use crate::model::{Agreement, ColorInputs, NumericModel, agreement};
use crate::vectors::VectorLine;
use wgpu_types::ColorWrites;

/// What a blender stored for one texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// What it was given.
    pub inputs: ColorInputs,
    /// The write mask.
    pub mask: ColorWrites,
    /// The codes it left, RGBA.
    pub got: Codes,
}

impl Sample {
    /// How the sample relates to what a model stores; any NaN equals any NaN.
    #[must_use]
    pub fn agreement(&self, model: &dyn NumericModel) -> Agreement {
        agreement(model, &self.inputs, self.mask, self.got)
    }

    /// Whether a model may have stored this.
    #[must_use]
    pub fn is_possible_for(&self, model: &dyn NumericModel) -> bool {
        self.agreement(model) != Agreement::Different
    }

    /// The texels of a vector line with results; `None` where it has none.
    #[must_use]
    pub fn from_line(line: &VectorLine) -> Option<Vec<Self>> {
        let out = line.out.as_ref()?;
        let each = line.format.bytes_per_texel();
        let sample = |i: usize| Self {
            inputs: line.inputs(i),
            mask: line.mask,
            got: line.format.unpack(&out[i * each..(i + 1) * each]),
        };
        Some((0..line.len()).map(sample).collect())
    }
}
