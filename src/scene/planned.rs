//! A scene's plan: what each draw needs, what is left out and why, and what that saves.

use std::time::{Duration, Instant};

use super::description::Scene;
use super::draw::Draw;
use super::render::SceneError;
use crate::merger::MergerError;
use crate::model::NumericModel;
use crate::plan::{Access, Counted, Decision, Plan, Planned, Traffic};
use crate::target::{DepthStencilTarget, Framebuffer};

/// Whether a part of a draw outside the output merger is needed, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct PipelineDecision {
    /// `sort`, or a part of the fragment shader.
    pub part: &'static str,
    /// Whether the draw needs it.
    pub needed: bool,
    /// What needs it, or why nobody can see that it is left out.
    pub reason: &'static str,
}

/// Bytes and time of the same fragments, merged with and without the plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Cost {
    /// Bytes of the targets read and written.
    pub traffic: Traffic,
    /// Seconds in the merger, measured on this machine in this run: the fastest of its repetitions.
    pub seconds: f64,
}

/// One draw.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct DrawPlan {
    /// Name of the object.
    pub object: String,
    /// Name of the pass.
    pub pass: String,
    /// Fragments shaded, discarded ones included.
    pub fragments: u64,
    /// Drawing order, then the parts of the fragment shader.
    pub pipeline: Vec<PipelineDecision>,
    /// Parts of the output merger in pipeline order.
    pub merger: Vec<Decision>,
    /// What the plan costs.
    pub planned: Cost,
    /// What it would cost to read, evaluate and write all that the state names.
    pub everything: Cost,
}

/// A scene's draws in drawing order.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct ScenePlan {
    /// Name of the numeric model.
    pub model: String,
    /// Whether the scene needs its depth target at all.
    pub depth_target: PipelineDecision,
    /// Bytes that target takes, or would take, in a [`Framebuffer`].
    pub depth_target_bytes: usize,
    /// The draws.
    pub draws: Vec<DrawPlan>,
    /// Whether targets merged with and without the plan hold the same bytes. Anything else is a bug in the plan.
    pub same_bytes: bool,
}

/// Targets merged in one way, timed on one copy and counted on another.
struct Way {
    timed: Framebuffer,
    counted: Framebuffer,
}

impl Way {
    fn merge(&mut self, merger: &Planned<'_>, fragments: &[super::PixelFragment], cost: &mut Cost) {
        let started = Instant::now();
        for pixel in fragments {
            merger.merge(&pixel.fragment, pixel.x, pixel.y, &mut self.timed);
        }
        let elapsed: Duration = started.elapsed();
        cost.seconds += elapsed.as_secs_f64();
        let mut memory = Counted::new(&mut self.counted);
        for pixel in fragments {
            merger.merge(&pixel.fragment, pixel.x, pixel.y, &mut memory);
        }
        cost.traffic += memory.traffic;
    }
}

impl Scene {
    /// Plans every draw for a model and measures what the plan leaves out.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn plan(&self, model: &dyn NumericModel) -> Result<ScenePlan, SceneError> {
        self.plan_repeated(model, 1)
    }

    /// As [`Scene::plan`], measured several times (at least once): each draw's shortest times count.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn plan_repeated(&self, model: &dyn NumericModel, repetitions: u32) -> Result<ScenePlan, SceneError> {
        let mut best = self.plan_once(model)?;
        for _ in 1..repetitions {
            for (best, again) in best.draws.iter_mut().zip(self.plan_once(model)?.draws) {
                best.planned.seconds = best.planned.seconds.min(again.planned.seconds);
                best.everything.seconds = best.everything.seconds.min(again.everything.seconds);
            }
        }
        Ok(best)
    }

    fn plan_once(&self, model: &dyn NumericModel) -> Result<ScenePlan, SceneError> {
        let cleared = self.cleared()?;
        let way = || Way { timed: cleared.clone(), counted: cleared.clone() };
        let (mut lean, mut full) = (way(), way());
        let mut plans = Vec::new();
        let draws = self.draws();
        for (index, draw) in draws.iter().enumerate() {
            let failed = |source: MergerError| SceneError::Merger { index, draw: draw.label(), source };
            let planned = Planned::new(&draw.state, model, &cleared).map_err(failed)?;
            let everything = Planned::everything(&draw.state, model, &cleared).map_err(failed)?;
            let mut costs = [Cost::default(); 2];
            let work = self.shade(draw, None, |fragments| {
                lean.merge(&planned, fragments, &mut costs[0]);
                full.merge(&everything, fragments, &mut costs[1]);
            });
            plans.push(DrawPlan {
                object: draw.object.clone(),
                pass: draw.pass.clone(),
                fragments: work.fragments,
                pipeline: pipeline(draw, planned.plan()),
                merger: planned.plan().decisions.clone(),
                planned: costs[0],
                everything: costs[1],
            });
        }
        let depth_target = match (&cleared.depth_stencil, self.touches_depth(&draws, &[model])?) {
            (None, _) => (false, "the scene asks for none"),
            (Some(_), false) => (false, "no draw reads or writes depth or stencil"),
            (Some(_), true) => (true, "a draw reads or writes depth or stencil"),
        };
        let bytes = |target: &DepthStencilTarget| size_of_val(target.depth()) + size_of_val(target.stencil());
        Ok(ScenePlan {
            model: model.name(),
            depth_target: PipelineDecision { part: "depth target", needed: depth_target.0, reason: depth_target.1 },
            depth_target_bytes: cleared.depth_stencil.as_ref().map_or(0, bytes),
            draws: plans,
            same_bytes: lean.timed == full.timed,
        })
    }
}

/// Drawing order and the fragment shader.
fn pipeline(draw: &Draw, plan: &Plan) -> Vec<PipelineDecision> {
    let mut all = vec![sort(plan)];
    let evaluated: Vec<&str> = draw.keywords.names().collect();
    for (part, without) in [
        ("color", "no target stores color"),
        ("alpha", "the mode's alpha is 1, or nothing reads it"),
        ("clip", "the mode has no holes"),
        ("texture", "the material has none, or nothing reads color or alpha"),
        ("light", "unlit, one flat color, or nothing reads the color"),
        ("premultiply", "the mode does not premultiply, or nothing reads color or alpha"),
    ] {
        let needed = evaluated.contains(&part);
        all.push(PipelineDecision { part, needed, reason: if needed { "an output depends on it" } else { without } });
    }
    all
}

/// Whether the draw's place in the order shows, ties in depth aside.
fn sort(plan: &Plan) -> PipelineDecision {
    let blends = plan.targets.iter().flatten().any(|target| target.blend && target.read);
    let Access { depth_read, depth_write, .. } = plan.depth_stencil;
    let (needed, reason) = match (blends, depth_read && depth_write) {
        (true, _) => (true, "blending depends on what was drawn before"),
        (false, true) => (false, "the depth test keeps the nearest fragment in any order; sorting only saves work"),
        (false, false) => (true, "without depth test and depth write the last draw wins"),
    };
    PipelineDecision { part: "sort", needed, reason }
}
