//! Values of `[_Property]` references: numbers as Unity's enums number them, or names; and the `Properties` block.

use std::collections::BTreeMap;

use super::lexer::Kind;
use super::parser::{Parser, error};
use super::{Position, ShaderLabError};

/// A property's value.
#[derive(Clone, Debug, PartialEq)]
pub enum PropertyValue {
    /// A number; where a command expects a name, the index into Unity's enum.
    Number(f64),
    /// A name, as it would be written in place of the reference.
    Name(String),
}

/// Property values by name, with the leading underscore.
pub type Properties = BTreeMap<String, PropertyValue>;

/// `Properties { [Attribute] _Name ("Label", Type) = default ... }`: the defaults that are numbers.
pub(super) fn property_block(parser: &mut Parser<'_>, opened: Position) -> Result<Properties, ShaderLabError> {
    let mut defaults = Properties::new();
    parser.mark('{')?;
    while !parser.accept('}') {
        let at = parser.at();
        let name = match parser.take().map(|token| token.kind) {
            // An attribute, `[HDR]` or `[Enum(Off,0,On,1)]`.
            Some(Kind::Property(_)) => continue,
            Some(Kind::Word(name)) => name,
            Some(_) => return Err(error(at, "expected a property's name, an [Attribute] or `}`")),
            None => return Err(error(opened, "this Properties block is never closed with `}`")),
        };
        parser.mark('(')?;
        skip_parentheses(parser, at)?;
        parser.mark('=')?;
        match parser.peek() {
            Some(Kind::Text(_)) => {
                parser.take();
                if parser.peek() == Some(&Kind::Mark('{')) {
                    parser.skip_block(at)?;
                }
            }
            Some(Kind::Mark('(')) => {
                parser.take();
                skip_parentheses(parser, at)?;
            }
            _ => {
                let value = parser.number("the property's default")?;
                defaults.insert(name, PropertyValue::Number(value));
            }
        }
    }
    Ok(defaults)
}

/// Passes over everything to the parenthesis that closes the one just read.
fn skip_parentheses(parser: &mut Parser<'_>, opened: Position) -> Result<(), ShaderLabError> {
    let mut depth = 1_usize;
    while depth > 0 {
        match parser.take().map(|token| token.kind) {
            None => return Err(error(opened, "this property's parenthesis is never closed with `)`")),
            Some(Kind::Mark('(')) => depth += 1,
            Some(Kind::Mark(')')) => depth -= 1,
            Some(_) => {}
        }
    }
    Ok(())
}

/// `UnityEngine.Rendering.BlendMode`.
pub(super) const BLEND_MODES: [&str; 11] = [
    "Zero",
    "One",
    "DstColor",
    "SrcColor",
    "OneMinusDstColor",
    "SrcAlpha",
    "OneMinusSrcColor",
    "DstAlpha",
    "OneMinusDstAlpha",
    "SrcAlphaSaturate",
    "OneMinusSrcAlpha",
];

/// `UnityEngine.Rendering.BlendOp`, its first five.
pub(super) const BLEND_OPERATIONS: [&str; 5] = ["Add", "Sub", "RevSub", "Min", "Max"];

/// `UnityEngine.Rendering.CompareFunction`.
pub(super) const COMPARE_FUNCTIONS: [&str; 9] =
    ["Off", "Never", "Less", "Equal", "LEqual", "Greater", "NotEqual", "GEqual", "Always"];

/// `UnityEngine.Rendering.CullMode`.
pub(super) const CULL_MODES: [&str; 3] = ["Off", "Front", "Back"];

/// `ZWrite [_ZWrite]`.
pub(super) const SWITCHES: [&str; 2] = ["Off", "On"];

/// `UnityEngine.Rendering.StencilOp`.
pub(super) const STENCIL_OPERATIONS: [&str; 8] =
    ["Keep", "Zero", "Replace", "IncrSat", "DecrSat", "Invert", "IncrWrap", "DecrWrap"];
