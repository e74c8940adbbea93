//! The rules, one a file.

mod blend_constant;
mod blended_first;
mod depth_write;
mod destination_alpha;
mod double_multiply;
mod one_zero;
mod prepass_cutoff;
mod queue;
mod straight_source;

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use super::{Example, Rule, StateQuestion, written_blend};
use crate::format::Codes;
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel};
use crate::scene::Draw;

/// Every rule.
pub const RULES: [Rule; 9] = [
    destination_alpha::RULE,
    double_multiply::RULE,
    straight_source::RULE,
    depth_write::RULE,
    blended_first::RULE,
    prepass_cutoff::RULE,
    blend_constant::RULE,
    one_zero::RULE,
    queue::RULE,
];

/// Color alone, alpha alone, and both.
const COLOR: [bool; 4] = [true, true, true, false];
const ALPHA: [bool; 4] = [false, false, false, true];
const ALL: [bool; 4] = [true; 4];

/// Whether a component's result depends on the destination.
fn reads_destination(component: &BlendComponent) -> bool {
    matches!(component.operation, BlendOperation::Min | BlendOperation::Max)
        || component.dst_factor != BlendFactor::Zero
        || matches!(
            component.src_factor,
            BlendFactor::Dst
                | BlendFactor::OneMinusDst
                | BlendFactor::DstAlpha
                | BlendFactor::OneMinusDstAlpha
                | BlendFactor::SrcAlphaSaturated
        )
}

/// Whether a blend state mixes source and destination.
fn blends(blend: &BlendState) -> bool {
    reads_destination(&blend.color) || reads_destination(&blend.alpha)
}

/// Whether a draw mixes its color with what is there, on any target.
fn draw_blends(draw: &Draw) -> bool {
    draw.state.targets.iter().flatten().filter_map(written_blend).any(blends)
}

/// Whether a draw writes any color target.
fn writes_color(draw: &Draw) -> bool {
    draw.state.targets.iter().flatten().any(|target| !target.write_mask.is_empty())
}

/// The blend states of a draw's written targets, to change.
fn blends_mut(draw: &mut Draw) -> impl Iterator<Item = &mut BlendState> {
    draw.state.targets.iter_mut().flatten().filter_map(|target| target.blend.as_mut())
}

/// Colors that most examples use.
const GREY: [f32; 4] = [0.25, 0.25, 0.25, 1.0];

/// The codes of a number.
fn stored(question: &StateQuestion, value: [f32; 4]) -> Codes {
    merge(question, None, value, [0; 4])
}

/// One blend in the `exact` model.
fn merge(question: &StateQuestion, blend: Option<BlendState>, src: [f32; 4], dst: Codes) -> Codes {
    let constant = question.constant.unwrap_or_default();
    let inputs = ColorInputs { format: question.format, blend, constant, src, src1: [0.0; 4], dst };
    Exact::default().merge_color(&inputs)
}

/// One blend of `src` over `dst`, as the state has it and repaired.
fn example(question: &StateQuestion, repaired: Option<BlendState>, src: [f32; 4], dst: [f32; 4]) -> Example {
    let codes = stored(question, dst);
    Example {
        pixel: None,
        given: format!("source {src:?} over {dst:?}"),
        target: 0,
        format: question.format,
        stored: merge(question, question.block.blend[0], src, codes),
        repaired: merge(question, repaired, src, codes),
    }
}
