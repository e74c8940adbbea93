//! `blend-constant`: a factor reads the blend constant, which nobody set.

use wgpu_types::{BlendFactor as F, BlendState};

use super::{ALL, GREY, example};
use crate::lint::{Finding, Rule, StateQuestion, View, written_blend};
use crate::scene::{Draw, SceneError};

pub(super) const RULE: Rule = Rule {
    name: "blend-constant",
    about: "A factor reads the blend constant, and it was never set: every pass starts with zeros.",
    state,
    scene,
};

const PROBLEM: &str = "a factor is the blend constant, which was never set: every pass starts with (0, 0, 0, 0)";
const FIX: &str = "set the blend constant before the draw (setBlendConstant, blend-constant in a scene)";

fn reads(blend: &BlendState) -> bool {
    [blend.color, blend.alpha]
        .iter()
        .flat_map(|component| [component.src_factor, component.dst_factor])
        .any(|factor| matches!(factor, F::Constant | F::OneMinusConstant))
}

fn state(question: &StateQuestion) -> Option<Finding> {
    let blend = question.block.blend[0].filter(reads)?;
    question.constant.is_none().then(|| {
        let source = [1.0, 1.0, 1.0, 1.0];
        let set = StateQuestion { constant: Some([0.5; 4]), ..question.clone() };
        let mut shown = example(question, Some(blend), source, GREY);
        shown.repaired = example(&set, Some(blend), source, GREY).stored;
        shown.given += ", repaired: with a constant of 0.5";
        Finding {
            rule: RULE.name,
            place: "blend".to_owned(),
            problem: PROBLEM.to_owned(),
            fix: FIX.to_owned(),
            example: shown,
        }
    })
}

/// A constant of zeros counts as never set; it shows where ones would change a pixel.
fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, draw) in view.draws.iter().enumerate() {
        let unset = draw.state.dynamic.blend_constant == [0.0; 4];
        if !unset || !draw.state.targets.iter().flatten().filter_map(written_blend).any(reads) {
            continue;
        }
        let repair = |draw: &mut Draw| draw.state.dynamic.blend_constant = [1.0; 4];
        if let Some(changed) = view.changed_by_one(index, ALL, repair)? {
            let problem = format!("{PROBLEM}; repaired is with ones");
            findings.push(view.finding(RULE.name, index, (problem, FIX), &changed));
        }
    }
    Ok(findings)
}
