//! `prepass-cutoff`: a depth prepass keeps fragments that the color pass drops, or the other way round.

use super::{ALL, writes_color};
use crate::lint::{Finding, Rule, StateQuestion, View};
use crate::scene::{Draw, SceneError};
use crate::state::AlphaTest;

pub(super) const RULE: Rule = Rule {
    name: "prepass-cutoff",
    about: "A depth prepass tests alpha otherwise than the pass that draws the color: holes, or a missing rim.",
    state,
    scene,
};

const FIX: &str = "test alpha in both passes with the same comparison and cutoff";

/// One state alone has no other pass.
fn state(_: &StateQuestion) -> Option<Finding> {
    None
}

fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    for (index, prepass) in view.draws.iter().enumerate().filter(|(_, draw)| is_prepass(draw)) {
        // The passes of an object follow one another; the prepass itself writes no color.
        let color = view.draws[index..].iter().take_while(|draw| draw.object == prepass.object);
        let Some(color) = color.into_iter().find(|draw| writes_color(draw)) else { continue };
        let (before, after) = (prepass.state.alpha_test, color.state.alpha_test);
        if before == after {
            continue;
        }
        let repair = |draw: &mut Draw| {
            draw.state.alpha_test = after;
            // Alpha is evaluated again where only the new test reads it.
            draw.keywords = color.keywords;
        };
        if let Some(changed) = view.changed_by_one(index, ALL, repair)? {
            let problem = format!(
                "it writes depth with {}, and pass {} draws the color with {}",
                words(before),
                color.pass,
                words(after)
            );
            findings.push(view.finding(RULE.name, index, (problem, FIX), &changed));
        }
    }
    Ok(findings)
}

/// Whether a draw writes depth and no color.
fn is_prepass(draw: &Draw) -> bool {
    let depth = draw.state.depth_stencil.as_ref().is_some_and(|state| state.depth_write_enabled == Some(true));
    depth && !writes_color(draw)
}

fn words(test: AlphaTest) -> String {
    match test {
        AlphaTest::Off => "no alpha test".to_owned(),
        AlphaTest::On { compare, reference } => format!("AlphaTest {compare:?} {reference}"),
    }
}
