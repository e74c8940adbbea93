//! Extreme values: one blend each, its outcome in every model, and what the APIs say.
//!
//! Rules are quoted by meaning from Vulkan (*Framebuffer / Blending*, *Fixed-Point Data Conversions*, *Floating-Point
//! Format Conversions*) and the Direct3D 11.3 functional specification (3.1, 3.2, 17). WebGPU says nothing about any of
//! these values; its back ends' rules apply.

use serde::Serialize;

use crate::format::ColorFormat;
use crate::format::depth::DepthKind;
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel};
use crate::scene::display::value;
use crate::state::shaderlab::Properties;
use crate::state::text;

/// One blend in question: all channels alike, alpha apart.
struct Case {
    name: &'static str,
    format: &'static str,
    state: &'static str,
    /// Color and alpha of the shader.
    src: [f32; 2],
    /// Color and alpha stored before.
    dst: [f32; 2],
    constant: f32,
    vulkan: &'static str,
    d3d: &'static str,
}

const NAN: f32 = f32::NAN;
const INF: f32 = f32::INFINITY;
const SUBNORMAL_HALF: f32 = 5.960_464_5e-8; // 2^-24
const SUBNORMAL: f32 = 1e-40;

/// The cases, by kind.
#[rustfmt::skip]
const CASES: [Case; 24] = [
    Case { name: "NaN stored in unorm", format: "rgba8unorm", state: "opaque", src: [NAN, 1.0], dst: [1.0, 1.0], constant: 0.0, vulkan: "undefined", d3d: "0" },
    Case { name: "NaN blended into unorm", format: "rgba8unorm", state: "alpha-blending", src: [NAN, 0.5], dst: [1.0, 1.0], constant: 0.0, vulkan: "undefined", d3d: "NaN clamps to 0: 0.5" },
    Case { name: "NaN alpha into unorm", format: "rgba8unorm", state: "alpha-blending", src: [1.0, NAN], dst: [0.2, 1.0], constant: 0.0, vulkan: "undefined", d3d: "alpha 0: unchanged" },
    Case { name: "infinity into unorm", format: "rgba8unorm", state: "opaque", src: [INF, 1.0], dst: [0.0, 1.0], constant: 0.0, vulkan: "1 if Inf is supported", d3d: "1" },
    Case { name: "NaN stored in half", format: "rgba16float", state: "opaque", src: [NAN, 1.0], dst: [1.0, 1.0], constant: 0.0, vulkan: "a NaN", d3d: "a NaN" },
    Case { name: "factor zero times stored NaN", format: "rgba16float", state: "one zero", src: [0.5, 1.0], dst: [NAN, 1.0], constant: 0.0, vulkan: "open: NaN or 0.5", d3d: "NaN" },
    Case { name: "factor zero times source Inf", format: "rgba16float", state: "zero one", src: [INF, 1.0], dst: [0.5, 1.0], constant: 0.0, vulkan: "open: NaN or 0.5", d3d: "NaN" },
    Case { name: "Inf - Inf", format: "rgba16float", state: "one one", src: [-INF, 1.0], dst: [INF, 1.0], constant: 0.0, vulkan: "NaN if supported", d3d: "NaN" },
    Case { name: "min of NaN and 1", format: "rgba16float", state: "one one min", src: [NAN, 1.0], dst: [1.0, 1.0], constant: 0.0, vulkan: "open", d3d: "1 or NaN (text conflicts)" },
    Case { name: "max of NaN and 1", format: "rgba16float", state: "one one max", src: [NAN, 1.0], dst: [1.0, 1.0], constant: 0.0, vulkan: "open", d3d: "1 or NaN (text conflicts)" },
    Case { name: "-0 by factors one, zero", format: "rgba16float", state: "one zero", src: [-0.0, 1.0], dst: [0.5, 1.0], constant: 0.0, vulkan: "either zero", d3d: "+0 by the sum, -0 by the round trip" },
    Case { name: "subnormal half added", format: "rgba16float", state: "one one", src: [SUBNORMAL_HALF, 1.0], dst: [0.0, 1.0], constant: 0.0, vulkan: "it, or a neighbour", d3d: "kept" },
    Case { name: "subnormal f32 added", format: "rgba32float", state: "one one", src: [SUBNORMAL, 1.0], dst: [0.0, 1.0], constant: 0.0, vulkan: "not named", d3d: "flushed to 0" },
    Case { name: "65504 + 16 in half", format: "rgba16float", state: "one one", src: [16.0, 1.0], dst: [65504.0, 1.0], constant: 0.0, vulkan: "65504 or Inf", d3d: "65504 converted, Inf in half arithmetic" },
    Case { name: "65504 + 65504 in half", format: "rgba16float", state: "one one", src: [65504.0, 1.0], dst: [65504.0, 1.0], constant: 0.0, vulkan: "65504 or Inf", d3d: "65504 converted, Inf in half arithmetic" },
    Case { name: "1e6 times 0.01 in half", format: "rgba16float", state: "src-alpha zero", src: [1e6, 0.01], dst: [0.0, 1.0], constant: 0.0, vulkan: "10000, 655 or Inf", d3d: "10000 or 655" },
    Case { name: "alpha -1 on half", format: "rgba16float", state: "alpha-blending", src: [1.0, -1.0], dst: [0.5, 1.0], constant: 0.0, vulkan: "0: not clamped", d3d: "0: not clamped" },
    Case { name: "alpha 2 on half", format: "rgba16float", state: "alpha-blending", src: [1.0, 2.0], dst: [0.5, 1.0], constant: 0.0, vulkan: "1.5: not clamped", d3d: "1.5: not clamped" },
    Case { name: "alpha 2 on unorm", format: "rgba8unorm", state: "alpha-blending", src: [0.6, 2.0], dst: [0.2, 1.0], constant: 0.0, vulkan: "0.6: alpha is 1", d3d: "0.6: alpha is 1" },
    Case { name: "additive beyond 1 on unorm", format: "rgba8unorm", state: "one one", src: [0.75, 1.0], dst: [0.75, 1.0], constant: 0.0, vulkan: "1", d3d: "1" },
    Case { name: "subtract below 0 on unorm", format: "rgba8unorm", state: "one one reverse-subtract", src: [0.75, 1.0], dst: [0.25, 1.0], constant: 0.0, vulkan: "0", d3d: "0" },
    Case { name: "subtract below 0 on half", format: "rgba16float", state: "one one reverse-subtract", src: [0.75, 1.0], dst: [0.25, 1.0], constant: 0.0, vulkan: "-0.5", d3d: "-0.5" },
    Case { name: "constant 2 on unorm", format: "rgba8unorm", state: "constant zero", src: [0.5, 1.0], dst: [0.0, 1.0], constant: 2.0, vulkan: "0.5: constant is 1", d3d: "0.5: constant is 1" },
    Case { name: "constant 2 on half", format: "rgba16float", state: "constant zero", src: [0.5, 1.0], dst: [0.0, 1.0], constant: 2.0, vulkan: "1", d3d: "1" },
];

