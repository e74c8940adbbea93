//! The planned merger: the stages of [`crate::merger`], without those that a plan leaves out.

use wgpu_types::ColorWrites;

use super::memory::{Memory, Place};
use super::{Access, Plan, TargetPlan, Test};
use crate::fragment::Fragment;
use crate::merger::depth_stencil::{self, DepthStencil};
use crate::merger::{Merger, MergerError, coverage, discard, write_mask};
use crate::model::{ColorInputs, NumericModel};
use crate::state::MergerState;
use crate::target::Framebuffer;

/// An output merger that follows a plan.
#[derive(Debug)]
pub struct Planned<'a> {
    pub(crate) merger: Merger<'a>,
    plan: Plan,
    leaves_a_trace: bool,
}

impl<'a> Planned<'a> {
    /// The planned merger of a state in a model.
    ///
    /// # Errors
    /// As [`Merger::new`].
    pub fn new(
        state: &'a MergerState,
        model: &'a dyn NumericModel,
        targets: &Framebuffer,
    ) -> Result<Self, MergerError> {
        Ok(Self::with_plan(Merger::new(state, model, targets)?, Plan::for_model(state, model)?))
    }

    /// The same merger without a plan's omissions: reads, evaluates and writes all that the state names.
    ///
    /// # Errors
    /// As [`Merger::new`].
    pub fn everything(
        state: &'a MergerState,
        model: &'a dyn NumericModel,
        targets: &Framebuffer,
    ) -> Result<Self, MergerError> {
        Ok(Self::with_plan(Merger::new(state, model, targets)?, Plan::everything(state, model)?))
    }

    fn with_plan(merger: Merger<'a>, plan: Plan) -> Self {
        let leaves_a_trace = plan.leaves_a_trace();
        Self { merger, plan, leaves_a_trace }
    }

    /// The plan it follows.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Merges one fragment into texel (x, y).
    ///
    /// # Panics
    /// When the texel lies outside `memory`.
    pub fn merge<M: Memory>(&self, fragment: &Fragment, x: u32, y: u32, memory: &mut M) {
        if !self.leaves_a_trace {
            return;
        }
        let state = self.merger.state;
        let mask = self.merger.model.sample_mask(&state.multisample);
        let covered = coverage::covered_samples(state.multisample.count, mask, &state.dynamic, fragment, (x, y));
        if covered == 0 {
            return;
        }
        let alpha = fragment.outputs[0][3];
        let lives = !fragment.discarded
            && match self.plan.alpha_test {
                Test::Passes => true,
                Test::Fails => false,
                Test::Evaluated => state.alpha_test.passes(alpha),
            };
        let mut kept = if lives { covered } else { 0 };
        if lives && self.plan.alpha_to_coverage {
            kept &= discard::alpha_to_coverage(&state.multisample, alpha);
        }
        for sample in (0..state.multisample.count).filter(|sample| covered >> sample & 1 == 1) {
            let at = (x, y, sample);
            let merged = kept >> sample & 1 == 1 && self.passes_depth_stencil(fragment, at, memory);
            for (index, target) in self.plan.targets.iter().enumerate() {
                if let Some(target) = target {
                    self.write_color(fragment, index, target, merged, at, memory);
                }
            }
        }
    }

    /// Stage 3. Values the plan does not read are given as 0: the outcome does not depend on them.
    fn passes_depth_stencil<M: Memory>(&self, fragment: &Fragment, at: Place, memory: &mut M) -> bool {
        let (Some(state), Some(format)) = (&self.merger.state.depth_stencil, self.merger.depth) else { return true };
        let Access { depth_read, depth_write, stencil_read, stencil_write } = self.plan.depth_stencil;
        let dynamic = &self.merger.state.dynamic;
        let code = match format.depth() {
            Some(kind) if depth_read || depth_write => {
                self.merger.model.depth_code(kind, fragment.depth, dynamic.depth_range)
            }
            _ => 0,
        };
        let stored = DepthStencil {
            depth: if depth_read { memory.read_depth(at) } else { 0 },
            stencil: if stencil_read { memory.read_stencil(at) } else { 0 },
        };
        let tested = depth_stencil::test(state, format, fragment.front_facing, dynamic.stencil_reference, code, stored);
        if stencil_write && (!stencil_read || tested.stored.stencil != stored.stencil) {
            memory.write_stencil(at, tested.stored.stencil);
        }
        if depth_write && tested.passed() && state.depth_write_enabled == Some(true) {
            memory.write_depth(at, tested.stored.depth);
        }
        tested.passed()
    }

    /// Stages 4 to 7 on one target.
    pub(crate) fn write_color<M: Memory>(
        &self,
        fragment: &Fragment,
        index: usize,
        plan: &TargetPlan,
        merged: bool,
        at: Place,
        memory: &mut M,
    ) {
        let Some((state, format)) = self.merger.colors[index] else { return };
        let model = self.merger.model;
        if !(merged && plan.write) {
            if plan.rewrite {
                let old = memory.read_color(index, at);
                memory.write_color(index, at, model.rewrite_untouched(format, old));
            }
            return;
        }
        let old = if plan.read { memory.read_color(index, at) } else { [0; 4] };
        let mut codes = old;
        if state.write_mask != ColorWrites::empty() {
            codes = model.merge_color(&ColorInputs {
                format,
                blend: state.blend.filter(|_| plan.blend),
                constant: if plan.reads.constant { self.merger.state.dynamic.blend_constant } else { [0.0; 4] },
                src: fragment.outputs[index],
                src1: if plan.reads.second_source { fragment.src1 } else { [0.0; 4] },
                dst: old,
            });
        }
        if !plan.whole {
            let untouched = if plan.rewrite { model.rewrite_untouched(format, old) } else { old };
            codes = write_mask::select(state.write_mask, untouched, codes);
        }
        memory.write_color(index, at, codes);
    }
}
