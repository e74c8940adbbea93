//! What the bundled scenes do not need, and what leaving it out saves.

use super::{Failure, Figure, Section, Table, percent};
use crate::model::binary32::Binary32;
use crate::plan::Part;
use crate::report::plot::{Axis, Chart, Mark, Series};
use crate::scene::Scene;
use crate::scene::planned::{DrawPlan, ScenePlan};

/// A scene's plan with the scene's name.
struct Planned {
    name: &'static str,
    plan: ScenePlan,
}

impl Planned {
    fn bytes(&self) -> (u64, u64) {
        let sum = |of: fn(&DrawPlan) -> u64| self.plan.draws.iter().map(of).sum();
        (sum(|draw| draw.planned.traffic.total()), sum(|draw| draw.everything.traffic.total()))
    }

    fn seconds(&self) -> (f64, f64) {
        let sum = |of: fn(&DrawPlan) -> f64| self.plan.draws.iter().map(of).sum();
        (sum(|draw| draw.planned.seconds), sum(|draw| draw.everything.seconds))
    }
}

/// A part of the pipeline over all draws.
struct PartCount {
    name: String,
    left_out: usize,
    draws: usize,
    /// The reasons for leaving it out, with how often each was given.
    reasons: Vec<(&'static str, usize)>,
}

/// The section, over all bundled scenes.
///
/// # Errors
/// A scene that cannot be read or planned, which bundled ones can.
pub fn section() -> Result<Section, Failure> {
    let mut plans = Vec::new();
    for (name, scene) in Scene::bundled() {
        plans.push(Planned { name, plan: scene?.plan(&Binary32)? });
    }
    if let Some(wrong) = plans.iter().find(|planned| !planned.plan.same_bytes) {
        return Err(format!("the plan of scene {} changes bytes: a bug", wrong.name).into());
    }
    Ok(Section {
        id: "plan",
        title: "What scenes do not need",
        finding: finding(&plans),
        method: "Every draw is merged twice in the model `f32`: as its plan has it, and reading, evaluating and writing \
                 all that its state names. Both leave the same bytes in every target; the bytes that move between the \
                 merger and the targets are counted, the times measured in this run. `render` and this report follow the \
                 plans."
            .to_owned(),
        figures: vec![Figure::chart("Bytes moved, a dot a scene; the line is nothing saved", chart(&plans))],
        tables: vec![parts_table(&parts(&plans)), scenes_table(&plans)],
        command: "outmerge plan SCENE".to_owned(),
    })
}

fn finding(plans: &[Planned]) -> String {
    let total = plans.iter().map(Planned::bytes).fold((0, 0), |sum, bytes| (sum.0 + bytes.0, sum.1 + bytes.1));
    let most = plans.iter().max_by(|a, b| saved(a.bytes()).total_cmp(&saved(b.bytes())));
    let most = most
        .map_or(String::new(), |planned| format!("; most in `{}`, {}", planned.name, percent(saved(planned.bytes()))));
    format!(
        "Over all scenes {} of the bytes need not move and nobody can see the difference{most}.",
        percent(saved(total))
    )
    .replace('`', "")
}

/// The share saved.
fn saved((planned, everything): (u64, u64)) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "byte counts far below 2^53")]
    let share = 1.0 - planned as f64 / everything.max(1) as f64;
    share
}

/// How often each part was left out, shader first, then the merger's stages in order.
fn parts(plans: &[Planned]) -> Vec<PartCount> {
    let mut counts: Vec<PartCount> = Vec::new();
    for draw in plans.iter().flat_map(|planned| &planned.plan.draws) {
        let shader = draw.pipeline.iter().map(|decision| (decision.part, decision.needed, decision.reason));
        let merger = draw
            .merger
            .iter()
            .filter(|decision| decision.target.is_none_or(|target| target == 0))
            .map(|decision| (Part::name(decision.part), decision.needed, decision.reason));
        for (name, needed, reason) in shader.chain(merger) {
            let index = counts.iter().position(|count| count.name == name).unwrap_or_else(|| {
                counts.push(PartCount { name: name.to_owned(), left_out: 0, draws: 0, reasons: Vec::new() });
                counts.len() - 1
            });
            let count = &mut counts[index];
            count.draws += 1;
            if needed {
                continue;
            }
            count.left_out += 1;
            match count.reasons.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, times)) => *times += 1,
                None => count.reasons.push((reason, 1)),
            }
        }
    }
    counts
}

fn parts_table(counts: &[PartCount]) -> Table {
    let mut table = Table::new("Parts left out, over all draws", ["part", "left out", "of draws", "mostly because"]);
    for count in counts {
        let reason = count.reasons.iter().max_by_key(|(_, times)| *times).map_or("", |(reason, _)| reason);
        table.add([count.name.clone(), count.left_out.to_string(), count.draws.to_string(), reason.to_owned()]);
    }
    table
}

fn scenes_table(plans: &[Planned]) -> Table {
    let mut table = Table::new(
        "Each scene",
        ["scene", "draws", "bytes moved", "with nothing left out", "saved", "merge time", "with nothing left out"],
    );
    for planned in plans {
        let ((lean, full), (fast, slow)) = (planned.bytes(), planned.seconds());
        table.add([
            planned.name.to_owned(),
            planned.plan.draws.len().to_string(),
            lean.to_string(),
            full.to_string(),
            percent(saved((lean, full))),
            format!("{:.2} ms", 1e3 * fast),
            format!("{:.2} ms", 1e3 * slow),
        ]);
    }
    table
}

fn chart(plans: &[Planned]) -> Chart {
    #[expect(clippy::cast_precision_loss, reason = "byte counts far below 2^53")]
    let points: Vec<(f64, f64)> =
        plans.iter().map(Planned::bytes).map(|(lean, full)| (full as f64, lean as f64)).collect();
    let (low, high) = points.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), (x, _)| (low.min(*x), high.max(*x)));
    Chart {
        x: Axis::new("bytes with nothing left out", 1.0),
        y: Axis::new("bytes as planned", 1.0),
        series: vec![
            Series { name: "scenes".to_owned(), points, mark: Mark::Dots },
            Series { name: "nothing saved".to_owned(), points: vec![(low, low), (high, high)], mark: Mark::Line },
        ],
    }
}
