//! Numeric models: the arithmetic of the output merger, and nothing else.
//!
//! The blend equation is written once, in [`crate::merger`], over [`Arithmetic`]. A model that follows the equation
//! supplies an `Arithmetic`; a driver that fuses load, blend and encode implements [`NumericModel`] as one unit. The
//! rest of the crate sees only `NumericModel`.
//!
//! | model | meaning |
//! |---|---|
//! | [`exact`] | real arithmetic, one correct rounding at the store |
//! | [`binary32`] (`f32`) | every operation rounded to binary32 |
//! | [`binary16`] (`f16`) | every operation rounded to binary16 |
//! | [`fixed`] | parametric fixed point |
//! | [`llvmpipe`] | Mesa's llvmpipe (lavapipe), bit for bit |
//! | [`swiftshader`] | SwiftShader's Vulkan driver, bit for bit |
//! | [`nvidia`] | an NVIDIA GPU's blender, found from what it stores |

pub mod account;
mod agreement;
pub mod binary16;
pub mod binary32;
pub mod exact;
mod explanation;
pub mod fixed;
pub mod llvmpipe;
mod number;
pub mod nvidia;
pub mod registry;
pub mod swiftshader;

pub use agreement::{Agreement, agreement, agreement_of_layers, same_codes};
pub use explanation::{ChannelStep, Explanation, Step, StepKind};
pub use number::{Number, decimal};

use std::fmt::Debug;

use num_rational::BigRational;
use wgpu_types::{BlendState, MultisampleState};

use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, TargetClass};
use crate::merger::blend::{self, blend};
use crate::merger::encode::encode;

/// What the blender sees of one texel: state, shader outputs and stored codes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInputs {
    /// The target's format.
    pub format: ColorFormat,
    /// The blend state; `None` is blending off.
    pub blend: Option<BlendState>,
    /// The blend constant, RGBA, unclamped.
    pub constant: [f32; 4],
    /// The shader's output, RGBA, unclamped.
    pub src: [f32; 4],
    /// The second source, RGBA, unclamped.
    pub src1: [f32; 4],
    /// The codes stored before.
    pub dst: Codes,
}

/// A named way to compute the output merger's numbers.
///
/// Implementations are pure: equal inputs give equal codes.
pub trait NumericModel: Debug + Send + Sync {
    /// The name that selects this model, e.g. `exact` or `fixed:8`.
    fn name(&self) -> String;

    /// Where the rules come from and how they were checked, in one sentence.
    fn provenance(&self) -> String;

    /// Whether the model defines a result for this format and blend state.
    ///
    /// # Errors
    /// [`Unsupported`], with the reason.
    fn supports(&self, format: ColorFormat, blend: Option<&BlendState>) -> Result<(), Unsupported>;

    /// The codes after this fragment with every channel written: load, blend and encode. The write mask comes later.
    ///
    /// `inputs` must be [supported](Self::supports); for others the result is unspecified.
    fn merge_color(&self, inputs: &ColorInputs) -> Codes;

    /// The other codes that may be stored instead of [`merge_color`](Self::merge_color)'s, where the driver's result depends on
    /// what it did before. `None` nearly everywhere: the result is decided.
    fn alternative(&self, inputs: &ColorInputs) -> Option<Codes> {
        let _ = inputs;
        None
    }

    /// The codes that `LoadOp::Clear` stores for a color, RGBA, unclamped: its own conversion in some drivers. The
    /// default rounds once, correctly, and so do models of drivers whose clears were not measured.
    fn clear_color(&self, format: ColorFormat, color: [f32; 4]) -> Codes {
        let zeros = [0.0; 4];
        let inputs = ColorInputs { format, blend: None, constant: zeros, src: color, src1: zeros, dst: [0; 4] };
        exact::Exact::default().merge_color(&inputs)
    }

    /// Whether [`clear_color`](Self::clear_color) and [`clear_depth`](Self::clear_depth) are known to be the driver's. Comparisons
    /// leave out the clears of models where they are not.
    fn knows_clears(&self) -> bool {
        true
    }

    /// The depth code that `LoadOp::Clear` stores for a depth, 0 to 1. The default rounds once, correctly.
    fn clear_depth(&self, kind: DepthKind, z: f32) -> u32 {
        kind.encode(z, [0.0, 1.0])
    }

    /// [`merge_color`](Self::merge_color) with every intermediate number, for people.
    fn explain_color(&self, inputs: &ColorInputs) -> Explanation;

    /// The sample mask as the driver obeys it: the state's own, but for a driver that does otherwise.
    fn sample_mask(&self, multisample: &MultisampleState) -> u64 {
        multisample.mask
    }

    /// The depth code of a fragment's depth `z`, clamped to the viewport's `range` first.
    fn depth_code(&self, kind: DepthKind, z: f32, range: [f32; 2]) -> u32;

    /// What becomes of a texel that the fragment covers but may not change (masked channels, failed tests). Specs say
    /// it keeps its bits; a driver that rewrites the texel may canonicalise NaNs.
    fn rewrite_untouched(&self, format: ColorFormat, codes: Codes) -> Codes {
        let _ = format;
        codes
    }

    /// Whether [`rewrite_untouched`](Self::rewrite_untouched) may change a texel of this format. `false` promises that it
    /// never does, and lets [`crate::plan`] leave such texels alone.
    fn rewrites_untouched(&self, format: ColorFormat) -> bool {
        let _ = format;
        false
    }

