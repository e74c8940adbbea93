//! Where a model's code comes from: every rounding on the way from the exact value to the code, in codes.
//!
//! The parts are found by running the equation in real arithmetic on more and more of the model's own numbers: its
//! operands, its factors, its terms, its result. Each part is what one more of them changes, so the parts add up.

use super::exact::extended::{Extended, Value};
use super::{Arithmetic, ColorInputs, Explanation, Number, StepKind};
use crate::format::{ChannelKind, FloatLayout, Rounding, snorm, srgb, unorm};
use crate::merger::blend::{Operands, component, equation, operation};

/// What a part of the difference is due to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
#[cfg_attr(feature = "json", serde(rename_all = "kebab-case"))]
pub enum Cause {
    /// Source, constant and destination, rounded as they are taken in.
    TakenIn,
    /// Factors, rounded.
    Factors,
    /// Products, rounded.
    Products,
    /// The operation, rounded; for fused rules all of the equation.
    Operation,
    /// The scaling to codes, rounded.
    Scaling,
    /// The store.
    Store,
}

impl Cause {
    /// In the order of the computation.
    pub const ALL: [Self; 6] =
        [Self::TakenIn, Self::Factors, Self::Products, Self::Operation, Self::Scaling, Self::Store];

    /// A short name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TakenIn => "taken in",
            Self::Factors => "factors",
            Self::Products => "products",
            Self::Operation => "sum",
            Self::Scaling => "scaling",
            Self::Store => "store",
        }
    }
}

/// One channel's way from the exact value to the code.
///
/// `exact` plus all `parts` is `stored`. Unit: one code; on float channels one unit in the last place at the exact
/// value; on sRGB channels a step between neighbouring codes, interpolated in between.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Account {
    /// The exact result, in units.
    pub exact: f64,
    /// What each cause adds, in the order of [`Cause::ALL`].
    pub parts: [f64; 6],
    /// The code stored, in units.
    pub stored: f64,
}

impl Account {
    /// What all roundings before the store add up to.
    #[must_use]
    pub fn before_store(&self) -> f64 {
        self.parts[..5].iter().sum()
    }
}

/// The account of one channel; `None` where a number on the way is not finite, or the format has no such channel.
///
/// `exact` is the explanation of [`super::exact::Exact`] for the same inputs.
#[must_use]
pub fn account(inputs: &ColorInputs, model: &Explanation, exact: &Explanation, channel: usize) -> Option<Account> {
    let kind = inputs.format.channels()[channel];
    let real = Real { arithmetic: Extended::new(Rounding::NearestEven), inputs, model, exact };
    let scale = Scale::new(kind, real.final_value(exact, channel)?)?;
    let start = scale.position(real.final_value(exact, channel)?);
    let mut at = start;
    let mut next = |value: Option<f64>| {
        // A step the model does not have changes nothing; what it would have changed shows in the next.
        let position = value.filter(|value| value.is_finite()).map_or(at, |value| scale.position(value));
        let part = tidy(position - at);
        at = position;
        part
    };
    let taken_in = next(real.on_operands(channel));
    let factors = next(real.on_factors(channel));
    let products = next(real.on_terms(channel));
    let operation = next(Some(real.final_value(model, channel)?));
    let scaling = match (kind, model.value(StepKind::Scaled, channel)) {
        (ChannelKind::Unorm(bits), Some(scaled)) => next(Some(scaled.decimal / f64::from(unorm::steps(bits)))),
        (ChannelKind::Snorm(bits), Some(scaled)) => next(Some(scaled.decimal / f64::from(snorm::steps(bits)))),
        _ => 0.0,
    };
    let store = next(Some(decode(kind, model.codes[channel])));
    Some(Account { exact: start, parts: [taken_in, factors, products, operation, scaling, store], stored: at })
}

/// The equation in real arithmetic, on some of a model's numbers.
struct Real<'a> {
    arithmetic: Extended,
    inputs: &'a ColorInputs,
    model: &'a Explanation,
    exact: &'a Explanation,
}

