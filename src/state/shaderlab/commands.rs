//! The state commands, one function each.

use wgpu_types::{
    BlendComponent, BlendOperation, BlendState, ColorWrites, CompareFunction, DepthBiasState, Face, StencilFaceState,
    StencilOperation, StencilState,
};

use super::parser::{Parser, error};
use super::property::{BLEND_MODES, BLEND_OPERATIONS, COMPARE_FUNCTIONS, CULL_MODES, STENCIL_OPERATIONS, SWITCHES};
use super::{Position, ShaderLabError};
use crate::state::block::{StateBlock, queue_number};
use crate::state::{AlphaTest, MAX_COLOR_TARGETS, spelling};

type Result<T> = std::result::Result<T, ShaderLabError>;

/// The commands there are, for the message about an unknown one.
const COMMANDS: &str =
    "Blend, BlendOp, ZWrite, ZTest, ColorMask, Cull, Offset, AlphaTest, Stencil, Tags, Pass, SubShader";

/// Reads one command's arguments into `state`.
pub(super) fn command(parser: &mut Parser<'_>, word: &str, at: Position, state: &mut StateBlock) -> Result<()> {
    match word {
        "Blend" => blend(parser, state),
        "BlendOp" => blend_operation(parser, state),
        "ZWrite" => {
            state.depth_write = switch(parser, "ZWrite")?;
            Ok(())
        }
        "ZTest" => {
            // `ZTest Off` and the number 0 turn the test off, which always passes.
            state.depth_compare = comparison(parser, "a comparison")?.unwrap_or(CompareFunction::Always);
            Ok(())
        }
        "ColorMask" => color_mask(parser, state),
        "Cull" => cull(parser, state),
        "Offset" => offset(parser, state),
        "AlphaTest" => alpha_test(parser, state),
        "Stencil" => stencil(parser, state),
        "Tags" => tags(parser, state),
        "Lighting" | "ZClip" | "AlphaToMask" | "Conservative" | "Fog" | "SetTexture" | "Material" => {
            Err(error(at, format!("`{word}` is ShaderLab, but no part of the state outmerge models; remove it")))
        }
        _ => Err(error(at, format!("unknown command `{word}`; known are {COMMANDS}"))),
    }
}

/// A leading target index, if the next word is one: the targets a command is for.
fn target_range(parser: &mut Parser<'_>) -> Result<std::ops::Range<usize>> {
    let at = parser.at();
    match parser.peek_word().and_then(|word| word.parse::<usize>().ok()) {
        None => Ok(0..MAX_COLOR_TARGETS),
        Some(index) if index < MAX_COLOR_TARGETS => {
            parser.skip();
            Ok(index..index + 1)
        }
        Some(index) => {
            Err(error(at, format!("there is no target {index}; targets are 0 to {}", MAX_COLOR_TARGETS - 1)))
        }
    }
}

/// `Blend Off`, `Blend [target] A B`, `Blend [target] A B, C D`.
fn blend(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    let targets = target_range(parser)?;
    if parser.peek_word() == Some("Off") {
        parser.skip();
        state.blend[targets].fill(None);
        return Ok(());
    }
    let color = (factor(parser)?, factor(parser)?);
    let alpha = if parser.accept(',') { (factor(parser)?, factor(parser)?) } else { color };
    for target in &mut state.blend[targets] {
        let old = target.unwrap_or(BlendState::REPLACE);
        *target = Some(BlendState {
            color: BlendComponent { src_factor: color.0, dst_factor: color.1, operation: old.color.operation },
            alpha: BlendComponent { src_factor: alpha.0, dst_factor: alpha.1, operation: old.alpha.operation },
        });
    }
    normalise_extremes(state);
    Ok(())
}

/// `BlendOp [target] X`, `BlendOp [target] X, Y`. Without a `Blend` it blends with factors one and zero.
fn blend_operation(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    let targets = target_range(parser)?;
    let operation = |parser: &mut Parser<'_>| {
        let (name, at) = parser.name("a blend operation", &BLEND_OPERATIONS)?;
        spelling::blend_operation(&name).map_err(|e| error(at, e.to_string()))
    };
    let color = operation(parser)?;
    let alpha = if parser.accept(',') { operation(parser)? } else { color };
    for target in &mut state.blend[targets] {
        let mut blend = target.unwrap_or(BlendState::REPLACE);
        blend.color.operation = color;
        blend.alpha.operation = alpha;
        *target = Some(blend);
    }
    normalise_extremes(state);
    Ok(())
}

