//! What a draw needs of the output merger, what can be left out, and why nobody can see that it was.
//!
//! A [`Plan`] is derived from the state alone, so it holds for every fragment and every destination, NaN and infinity
//! included. [`Planned`] runs it: what the plan leaves out is not computed, read or written. Two rules may depend on the
//! numeric model, and the model is asked for them ([`Plan::for_model`]); without a model the plan holds for all
//! ([`Plan::for_any_model`]).
//!
//! - [`equation`]: what a blend equation reads; [`depth_stencil`]: what the tests can come to;
//! - [`explain`]: each part of the merger with the reason why it is needed or left out;
//! - [`memory`]: target memory whose accesses can be counted; [`run`]: the planned merger.

pub mod depth_stencil;
pub mod equation;
pub mod explain;
pub mod memory;
pub mod run;
#[cfg(test)]
mod tests;

pub use depth_stencil::Access;
pub use equation::Reads;
pub use explain::{Decision, Part};
pub use memory::{Counted, Memory, Traffic};
pub use run::Planned;

use wgpu_types::{BlendState, ColorTargetState, CompareFunction};

use crate::format::{ColorFormat, DepthFormat, FormatError, TargetClass};
use crate::model::NumericModel;
use crate::state::{AlphaTest, MergerState};

/// What becomes of a test of a fragment's alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Test {
    /// Every fragment passes, or nothing depends on it.
    Passes,
    /// No fragment passes.
    Fails,
    /// It must be evaluated.
    Evaluated,
}

/// What a draw needs of one color target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "one independent fact each")]
pub struct TargetPlan {
    /// Fragments that pass store something.
    pub write: bool,
    /// The stored texel is read for that.
    pub read: bool,
    /// The blend equation is evaluated; otherwise the source is stored as with blending off.
    pub blend: bool,
    /// What is read beside the stored texel: source channels, second source, constant.
    pub reads: Reads,
    /// The model rewrites texels, or masked channels of them, that may not change.
    pub rewrite: bool,
    /// The write mask covers every channel the format stores.
    pub whole: bool,
}

/// What a draw needs of the output merger.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// By color target; `None` where the state has none.
    pub targets: Vec<Option<TargetPlan>>,
    /// Depth and stencil.
    pub depth_stencil: Access,
    /// The fixed-function alpha test.
    pub alpha_test: Test,
    /// Alpha to coverage: evaluated or not.
    pub alpha_to_coverage: bool,
    /// Parts with their reasons, in the order of the pipeline.
    pub decisions: Vec<Decision>,
}

impl Plan {
    /// The plan of a state that holds in every numeric model.
    ///
    /// A model may still rewrite texels it may not change, which a plan for that model knows.
    ///
    /// # Errors
    /// [`FormatError`] for formats without their role.
    pub fn for_any_model(state: &MergerState) -> Result<Self, FormatError> {
        Self::new(state, None)
    }

    /// The plan of a state in one numeric model.
    ///
    /// # Errors
    /// [`FormatError`] for formats without their role.
    pub fn for_model(state: &MergerState, model: &dyn NumericModel) -> Result<Self, FormatError> {
        Self::new(state, Some(model))
    }

    fn new(state: &MergerState, model: Option<&dyn NumericModel>) -> Result<Self, FormatError> {
        let formats = Formats::new(state)?;
        let depth_state = state.depth_stencil.as_ref().zip(formats.depth);
        let reference = state.dynamic.stencil_reference;
        let alpha_test = constant_alpha_test(state.alpha_test);
        let covers = can_cover(state, model);
        let alive = covers && alpha_test != Test::Fails;
        let outcomes = depth_stencil::outcomes(depth_state, reference);
        let color = |(target, format): (&Option<ColorTargetState>, &Option<ColorFormat>)| {
            let (target, format) = (target.as_ref()?, (*format)?);
            Some(target_plan(target, format, model, alive && outcomes.can_pass, covers))
        };
        let targets: Vec<_> = state.targets.iter().zip(&formats.colors).map(color).collect();
        let color_written = targets.iter().flatten().any(|target| target.write);
        let access = match depth_state {
            Some((state, format)) if alive => depth_stencil::access(state, format, reference, color_written),
            _ => Access::default(),
        };
        let changes = color_written || access.depth_write || access.stencil_write;
        let mut plan = Self {
            targets,
            depth_stencil: access,
            alpha_test: if alpha_test == Test::Evaluated && !changes { Test::Passes } else { alpha_test },
            alpha_to_coverage: state.multisample.alpha_to_coverage_enabled && changes,
            decisions: Vec::new(),
        };
        plan.decisions = explain::decisions(state, &formats, &plan, covers, outcomes, model);
        Ok(plan)
    }

