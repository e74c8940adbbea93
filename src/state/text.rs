//! State from one text: a preset's name, two or four blend factors, a ShaderLab block, or WebGPU's JSON.

use wgpu_types::{BlendComponent, BlendOperation, BlendState};

use super::block::StateBlock;
use super::preset;
use super::shaderlab::{self, Properties, ShaderLabError};
use super::spelling::{self, SpellingError};

/// A text that names no state.
#[derive(Debug, thiserror::Error)]
pub enum StateTextError {
    /// Nothing there.
    #[error("the state is empty; give a preset ({presets}), blend factors, a ShaderLab block or WebGPU JSON", presets = preset_names())]
    Empty,
    /// A factor or operation is misspelt.
    #[error(transparent)]
    Spelling(#[from] SpellingError),
    /// Not a ShaderLab block.
    #[error("{0}")]
    ShaderLab(#[from] ShaderLabError),
    /// More than one pass.
    #[error("the state has {0} passes; one state is asked for")]
    Passes(usize),
    /// Not WebGPU's JSON.
    #[cfg(feature = "json")]
    #[error(transparent)]
    Json(#[from] super::webgpu::WebGpuError),
    /// JSON without the feature that reads it.
    #[cfg(not(feature = "json"))]
    #[error("reading WebGPU JSON needs the `json` feature")]
    NoJson,
}

/// The preset names, comma separated.
fn preset_names() -> String {
    preset::PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>().join(", ")
}

/// Reads a state from a text such as `fade`, `SrcAlpha OneMinusSrcAlpha`, `GL_SRC_ALPHA, GL_ONE`,
/// `Blend One OneMinusSrcAlpha ZWrite Off` or `{"color":{"srcFactor":"src-alpha"}}`.
///
/// Factors alone may be separated by blanks or commas: two serve color and alpha, four color then alpha; an operation
/// may follow.
///
/// # Errors
/// [`StateTextError`], naming the place where the text has one.
pub fn parse(text: &str, properties: &Properties) -> Result<StateBlock, StateTextError> {
    let text = text.trim();
    if text.is_empty() {
        return Err(StateTextError::Empty);
    }
    if let Some(preset) = preset::by_name(text) {
        let mut block = StateBlock::with_blend(preset.blend);
        block.depth_write = preset.depth_write;
        return Ok(block);
    }
    if text.eq_ignore_ascii_case("off") {
        return Ok(StateBlock::default());
    }
    if text.starts_with('{') {
        #[cfg(feature = "json")]
        return Ok(super::webgpu::block_from_json(text)?);
        #[cfg(not(feature = "json"))]
        return Err(StateTextError::NoJson);
    }
    let words: Vec<&str> = text.split([' ', ',', '\t', '\n', '|', ';']).filter(|word| !word.is_empty()).collect();
    if words.first().is_some_and(|word| spelling::blend_factor(word).is_ok()) {
        return Ok(StateBlock::with_blend(Some(factors(&words)?)));
    }
    let mut passes = shaderlab::parse(text, properties)?;
    match passes.len() {
        1 => Ok(passes.remove(0).state),
        count => Err(StateTextError::Passes(count)),
    }
}

/// Two or four factors, then perhaps an operation or two.
fn factors(words: &[&str]) -> Result<BlendState, StateTextError> {
    let operations = words.iter().rev().take_while(|word| spelling::blend_operation(word).is_ok()).count();
    let (names, operations) = words.split_at(words.len() - operations.min(2));
    let factors = names.iter().map(|word| spelling::blend_factor(word)).collect::<Result<Vec<_>, _>>()?;
    let operation = |i: usize| -> Result<BlendOperation, SpellingError> {
        operations.get(i).or(operations.first()).map_or(Ok(BlendOperation::Add), |word| spelling::blend_operation(word))
    };
    let component = |src_factor, dst_factor, operation| BlendComponent { src_factor, dst_factor, operation };
    match factors[..] {
        [src, dst] => {
            Ok(BlendState { color: component(src, dst, operation(0)?), alpha: component(src, dst, operation(1)?) })
        }
        [src, dst, alpha_src, alpha_dst] => Ok(BlendState {
            color: component(src, dst, operation(0)?),
            alpha: component(alpha_src, alpha_dst, operation(1)?),
        }),
        _ => Err(SpellingError::Unknown {
            kind: "state",
            name: names.join(" "),
            hint: format!("; {} blend factors given, two or four are needed", factors.len()),
            list: spelling::blend_factors().map(spelling::factor_name).collect::<Vec<_>>().join(", "),
        }
        .into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu_types::BlendFactor as F;

    fn read(text: &str) -> StateBlock {
        parse(text, &Properties::new()).unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    #[test]
    fn one_state_in_every_spelling() {
        let fade = read("fade").blend[0];
        for text in [
            "Blend SrcAlpha OneMinusSrcAlpha",
            "SrcAlpha OneMinusSrcAlpha",
            "SRC_ALPHA, INV_SRC_ALPHA",
            "GL_SRC_ALPHA GL_ONE_MINUS_SRC_ALPHA GL_FUNC_ADD",
            "VK_BLEND_FACTOR_SRC_ALPHA,VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA",
            "src-alpha one-minus-src-alpha, src-alpha one-minus-src-alpha",
        ] {
            assert_eq!(read(text).blend[0], fade, "{text}");
        }
        assert_eq!(read("off").blend[0], None, "off");
    }

    #[test]
    fn operations_may_follow_the_factors() {
        let blend = read("one one one zero revsub max").blend[0].expect("on");
        assert_eq!(blend.color.operation, BlendOperation::ReverseSubtract, "color");
        assert_eq!((blend.alpha.operation, blend.alpha.dst_factor), (BlendOperation::Max, F::Zero), "alpha");
    }

    #[test]
    fn mistakes_say_what_to_write() {
        let message = |text| parse(text, &Properties::new()).expect_err(text).to_string();
        assert!(message("one one one").contains("two or four are needed"), "{}", message("one one one"));
        assert!(message("One SrcAlhpa").contains("did you mean"), "{}", message("One SrcAlhpa"));
        assert!(message("Pass{} Pass{}").contains("2 passes"), "{}", message("Pass{} Pass{}"));
        assert!(message(" ").contains("premultiplied"), "{}", message(" "));
    }
}