/// Min and max ignore factors; WebGPU wants them to be one.
fn normalise_extremes(state: &mut StateBlock) {
    for blend in state.blend.iter_mut().flatten() {
        for component in [&mut blend.color, &mut blend.alpha] {
            if matches!(component.operation, BlendOperation::Min | BlendOperation::Max) {
                component.src_factor = wgpu_types::BlendFactor::One;
                component.dst_factor = wgpu_types::BlendFactor::One;
            }
        }
    }
}

fn factor(parser: &mut Parser<'_>) -> Result<wgpu_types::BlendFactor> {
    let (name, at) = parser.name("a blend factor", &BLEND_MODES)?;
    spelling::blend_factor(&name).map_err(|e| error(at, e.to_string()))
}

fn switch(parser: &mut Parser<'_>, what: &str) -> Result<bool> {
    let (name, at) = parser.name("On or Off", &SWITCHES)?;
    match name.to_ascii_lowercase().as_str() {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(error(at, format!("`{what} {name}`: write On or Off"))),
    }
}

/// A comparison; `None` for Off.
fn comparison(parser: &mut Parser<'_>, what: &str) -> Result<Option<CompareFunction>> {
    let (name, at) = parser.name(what, &COMPARE_FUNCTIONS)?;
    if name.eq_ignore_ascii_case("off") || name.eq_ignore_ascii_case("disabled") {
        return Ok(None);
    }
    spelling::compare_function(&name).map(Some).map_err(|e| error(at, e.to_string()))
}

/// `ColorMask RGB`, `ColorMask 0`, `ColorMask RGB 1`, `ColorMask [_Mask]` (Unity numbers: A 1, B 2, G 4, R 8).
fn color_mask(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    const BY_NUMBER: [&str; 16] =
        ["0", "A", "B", "BA", "G", "GA", "GB", "GBA", "R", "RA", "RB", "RBA", "RG", "RGA", "RGB", "RGBA"];
    let (name, at) = parser.name("channels out of R, G, B, A", &BY_NUMBER)?;
    let mut mask = ColorWrites::empty();
    for channel in name.chars().filter(|_| name != "0") {
        mask |= match channel.to_ascii_uppercase() {
            'R' => ColorWrites::RED,
            'G' => ColorWrites::GREEN,
            'B' => ColorWrites::BLUE,
            'A' => ColorWrites::ALPHA,
            _ => return Err(error(at, format!("`ColorMask {name}`: write 0, or letters out of R, G, B, A"))),
        };
    }
    let targets = target_range(parser)?;
    state.write_mask[targets].fill(mask);
    Ok(())
}

fn cull(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    let (name, at) = parser.name("Back, Front or Off", &CULL_MODES)?;
    state.cull = match name.to_ascii_lowercase().as_str() {
        "off" => None,
        "front" => Some(Face::Front),
        "back" => Some(Face::Back),
        _ => return Err(error(at, format!("`Cull {name}`: write Back, Front or Off"))),
    };
    Ok(())
}

/// `Offset factor, units`: slope scale and constant of the depth bias.
fn offset(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    let slope = parser.number("the offset's factor")?;
    parser.mark(',')?;
    let at = parser.at();
    let units = parser.number("the offset's units")?;
    if units.fract() != 0.0 || units.abs() > f64::from(i32::MAX) {
        return Err(error(at, format!("the offset's units are {units}; WebGPU's depth bias is a whole number")));
    }
    #[expect(clippy::cast_possible_truncation, reason = "whole and within i32, as just checked; the slope is an f32")]
    let (constant, slope_scale) = (units as i32, slope as f32);
    state.depth_bias = DepthBiasState { constant, slope_scale, clamp: 0.0 };
    Ok(())
}

/// `AlphaTest Off`, `AlphaTest Greater 0.5`, `AlphaTest Greater [_Cutoff]`.
fn alpha_test(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    state.alpha_test = match comparison(parser, "a comparison or Off")? {
        None => AlphaTest::Off,
        // Always and Never may stand without a reference.
        Some(compare @ (CompareFunction::Always | CompareFunction::Never))
            if parser.peek_word().is_none_or(|word| word.parse::<f64>().is_err()) =>
        {
            AlphaTest::On { compare, reference: 0.0 }
        }
        Some(compare) => {
            let reference = parser.number("the alpha test's reference value")?;
            #[expect(clippy::cast_possible_truncation, reason = "references are f32")]
            let reference = reference as f32;
            AlphaTest::On { compare, reference }
        }
    };
    Ok(())
}

