//! `straight-source`: a straight color under a premultiplied state is never multiplied by alpha.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, BlendState};

use super::{COLOR, blends_mut, double_multiply, example};
use crate::lint::{Finding, Rule, SourceAlpha, StateQuestion, View, written_blend};
use crate::scene::{Draw, SceneError};

pub(super) const RULE: Rule = Rule {
    name: "straight-source",
    about: "A straight color under a premultiplied state (One, OneMinusSrcAlpha): never multiplied, too bright.",
    state,
    scene,
};

const FIX: &str = "multiply color by alpha in the shader or the texture, or use SrcAlpha as source factor";

fn premultiplied_over(blend: &BlendState) -> bool {
    let BlendComponent { src_factor, dst_factor, operation } = blend.color;
    (src_factor, dst_factor, operation) == (F::One, F::OneMinusSrcAlpha, BlendOperation::Add)
}

fn repaired(blend: &BlendState) -> BlendState {
    BlendState { color: BlendComponent { src_factor: F::SrcAlpha, ..blend.color }, ..*blend }
}

fn state(question: &StateQuestion) -> Option<Finding> {
    let blend = question.block.blend[0].as_ref()?;
    let never = question.source == Some(SourceAlpha::Straight) && premultiplied_over(blend);
    never.then(|| Finding {
        rule: RULE.name,
        place: "blend.color".to_owned(),
        problem: "the source is straight, and nothing multiplies it by its alpha".to_owned(),
        fix: FIX.to_owned(),
        example: example(question, Some(repaired(blend)), [1.0, 1.0, 1.0, 0.5], [0.0, 0.0, 0.0, 1.0]),
    })
}

fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, draw) in view.draws.iter().enumerate() {
        let over = draw.state.targets.iter().flatten().filter_map(written_blend).any(premultiplied_over);
        if !over || double_multiply::premultiplied_by(draw).is_some() {
            continue;
        }
        let repair = |draw: &mut Draw| {
            blends_mut(draw).filter(|blend| premultiplied_over(blend)).for_each(|blend| *blend = repaired(blend));
        };
        if let Some(changed) = view.changed_by_one(index, COLOR, repair)? {
            let problem = "the color is straight, and nothing multiplies it by its alpha".to_owned();
            findings.push(view.finding(RULE.name, index, (problem, FIX), &changed));
        }
    }
    Ok(findings)
}
