//! The stages a fragment met, each with the comparison it made and the numbers in it.

use wgpu_types::{ColorWrites, CompareFunction, StencilOperation};

use crate::format::DepthFormat;
use crate::fragment::Fragment;
use crate::merger::depth_stencil::stencil_matters;
use crate::merger::{Fate, SampleTrace};
use crate::model::decimal;
use crate::scene::draw::Draw;
use crate::state::{AlphaTest, spelling};

/// What a stage did with the fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
#[cfg_attr(feature = "json", serde(rename_all = "kebab-case"))]
pub enum Verdict {
    /// The state has no such stage.
    Off,
    /// It went on.
    Passed,
    /// It ended here.
    Failed,
}

/// One stage.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Stage {
    /// Its name.
    pub name: &'static str,
    /// What became of the fragment.
    pub verdict: Verdict,
    /// The comparison with its numbers, or what was written.
    pub detail: String,
}

/// The stages up to the one that ended the fragment.
pub(super) fn stages(draw: &Draw, fragment: &Fragment, sample: &SampleTrace) -> Vec<Stage> {
    let alpha = fragment.outputs[0][3];
    let mut all = vec![coverage(sample), discard(draw, sample), alpha_test(draw.state.alpha_test, alpha, sample)];
    if draw.state.multisample.alpha_to_coverage_enabled {
        let detail = format!("alpha {alpha}");
        all.push(Stage { name: "alpha to coverage", verdict: verdict(sample, Fate::AlphaToCoverage), detail });
    }
    all.push(stencil(draw, fragment, sample));
    all.push(depth(draw, fragment, sample));
    all.push(writes(draw));
    let end = all.iter().position(|stage| stage.verdict == Verdict::Failed).map_or(all.len(), |failed| failed + 1);
    all.truncate(end);
    all
}

fn verdict(sample: &SampleTrace, failure: Fate) -> Verdict {
    if sample.fate == failure { Verdict::Failed } else { Verdict::Passed }
}

fn off(name: &'static str, detail: &str) -> Stage {
    Stage { name, verdict: Verdict::Off, detail: detail.to_owned() }
}

fn coverage(sample: &SampleTrace) -> Stage {
    let detail = "scissor, primitive and sample mask".to_owned();
    Stage { name: "coverage", verdict: verdict(sample, Fate::NotCovered), detail }
}

fn discard(draw: &Draw, sample: &SampleTrace) -> Stage {
    if !draw.keywords.clip {
        return off("discard", "the mode does not clip");
    }
    let failed = verdict(sample, Fate::Discarded);
    let relation = if failed == Verdict::Failed { "below" } else { "at or above" };
    let detail = format!("clip: the material's alpha is {relation} the cutoff {}", draw.material.cutoff);
    Stage { name: "discard", verdict: failed, detail }
}

fn alpha_test(test: AlphaTest, alpha: f32, sample: &SampleTrace) -> Stage {
    let AlphaTest::On { compare, reference } = test else { return off("alpha test", "") };
    let detail = comparison(compare, &format!("alpha {alpha}"), &reference.to_string());
    Stage { name: "alpha test", verdict: verdict(sample, Fate::AlphaTestFailed), detail }
}

fn stencil(draw: &Draw, fragment: &Fragment, sample: &SampleTrace) -> Stage {
    let state = draw.state.depth_stencil.as_ref();
    let has = state.and_then(|state| DepthFormat::new(state.format).ok()).is_some_and(DepthFormat::has_stencil);
    let (Some(state), true) = (state, has) else { return off("stencil", "no stencil target") };
    if !stencil_matters(&state.stencil) {
        return off("stencil", "always passes and keeps the value");
    }
    let Some((_, before, after)) = sample.depth_stencil else { return off("stencil", "not reached") };
    let face = if fragment.front_facing { &state.stencil.front } else { &state.stencil.back };
    let low = |x: u32| x & 0xff;
    let (reference, mask) = (low(draw.state.dynamic.stencil_reference), low(state.stencil.read_mask));
    let masked = |x: u32| if mask == 0xff { x.to_string() } else { format!("({x} & {mask:#04x})") };
    let compared =
        comparison(face.compare, &format!("reference {}", masked(reference)), &masked(u32::from(before.stencil)));
    let (which, operation) = match sample.fate {
        Fate::StencilFailed => ("failOp", face.fail_op),
        Fate::DepthFailed => ("depthFailOp", face.depth_fail_op),
        _ => ("passOp", face.pass_op),
    };
    let written = match operation {
        StencilOperation::Keep => String::new(),
        other => {
            let name = spelling::stencil_operation_name(other);
            format!(", {which} {name}: {} becomes {}", before.stencil, after.stencil)
        }
    };
    Stage { name: "stencil", verdict: verdict(sample, Fate::StencilFailed), detail: compared + &written }
}

fn depth(draw: &Draw, fragment: &Fragment, sample: &SampleTrace) -> Stage {
    let state = draw.state.depth_stencil.as_ref();
    let kind = state.and_then(|state| DepthFormat::new(state.format).ok()).and_then(DepthFormat::depth);
    let (Some(state), Some(kind)) = (state, kind) else { return off("depth", "no depth target") };
    let Some((code, before, after)) = sample.depth_stencil else { return off("depth", "not reached") };
    let compare = state.depth_compare.unwrap_or_default();
    let shown = |code: u32| decimal(kind.value(code));
    let clamped = if (0.0..=1.0).contains(&fragment.depth) { "" } else { ", clamped" };
    let compared = comparison(compare, &format!("depth {}{clamped}", shown(code)), &shown(before.depth));
    let failed = verdict(sample, Fate::DepthFailed);
    let writes = state.depth_write_enabled == Some(true);
    let written = match (failed, writes) {
        (Verdict::Failed, _) => String::new(),
        (_, true) => format!(", {} written", shown(after.depth)),
        (_, false) => ", no depth write".to_owned(),
    };
    Stage { name: "depth", verdict: failed, detail: compared + &written }
}

fn writes(draw: &Draw) -> Stage {
    let masks: Vec<ColorWrites> = draw.state.targets.iter().flatten().map(|target| target.write_mask).collect();
    let name = |mask: ColorWrites| {
        let letters = [(ColorWrites::RED, 'R'), (ColorWrites::GREEN, 'G'), (ColorWrites::BLUE, 'B')];
        let all = letters.into_iter().chain([(ColorWrites::ALPHA, 'A')]);
        let written: String = all.filter(|(bit, _)| mask.contains(*bit)).map(|(_, letter)| letter).collect();
        if written.is_empty() { "nothing".to_owned() } else { written }
    };
    let detail = masks.into_iter().map(name).collect::<Vec<_>>().join("; ");
    Stage { name: "color write", verdict: Verdict::Passed, detail }
}

/// `left op right`, with the comparison's sign where it has one.
fn comparison(compare: CompareFunction, left: &str, right: &str) -> String {
    match compare {
        CompareFunction::Never => format!("never, {left}"),
        CompareFunction::Always => format!("always, {left}"),
        other => format!("{left} {} {right}", sign(other)),
    }
}

fn sign(compare: CompareFunction) -> &'static str {
    match compare {
        CompareFunction::Never => "never",
        CompareFunction::Less => "<",
        CompareFunction::Equal => "==",
        CompareFunction::LessEqual => "<=",
        CompareFunction::Greater => ">",
        CompareFunction::NotEqual => "!=",
        CompareFunction::GreaterEqual => ">=",
        CompareFunction::Always => "always",
    }
}