/// `Stencil { Ref 1 ReadMask 255 WriteMask 255 Comp Equal Pass Keep Fail Keep ZFail Keep }`, with `Front`/`Back` forms.
fn stencil(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    let start = parser.at();
    parser.mark('{')?;
    let mut stencil = StencilState {
        front: StencilFaceState::IGNORE,
        back: StencilFaceState::IGNORE,
        read_mask: 255,
        write_mask: 255,
    };
    let mut reference = 0;
    while !parser.accept('}') {
        let at = parser.at();
        let Some(word) = parser.peek_word().map(str::to_owned) else {
            return Err(error(start, "this Stencil block is never closed with `}`"));
        };
        parser.skip();
        match word.as_str() {
            "Ref" => reference = byte(parser)?,
            "ReadMask" => stencil.read_mask = byte(parser)?,
            "WriteMask" => stencil.write_mask = byte(parser)?,
            _ => {
                let (command, front, back) = if let Some(command) = word.strip_suffix("Front") {
                    (command, true, false)
                } else if let Some(command) = word.strip_suffix("Back") {
                    (command, false, true)
                } else {
                    (word.as_str(), true, true)
                };
                let mut set = |change: &dyn Fn(&mut StencilFaceState)| {
                    if front {
                        change(&mut stencil.front);
                    }
                    if back {
                        change(&mut stencil.back);
                    }
                };
                match command {
                    "Comp" => {
                        let compare = comparison(parser, "a comparison")?.unwrap_or(CompareFunction::Always);
                        set(&|face| face.compare = compare);
                    }
                    "Pass" => {
                        let operation = stencil_operation(parser)?;
                        set(&|face| face.pass_op = operation);
                    }
                    "Fail" => {
                        let operation = stencil_operation(parser)?;
                        set(&|face| face.fail_op = operation);
                    }
                    "ZFail" => {
                        let operation = stencil_operation(parser)?;
                        set(&|face| face.depth_fail_op = operation);
                    }
                    _ => {
                        return Err(error(
                            at,
                            format!(
                                "unknown stencil command `{word}`; known are Ref, ReadMask, WriteMask, Comp, Pass, Fail, \
                                 ZFail, each of the last four also with Front or Back"
                            ),
                        ));
                    }
                }
            }
        }
    }
    state.stencil = Some((stencil, reference));
    Ok(())
}

fn byte(parser: &mut Parser<'_>) -> Result<u32> {
    let at = parser.at();
    let number = parser.number("a number from 0 to 255")?;
    (0..=255_u32)
        .find(|i| f64::from(*i) == number)
        .ok_or_else(|| error(at, format!("{number} is not a whole number from 0 to 255")))
}

fn stencil_operation(parser: &mut Parser<'_>) -> Result<StencilOperation> {
    let (name, at) = parser.name("a stencil operation", &STENCIL_OPERATIONS)?;
    Ok(match name.to_ascii_lowercase().as_str() {
        "keep" => StencilOperation::Keep,
        "zero" => StencilOperation::Zero,
        "replace" => StencilOperation::Replace,
        "incrsat" | "increment-clamp" => StencilOperation::IncrementClamp,
        "decrsat" | "decrement-clamp" => StencilOperation::DecrementClamp,
        "invert" => StencilOperation::Invert,
        "incrwrap" | "increment-wrap" => StencilOperation::IncrementWrap,
        "decrwrap" | "decrement-wrap" => StencilOperation::DecrementWrap,
        _ => {
            let known = STENCIL_OPERATIONS.join(", ");
            return Err(error(at, format!("unknown stencil operation `{name}`; known are {known}")));
        }
    })
}

/// `Tags { "Queue" = "Transparent" "RenderType" = "Transparent" }`; a queue must be one.
fn tags(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    parser.mark('{')?;
    while !parser.accept('}') {
        let key = parser.text("a tag's name, or `}`,")?;
        parser.mark('=')?;
        let at = parser.at();
        let value = parser.text("the tag's value")?;
        if key == "Queue" {
            queue_number(&value).map_err(|e| error(at, e.to_string()))?;
        }
        state.tags.retain(|(known, _)| *known != key);
        state.tags.push((key, value));
    }
    Ok(())
}
