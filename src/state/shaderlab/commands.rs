//! The state commands, one function each.

use wgpu_types::{ColorWrites, CompareFunction, DepthBiasState, Face};

use super::draft::Draft;
use super::lexer::Kind;
use super::parser::{Parser, error};
use super::property::{BLEND_MODES, BLEND_OPERATIONS, COMPARE_FUNCTIONS, CULL_MODES, SWITCHES};
use super::{Position, ShaderLabError};
use crate::state::block::{StateBlock, queue_number};
use crate::state::{AlphaTest, MAX_COLOR_TARGETS, spelling};

type Result<T> = std::result::Result<T, ShaderLabError>;

/// The commands there are, for the message about an unknown one.
const COMMANDS: [&str; 20] = [
    "Blend",
    "BlendOp",
    "ZWrite",
    "ZTest",
    "ColorMask",
    "Cull",
    "Offset",
    "AlphaTest",
    "Stencil",
    "Tags",
    "Pass",
    "SubShader",
    "Category",
    "Properties",
    "Name",
    "LOD",
    "Fallback",
    "ZClip",
    "AlphaToMask",
    "Lighting",
];

/// Tags a block may have; a bound for malformed input.
const MAX_TAGS: usize = 64;

/// Reads one command's arguments into `draft`.
pub(super) fn command(parser: &mut Parser<'_>, word: &str, at: Position, draft: &mut Draft) -> Result<()> {
    let state = &mut draft.block;
    match word.to_ascii_lowercase().as_str() {
        "blend" => blend(parser, draft),
        "blendop" => blend_operation(parser, draft),
        "zwrite" => {
            state.depth_write = switch(parser, "ZWrite")?;
            Ok(())
        }
        "ztest" => {
            // `ZTest Off` and the number 0 turn the test off, which always passes.
            state.depth_compare = comparison(parser, "a comparison")?.unwrap_or(CompareFunction::Always);
            Ok(())
        }
        "colormask" => color_mask(parser, state),
        "cull" => cull(parser, state),
        "offset" => offset(parser, state),
        "alphatest" => alpha_test(parser, state),
        "stencil" => super::stencil::stencil(parser, at, state),
        "tags" => tags(parser, at, state),
        "zclip" => neutral(parser, word, &["True", "On"]),
        "alphatomask" | "lighting" | "separatespecular" => neutral(parser, word, &["Off"]),
        "conservative" => neutral(parser, word, &["False", "Off"]),
        "fog" => {
            parser.mark('{')?;
            let at = parser.at();
            if !parser.accept_word("Mode") {
                return Err(error(at, "outmerge has no fog; write `Fog { Mode Off }`, or leave it out"));
            }
            neutral(parser, "Fog { Mode", &["Off"])?;
            parser.mark('}')
        }
        "settexture" | "material" | "color" | "colormaterial" | "bindchannels" => Err(error(
            at,
            format!("`{word}` belongs to fixed-function shading, which outmerge leaves to the caller; remove it"),
        )),
        _ => Err(error(at, unknown(word))),
    }
}

fn unknown(word: &str) -> String {
    let nearest = COMMANDS
        .iter()
        .map(|known| (spelling::distance(&known.to_ascii_lowercase(), &word.to_ascii_lowercase()), *known))
        .min();
    let hint = match nearest {
        Some((steps, near)) if 3 * steps <= word.chars().count() => format!("; did you mean `{near}`?"),
        _ => String::new(),
    };
    let word: String = word.chars().take(60).collect();
    format!("unknown command `{word}`{hint}; known are {}", COMMANDS.join(", "))
}

/// A command that is no part of the state modelled, accepted where it says the default.
fn neutral(parser: &mut Parser<'_>, command: &str, defaults: &[&str]) -> Result<()> {
    let at = parser.at();
    if defaults.iter().any(|word| parser.accept_word(word)) {
        return Ok(());
    }
    let default = defaults[0];
    Err(error(
        at,
        format!("`{command}` is no part of the state outmerge models; write `{command} {default}`, or remove it"),
    ))
}

/// A leading target index, if the next word is one: the targets a command is for.
fn target_range(parser: &mut Parser<'_>) -> Result<std::ops::Range<usize>> {
    let at = parser.at();
    match parser.peek_word().and_then(|word| word.parse::<usize>().ok()) {
        None => Ok(0..MAX_COLOR_TARGETS),
        Some(index) if index < MAX_COLOR_TARGETS => {
            parser.take();
            Ok(index..index + 1)
        }
        Some(index) => {
            Err(error(at, format!("there is no target {index}; targets are 0 to {}", MAX_COLOR_TARGETS - 1)))
        }
    }
}