/// One case, answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExtremeRow {
    /// What is tried.
    pub name: &'static str,
    /// The format.
    pub format: &'static str,
    /// The state.
    pub state: &'static str,
    /// Vulkan's rule for the stored value.
    pub vulkan: &'static str,
    /// Direct3D's rule.
    pub d3d: &'static str,
    /// What each model stores in red; `None` where it does not cover the format. As text: JSON has no NaN.
    pub outcomes: Vec<Option<String>>,
}

/// Every case in every model.
///
/// # Panics
/// Never: the cases' formats and states are known to parse (a test reads them all).
#[must_use]
pub fn extremes(models: &[&dyn NumericModel]) -> Vec<ExtremeRow> {
    CASES.iter().map(|case| row(case, models)).collect()
}

fn row(case: &Case, models: &[&dyn NumericModel]) -> ExtremeRow {
    let format = ColorFormat::from_name(case.format).expect("the case's format is known");
    let blend = text::parse(case.state, &Properties::new()).expect("the case's state is known").blend[0];
    let color = |[color, alpha]: [f32; 2]| [color, color, color, alpha];
    let unblended =
        ColorInputs { format, blend: None, constant: [0.0; 4], src: color(case.dst), src1: [0.0; 4], dst: [0; 4] };
    let dst = Exact::default().merge_color(&unblended);
    let inputs = ColorInputs { blend, constant: [case.constant; 4], src: color(case.src), dst, ..unblended };
    let outcome = |model: &&dyn NumericModel| {
        model.supports(format, blend.as_ref()).ok()?;
        Some(shown(value(format.channels()[0], model.merge_color(&inputs)[0])))
    };
    let outcomes = models.iter().map(outcome).collect();
    ExtremeRow { name: case.name, format: case.format, state: case.state, vulkan: case.vulkan, d3d: case.d3d, outcomes }
}

/// A depth that is no ordinary one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DepthRow {
    /// The fragment's depth.
    pub name: &'static str,
    /// The depth format.
    pub format: &'static str,
    /// The rules.
    pub rule: &'static str,
    /// The depth each model stores.
    pub outcomes: Vec<String>,
}

/// Extreme depths with viewport range 0 to 1.
#[must_use]
pub fn depths(models: &[&dyn NumericModel]) -> Vec<DepthRow> {
    const DEPTHS: [(&str, f32, &str); 6] = [
        ("NaN", NAN, "Vulkan: undefined; D3D: the range's minimum"),
        ("-0", -0.0, "0"),
        ("-0.5", -0.5, "clamped to 0"),
        ("1.5", 1.5, "clamped to 1"),
        ("Inf", INF, "clamped to 1"),
        ("0.5", 0.5, "a tie of 16 and 24 bits: either neighbour"),
    ];
    const KINDS: [(&str, DepthKind); 3] = [
        ("depth16unorm", DepthKind::Unorm(16)),
        ("depth24plus", DepthKind::Unorm(24)),
        ("depth32float", DepthKind::Float32),
    ];
    let mut rows = Vec::new();
    for (name, z, rule) in DEPTHS {
        for (format, kind) in KINDS {
            let outcome = |model: &&dyn NumericModel| {
                let code = model.depth_code(kind, z, [0.0, 1.0]);
                match kind {
                    DepthKind::Unorm(_) => format!("code {code}"),
                    DepthKind::Float32 => shown(kind.value(code)),
                }
            };
            rows.push(DepthRow { name, format, rule, outcomes: models.iter().map(outcome).collect() });
        }
    }
    rows
}

/// A value with the digits that tell outcomes apart.
fn shown(x: f64) -> String {
    if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e7) && x.is_finite() {
        return format!("{x:.3e}");
    }
    let text = format!("{x:.4}");
    let trimmed = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    trimmed.to_owned()
}

/// What the rows show, in a sentence.
#[must_use]
pub fn finding(rows: &[ExtremeRow]) -> String {
    let differ = |row: &&ExtremeRow| {
        let mut outcomes = row.outcomes.iter().flatten();
        let first = outcomes.next();
        outcomes.any(|outcome| Some(outcome) != first)
    };
    format!(
        "{} of {} extreme blends have different outcomes in different models.",
        rows.iter().filter(differ).count(),
        rows.len()
    )
}
