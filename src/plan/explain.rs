//! The parts of the output merger, each with the reason why a draw needs it or can do without.

use wgpu_types::{ColorTargetState, CompareFunction};

use super::depth_stencil::Outcomes;
use super::{Formats, Plan, TargetPlan, Test, equation};
use crate::format::{ColorFormat, DepthFormat, TargetClass};
use crate::merger::blend::component;
use crate::model::NumericModel;
use crate::state::{AlphaTest, MergerState};

/// A part of the output merger that a draw may do without.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
#[cfg_attr(feature = "json", serde(rename_all = "kebab-case"))]
pub enum Part {
    /// The fixed-function alpha test.
    AlphaTest,
    /// Alpha to coverage.
    AlphaToCoverage,
    /// Reading the stored stencil value.
    StencilRead,
    /// Writing stencil.
    StencilWrite,
    /// Reading the stored depth.
    DepthRead,
    /// Writing depth.
    DepthWrite,
    /// The alpha of the shader's output for a target; target 0's serves the alpha test too.
    SourceAlpha,
    /// The second source of dual-source blending.
    SecondSource,
    /// The blend constant.
    BlendConstant,
    /// Reading the stored texel.
    DestinationRead,
    /// The blend equation.
    Blend,
    /// Writing the texel.
    ColorWrite,
}

impl Part {
    /// The part in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AlphaTest => "alpha test",
            Self::AlphaToCoverage => "alpha to coverage",
            Self::StencilRead => "stencil read",
            Self::StencilWrite => "stencil write",
            Self::DepthRead => "depth read",
            Self::DepthWrite => "depth write",
            Self::SourceAlpha => "source alpha",
            Self::SecondSource => "second source",
            Self::BlendConstant => "blend constant",
            Self::DestinationRead => "destination read",
            Self::Blend => "blend",
            Self::ColorWrite => "color write",
        }
    }
}

/// Whether a part is needed, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Decision {
    /// The part.
    pub part: Part,
    /// Index of the color target, for parts that each target has.
    pub target: Option<usize>,
    /// Whether the draw needs it.
    pub needed: bool,
    /// What needs it, or why nobody can see that it is left out.
    pub reason: &'static str,
}

const NO_TRACE: &str = "nothing is written, so no outcome shows";

/// Every part of a state with its reason.
pub(super) fn decisions(
    state: &MergerState,
    formats: &Formats,
    plan: &Plan,
    covers: bool,
    outcomes: Outcomes,
    model: Option<&dyn NumericModel>,
) -> Vec<Decision> {
    let mut all = Vec::new();
    let mut add = |part, target, (needed, reason)| all.push(Decision { part, target, needed, reason });
    let dead = dead(covers, plan, outcomes);
    add(Part::AlphaTest, None, alpha_test(state.alpha_test, plan));
    add(Part::AlphaToCoverage, None, alpha_to_coverage(state, plan));
    for (part, decision) in depth_stencil(state, formats.depth, plan, dead) {
        add(part, None, decision);
    }
    for (index, target) in plan.targets.iter().enumerate() {
        let (Some(target), Some(Some(target_state)), Some(Some(format))) =
            (target, state.targets.get(index), formats.colors.get(index))
        else {
            continue;
        };
        let target = Target { state: target_state, format: *format, plan: target, dead, model };
        let alpha_tests = index == 0 && (plan.alpha_test == Test::Evaluated || plan.alpha_to_coverage);
        add(Part::SourceAlpha, Some(index), target.source_alpha(alpha_tests));
        add(Part::SecondSource, Some(index), target.second_source());
        add(Part::BlendConstant, Some(index), target.constant());
        add(Part::DestinationRead, Some(index), target.destination_read());
        add(Part::Blend, Some(index), target.blend());
        add(Part::ColorWrite, Some(index), target.write());
    }
    all
}

/// Why no fragment reaches the color targets, if so.
fn dead(covers: bool, plan: &Plan, outcomes: Outcomes) -> Option<&'static str> {
    if !covers {
        Some("no sample can be covered: the scissor is empty or the sample mask has no bit")
    } else if plan.alpha_test == Test::Fails {
        Some("no fragment passes the alpha test")
    } else if outcomes.depth == Some(false) {
        Some("no fragment passes the depth test")
    } else if !outcomes.can_pass {
        Some("no fragment passes the stencil test")
    } else {
        None
    }
}

fn alpha_test(test: AlphaTest, plan: &Plan) -> (bool, &'static str) {
    match (test, plan.alpha_test) {
        (_, Test::Evaluated) => (true, "its outcome depends on alpha"),
        (AlphaTest::Off, _) => (false, "it is off"),
        (AlphaTest::On { compare: CompareFunction::Always, .. }, _) => (false, "it always passes, NaN included"),
        (_, Test::Fails) => (false, "it never passes, whatever the alpha"),
        (AlphaTest::On { reference, .. }, Test::Passes) if reference.is_nan() => {
            (false, "every alpha differs from a NaN reference")
        }
        (_, Test::Passes) => (false, NO_TRACE),
    }
}

fn alpha_to_coverage(state: &MergerState, plan: &Plan) -> (bool, &'static str) {
    match (plan.alpha_to_coverage, state.multisample.alpha_to_coverage_enabled) {
        (true, _) => (true, "it drops samples by alpha"),
        (false, false) => (false, "it is off"),
        (false, true) => (false, NO_TRACE),
    }
}

