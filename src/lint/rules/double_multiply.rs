//! `double-multiply`: a premultiplied color is multiplied by alpha once more.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendState};

use super::{COLOR, blends_mut, example};
use crate::lint::{Finding, Rule, SourceAlpha, StateQuestion, View, written_blend};
use crate::scene::material::Shader;
use crate::scene::{Draw, SceneError};

pub(super) const RULE: Rule = Rule {
    name: "double-multiply",
    about: "A premultiplied color under a straight state (SrcAlpha): multiplied by alpha twice, too dark.",
    state,
    scene,
};

const FIX: &str = "use One as source factor: Blend One OneMinusSrcAlpha";

fn multiplies(blend: &BlendState) -> bool {
    blend.color.src_factor == F::SrcAlpha
}

fn repaired(blend: &BlendState) -> BlendState {
    BlendState { color: BlendComponent { src_factor: F::One, ..blend.color }, ..*blend }
}

fn state(question: &StateQuestion) -> Option<Finding> {
    let blend = question.block.blend[0].as_ref()?;
    let twice = question.source == Some(SourceAlpha::Premultiplied) && multiplies(blend);
    twice.then(|| Finding {
        rule: RULE.name,
        place: "blend.color".to_owned(),
        problem: "the source is premultiplied, and the state multiplies it by its alpha again".to_owned(),
        fix: FIX.to_owned(),
        example: example(question, Some(repaired(blend)), [0.5, 0.5, 0.5, 0.5], [0.0, 0.0, 0.0, 1.0]),
    })
}

fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, draw) in view.draws.iter().enumerate() {
        let Some(who) = premultiplied_by(draw) else { continue };
        if !draw.state.targets.iter().flatten().filter_map(written_blend).any(multiplies) {
            continue;
        }
        let repair = |draw: &mut Draw| {
            blends_mut(draw).filter(|blend| multiplies(blend)).for_each(|blend| *blend = repaired(blend));
        };
        if let Some(changed) = view.changed_by_one(index, COLOR, repair)? {
            let problem = format!("{who} already multiplied the color by alpha, and the state does so again");
            findings.push(view.finding(RULE.name, index, (problem, FIX), &changed));
        }
    }
    Ok(findings)
}

/// What multiplied a draw's color by its alpha, if anything did.
pub(super) fn premultiplied_by(draw: &Draw) -> Option<&'static str> {
    if draw.material.mode.settings().premultiplies {
        return Some("the shader");
    }
    let texture = draw.material.texture.is_some() && draw.material.premultiplied_texture;
    (texture && draw.shader != Shader::Flat).then_some("the texture")
}
