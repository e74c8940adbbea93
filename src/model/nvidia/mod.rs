//! The `nvidia` model: the blender of an NVIDIA GPU, found from what it stores.
//!
//! Provenance: an H100 (Hopper) through Vulkan, driver 580.159.04. No text of the maker tells the arithmetic; the rules below
//! were fitted to recorded vectors (`tests/data/nvidia-h100-*.jsonl`) and checked by `outmerge conform --adapter NVIDIA --model
//! nvidia`.
//!
//! One example first. Red 0.29607844 on `rgba8unorm` is code 75.50 and stores 75, not 76: the shader's output is cut to twelve
//! fractional bits (1212 / 4096 = 75.46 codes) before it is rounded to a code. With blending on the same happens, and only codes
//! reach the blender.
//!
//! | target | what enters the blender | inside | the store |
//! |---|---|---|---|
//! | unorm, n bits | cut to n + 4 fractional bits, then the nearest code, halves down ([`unorm`]) | exact | the nearest code |
//! | half float, 11/10-bit float | cut to half float | half float, one rounding a sum ([`float`]) | half float; 11/10-bit cut from it |
//! | 32-bit float | as it is | binary32 likewise, no denormals | binary32 |
//! | sRGB | the sRGB code, and that as a half float of eight significant bits ([`srgb`]) | half float | sRGB code, by thresholds |

pub mod depth;
pub mod float;
pub mod srgb;
pub mod unorm;

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use super::{Arithmetic, ColorInputs, Explanation, NumericModel, Unsupported, evaluate, explain};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout, TargetClass};
use crate::merger::blend::{self, Steps, blend};
use crate::merger::encode::encode;

use float::{Unit, Value};

/// The model of an NVIDIA H100.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Nvidia;

/// An equation that leaves the source as it is: the hardware does not blend then.
const REPLACE: BlendComponent =
    BlendComponent { src_factor: BlendFactor::One, dst_factor: BlendFactor::Zero, operation: BlendOperation::Add };

/// The inputs with a state that only replaces taken for blending off.
fn simplified(inputs: &ColorInputs) -> ColorInputs {
    let replaces = |state: &BlendState| state.color == REPLACE && state.alpha == REPLACE;
    ColorInputs { blend: inputs.blend.filter(|state| !replaces(state)), ..*inputs }
}

/// Which part of the hardware blends a format.
enum Part {
    Unorm(unorm::Unit),
    Srgb,
    Float(Unit),
}

fn part(format: ColorFormat) -> Part {
    match format.channels()[0] {
        ChannelKind::Unorm(bits) => Part::Unorm(unorm::Unit { bits }),
        ChannelKind::Srgb => Part::Srgb,
        ChannelKind::Float(FloatLayout::SINGLE) => Part::Float(Unit::SINGLE),
        // Signed normalised targets are refused by `supports`.
        ChannelKind::Float(_) | ChannelKind::Snorm(_) | ChannelKind::Absent => Part::Float(Unit::HALF),
    }
}

/// Whether the source adds nothing to any channel and the destination is kept by every factor: then the texel keeps its bits,
/// denormals and infinities too.
fn keeps_destination(inputs: &ColorInputs, steps: &Steps<Value>) -> bool {
    let (Some(state), Some(equation)) = (&inputs.blend, &steps.equation) else { return false };
    let channels = inputs.format.channels();
    (0..4).filter(|i| channels[*i] != ChannelKind::Absent).all(|i| {
        blend::component(state, i).operation == BlendOperation::Add
            && equation.terms[i].0.number() == 0.0
            && equation.dst_factors[i].is_one()
    })
}

/// The codes of a target that floats are blended in.
fn stored<A: Arithmetic<Value = Value>>(arithmetic: &A, inputs: &ColorInputs, steps: &Steps<Value>) -> Codes {
    if keeps_destination(inputs, steps) { inputs.dst } else { encode(arithmetic, inputs, steps) }
}

fn merge<A: Arithmetic<Value = Value>>(arithmetic: &A, inputs: &ColorInputs) -> Codes {
    stored(arithmetic, inputs, &blend(arithmetic, inputs))
}

fn explained<A: Arithmetic<Value = Value>>(arithmetic: &A, inputs: &ColorInputs) -> Explanation {
    let steps = blend(arithmetic, inputs);
    blend::explain(arithmetic, inputs, &steps, stored(arithmetic, inputs, &steps))
}

impl NumericModel for Nvidia {
    fn name(&self) -> String {
        "nvidia:gpu=h100".to_owned()
    }

    fn provenance(&self) -> String {
        "NVIDIA H100 through Vulkan, driver 580.159.04: rules fitted to what it stored".to_owned()
    }

    fn supports(&self, format: ColorFormat, _blend: Option<&BlendState>) -> Result<(), Unsupported> {
        if format.class() == TargetClass::Snorm {
            let reason = "signed normalised targets of this device were not measured";
            return Err(Unsupported { model: self.name(), what: format.name().to_owned(), reason });
        }
        Ok(())
    }

    /// They go by other rules, which were not found.
    fn knows_clears(&self) -> bool {
        false
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        let inputs = &simplified(inputs);
        match part(inputs.format) {
            Part::Unorm(unit) => evaluate(&unit, inputs),
            Part::Srgb => merge(&srgb::Srgb, inputs),
            Part::Float(unit) => merge(&unit, inputs),
        }
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        let inputs = &simplified(inputs);
        match part(inputs.format) {
            Part::Unorm(unit) => explain(&unit, inputs),
            Part::Srgb => explained(&srgb::Srgb, inputs),
            Part::Float(unit) => explained(&unit, inputs),
        }
    }

    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        depth::code(kind, z, range)
    }
}
