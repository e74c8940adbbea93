//! Which numeric model is this? From samples of an unknown blender to the models that reproduce it.
//!
//! [`fit()`] ranks every candidate on given samples; [`interrogate()`] chooses the samples itself, each batch the one that
//! tells the remaining candidates apart best. Candidates are the [named models](crate::model::registry::NAMES) and a
//! [`family`] of fixed-point blenders. A blender that none of them reproduces is called that, with the best fits and
//! their mismatch rates.
//!
//! - [`question`]: inputs that look for trouble;
//! - [`mod@candidates`]: the models and the family;
//! - [`score`]: samples against candidates;
//! - [`mod@telling`]: questions that two models answer differently, found by search;
//! - [`mod@interrogate`]: the conversation.

pub mod candidates;
pub mod interrogate;
pub mod question;
pub mod score;
pub mod telling;

pub use candidates::{Candidate, candidates, family};
pub use interrogate::{Interrogation, Options, interrogate, propose};
pub use question::Questions;
pub use score::{Fit, fit};
pub use telling::telling;

use crate::format::Codes;
use crate::merger::write_mask;
use crate::model::{ColorInputs, NumericModel};
use crate::vectors::{VectorLine, same_codes};
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
    /// Whether a model stores the same; any NaN equals any NaN.
    #[must_use]
    pub fn is_reproduced_by(&self, model: &dyn NumericModel) -> bool {
        let expected = write_mask::select(self.mask, self.inputs.dst, model.merge_color(&self.inputs));
        same_codes(self.inputs.format, expected, self.got)
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
