//! The `exact` model: the equation in real arithmetic on the given inputs, one correct rounding at the store.
//!
//! Every finite `f32` input, every stored code, and infinities, NaN and signed zeros by IEEE 754's rules. The equation
//! is first run in [`bounded`] arithmetic: `f64` numbers with a proven bound on their error. Where that bound cannot
//! decide the rounding, the same equation is run again in [`extended`] arithmetic on [`real`] numbers, which knows every
//! number exactly and decides ties by algebra.

pub mod bounded;
pub mod extended;
pub mod real;

use wgpu_types::BlendState;

use super::{ColorInputs, Explanation, NumericModel, Unsupported, evaluate, explain};
use crate::format::depth::DepthKind;
use crate::format::{Codes, ColorFormat, Rounding};

use bounded::Bounded;
use extended::Extended;

/// The `exact` model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exact {
    /// How the one rounding goes; nearest even unless asked otherwise.
    pub rounding: Rounding,
}

impl Exact {
    /// The result by bounded `f64` arithmetic alone; `None` where it cannot decide a rounding or an input is not finite.
    #[must_use]
    pub fn merge_color_bounded(self, inputs: &ColorInputs) -> Option<Codes> {
        if !Bounded::covers(inputs) {
            return None;
        }
        let arithmetic = Bounded::new(self.rounding);
        let codes = evaluate(&arithmetic, inputs);
        (!arithmetic.in_doubt()).then_some(codes)
    }

    /// The result by exact arithmetic alone; slow, and equal to [`NumericModel::merge_color`] by construction of the
    /// bound (and by test).
    #[must_use]
    pub fn merge_color_rational(self, inputs: &ColorInputs) -> Codes {
        evaluate(&Extended::new(self.rounding), inputs)
    }
}

impl NumericModel for Exact {
    fn name(&self) -> String {
        match self.rounding {
            Rounding::NearestEven => "exact".to_owned(),
            Rounding::NearestAway => "exact:ties-away".to_owned(),
            Rounding::TowardZero => "exact:toward-zero".to_owned(),
        }
    }

    fn provenance(&self) -> String {
        "real arithmetic on the given inputs and one correct rounding; checked against an independent \
         arbitrary-precision evaluation"
            .to_owned()
    }

    fn supports(&self, _format: ColorFormat, _blend: Option<&BlendState>) -> Result<(), Unsupported> {
        Ok(())
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        self.merge_color_bounded(inputs).unwrap_or_else(|| self.merge_color_rational(inputs))
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        explain(&Extended::new(self.rounding), inputs)
    }

    fn float_rule(&self) -> Option<crate::kernel::FloatRule> {
        (self.rounding == Rounding::NearestEven).then_some(crate::kernel::FloatRule::Exact)
    }

    fn unorm8_rule(&self) -> Option<crate::kernel::Rule> {
        // Sums of 8-bit products are never ties, so that both ways to the nearest agree.
        (self.rounding != Rounding::TowardZero).then_some(crate::kernel::Rule::Exact)
    }

    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        kind.encode(z, range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu_types::{BlendComponent, BlendFactor, BlendOperation};

    /// Toward zero an sRGB code lies on the boundary of its own interval, which no enclosure can tell from it.
    #[test]
    fn toward_zero_keeps_the_srgb_codes_that_a_blend_keeps() {
        let keep = BlendComponent {
            src_factor: BlendFactor::Zero,
            dst_factor: BlendFactor::One,
            operation: BlendOperation::Add,
        };
        for code in (0..=255).step_by(15).chain([1, 11, 254]) {
            let inputs = ColorInputs {
                format: ColorFormat::from_name("rgba8unorm-srgb").expect("a format"),
                blend: Some(BlendState { color: keep, alpha: keep }),
                constant: [0.0; 4],
                src: [0.5; 4],
                src1: [0.0; 4],
                dst: [code; 4],
            };
            assert_eq!(Exact { rounding: Rounding::TowardZero }.merge_color(&inputs), [code; 4], "{code}");
        }
    }
}