impl Real<'_> {
    /// The value a model stores, before scaling.
    fn final_value(&self, explanation: &Explanation, channel: usize) -> Option<f64> {
        let last = [StepKind::Clamped, StepKind::Result, StepKind::Source];
        let number = last.iter().find_map(|kind| explanation.value(*kind, channel))?;
        Some(self.clamped(&Value::from(number))).filter(|value| value.is_finite())
    }

    fn clamped(&self, value: &Value) -> f64 {
        self.arithmetic.describe(&self.arithmetic.clamp(value, self.inputs.format.class())).decimal
    }

    /// One operand of the model, all channels; exact where the model does not show it.
    fn operand(&self, kind: StepKind) -> [Value; 4] {
        std::array::from_fn(|i| {
            let number = self.model.value(kind, i).or_else(|| self.exact.value(kind, i));
            match (number, kind) {
                (Some(number), _) => Value::from(number),
                (None, StepKind::Destination) if i == 3 => Value::from(&Number::binary(1.0)),
                (None, _) => Value::from(&Number::binary(0.0)),
            }
        })
    }

    fn operands(&self) -> Operands<Value> {
        Operands {
            src: self.operand(StepKind::Source),
            src1: self.operand(StepKind::SecondSource),
            constant: self.operand(StepKind::Constant),
            dst: self.operand(StepKind::Destination),
        }
    }

    fn combine(&self, channel: usize, src: &Value, dst: &Value) -> Option<f64> {
        let operation = component(self.inputs.blend.as_ref()?, channel).operation;
        Some(self.clamped(&operation::apply(&self.arithmetic, operation, src, dst)))
    }

    /// Everything after the operands in real arithmetic.
    fn on_operands(&self, channel: usize) -> Option<f64> {
        let Some(state) = &self.inputs.blend else { return self.final_value(self.model, channel) };
        let equation = equation(&self.arithmetic, state, &self.operands(), self.inputs);
        let (src, dst) = &equation.terms[channel];
        self.combine(channel, src, dst)
    }

    /// Everything after the factors in real arithmetic.
    fn on_factors(&self, channel: usize) -> Option<f64> {
        let state = self.inputs.blend.as_ref()?;
        if operation::ignores_factors(component(state, channel).operation) {
            return None;
        }
        let operands = self.operands();
        let value = |kind| self.model.value(kind, channel).map(Value::from);
        let src = self.arithmetic.multiply(&operands.src[channel], &value(StepKind::SourceFactor)?);
        let dst = self.arithmetic.multiply(&operands.dst[channel], &value(StepKind::DestinationFactor)?);
        self.combine(channel, &src, &dst)
    }

    /// The operation alone in real arithmetic.
    fn on_terms(&self, channel: usize) -> Option<f64> {
        let value = |kind| self.model.value(kind, channel).map(Value::from);
        self.combine(channel, &value(StepKind::SourceTerm)?, &value(StepKind::DestinationTerm)?)
    }
}

/// Values to units of one code.
enum Scale {
    Linear(f64),
    Srgb,
}

impl Scale {
    fn new(kind: ChannelKind, exact: f64) -> Option<Self> {
        Some(match kind {
            ChannelKind::Absent => return None,
            ChannelKind::Unorm(bits) => Self::Linear(f64::from(unorm::steps(bits))),
            ChannelKind::Snorm(bits) => Self::Linear(f64::from(snorm::steps(bits))),
            ChannelKind::Srgb => Self::Srgb,
            ChannelKind::Float(layout) => Self::Linear(1.0 / unit_in_the_last_place(layout, exact)),
        })
    }

    fn position(&self, value: f64) -> f64 {
        match self {
            Self::Linear(steps) => value * steps,
            Self::Srgb => {
                // The last code at or below the value, and the way to the next.
                let mut code = 0;
                while code < 254 && srgb::decode(code + 1).value <= value {
                    code += 1;
                }
                let (low, high) = (srgb::decode(code).value, srgb::decode(code + 1).value);
                f64::from(code) + (value - low) / (high - low)
            }
        }
    }
}

