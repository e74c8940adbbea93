//! ShaderLab state blocks: the render-state commands of Unity shaders, alone or in a whole `Shader` file.
//!
//! `Blend`, `BlendOp`, `ZWrite`, `ZTest`, `ColorMask`, `Cull`, `Offset`, `AlphaTest`, `Stencil` and `Tags` are read;
//! `[_Property]` references take the values given, or a `Properties` block's defaults; shader programs are skipped;
//! anything unknown is an error with line and column. Names are read in any case, and blend factors, operations and
//! comparisons in any API's spelling. Source: Unity manual, *ShaderLab commands*.
//!
//! Two readings that are not obvious: `Blend A B` uses A and B for alpha too, and `BlendOp` does nothing where no
//! `Blend` turns blending on. Without a target index a command is for all targets.

mod commands;
mod draft;
mod lexer;
mod parser;
mod property;
mod stencil;
#[cfg(test)]
mod tests;

pub use property::{Properties, PropertyValue};

use super::block::StateBlock;

/// A place in a text, both from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Position {
    /// Line.
    pub line: u32,
    /// Column, in characters.
    pub column: u32,
}

/// A text that is not ShaderLab, or says something this reader does not know.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {}, column {}: {message}", position.line, position.column)]
pub struct ShaderLabError {
    /// Where.
    pub position: Position,
    /// What is wrong, and what to write instead.
    pub message: String,
}

/// One pass: its name, if it has one, and its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// The `Name` command's value.
    pub name: Option<String>,
    /// Which `SubShader` it is of, from 0. Unity draws with the first one that the GPU supports, not with all.
    pub sub_shader: usize,
    /// The state, inherited from `Category` and `SubShader` where the pass says nothing.
    pub state: StateBlock,
}

/// Reads a state block, or the passes of a whole shader; at least one pass.
///
/// # Errors
/// [`ShaderLabError`] at the first problem.
pub fn parse(text: &str, properties: &Properties) -> Result<Vec<Pass>, ShaderLabError> {
    parser::parse(text, properties)
}