    /// The plan that leaves nothing out: every part the state has is evaluated, every texel read and written.
    ///
    /// # Errors
    /// [`FormatError`] for formats without their role.
    pub fn everything(state: &MergerState, model: &dyn NumericModel) -> Result<Self, FormatError> {
        let formats = Formats::new(state)?;
        let all = Reads { source: [true; 4], second_source: true, constant: true, destination: true };
        let color = |(target, format): (&Option<ColorTargetState>, &Option<ColorFormat>)| {
            let (target, format) = (target.as_ref()?, (*format)?);
            let (blend, rewrite) = (target.blend.is_some(), model.rewrites_untouched(format));
            Some(TargetPlan { write: true, read: true, blend, reads: all, rewrite, whole: false })
        };
        let has_depth = formats.depth.is_some_and(|format| format.depth().is_some());
        let has_stencil = formats.depth.is_some_and(DepthFormat::has_stencil);
        Ok(Self {
            targets: state.targets.iter().zip(&formats.colors).map(color).collect(),
            depth_stencil: Access {
                depth_read: has_depth,
                depth_write: has_depth,
                stencil_read: has_stencil,
                stencil_write: has_stencil,
            },
            alpha_test: if state.alpha_test == AlphaTest::Off { Test::Passes } else { Test::Evaluated },
            alpha_to_coverage: state.multisample.alpha_to_coverage_enabled,
            decisions: Vec::new(),
        })
    }

    /// Whether the alpha of output 0 is read by anything.
    #[must_use]
    pub fn reads_source_alpha(&self) -> bool {
        let first = self.targets.first().copied().flatten().unwrap_or_default();
        self.alpha_test == Test::Evaluated || self.alpha_to_coverage || first.reads.source[3]
    }

    /// Whether a fragment can leave any trace.
    #[must_use]
    pub fn leaves_a_trace(&self) -> bool {
        let Access { depth_write, stencil_write, .. } = self.depth_stencil;
        depth_write || stencil_write || self.targets.iter().flatten().any(|target| target.write || target.rewrite)
    }
}

/// The formats of a state, in their roles.
pub(crate) struct Formats {
    pub(crate) colors: Vec<Option<ColorFormat>>,
    pub(crate) depth: Option<DepthFormat>,
}

impl Formats {
    fn new(state: &MergerState) -> Result<Self, FormatError> {
        let color = |target: &Option<ColorTargetState>| target.as_ref().map(|t| ColorFormat::new(t.format)).transpose();
        let depth = state.depth_stencil.as_ref().map(|depth| DepthFormat::new(depth.format)).transpose()?;
        Ok(Self { colors: state.targets.iter().map(color).collect::<Result<_, _>>()?, depth })
    }
}

/// Whether any fragment can cover a sample; without a model, as the specifications say.
fn can_cover(state: &MergerState, model: Option<&dyn NumericModel>) -> bool {
    let existing = u64::from(u32::MAX >> (32 - state.multisample.count.clamp(1, 32)));
    let empty = state.dynamic.scissor.is_some_and(|scissor| scissor.width == 0 || scissor.height == 0);
    let mask = model.map_or(state.multisample.mask, |model| model.sample_mask(&state.multisample));
    mask & existing != 0 && !empty
}

/// The alpha test where it does not depend on alpha. Comparisons with a NaN reference are false, but not-equal is true.
fn constant_alpha_test(test: AlphaTest) -> Test {
    use CompareFunction as C;
    match test {
        AlphaTest::Off | AlphaTest::On { compare: C::Always, .. } => Test::Passes,
        AlphaTest::On { compare: C::Never, .. } => Test::Fails,
        AlphaTest::On { compare: C::NotEqual, reference } if reference.is_nan() => Test::Passes,
        AlphaTest::On { reference, .. } if reference.is_nan() => Test::Fails,
        AlphaTest::On { .. } => Test::Evaluated,
    }
}

fn target_plan(
    target: &ColorTargetState,
    format: ColorFormat,
    model: Option<&dyn NumericModel>,
    can_pass: bool,
    covers: bool,
) -> TargetPlan {
    let stored: Vec<usize> = (0..4).filter(|&i| equation::stored(format, i)).collect();
    let masked_in = |i: &usize| target.write_mask.bits() >> i & 1 == 1;
    let written: Vec<usize> = stored.iter().copied().filter(masked_in).collect();
    let whole = written.len() == stored.len();
    let write = can_pass && !written.is_empty();
    let rewrite = covers && model.is_some_and(|model| model.rewrites_untouched(format));
    if !write {
        return TargetPlan { rewrite, whole, ..TargetPlan::default() };
    }
    let drops = |blend: &BlendState| model.is_some_and(|model| model.drops_zero_destination(format, blend));
    // Drivers fuse whole texels on float targets, so there the equation must be the source in every stored channel.
    let blend = target.blend.filter(|blend| {
        let finite = format.class() != TargetClass::Float;
        let (channels, known) = if finite { (&written, true) } else { (&stored, drops(blend)) };
        !(known && channels.iter().all(|&i| equation::is_source(blend, i, format)))
    });
    let equation_reads = |i: &usize| match &blend {
        Some(blend) => equation::reads(blend, *i, format, drops(blend)),
        None => Reads { source: std::array::from_fn(|channel| channel == *i), ..Reads::default() },
    };
    let reads = written.iter().map(equation_reads).fold(Reads::default(), Reads::union);
    TargetPlan { write, read: reads.destination || !whole, blend: blend.is_some(), reads, rewrite, whole }
}