/// The distance of neighbouring codes at a value.
fn unit_in_the_last_place(layout: FloatLayout, value: f64) -> f64 {
    let code = layout.encode(value.abs(), Rounding::TowardZero);
    let (here, next) = (layout.decode(code), layout.decode(code + 1));
    if next.is_finite() { next - here } else { here - layout.decode(code - 1) }
}

fn decode(kind: ChannelKind, code: u32) -> f64 {
    match kind {
        ChannelKind::Absent => 0.0,
        ChannelKind::Unorm(bits) => f64::from(code) / f64::from(unorm::steps(bits)),
        ChannelKind::Snorm(bits) => f64::from(snorm::signed_code(code, bits)) / f64::from(snorm::steps(bits)),
        ChannelKind::Srgb => srgb::decode(code).value,
        ChannelKind::Float(layout) => layout.decode(code),
    }
}

/// What is only the rounding of binary64 here counts as nothing.
fn tidy(x: f64) -> f64 {
    if x.abs() < 1e-9 { 0.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{ColorFormat, layout::FORMATS};
    use crate::model::registry;
    use wgpu_types::BlendState;

    fn inputs(format: &str, src: [f32; 4], dst: [f32; 4]) -> ColorInputs {
        let format = ColorFormat::from_name(format).expect("known");
        let store = ColorInputs { format, blend: None, constant: [0.0; 4], src: dst, src1: [0.0; 4], dst: [0; 4] };
        let dst = registry::by_name("exact").expect("known").merge_color(&store);
        ColorInputs { blend: Some(BlendState::ALPHA_BLENDING), src, dst, ..store }
    }

    fn of(model: &str, inputs: &ColorInputs, channel: usize) -> Account {
        let explain = |name: &str| registry::by_name(name).expect("known").explain_color(inputs);
        account(inputs, &explain(model), &explain("exact"), channel).expect("finite")
    }

    #[test]
    fn fade_at_one_half_over_mid_grey_loses_half_a_code_in_8_bits() {
        let inputs = inputs("rgba8unorm", [0.0, 0.0, 0.0, 0.5], [127.0 / 255.0; 4]);
        let exact = of("exact", &inputs, 0);
        assert_eq!((exact.exact, exact.before_store(), exact.stored), (63.5, 0.0, 64.0), "a tie, to even");
        let fixed = of("fixed:8", &inputs, 0);
        // 127 * 127 / 255 = 63 + 64/255.
        assert!((fixed.parts[0] + 0.5 - 64.0 / 255.0).abs() < 1e-9, "alpha becomes 128/255: {:?}", fixed.parts);
        assert!((fixed.parts[2] + 64.0 / 255.0).abs() < 1e-9, "the product is rounded: {:?}", fixed.parts);
        assert_eq!((fixed.parts[5], fixed.stored), (0.0, 63.0), "the store has nothing left to round");
    }

    #[test]
    fn parts_add_up_in_every_model_and_format() {
        for (name, _) in FORMATS {
            let inputs = inputs(name, [0.3, 0.9, 0.05, 0.4], [0.7, 0.2, 0.6, 0.5]);
            for model in registry::all() {
                if model.supports(inputs.format, inputs.blend.as_ref()).is_err() {
                    continue;
                }
                for channel in 0..4 {
                    if inputs.format.channels()[channel] == ChannelKind::Absent {
                        continue;
                    }
                    let account = of(&model.name(), &inputs, channel);
                    let sum = account.exact + account.parts.iter().sum::<f64>();
                    let near = (sum - account.stored).abs() <= 1e-6;
                    assert!(near, "{name}, {}, channel {channel}: {account:?}", model.name());
                    let total: f64 = account.parts.iter().map(|part| part.abs()).sum();
                    // Six roundings to 8 bits at the worst, of numbers at most twice the result; and the store's own.
                    let range = match inputs.format.channels()[channel] {
                        ChannelKind::Unorm(bits) => f64::from(unorm::steps(bits)),
                        _ => 2.0 * account.exact.abs(),
                    };
                    let reach = 20.0 + 6.0 / 510.0 * range;
                    assert!(total < reach, "{name}, {}, channel {channel}: {account:?}", model.name());
                }
            }
        }
    }
}
