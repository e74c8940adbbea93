//! A line of any kind: what reading, checking, filling in and recording have in common.

use serde::Deserialize;
use wgpu_types::BlendState;

use super::check::Mismatch;
use super::{DepthLine, DriverRecord, LayersLine, LineError, VectorLine, describe};
use crate::format::ColorFormat;
use crate::merger::write_mask;
use crate::model::{Agreement, NumericModel, Unsupported, agreement, agreement_of_layers};

/// The kinds of lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Kind {
    /// One draw onto a color target.
    Color,
    /// Depths against stored depth and stencil.
    Depth,
    /// Several draws onto a color target, one after the other.
    Layers,
}

/// A parsed line of any kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// No `kind`, or `"kind":"color"`.
    Color(VectorLine),
    /// `"kind":"depth"`.
    Depth(DepthLine),
    /// `"kind":"layers"`.
    Layers(LayersLine),
}

/// What one line of a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// `"kind":"driver"`: who recorded the lines that follow.
    Driver(DriverRecord),
    /// Texels.
    Line(Line),
}

impl Entry {
    /// Parses one line.
    ///
    /// # Errors
    /// [`LineError`], naming the member.
    pub fn parse(text: &str) -> Result<Self, LineError> {
        match serde_json::from_str::<Peek>(text)?.kind.as_deref() {
            Some("driver") => DriverRecord::parse(text).map(Self::Driver),
            _ => Line::parse(text).map(Self::Line),
        }
    }
}

#[derive(Deserialize)]
struct Peek {
    #[serde(default)]
    kind: Option<String>,
}

/// A line's result against a model's.
#[derive(Debug, Default)]
pub(super) struct Compared {
    /// Texels that differ.
    pub(super) different: usize,
    /// Texels whose result depends on the driver's history.
    pub(super) undecided: usize,
    /// The first that differs.
    pub(super) first: Option<Mismatch>,
}

impl Line {
    /// Parses one line.
    ///
    /// # Errors
    /// [`LineError`], naming the member.
    pub fn parse(text: &str) -> Result<Self, LineError> {
        let kind = serde_json::from_str::<Peek>(text)?.kind;
        match kind.as_deref() {
            None | Some("color") => VectorLine::parse(text).map(Self::Color),
            Some("depth") => DepthLine::parse(text).map(Self::Depth),
            Some("layers") => LayersLine::parse(text).map(Self::Layers),
            Some(other) => Err(LineError::Kind(other.to_owned())),
        }
    }

    /// The line as JSON, without a line break.
    #[must_use]
    pub fn to_json(&self) -> String {
        match self {
            Self::Color(line) => line.to_json(),
            Self::Depth(line) => line.to_json(),
            Self::Layers(line) => line.to_json(),
        }
    }

    /// Number of texels.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Color(line) => line.len(),
            Self::Depth(line) => line.len(),
            Self::Layers(line) => line.len(),
        }
    }

    /// Whether the line has no texels.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What counts are kept under: the format's name, after `layers ` for layers.
    #[must_use]
    pub fn group(&self) -> String {
        match self {
            Self::Color(line) => line.format.name().to_owned(),
            Self::Depth(line) => line.format.name().to_owned(),
            Self::Layers(line) => format!("layers {}", line.format.name()),
        }
    }

    /// Whether the model defines the line's result.
    ///
    /// # Errors
    /// [`Unsupported`], with the reason.
    pub fn supported(&self, model: &dyn NumericModel) -> Result<(), Unsupported> {
        match self {
            Self::Color(line) => model.supports(line.format, line.blend.as_ref()),
            Self::Depth(_) => Ok(()),
            Self::Layers(line) => {
                line.layers.iter().try_for_each(|layer| model.supports(line.format, layer.blend.as_ref()))
            }
        }
    }

    /// Blending off wherever the model does not define it.
    pub fn reduce_to(&mut self, model: &dyn NumericModel) {
        let reduce = |format: ColorFormat, blend: &mut Option<BlendState>, src1: &mut Option<Vec<[f32; 4]>>| {
            if model.supports(format, blend.as_ref()).is_err() {
                (*blend, *src1) = (None, None);
            }
        };
        match self {
            Self::Color(line) => reduce(line.format, &mut line.blend, &mut line.src1),
            Self::Depth(_) => {}
            Self::Layers(line) => {
                for layer in &mut line.layers {
                    reduce(line.format, &mut layer.blend, &mut layer.src1);
                }
            }
        }
    }

    /// Sets the results to the model's, which must [support](Self::supported) the line.
    pub fn fill(&mut self, model: &dyn NumericModel) {
        match self {
            Self::Color(line) => super::fill(model, line),
            Self::Depth(line) => line.fill(model),
            Self::Layers(line) => line.fill(model),
        }
    }

    /// Holds the line's result against the model; `None` when the line has none.
    pub(super) fn compare(&self, model: &dyn NumericModel, number: usize) -> Option<Compared> {
        let mut compared = Compared::default();
        let mut note = |agreement, mismatch: &dyn Fn() -> Mismatch| match agreement {
            Agreement::Same => {}
            Agreement::Undecided => compared.undecided += 1,
            Agreement::Different => {
                compared.different += 1;
                compared.first.get_or_insert_with(mismatch);
            }
        };
        let mismatch = |texel, state, inputs, expected, got| Mismatch {
            line: number,
            texel,
            texels: 0,
            of: self.len(),
            state,
            inputs,
            expected,
            got,
        };
        match self {
            Self::Color(line) => {
                let out = line.out.as_ref()?;
                for i in 0..line.len() {
                    let (inputs, got) = (line.inputs(i), line.codes(out, i));
                    note(agreement(model, &inputs, line.mask, got), &|| {
                        let state = describe::color_state(line.format, line.blend.as_ref(), line.mask);
                        let expected = write_mask::select(line.mask, inputs.dst, model.merge_color(&inputs));
                        let codes = (describe::codes(expected), describe::codes(got));
                        mismatch(i, state, describe::inputs(&inputs), codes.0, codes.1)
                    });
                }
            }
            Self::Depth(line) => {
                let out = line.out.as_ref()?;
                for i in 0..line.len() {
                    let (stored, passes) = line.run(model, i);
                    let passed = line.passed.as_ref().map_or(passes, |passed| passed[i]);
                    let result = |stored, passed| describe::depth_result(line.format, stored, passed);
                    note((stored == out[i] && passes == passed).into(), &|| {
                        let (state, inputs) = (describe::depth_state(line), describe::depth_inputs(line, i));
                        mismatch(i, state, inputs, result(stored, passes), result(out[i], passed))
                    });
                }
            }
            Self::Layers(line) => {
                let out = line.out.as_ref()?;
                for i in 0..line.len() {
                    let got = line.codes(out, i);
                    let draws = line.layers.iter().map(|draw| (|dst| draw.inputs(line.format, i, dst), draw.mask));
                    let agreement = agreement_of_layers(model, line.format, draws, line.codes(&line.dst, i), got);
                    note(agreement, &|| {
                        let (state, inputs) = (describe::layers_state(line), describe::layers_inputs(line, model, i));
                        mismatch(i, state, inputs, describe::codes(line.run(model, i)), describe::codes(got))
                    });
                }
            }
        }
        let different = compared.different;
        compared.first = compared.first.map(|first| Mismatch { texels: different, ..first });
        Some(compared)
    }
}
