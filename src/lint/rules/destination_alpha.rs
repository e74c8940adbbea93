//! `destination-alpha`: SrcAlpha on the alpha channel squares the source's alpha.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, BlendState, ColorWrites};

use super::{ALPHA, blends_mut, example};
use crate::format::{ChannelKind, ColorFormat};
use crate::lint::{Finding, Rule, StateQuestion, View, written_blend};
use crate::scene::{Draw, SceneError};

pub(super) const RULE: Rule = Rule {
    name: "destination-alpha",
    about: "SrcAlpha as factor of the alpha channel: the target's alpha gets the square of the source's.",
    state,
    scene,
};

const PROBLEM: &str = "the alpha channel is multiplied by SrcAlpha, so the target's alpha becomes a*a + ... instead of the \
                       coverage, and shows when the target is composited or its alpha is a factor";
const FIX: &str = "give alpha factors of its own: Blend ... , One OneMinusSrcAlpha";

fn squares(alpha: &BlendComponent) -> bool {
    alpha.src_factor == F::SrcAlpha && alpha.operation == BlendOperation::Add
}

fn repaired(blend: &BlendState) -> BlendState {
    BlendState { alpha: BlendComponent { src_factor: F::One, ..blend.alpha }, ..*blend }
}

fn has_alpha(format: ColorFormat) -> bool {
    format.channels()[3] != ChannelKind::Absent
}

fn state(question: &StateQuestion) -> Option<Finding> {
    let blend = question.block.blend[0].as_ref()?;
    let written = question.block.write_mask[0].contains(ColorWrites::ALPHA) && has_alpha(question.format);
    (written && squares(&blend.alpha)).then(|| Finding {
        rule: RULE.name,
        place: "blend.alpha".to_owned(),
        problem: PROBLEM.to_owned(),
        fix: FIX.to_owned(),
        example: example(question, Some(repaired(blend)), [1.0, 1.0, 1.0, 0.5], [0.0; 4]),
    })
}

/// Only targets whose alpha matters: cleared to less than 1, as targets to be composited are, or read by a later factor.
fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, draw) in view.draws.iter().enumerate() {
        let squared = draw.state.targets.iter().enumerate().any(|(i, target)| {
            let Some(target) = target else { return false };
            target.write_mask.contains(ColorWrites::ALPHA)
                && written_blend(target).is_some_and(|blend| squares(&blend.alpha))
                && view.scene.target.colors.get(i).is_some_and(|color| {
                    has_alpha(color.format)
                        && (color.clear[3] < 1.0 || view.draws[index + 1..].iter().any(|d| reads(d, i)))
                })
        });
        if !squared {
            continue;
        }
        let repair = |draw: &mut Draw| blends_mut(draw).for_each(|blend| *blend = repaired(blend));
        if let Some(changed) = view.changed_by_one(index, ALPHA, repair)? {
            findings.push(view.finding(RULE.name, index, (PROBLEM.to_owned(), FIX), &changed));
        }
    }
    Ok(findings)
}

/// Whether a draw reads the target's alpha as a factor.
fn reads(draw: &Draw, target: usize) -> bool {
    let alpha = |factor| matches!(factor, F::DstAlpha | F::OneMinusDstAlpha | F::SrcAlphaSaturated);
    let blend = draw.state.targets.get(target).and_then(Option::as_ref).and_then(written_blend);
    blend.is_some_and(|blend| [blend.color.src_factor, blend.color.dst_factor].into_iter().any(alpha))
}
