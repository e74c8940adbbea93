//! `one-zero`: a destination factor of zero is no switch-off on float targets.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, BlendState};

use super::merge;
use crate::format::{ChannelKind, Codes, ColorFormat, TargetClass};
use crate::lint::{Example, Finding, Rule, StateQuestion, View, written_blend};
use crate::scene::SceneError;

pub(super) const RULE: Rule = Rule {
    name: "one-zero",
    about: "Blend One Zero on a float target: a NaN or infinity in the destination still comes through.",
    state,
    scene,
};

const PROBLEM: &str = "the destination is multiplied by zero, not left out: on a float target NaN x 0 and Inf x 0 are NaN, \
                       in D3D by rule; other drivers may skip it";
const FIX: &str = "switch blending off to replace the destination";

/// Whether a component looks like a replacement but reads the destination.
fn zero_destination(component: &BlendComponent) -> bool {
    let sum = !matches!(component.operation, BlendOperation::Min | BlendOperation::Max);
    sum && (component.src_factor, component.dst_factor) == (F::One, F::Zero)
}

fn replaces(blend: &BlendState) -> bool {
    zero_destination(&blend.color) || zero_destination(&blend.alpha)
}

fn shown(question: &StateQuestion, blend: BlendState) -> Example {
    let src = [0.5, 0.5, 0.5, 1.0];
    Example {
        pixel: None,
        given: format!("source {src:?}, NaN in the destination"),
        target: 0,
        format: question.format,
        stored: merge(question, Some(blend), src, nan(question.format)),
        repaired: merge(question, None, src, nan(question.format)),
    }
}

fn nan(format: ColorFormat) -> Codes {
    format.channels().map(|kind| match kind {
        ChannelKind::Float(layout) => layout.nan(),
        _ => 0,
    })
}

fn state(question: &StateQuestion) -> Option<Finding> {
    let blend = question.block.blend[0].filter(replaces)?;
    let written = !question.block.write_mask[0].is_empty();
    (written && question.format.class() == TargetClass::Float).then(|| Finding {
        rule: RULE.name,
        place: "blend".to_owned(),
        problem: PROBLEM.to_owned(),
        fix: FIX.to_owned(),
        example: shown(question, blend),
    })
}

/// The example is a NaN that the scene need not have.
fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, draw) in view.draws.iter().enumerate() {
        for (target, state) in draw.state.targets.iter().enumerate() {
            let Some(blend) = state.as_ref().and_then(written_blend).filter(|blend| replaces(blend)) else { continue };
            let format = view.scene.target.colors[target].format;
            if format.class() != TargetClass::Float {
                continue;
            }
            let question = StateQuestion {
                block: crate::state::StateBlock::with_blend(Some(*blend)),
                format,
                constant: None,
                source: None,
                depth_known: false,
            };
            findings.push(Finding {
                rule: RULE.name,
                place: format!("{}, color target {target}", view.place(index)),
                problem: PROBLEM.to_owned(),
                fix: FIX.to_owned(),
                example: Example { target, ..shown(&question, *blend) },
            });
        }
    }
    Ok(findings)
}
