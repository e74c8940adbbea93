//! `depth-write`: a blended draw that writes depth hides what should shine through.

use super::{ALL, GREY, blends, draw_blends, merge, stored};
use crate::lint::{Example, Finding, Rule, StateQuestion, View};
use crate::scene::{Draw, SceneError};

pub(super) const RULE: Rule = Rule {
    name: "depth-write",
    about: "A blended draw writes depth: later draws behind it fail the depth test and leave holes.",
    state,
    scene,
};

const PROBLEM: &str = "it blends and writes depth, so what is drawn later behind it fails the depth test";
const FIX: &str = "ZWrite Off; for a mesh that overlaps itself, a depth prepass with ColorMask 0";

fn state(question: &StateQuestion) -> Option<Finding> {
    let block = &question.block;
    let blend = block.blend[0].filter(|blend| blends(blend) && !block.write_mask[0].is_empty())?;
    (question.depth_known && block.depth_write).then(|| {
        let near = merge(question, Some(blend), [1.0, 0.0, 0.0, 0.5], stored(question, GREY));
        let far = merge(question, Some(blend), [0.0, 0.0, 1.0, 0.5], stored(question, GREY));
        Finding {
            rule: RULE.name,
            place: "ZWrite".to_owned(),
            problem: PROBLEM.to_owned(),
            fix: FIX.to_owned(),
            example: Example {
                pixel: None,
                given:
                    "a near layer [1, 0, 0, 0.5], then a far one [0, 0, 1, 0.5], over grey; repaired: far, then near"
                        .to_owned(),
                target: 0,
                format: question.format,
                stored: near,
                repaired: merge(question, Some(blend), [1.0, 0.0, 0.0, 0.5], far),
            },
        }
    })
}

fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, draw) in view.draws.iter().enumerate() {
        let writes = draw.state.depth_stencil.as_ref().is_some_and(|state| state.depth_write_enabled == Some(true));
        if !writes || !draw_blends(draw) {
            continue;
        }
        let repair = |draw: &mut Draw| {
            if let Some(state) = &mut draw.state.depth_stencil {
                state.depth_write_enabled = Some(false);
            }
        };
        if let Some(changed) = view.changed_by_one(index, ALL, repair)? {
            findings.push(view.finding(RULE.name, index, (PROBLEM.to_owned(), FIX), &changed));
        }
    }
    Ok(findings)
}