/// `Blend [target] Off`, `Blend [target] A B`, `Blend [target] A B, C D`.
fn blend(parser: &mut Parser<'_>, draft: &mut Draft) -> Result<()> {
    let targets = target_range(parser)?;
    if parser.accept_word("Off") {
        draft.factors[targets].fill(None);
        return Ok(());
    }
    let color = (factor(parser)?, factor(parser)?);
    let alpha = if parser.accept(',') { (factor(parser)?, factor(parser)?) } else { color };
    draft.factors[targets].fill(Some((color, alpha)));
    Ok(())
}

/// `BlendOp [target] X`, `BlendOp [target] X, Y`.
fn blend_operation(parser: &mut Parser<'_>, draft: &mut Draft) -> Result<()> {
    let targets = target_range(parser)?;
    let operation = |parser: &mut Parser<'_>| {
        let (name, at) = parser.name("a blend operation", &BLEND_OPERATIONS)?;
        spelling::blend_operation(&name).map_err(|e| error(at, e.to_string()))
    };
    let color = operation(parser)?;
    let alpha = if parser.accept(',') { operation(parser)? } else { color };
    draft.operations[targets].fill((color, alpha));
    Ok(())
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
        _ => Err(error(at, format!("`{what} {}`: write On or Off", cut(&name)))),
    }
}

/// A comparison; `None` for Off.
pub(super) fn comparison(parser: &mut Parser<'_>, what: &str) -> Result<Option<CompareFunction>> {
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
            _ => {
                return Err(error(at, format!("`ColorMask {}`: write 0, or letters out of R, G, B, A", cut(&name))));
            }
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
        _ => return Err(error(at, format!("`Cull {}`: write Back, Front or Off", cut(&name)))),
    };
    Ok(())
}

/// `Offset factor, units`: slope scale and constant of the depth bias.
fn offset(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    let slope_scale = parser.number_f32("the offset's factor")?;
    parser.mark(',')?;
    let at = parser.at();
    let units = parser.number("the offset's units")?;
    let constant = f64_to_i32(units).ok_or_else(|| {
        error(at, format!("the offset's units are {units}; WebGPU's depth bias is a whole number of 32 bits"))
    })?;
    state.depth_bias = DepthBiasState { constant, slope_scale, clamp: 0.0 };
    Ok(())
}

/// A whole number in the range of `i32`.
#[expect(clippy::cast_possible_truncation, reason = "checked to be whole and in range")]
fn f64_to_i32(x: f64) -> Option<i32> {
    let fits = x.fract() == 0.0 && x >= f64::from(i32::MIN) && x <= f64::from(i32::MAX);
    fits.then_some(x as i32)
}

/// `AlphaTest Off`, `AlphaTest Greater 0.5`, `AlphaTest Greater [_Cutoff]`.
fn alpha_test(parser: &mut Parser<'_>, state: &mut StateBlock) -> Result<()> {
    state.alpha_test = match comparison(parser, "a comparison or Off")? {
        None => AlphaTest::Off,
        // Always and Never may stand without a reference.
        Some(compare @ (CompareFunction::Always | CompareFunction::Never)) if !number_follows(parser) => {
            AlphaTest::On { compare, reference: 0.0 }
        }
        Some(compare) => AlphaTest::On { compare, reference: parser.number_f32("the alpha test's reference value")? },
    };
    Ok(())
}

fn number_follows(parser: &Parser<'_>) -> bool {
    match parser.peek() {
        Some(Kind::Word(word)) => word.parse::<f64>().is_ok(),
        Some(Kind::Property(_)) => true,
        _ => false,
    }
}

/// `Tags { "Queue" = "Transparent" "RenderType" = "Transparent" }`; a queue must be one.
fn tags(parser: &mut Parser<'_>, opened: Position, state: &mut StateBlock) -> Result<()> {
    parser.mark('{')?;
    while !parser.accept('}') {
        if parser.peek().is_none() {
            return Err(error(opened, "this Tags block is never closed with `}`"));
        }
        let key = parser.text("a tag's name, or `}`,")?;
        parser.mark('=')?;
        let at = parser.at();
        let value = parser.text("the tag's value")?;
        if key.eq_ignore_ascii_case("Queue") {
            queue_number(&value).map_err(|e| error(at, e.to_string()))?;
        }
        state.tags.retain(|(known, _)| !known.eq_ignore_ascii_case(&key));
        if state.tags.len() == MAX_TAGS {
            return Err(error(at, format!("more than {MAX_TAGS} tags")));
        }
        state.tags.push((key, value));
    }
    Ok(())
}

/// The beginning of a name that may be of any length.
fn cut(name: &str) -> String {
    name.chars().take(60).collect()
}
