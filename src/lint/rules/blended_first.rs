//! `blended-first`: a blended draw comes before an opaque one that lies behind it.

use super::{ALL, draw_blends, writes_color};
use crate::lint::{Finding, Rule, StateQuestion, View};
use crate::scene::{Draw, SceneError};

pub(super) const RULE: Rule = Rule {
    name: "blended-first",
    about: "A blended draw comes before opaque ones: it mixes with what they cover up later.",
    state,
    scene,
};

const FIX: &str = "draw opaque objects first: give blended ones the queue Transparent (3000)";

/// One state alone has no order.
fn state(_: &StateQuestion) -> Option<Finding> {
    None
}

/// The first blended draw with an opaque one after it, if drawing all opaque ones first changes a pixel.
fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let opaque = |draw: &Draw| writes_color(draw) && !draw_blends(draw);
    let Some(last) = view.draws.iter().rposition(opaque) else { return Ok(Vec::new()) };
    // Draws without color, as depth prepasses are, keep their place before the draw that follows them.
    let Some(first) = view.draws[..last].iter().position(draw_blends) else { return Ok(Vec::new()) };
    let (mut early, mut late) = (Vec::new(), Vec::new());
    for draw in &view.draws {
        let group = if opaque(draw) { &mut early } else { &mut late };
        group.push(draw.clone());
    }
    early.append(&mut late);
    let changed = view.changed_by(&early, ALL)?;
    Ok(changed.map_or_else(Vec::new, |changed| {
        let problem = format!("it blends, and {} is opaque and drawn after it", view.place(last));
        vec![view.finding(RULE.name, first, (problem, FIX), &changed)]
    }))
}
