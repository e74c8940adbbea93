//! How a model arrives at its codes, step by step, with the numbers of every step.

use std::fmt;

use super::Number;
use crate::format::Codes;

/// What a step is about, in the order of the computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
#[cfg_attr(feature = "json", serde(rename_all = "kebab-case"))]
pub enum StepKind {
    /// The shader's output as the blender takes it in.
    Source,
    /// The second source, likewise.
    SecondSource,
    /// The blend constant, likewise.
    Constant,
    /// The stored texel, decoded.
    Destination,
    /// The source factor.
    SourceFactor,
    /// The destination factor.
    DestinationFactor,
    /// The source times its factor.
    SourceTerm,
    /// The destination times its factor.
    DestinationTerm,
    /// What the operation gives.
    Result,
    /// The result in the target's range; left out where nothing changes.
    Clamped,
    /// The result on the scale of the codes; normalised channels only.
    Scaled,
    /// The code.
    Stored,
}

impl fmt::Display for StepKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Source => "source",
            Self::SecondSource => "second source",
            Self::Constant => "blend constant",
            Self::Destination => "destination",
            Self::SourceFactor => "source factor",
            Self::DestinationFactor => "destination factor",
            Self::SourceTerm => "source term",
            Self::DestinationTerm => "destination term",
            Self::Result => "result",
            Self::Clamped => "clamped",
            Self::Scaled => "in codes",
            Self::Stored => "stored code",
        })
    }
}

/// One step on one channel.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct ChannelStep {
    /// The rule in symbols, e.g. `D Fd`.
    pub formula: String,
    /// The rule with numbers in place of symbols; empty where the formula has none to replace.
    pub substituted: String,
    /// What the rule gives in real arithmetic on the numbers of this model; `None` where that is the value.
    pub unrounded: Option<Number>,
    /// What the model gives.
    pub value: Number,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Step {
    /// What it is about.
    pub kind: StepKind,
    /// RGBA; `None` where the step does not apply to a channel.
    pub channels: [Option<ChannelStep>; 4],
}

/// How a model arrives at its codes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Explanation {
    /// The steps in order.
    pub steps: Vec<Step>,
    /// The resulting codes, all channels written.
    pub codes: Codes,
}

impl Explanation {
    /// One step of one channel; `None` where the model has no such step.
    #[must_use]
    pub fn step(&self, kind: StepKind, channel: usize) -> Option<&ChannelStep> {
        self.steps.iter().find(|step| step.kind == kind)?.channels[channel].as_ref()
    }

    /// The value of a step.
    #[must_use]
    pub fn value(&self, kind: StepKind, channel: usize) -> Option<&Number> {
        self.step(kind, channel).map(|step| &step.value)
    }
}
