//! `queue`: a render queue that does not suit the state.

use super::{ALL, blends, draw_blends, merge, stored, writes_color};
use crate::lint::{Example, Finding, Rule, StateQuestion, View};
use crate::scene::description::Order;
use crate::scene::queue::RenderQueue;
use crate::scene::{Draw, SceneError};
use crate::state::block::queue_number;

pub(super) const RULE: Rule = Rule {
    name: "queue",
    about: "A blended object in a queue up to 2500 (front to back), or an unblended one above (back to front).",
    state,
    scene,
};

const BLENDED: &str = "it blends, and queues up to 2500 are drawn front to back before all transparent ones";
const OPAQUE: &str = "it does not blend, and queues above 2500 are drawn back to front after all opaque ones";
const TO_TRANSPARENT: &str = "use the queue Transparent (3000)";
const TO_GEOMETRY: &str = "use the queue Geometry (2000), or AlphaTest (2450) with an alpha test or clip";

/// The last queue that is drawn front to back.
const LAST_OPAQUE: i32 = 2500;

fn state(question: &StateQuestion) -> Option<Finding> {
    let block = &question.block;
    let queue = queue_number(block.tag("Queue")?).ok()?;
    let blend = block.blend[0].filter(blends);
    let (problem, fix) = match (blend.is_some(), queue <= LAST_OPAQUE) {
        (true, true) => (BLENDED, TO_TRANSPARENT),
        (false, false) if !block.write_mask[0].is_empty() => (OPAQUE, TO_GEOMETRY),
        _ => return None,
    };
    // What is drawn first, and what second, when the queue is wrong; the other way round when it is right.
    let ground = stored(question, [0.0, 0.0, 0.0, 1.0]);
    let (layer, other) = ([1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 1.0]);
    let drawn = merge(question, block.blend[0], layer, ground);
    let (wrong, right) = match blend {
        Some(blend) => (
            merge(question, None, other, drawn),
            merge(question, Some(blend), layer, merge(question, None, other, ground)),
        ),
        None => (drawn, drawn),
    };
    let given = match blend {
        Some(_) => format!("a layer {layer:?} in queue {queue}, an opaque {other:?} behind it in a later one"),
        None => format!("queue {queue}: the same bytes, but every hidden pixel is shaded and overwritten"),
    };
    Some(Finding {
        rule: RULE.name,
        place: "Tags { \"Queue\" }".to_owned(),
        problem: problem.to_owned(),
        fix: fix.to_owned(),
        example: Example { pixel: None, given, target: 0, format: question.format, stored: wrong, repaired: right },
    })
}

fn scene(view: &View<'_>) -> Result<Vec<Finding>, SceneError> {
    let mut findings = Vec::new();
    if view.scene.order == Order::Listed || view.scene.replacement.is_some() {
        return Ok(findings);
    }
    let mut start = 0;
    for passes in view.draws.chunk_by(|a, b| a.object == b.object) {
        let first = start;
        start += passes.len();
        let Some(base) = passes.iter().find(|draw| writes_color(draw)) else { continue };
        let low = i32::from(base.key.queue.number()) <= LAST_OPAQUE;
        let (problem, fix, queue) = match (draw_blends(base), low) {
            (true, true) => (BLENDED, TO_TRANSPARENT, RenderQueue::TRANSPARENT),
            (false, false) if passes.iter().all(opaque) => (OPAQUE, TO_GEOMETRY, RenderQueue::ALPHA_TEST),
            _ => continue,
        };
        findings.push(finding(view, first, base, (problem, fix), queue)?);
    }
    Ok(findings)
}

/// A pass that replaces what is there, or adds a light to it.
fn opaque(draw: &Draw) -> bool {
    !draw_blends(draw) || draw.shader == crate::scene::material::Shader::Light
}

/// The object drawn in another queue, and the first pixel that differs, if one does.
fn finding(
    view: &View<'_>,
    first: usize,
    base: &Draw,
    (problem, fix): (&str, &str),
    queue: RenderQueue,
) -> Result<Finding, SceneError> {
    let mut scene = view.scene.clone();
    let materials: Vec<usize> =
        scene.objects.iter().filter(|object| object.name == base.object).map(|object| object.material).collect();
    for material in materials {
        scene.materials[material].queue = Some(queue);
    }
    let problem = format!("queue {}: {problem}", base.key.queue.number());
    if let Some(changed) = view.changed_by(&scene.draws(), ALL)? {
        return Ok(view.finding(RULE.name, first, (problem, fix), &changed));
    }
    let format = view.scene.target.colors[0].format;
    Ok(Finding {
        rule: RULE.name,
        place: view.place(first),
        problem,
        fix: fix.to_owned(),
        example: Example {
            pixel: None,
            given: "no pixel of this scene shows it".to_owned(),
            target: 0,
            format,
            stored: [0; 4],
            repaired: [0; 4],
        },
    })
}
