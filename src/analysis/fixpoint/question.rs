//! What is repeated: one fragment onto one channel of a normalised target.

use wgpu_types::{BlendFactor, BlendOperation, BlendState};

use crate::format::{ChannelKind, ColorFormat, FormatError, Rounding, TargetClass, srgb, unorm};
use crate::merger::blend::{blend, component};
use crate::model::exact::extended::Extended;
use crate::model::{Arithmetic, ColorInputs, NumericModel, Unsupported};

/// Which channel is followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    /// Red; green and blue go by the same equation.
    #[default]
    Color,
    /// Alpha.
    Alpha,
}

/// A fragment drawn again and again.
#[derive(Clone, Copy, Debug)]
pub struct Question {
    /// The target's format.
    pub format: ColorFormat,
    /// The blend state; `None` is blending off.
    pub blend: Option<BlendState>,
    /// The channel followed.
    pub channel: Channel,
    /// The shader's output in R, G and B.
    pub source: f32,
    /// The shader's output in A.
    pub alpha: f32,
    /// The blend constant, RGBA.
    pub constant: [f32; 4],
}

/// A question that makes no map of codes.
#[derive(Debug, thiserror::Error)]
pub enum FixpointError {
    /// Not a format.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// Not a normalised channel of at most 16 bits.
    #[error(
        "{0}: fixed points are followed on unsigned normalised targets (8, 10 or 16 bits, sRGB included); a float target \
         has no even steps to get stuck on"
    )]
    Class(&'static str),
    /// The format lacks the channel.
    #[error("{0} has no alpha channel; follow the color channel instead")]
    NoAlpha(&'static str),
    /// The channel's next code depends on another channel of the target.
    #[error(
        "the color equation reads the target's alpha (factor `{0}`), so a color code alone has no next code; follow the \
         alpha channel, or choose a state without that factor"
    )]
    DstAlpha(&'static str),
    /// A second source is asked for.
    #[error("factor `{0}` reads a second source, which this analysis does not have; use a factor of the first source")]
    SecondSource(&'static str),
    /// The start is not a code.
    #[error("code {code} does not exist in this channel; codes are 0 to {last}")]
    Code {
        /// The code asked for.
        code: u32,
        /// The largest code.
        last: u32,
    },
    /// The model does not cover the state.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
}

impl Question {
    /// Checks that the channel's next code depends on its code alone.
    ///
    /// # Errors
    /// [`FixpointError`], naming what is in the way.
    pub fn check(&self) -> Result<(), FixpointError> {
        if self.format.class() != TargetClass::Unorm {
            return Err(FixpointError::Class(self.format.name()));
        }
        if self.kind() == ChannelKind::Absent {
            return Err(FixpointError::NoAlpha(self.format.name()));
        }
        let Some(state) = self.blend else { return Ok(()) };
        let equation = component(&state, self.index());
        for factor in [equation.src_factor, equation.dst_factor] {
            use BlendFactor as F;
            let name = crate::state::spelling::factor_name(factor);
            match factor {
                F::Src1 | F::OneMinusSrc1 | F::Src1Alpha | F::OneMinusSrc1Alpha => {
                    return Err(FixpointError::SecondSource(name));
                }
                F::DstAlpha | F::OneMinusDstAlpha | F::SrcAlphaSaturated
                    if self.channel == Channel::Color && self.format.channels()[3] != ChannelKind::Absent =>
                {
                    return Err(FixpointError::DstAlpha(name));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Index of the channel.
    pub(super) fn index(&self) -> usize {
        match self.channel {
            Channel::Color => 0,
            Channel::Alpha => 3,
        }
    }

    /// Kind of the channel.
    pub(super) fn kind(&self) -> ChannelKind {
        self.format.channels()[self.index()]
    }

    /// The largest code of the channel.
    #[must_use]
    pub fn last_code(&self) -> u32 {
        unorm::steps(self.kind().bits().max(1))
    }

    /// One frame on a target whose channels all hold `code`.
    #[must_use]
    pub fn inputs(&self, code: u32) -> ColorInputs {
        let channels = self.format.channels();
        let dst = std::array::from_fn(|i| if channels[i] == self.kind() { code } else { 0 });
        let src = [self.source, self.source, self.source, self.alpha];
        ColorInputs { format: self.format, blend: self.blend, constant: self.constant, src, src1: [0.0; 4], dst }
    }

    /// The code after one more frame.
    #[must_use]
    pub fn next(&self, model: &dyn NumericModel, code: u32) -> u32 {
        model.merge_color(&self.inputs(code))[self.index()]
    }

    /// The map of codes to next codes.
    #[must_use]
    pub fn map(&self, model: &dyn NumericModel) -> Vec<u32> {
        (0..=self.last_code()).map(|code| self.next(model, code)).collect()
    }

    /// The code nearest to where real numbers would go: the fixed point A / (1 - B) of D' = A + B D, brought into range.
    ///
    /// `None` where the equation is not of that form (a factor reads the target, another operation, or B is 1).
    #[must_use]
    pub fn goal(&self) -> Option<u32> {
        use BlendFactor as F;
        let arithmetic = Extended::new(Rounding::NearestEven);
        let steps = blend(&arithmetic, &self.inputs(0));
        let i = self.index();
        let decimal = |x| arithmetic.describe(x).decimal;
        let (a, b) = match (&self.blend, &steps.equation) {
            (Some(state), Some(equation)) => {
                let c = component(state, i);
                let reads_target = |factor| {
                    matches!(factor, F::Dst | F::OneMinusDst | F::DstAlpha | F::OneMinusDstAlpha | F::SrcAlphaSaturated)
                };
                if c.operation != BlendOperation::Add || reads_target(c.src_factor) || reads_target(c.dst_factor) {
                    return None;
                }
                (decimal(&equation.terms[i].0), decimal(&equation.dst_factors[i]))
            }
            _ => (decimal(&steps.result[i]), 0.0),
        };
        if b >= 1.0 {
            return None;
        }
        let value = a / (1.0 - b);
        match self.kind() {
            ChannelKind::Srgb => srgb::encode(value),
            kind => Some(unorm::encode(value, kind.bits(), Rounding::NearestEven)),
        }
    }
}
