//! WebGPU-shaped JSON: `GPUBlendState`, `GPUColorTargetState`, `GPUDepthStencilState`, or a whole merger state.
//!
//! Members that are omitted take WebGPU's defaults, where `wgpu-types`' own form asks for all of them; unknown members
//! are errors, so that a misspelt one cannot pass for a default. This is the one file bound to a wgpu major's JSON.

use serde::{Deserialize, Serialize};
use wgpu_types::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthBiasState, DepthStencilState, MultisampleState, StencilFaceState, StencilOperation, StencilState,
    TextureFormat,
};

use super::block::StateBlock;
use super::{AlphaTest, DynamicState, MAX_COLOR_TARGETS, MergerState};

/// JSON that is not a WebGPU state.
#[derive(Debug, thiserror::Error)]
pub enum WebGpuError {
    /// Not JSON, an unknown member, or a value of the wrong kind; the message has line and column.
    #[error("WebGPU state: {0}")]
    Json(#[from] serde_json::Error),
    /// More targets than a pass may have.
    #[error("WebGPU state: {0} color targets; at most {MAX_COLOR_TARGETS} are possible")]
    TooManyTargets(usize),
    /// A write mask with bits beyond the four channels.
    #[error("WebGPU state: writeMask {0} is not a mask of four channels; it must be 0 to 15")]
    WriteMask(u32),
    /// A number beyond binary32's range.
    #[error("WebGPU state: {0} does not fit binary32; numbers may reach 3.4028235e38 in size")]
    TooLarge(&'static str),
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
struct Component {
    src_factor: BlendFactor,
    dst_factor: BlendFactor,
    operation: BlendOperation,
}

impl Default for Component {
    fn default() -> Self {
        BlendComponent::REPLACE.into()
    }
}

impl From<BlendComponent> for Component {
    fn from(c: BlendComponent) -> Self {
        Self { src_factor: c.src_factor, dst_factor: c.dst_factor, operation: c.operation }
    }
}

impl From<Component> for BlendComponent {
    fn from(c: Component) -> Self {
        Self { src_factor: c.src_factor, dst_factor: c.dst_factor, operation: c.operation }
    }
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
struct Blend {
    color: Component,
    alpha: Component,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Target {
    format: TextureFormat,
    #[serde(default)]
    blend: Option<Blend>,
    #[serde(default = "write_all")]
    write_mask: u32,
}

fn write_all() -> u32 {
    ColorWrites::ALL.bits()
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
struct StencilFace {
    compare: CompareFunction,
    fail_op: StencilOperation,
    depth_fail_op: StencilOperation,
    pass_op: StencilOperation,
}

impl Default for StencilFace {
    fn default() -> Self {
        StencilFaceState::IGNORE.into()
    }
}

impl From<StencilFaceState> for StencilFace {
    fn from(f: StencilFaceState) -> Self {
        Self { compare: f.compare, fail_op: f.fail_op, depth_fail_op: f.depth_fail_op, pass_op: f.pass_op }
    }
}

impl From<StencilFace> for StencilFaceState {
    fn from(f: StencilFace) -> Self {
        Self { compare: f.compare, fail_op: f.fail_op, depth_fail_op: f.depth_fail_op, pass_op: f.pass_op }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct DepthStencil {
    format: TextureFormat,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    depth_write_enabled: Option<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    depth_compare: Option<CompareFunction>,
    #[serde(default)]
    stencil_front: StencilFace,
    #[serde(default)]
    stencil_back: StencilFace,
    #[serde(default = "all_bits")]
    stencil_read_mask: u32,
    #[serde(default = "all_bits")]
    stencil_write_mask: u32,
    #[serde(default)]
    depth_bias: i32,
    #[serde(default)]
    depth_bias_slope_scale: f32,
    #[serde(default)]
    depth_bias_clamp: f32,
}

impl From<&DepthStencilState> for DepthStencil {
    fn from(d: &DepthStencilState) -> Self {
        Self {
            format: d.format,
            depth_write_enabled: d.depth_write_enabled,
            depth_compare: d.depth_compare,
            stencil_front: d.stencil.front.into(),
            stencil_back: d.stencil.back.into(),
            stencil_read_mask: d.stencil.read_mask,
            stencil_write_mask: d.stencil.write_mask,
            depth_bias: d.bias.constant,
            depth_bias_slope_scale: d.bias.slope_scale,
            depth_bias_clamp: d.bias.clamp,
        }
    }
}

fn all_bits() -> u32 {
    u32::MAX
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
struct Multisample {
    count: u32,
    mask: u32,
    alpha_to_coverage_enabled: bool,
}

impl Default for Multisample {
    fn default() -> Self {
        Self { count: 1, mask: u32::MAX, alpha_to_coverage_enabled: false }
    }
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct AlphaTestOn {
    compare: CompareFunction,
    #[serde(default)]
    reference: f32,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
struct State {
    targets: Vec<Option<Target>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth_stencil: Option<DepthStencil>,
    multisample: Multisample,
    blend_constant: [f32; 4],
    stencil_reference: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha_test: Option<AlphaTestOn>,
}

/// Reads a whole merger state: `targets`, `depthStencil`, `multisample`, `blendConstant`, `stencilReference` as WebGPU
/// names them, and `alphaTest` (`{"compare": "greater", "reference": 0.5}`), which WebGPU lacks.
///
/// # Errors
/// [`WebGpuError`], with line and column.
pub fn state_from_json(text: &str) -> Result<MergerState, WebGpuError> {
    let state: State = serde_json::from_str(text)?;
    if state.targets.len() > MAX_COLOR_TARGETS {
        return Err(WebGpuError::TooManyTargets(state.targets.len()));
    }
    for (member, x) in numbers(&state) {
        // serde reads numbers that are too large for binary32 as infinities.
        if !x.is_finite() {
            return Err(WebGpuError::TooLarge(member));
        }
    }
    let target = |target: Option<Target>| target.map(color_target).transpose();
    Ok(MergerState {
        targets: state.targets.into_iter().map(target).collect::<Result<_, _>>()?,
        depth_stencil: state.depth_stencil.map(depth_stencil),
        multisample: MultisampleState {
            count: state.multisample.count,
            mask: u64::from(state.multisample.mask),
            alpha_to_coverage_enabled: state.multisample.alpha_to_coverage_enabled,
        },
        alpha_test: state
            .alpha_test
            .map_or(AlphaTest::Off, |on| AlphaTest::On { compare: on.compare, reference: on.reference }),
        dynamic: DynamicState {
            blend_constant: state.blend_constant,
            stencil_reference: state.stencil_reference,
            ..DynamicState::default()
        },
    })
}

/// Every number with a fraction, with its member.
fn numbers(state: &State) -> impl Iterator<Item = (&'static str, f32)> {
    let bias = state.depth_stencil.iter().flat_map(|depth_stencil| {
        [
            ("depthStencil.depthBiasSlopeScale", depth_stencil.depth_bias_slope_scale),
            ("depthStencil.depthBiasClamp", depth_stencil.depth_bias_clamp),
        ]
    });
    let constant = state.blend_constant.map(|x| ("blendConstant", x)).into_iter();
    let reference = state.alpha_test.iter().map(|test| ("alphaTest.reference", test.reference));
    bias.chain(constant).chain(reference)
}

/// Reads a `GPUDepthStencilState`.
///
/// # Errors
/// [`WebGpuError`].
pub fn depth_stencil_from_value(value: serde_json::Value) -> Result<DepthStencilState, WebGpuError> {
    Ok(depth_stencil(serde_json::from_value(value)?))
}

/// Writes a depth/stencil state in the form [`depth_stencil_from_value`] reads.
///
/// # Panics
/// Never: the object has string keys and plain values only.
#[must_use]
pub fn depth_stencil_to_value(state: &DepthStencilState) -> serde_json::Value {
    serde_json::to_value(DepthStencil::from(state)).expect("plain values serialise")
}

/// Writes a merger state in the form [`state_from_json`] reads. Scissor and depth range are not part of it.
///
/// # Panics
/// Never: the object has string keys and plain values only.
#[must_use]
pub fn state_to_json(state: &MergerState) -> String {
    let target = |target: &Option<ColorTargetState>| {
        target.as_ref().map(|t| Target {
            format: t.format,
            blend: t.blend.map(|b| Blend { color: b.color.into(), alpha: b.alpha.into() }),
            write_mask: t.write_mask.bits(),
        })
    };
    let json = State {
        targets: state.targets.iter().map(target).collect(),
        depth_stencil: state.depth_stencil.as_ref().map(DepthStencil::from),
        multisample: Multisample {
            count: state.multisample.count,
            mask: u32::try_from(state.multisample.mask & u64::from(u32::MAX)).expect("masked to 32 bits"),
            alpha_to_coverage_enabled: state.multisample.alpha_to_coverage_enabled,
        },
        blend_constant: state.dynamic.blend_constant,
        stencil_reference: state.dynamic.stencil_reference,
        alpha_test: match state.alpha_test {
            AlphaTest::Off => None,
            AlphaTest::On { compare, reference } => Some(AlphaTestOn { compare, reference }),
        },
    };
    serde_json::to_string_pretty(&json).expect("plain values serialise")
}

/// Reads a state block from a `GPUBlendState`, or from an object with `blend` and `writeMask`.
///
/// # Errors
/// [`WebGpuError`], with line and column.
pub fn block_from_json(text: &str) -> Result<StateBlock, WebGpuError> {
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase", deny_unknown_fields, default)]
    struct Block {
        color: Option<Component>,
        alpha: Option<Component>,
        blend: Option<Blend>,
        write_mask: u32,
        /// Named so that a pasted `GPUColorTargetState` reads; the command line gives the format.
        #[serde(rename = "format")]
        _format: Option<TextureFormat>,
    }
    impl Default for Block {
        fn default() -> Self {
            Self { color: None, alpha: None, blend: None, write_mask: write_all(), _format: None }
        }
    }
    let block: Block = serde_json::from_str(text)?;
    let mask = ColorWrites::from_bits(block.write_mask).ok_or(WebGpuError::WriteMask(block.write_mask))?;
    let blend = match (block.color, block.alpha) {
        (None, None) => block.blend,
        (color, alpha) => Some(Blend { color: color.unwrap_or_default(), alpha: alpha.unwrap_or_default() }),
    };
    let blend = blend.map(|b| BlendState { color: b.color.into(), alpha: b.alpha.into() });
    Ok(StateBlock { write_mask: [mask; MAX_COLOR_TARGETS], ..StateBlock::with_blend(blend) })
}

fn color_target(target: Target) -> Result<ColorTargetState, WebGpuError> {
    Ok(ColorTargetState {
        format: target.format,
        blend: target.blend.map(|b| BlendState { color: b.color.into(), alpha: b.alpha.into() }),
        write_mask: ColorWrites::from_bits(target.write_mask).ok_or(WebGpuError::WriteMask(target.write_mask))?,
    })
}

fn depth_stencil(d: DepthStencil) -> DepthStencilState {
    DepthStencilState {
        format: d.format,
        depth_write_enabled: d.depth_write_enabled,
        depth_compare: d.depth_compare,
        stencil: StencilState {
            front: d.stencil_front.into(),
            back: d.stencil_back.into(),
            read_mask: d.stencil_read_mask,
            write_mask: d.stencil_write_mask,
        },
        bias: DepthBiasState {
            constant: d.depth_bias,
            slope_scale: d.depth_bias_slope_scale,
            clamp: d.depth_bias_clamp,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beyond_binary32_are_errors() {
        for (text, member) in [
            (r#"{"blendConstant":[0,0,-1e39,0]}"#, "blendConstant"),
            (r#"{"alphaTest":{"compare":"less","reference":1e39}}"#, "alphaTest.reference"),
            (r#"{"depthStencil":{"format":"depth16unorm","depthBiasClamp":4e38}}"#, "depthBiasClamp"),
            (r#"{"depthStencil":{"format":"depth16unorm","depthBiasSlopeScale":-4e38}}"#, "depthBiasSlopeScale"),
        ] {
            let error = state_from_json(text).expect_err(text).to_string();
            assert!(error.contains(member), "{error}");
        }
        assert!(state_from_json(r#"{"blendConstant":[3.4028235e38,0,0,0]}"#).is_ok(), "the largest number fits");
    }

    #[test]
    fn omitted_members_take_webgpu_s_defaults() {
        let state = state_from_json(
            r#"{"targets":[{"format":"rgba8unorm","blend":{"color":{"srcFactor":"src-alpha"}}}],
                "depthStencil":{"format":"depth24plus-stencil8","depthCompare":"less"}}"#,
        )
        .expect("valid");
        let target = state.targets[0].as_ref().expect("given");
        let blend = target.blend.expect("given");
        assert_eq!(blend.color.src_factor, BlendFactor::SrcAlpha, "given");
        assert_eq!(
            (blend.color.dst_factor, blend.color.operation),
            (BlendFactor::Zero, BlendOperation::Add),
            "defaults"
        );
        assert_eq!(blend.alpha, BlendComponent::REPLACE, "the whole component");
        assert_eq!(target.write_mask, ColorWrites::ALL, "mask");
        let depth = state.depth_stencil.expect("given");
        assert_eq!(depth.stencil.front, StencilFaceState::IGNORE, "stencil faces");
        assert_eq!(depth.stencil.read_mask, u32::MAX, "masks are all ones");
        assert_eq!(
            state.multisample,
            MultisampleState { mask: u64::from(u32::MAX), ..Default::default() },
            "multisample"
        );
    }

    #[test]
    fn states_survive_writing_and_reading() {
        let text = r#"{"targets":[null,{"format":"r16float","writeMask":1}],"stencilReference":7,
            "blendConstant":[0.5,1,2,-1],"alphaTest":{"compare":"greater-equal","reference":0.25},
            "depthStencil":{"format":"depth32float-stencil8","depthWriteEnabled":true,"depthCompare":"always",
            "stencilBack":{"passOp":"invert"},"stencilWriteMask":15,"depthBias":-2,"depthBiasSlopeScale":1.5}}"#;
        let state = state_from_json(text).expect("valid");
        assert_eq!(state_from_json(&state_to_json(&state)).expect("written"), state, "round trip");
    }

    #[test]
    fn unknown_members_and_values_are_errors_with_their_place() {
        for (text, expected) in [
            (r#"{"targets":[{"format":"rgba8unorm","writemask":1}]}"#, "writemask"),
            (r#"{"targets":[{"format":"rgba9unorm"}]}"#, "rgba9unorm"),
            (r#"{"targets":[{"format":"rgba8unorm","writeMask":16}]}"#, "0 to 15"),
            ("{", "line 1"),
        ] {
            let message = state_from_json(text).expect_err(text).to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
