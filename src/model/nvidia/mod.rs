//! The `nvidia` model: the blender of an NVIDIA GPU, found from what it stores.
//!
//! Provenance: an H100 (Hopper) through Vulkan, driver 580.159.04. No text of the maker tells the arithmetic; the rules below
//! were fitted to recorded vectors, and checked by `outmerge conform --adapter NVIDIA --model nvidia` and by vectors recorded
//! later (`tests/data/nvidia-*.jsonl`). What is proven and what is not: `docs/drivers/nvidia.md`.
//!
//! One example first. Red 0.29607844 on `rgba8unorm` is code 75.50 and stores 75, not 76: the shader's output is cut to twelve
//! fractional bits (1212 / 4096 = 75.46 codes) before it is rounded to a code. With blending on the same happens, and only codes
//! reach the blender.
//!
//! | target | what enters the blender | inside | the store |
//! |---|---|---|---|
//! | unorm, n bits | cut to n + 4 fractional bits, then the nearest code, halves down ([`normalised`]) | exact | the nearest code |
//! | snorm, n bits | likewise, the magnitude having n - 1 bits | exact, factors to 2 | the nearest code |
//! | half float, 11/10-bit float | cut to half float | half float, one rounding a sum ([`float`]) | half float; 11/10-bit cut from it |
//! | 32-bit float | as it is | binary32 likewise, no denormals | binary32 |
//! | sRGB | the sRGB code, and that as a half float of eight significant bits ([`srgb`]) | half float | sRGB code, by thresholds |
//!
//! A texel that its source would not change keeps its bits (`drops_source`).

pub mod depth;
pub mod float;
pub mod normalised;
pub mod srgb;

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use super::{Arithmetic, ColorInputs, Explanation, NumericModel, Unsupported};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout};
use crate::merger::blend::{self, Steps, blend};
use crate::merger::encode::encode;

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

/// What must be told of any part's numbers.
trait Operand {
    fn is_zero(&self) -> bool;
    fn is_one(&self) -> bool;
}

/// Whether the hardware drops a texel because its source changes nothing: it then keeps its bits, denormals, infinities and the
/// lowest signed code too.
///
/// For every channel the source is zero and the destination's factor is one, or the source's alpha is zero and makes them so, or a
/// signed minimum is taken with 1. The hardware asks this of the channels that the write mask leaves, which a model is not told.
fn drops_source<V: Operand>(inputs: &ColorInputs, steps: &Steps<V>) -> bool {
    let Some(state) = &inputs.blend else { return false };
    let src = &steps.operands.src;
    let no_alpha = src[3].is_zero();
    let channels = inputs.format.channels();
    (0..4).filter(|i| channels[*i] != ChannelKind::Absent).all(|i| {
        let component = blend::component(state, i);
        let adds_nothing = match (component.src_factor, component.dst_factor) {
            (_, BlendFactor::One) if src[i].is_zero() => true,
            (BlendFactor::SrcAlpha, BlendFactor::One) => no_alpha,
            (BlendFactor::SrcAlpha | BlendFactor::Zero, BlendFactor::OneMinusSrcAlpha) => no_alpha,
            (_, BlendFactor::OneMinusSrcAlpha) => no_alpha && src[i].is_zero(),
            _ => false,
        };
        match component.operation {
            BlendOperation::Add | BlendOperation::ReverseSubtract => adds_nothing,
            BlendOperation::Min => matches!(channels[i], ChannelKind::Snorm(_)) && src[i].is_one(),
            BlendOperation::Max | BlendOperation::Subtract => false,
        }
    })
}

/// What is done with a texel, once it is known which part of the hardware blends its format.
trait Job {
    type Output;
    fn run<A: Arithmetic<Value: Operand>>(self, part: &A, inputs: &ColorInputs) -> Self::Output;
}

fn stored<A: Arithmetic<Value: Operand>>(part: &A, inputs: &ColorInputs, steps: &Steps<A::Value>) -> Codes {
    if drops_source(inputs, steps) {
        return inputs.dst;
    }
    encode(part, inputs, steps)
}

struct Merge;

impl Job for Merge {
    type Output = Codes;

    fn run<A: Arithmetic<Value: Operand>>(self, part: &A, inputs: &ColorInputs) -> Codes {
        stored(part, inputs, &blend(part, inputs))
    }
}

struct Explain;

impl Job for Explain {
    type Output = Explanation;

    fn run<A: Arithmetic<Value: Operand>>(self, part: &A, inputs: &ColorInputs) -> Explanation {
        let steps = blend(part, inputs);
        blend::explain(part, inputs, &steps, stored(part, inputs, &steps))
    }
}

/// Runs a job on the part of the hardware that blends the format.
fn on_part<J: Job>(job: J, inputs: &ColorInputs) -> J::Output {
    let inputs = &simplified(inputs);
    match inputs.format.channels()[0] {
        ChannelKind::Unorm(bits) => job.run(&normalised::Unit::unsigned(bits), inputs),
        ChannelKind::Snorm(bits) => job.run(&normalised::Unit::signed(bits), inputs),
        ChannelKind::Srgb => job.run(&srgb::Srgb, inputs),
        ChannelKind::Float(FloatLayout::SINGLE) => job.run(&float::Unit::SINGLE, inputs),
        // No format lacks its first channel.
        ChannelKind::Float(_) | ChannelKind::Absent => job.run(&float::Unit::HALF, inputs),
    }
}

impl NumericModel for Nvidia {
    fn name(&self) -> String {
        "nvidia:gpu=h100".to_owned()
    }

    fn provenance(&self) -> String {
        "NVIDIA H100 and H200 through Vulkan, driver 580.159.04: rules fitted to what they stored; checked through wgpu: full \
         level on unorm, sRGB and depth targets, on others but for zeros, NaN and infinities (docs/drivers/nvidia.md)"
            .to_owned()
    }

    fn supports(&self, _format: ColorFormat, _blend: Option<&BlendState>) -> Result<(), Unsupported> {
        Ok(())
    }

    /// They go by other rules, which were not found.
    fn knows_clears(&self) -> bool {
        false
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        on_part(Merge, inputs)
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        on_part(Explain, inputs)
    }

    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32 {
        depth::code(kind, z, range)
    }
}
