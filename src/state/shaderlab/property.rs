//! Values of `[_Property]` references: numbers as Unity's enums number them, or names.

use std::collections::BTreeMap;

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