    /// The integer rule that gives this model's codes on 8-bit unorm targets with four channels when every source is an
    /// 8-bit code (k / 255 as binary32), if it has one: [`crate::kernel`] merges rows by it.
    fn unorm8_rule(&self) -> Option<crate::kernel::Rule> {
        None
    }

    /// How this model blends half-float and sRGB targets when sources are codes of the target's width, if
    /// [`crate::kernel`] has rows for it.
    fn float_rule(&self) -> Option<crate::kernel::FloatRule> {
        None
    }

    /// Whether, on this float target, destination terms whose factor is the constant zero are left out of the sum, so
    /// that not even NaN, infinity or the sign of a zero in the destination shows. With source factors one as well, the
    /// result is then that of blending off.
    ///
    /// On normalised targets no model can tell, and [`crate::plan`] does not ask: there a factor that is the constant
    /// zero must remove its term, and one that is the constant one must keep the operand.
    fn drops_zero_destination(&self, format: ColorFormat, blend: &BlendState) -> bool {
        let _ = (format, blend);
        false
    }
}

/// The operations the blend equation is made of, over one kind of number.
///
/// Callers clamp shader outputs (as `f32`, which is exact) before [`take_in`](Self::take_in).
pub trait Arithmetic {
    /// The number inside the blender.
    type Value: Clone + Debug;

    /// Takes in a shader output, already clamped for the target class.
    fn take_in(&self, x: f32, format: ColorFormat, channel: usize) -> Self::Value;

    /// Takes in a blend constant, clamping it for the target class.
    fn take_in_constant(&self, x: f32, format: ColorFormat, channel: usize) -> Self::Value {
        self.take_in(blend::clamp::clamp_input(x, format.class()), format, channel)
    }

    /// Decodes a stored code; sRGB codes give linear values. Never asked for an absent channel.
    fn decode(&self, code: u32, kind: ChannelKind) -> Self::Value;

    /// 0 as a factor or as a missing channel.
    fn zero(&self) -> Self::Value;

    /// 1 as a factor or as a missing channel.
    fn one(&self) -> Self::Value;

    /// 1 - x.
    fn complement(&self, x: &Self::Value) -> Self::Value;

    /// The factor src-alpha-saturated: the smaller of source alpha and 1 - destination alpha, the `room` left.
    fn saturate(&self, src_alpha: &Self::Value, room: &Self::Value) -> Self::Value {
        self.minimum(src_alpha, room)
    }

    /// Clamps a factor for a target class.
    ///
    /// Only signed targets can notice: there 1 - x reaches 2, which Vulkan clamps to 1 and D3D does not. This is Vulkan's
    /// rule; on unsigned targets the inputs' clamp already keeps factors in range.
    fn clamp_factor(&self, factor: Self::Value, class: TargetClass) -> Self::Value {
        match class {
            TargetClass::Snorm => self.clamp(&factor, class),
            TargetClass::Unorm | TargetClass::Float => factor,
        }
    }

    /// Narrows a value to the width of a factor; most models leave it alone.
    fn factor(&self, x: Self::Value) -> Self::Value {
        x
    }

    /// x * factor.
    fn multiply(&self, x: &Self::Value, factor: &Self::Value) -> Self::Value;

    /// x + y.
    fn add(&self, x: &Self::Value, y: &Self::Value) -> Self::Value;

    /// x - y.
    fn subtract(&self, x: &Self::Value, y: &Self::Value) -> Self::Value;

    /// The smaller; a number rather than NaN.
    fn minimum(&self, x: &Self::Value, y: &Self::Value) -> Self::Value;

    /// The larger; a number rather than NaN.
    fn maximum(&self, x: &Self::Value, y: &Self::Value) -> Self::Value;

    /// Clamps to the range of a normalised class; the identity for [`TargetClass::Float`]. NaN becomes 0.
    fn clamp(&self, x: &Self::Value, class: TargetClass) -> Self::Value;

    /// The code that stores x, already clamped for its class. Never asked for an absent channel.
    fn encode(&self, x: &Self::Value, kind: ChannelKind) -> u32;

    /// The number as people read it.
    fn describe(&self, x: &Self::Value) -> Number;

    /// x, clamped for its class, on the scale of a linear normalised channel's codes, as [`encode`](Self::encode)
    /// computes it before it rounds. The default is the exact product.
    fn describe_scaled(&self, x: &Self::Value, steps: u32) -> Number {
        match self.describe(x).fraction() {
            Some(x) => Number::rational(x * BigRational::from_integer(steps.into())),
            None => Number::near(self.describe(x).decimal * f64::from(steps)),
        }
    }
}

/// A format and state a model defines no result for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("model `{model}` does not cover {what}: {reason}")]
pub struct Unsupported {
    /// The model's name.
    pub model: String,
    /// The format or state.
    pub what: String,
    /// Why not.
    pub reason: &'static str,
}

/// Load, blend and encode by the generic equation.
pub(crate) fn evaluate<A: Arithmetic>(arithmetic: &A, inputs: &ColorInputs) -> Codes {
    encode(arithmetic, inputs, &blend(arithmetic, inputs))
}

/// The same, explained.
pub(crate) fn explain<A: Arithmetic>(arithmetic: &A, inputs: &ColorInputs) -> Explanation {
    let steps = blend(arithmetic, inputs);
    let codes = encode(arithmetic, inputs, &steps);
    blend::explain(arithmetic, inputs, &steps, codes)
}
