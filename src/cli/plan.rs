//! `outmerge plan`: what each draw of a scene needs, and what is left out.

use std::fmt::Write as _;

use clap::Args;

use super::{Failure, Outcome, output, render};
use crate::model::registry;
use crate::plan::Traffic;
use crate::scene::planned::{DrawPlan, ScenePlan};
use crate::verdict::Verdict;

/// Arguments of `plan`.
#[derive(Debug, Args)]
pub(super) struct PlanCommand {
    /// A scene file (.toml or .json), or the name of a bundled scene (see `outmerge scenes`).
    scene: String,
    /// The numeric model; some leave out more than others.
    #[arg(long, short, default_value = "exact")]
    model: String,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// As JSON has it.
#[derive(serde::Serialize)]
struct Judged<'a> {
    /// Whether the planned merger stores the bytes of the reference.
    verdict: Verdict,
    #[serde(flatten)]
    plan: &'a ScenePlan,
}

/// Measurements; the shortest times count.
const REPETITIONS: u32 = 3;

impl PlanCommand {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        let plan = render::load(&self.scene)?.plan_repeated(model.as_ref(), REPETITIONS)?;
        // Without a fragment both ways store the same whatever the plan is worth.
        let drawn = plan.draws.iter().filter(|draw| draw.fragments > 0).count();
        let verdict = Verdict::of_search(!plan.same_bytes, drawn);
        if self.json {
            output::print_json("plan", &Judged { verdict, plan: &plan })?;
        } else {
            output::print(&text(&plan)?)?;
        }
        Ok(Outcome::Judged(verdict))
    }
}

fn text(plan: &ScenePlan) -> Result<String, Failure> {
    let mut text = String::new();
    for (index, draw) in plan.draws.iter().enumerate() {
        writeln!(text, "draw {}: {}, pass {}, {} fragments", index + 1, draw.object, draw.pass, draw.fragments)?;
        text.push_str(&decisions(draw));
        writeln!(text, "  bytes moved {}\n", saved(draw.planned.traffic, draw.everything.traffic))?;
    }
    let sum = |cost: fn(&DrawPlan) -> f64| plan.draws.iter().map(cost).sum::<f64>() * 1e3;
    let (planned, everything) = (sum(|draw| draw.planned.seconds), sum(|draw| draw.everything.seconds));
    let total = |traffic: fn(&DrawPlan) -> Traffic| {
        plan.draws.iter().map(traffic).fold(Traffic::default(), |mut sum, traffic| {
            sum += traffic;
            sum
        })
    };
    let bytes = saved(total(|draw| draw.planned.traffic), total(|draw| draw.everything.traffic));
    let depth = &plan.depth_target;
    let word = if depth.needed { "needed" } else { "left out" };
    writeln!(text, "depth target {word}, {} bytes: {}", plan.depth_target_bytes, depth.reason)?;
    writeln!(text, "scene, model {}: bytes moved {bytes}", plan.model)?;
    writeln!(
        text,
        "merge time {planned:.2} ms, with nothing left out {everything:.2} ms (shortest of {REPETITIONS}, this machine)"
    )?;
    let same = if plan.same_bytes { "the targets hold the same bytes either way" } else { "THE BYTES DIFFER: a bug" };
    writeln!(text, "{same}")?;
    Ok(text)
}

fn decisions(draw: &DrawPlan) -> String {
    let mut table = output::table([]);
    let word = |needed| if needed { "needed" } else { "left out" };
    for decision in &draw.pipeline {
        table.add_row(["", decision.part, word(decision.needed), decision.reason]);
    }
    for decision in &draw.merger {
        let target = decision.target.filter(|&target| target > 0);
        let part = target.map_or(decision.part.name().to_owned(), |i| format!("{} {i}", decision.part.name()));
        table.add_row(["", &part, word(decision.needed), decision.reason]);
    }
    output::lines(&table)
}

fn saved(planned: Traffic, everything: Traffic) -> String {
    let (planned, everything) = (planned.total(), everything.total());
    format!("{planned}, with nothing left out {everything}, saved {}", everything - planned)
}
