//! A result that is not admitted, with its equation in numbers and the codes that are.

use wgpu_types::ColorWrites;

use super::{Class, Judge, Verdict};
use crate::format::{ChannelKind, Codes};
use crate::model::exact::Exact;
use crate::model::{ColorInputs, Explanation, NumericModel, StepKind};

/// How many admitted codes are listed before they become a range.
const LISTED: usize = 6;

impl Judge {
    /// The channels of `got` that are outside, in words: each with its equation in real arithmetic and the codes the
    /// narrowest and the widest class admit. Empty where nothing is outside.
    #[must_use]
    pub fn counterexample(&self, inputs: &ColorInputs, mask: ColorWrites, got: Codes) -> String {
        let judgement = self.judge(inputs, mask, got);
        let [exact, wide] = [Class::Exact, Class::Wide].map(|class| self.sets(inputs, class));
        let explanation = Exact::default().explain_color(inputs);
        let channels = (0..4).filter(|i| judgement.channels[*i] == Verdict::Outside).map(|i| {
            let kind = inputs.format.channels()[i];
            let name = ["red", "green", "blue", "alpha"][i];
            let stored = code(kind, got[i]);
            if mask.bits() >> i & 1 == 0 {
                return format!("{name} is masked and must keep {}, got {stored}", code(kind, inputs.dst[i]));
            }
            let codes = |set: &super::CodeSet| match set.len() {
                Some(n) if n <= LISTED as u64 => {
                    set.codes(kind, LISTED).into_iter().map(|c| code(kind, c)).collect::<Vec<_>>().join(", ")
                }
                Some(n) => format!("{n} codes from {}", code(kind, set.first(kind))),
                None => "any".to_owned(),
            };
            let equation = equation(&explanation, i);
            let admitted = format!("exact {}, at most {}", codes(&exact[i]), codes(&wide[i]));
            format!("{name}: {equation}; {} admits {admitted}; got {stored}", self.spec)
        });
        channels.collect::<Vec<_>>().join("; ")
    }
}

/// The channel's way to its code in one line.
fn equation(explanation: &Explanation, channel: usize) -> String {
    let shown =
        [StepKind::SourceTerm, StepKind::DestinationTerm, StepKind::Result, StepKind::Clamped, StepKind::Scaled];
    let line = |kind| {
        let step = explanation.step(kind, channel)?;
        let value = crate::model::decimal(step.value.decimal);
        let sides = [step.formula.as_str(), step.substituted.as_str(), value.as_str()];
        let mut line: Vec<&str> = sides.into_iter().filter(|side| !side.is_empty()).collect();
        line.dedup();
        Some(line.join(" = "))
    };
    let steps: Vec<String> = shown.into_iter().filter_map(line).collect();
    // With blending off nothing is computed.
    if steps.is_empty() { line(StepKind::Source).unwrap_or_default() } else { steps.join(", ") }
}

/// A code as readers know it: unorm as a number, floats by value.
fn code(kind: ChannelKind, code: u32) -> String {
    match kind {
        ChannelKind::Float(layout) => format!("{:?} ({code:#x})", layout.decode(code)),
        _ => code.to_string(),
    }
}