type Reasoned = (Part, (bool, &'static str));

fn depth_stencil(
    state: &MergerState,
    format: Option<DepthFormat>,
    plan: &Plan,
    dead: Option<&'static str>,
) -> [Reasoned; 4] {
    let access = plan.depth_stencil;
    let has_depth = format.is_some_and(|format| format.depth().is_some());
    let has_stencil = format.is_some_and(DepthFormat::has_stencil);
    let depth_state = state.depth_stencil.as_ref();
    let compare = depth_state.and_then(|state| state.depth_compare).unwrap_or_default();
    let stencil_read = match access.stencil_read {
        true => (true, "the test or the new value depends on what is stored"),
        false if !has_stencil => (false, "there is no stencil attachment"),
        false if access.stencil_write => (false, "the test's outcome and the value written are always the same"),
        false => (false, "the test's outcome is always the same or shows nowhere, and no value changes"),
    };
    let stencil_write = match access.stencil_write {
        true => (true, "an operation that can be reached changes the value"),
        false if !has_stencil => (false, "there is no stencil attachment"),
        false => (false, "every operation that can be reached keeps the value"),
    };
    let depth_read = match access.depth_read {
        true => (true, "the test compares with what is stored"),
        false if !has_depth => (false, "there is no depth attachment"),
        false if compare == CompareFunction::Always => (false, "the test always passes"),
        false if compare == CompareFunction::Never => (false, "the test never passes"),
        false => (false, dead.unwrap_or(NO_TRACE)),
    };
    let depth_write = match access.depth_write {
        true => (true, "fragments that pass store their depth"),
        false if !has_depth => (false, "there is no depth attachment"),
        false if depth_state.is_none_or(|state| state.depth_write_enabled != Some(true)) => {
            (false, "depth write is off")
        }
        false => (false, dead.unwrap_or("the test passes only where the same code is stored already")),
    };
    [
        (Part::StencilRead, stencil_read),
        (Part::StencilWrite, stencil_write),
        (Part::DepthRead, depth_read),
        (Part::DepthWrite, depth_write),
    ]
}

/// One color target and what is known of it.
struct Target<'a> {
    state: &'a ColorTargetState,
    format: ColorFormat,
    plan: &'a TargetPlan,
    dead: Option<&'static str>,
    model: Option<&'a dyn NumericModel>,
}

impl Target<'_> {
    /// Why nothing is written.
    fn unwritten(&self) -> &'static str {
        self.dead.unwrap_or("the write mask names no channel that the format stores")
    }

    fn source_alpha(&self, alpha_tests: bool) -> (bool, &'static str) {
        let stored = self.plan.write && equation::stored(self.format, 3);
        match (self.plan.reads.source[3], alpha_tests) {
            (_, true) => (true, "a test reads it"),
            (true, _) if self.plan.blend => (true, "the blend equation reads it"),
            (true, _) => (true, "it is stored"),
            (false, _) if !self.plan.write => (false, self.unwritten()),
            (false, _) if !stored => (false, "the format has no alpha, and no factor and no test reads it"),
            (false, _) => (false, "alpha is masked or multiplied by zero, and no factor and no test reads it"),
        }
    }

    fn second_source(&self) -> (bool, &'static str) {
        match self.plan.reads.second_source {
            true => (true, "a blend factor reads it"),
            false if !self.plan.write => (false, self.unwritten()),
            false => (false, "no blend factor that counts reads it"),
        }
    }

    fn constant(&self) -> (bool, &'static str) {
        match self.plan.reads.constant {
            true => (true, "a blend factor reads it"),
            false if !self.plan.write => (false, self.unwritten()),
            false => (false, "no blend factor that counts reads it"),
        }
    }

    /// The destination factor is the constant zero in some written channel of an equation that takes factors.
    fn has_zero_term(&self) -> bool {
        let Some(blend) = &self.state.blend else { return false };
        (0..4).filter(|&i| equation::stored(self.format, i)).any(|i| {
            let part = component(blend, i);
            let factor = equation::fold(part.dst_factor, i, self.format);
            factor == wgpu_types::BlendFactor::Zero
        })
    }

    fn destination_read(&self) -> (bool, &'static str) {
        let float = self.format.class() == TargetClass::Float;
        let drops =
            self.state.blend.as_ref().zip(self.model).is_some_and(|(b, m)| m.drops_zero_destination(self.format, b));
        let zero_shows = self.plan.blend && float && self.has_zero_term() && !drops;
        match (self.plan.read, self.state.blend.is_some()) {
            (true, _) if !self.plan.whole => (true, "the write mask leaves channels out, which keep their bits"),
            (true, _) if zero_shows => (
                true,
                "the factor is zero, but zero times NaN, infinity or a negative number of a float target shows in the result",
            ),
            (true, _) => (true, "the blend equation reads it"),
            (false, _) if self.plan.rewrite => {
                (true, "where a fragment may not change the texel, the model decodes and encodes it all the same")
            }
            (false, _) if !self.plan.write => (false, self.unwritten()),
            (false, false) => (false, "blending is off and every stored channel is written"),
            (false, true) if float => (false, "the factor is zero and this model drops such terms, NaN or not"),
            (false, true) => (false, "the factor is zero, and a normalised target holds no NaN or infinity"),
        }
    }

    fn blend(&self) -> (bool, &'static str) {
        match (self.plan.blend, self.state.blend.is_some()) {
            (true, _) => (true, "the result is not the source alone"),
            (false, false) => (false, "blending is off"),
            (false, true) if !self.plan.write => (false, self.unwritten()),
            (false, true) => (false, "source times one and destination times zero is the source"),
        }
    }

    fn write(&self) -> (bool, &'static str) {
        match (self.plan.write, self.plan.rewrite) {
            (true, _) => (true, "fragments that pass store their color"),
            (false, true) => (true, "the model decodes and encodes covered texels even where nothing may change"),
            (false, false) => (false, self.unwritten()),
        }
    }
}
