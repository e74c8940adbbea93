//! WebGPU's validation of a merger state, each problem named by its member's path.
//!
//! Source: WebGPU, *GPUColorTargetState*, *GPUBlendState*, *GPUDepthStencilState*, *GPUMultisampleState* (validating
//! steps) and *Texture Format Capabilities*.

use wgpu_types::{BlendFactor, BlendOperation, ColorTargetState, DepthStencilState, StencilOperation};

use super::{AlphaTest, MAX_COLOR_TARGETS, MergerState, component_reads_second_source};
use crate::format::{ChannelKind, ColorFormat, DepthFormat, FormatError};

/// A state WebGPU refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {problem}")]
pub struct ValidationError {
    /// The member, e.g. `targets[0].blend.color`.
    pub path: String,
    /// What is wrong and what to do.
    pub problem: Problem,
}

/// What WebGPU refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "each variant's message is its documentation")]
pub enum Problem {
    #[error(transparent)]
    Format(#[from] FormatError),
    #[error("{0} color targets; at most {MAX_COLOR_TARGETS} are possible")]
    TooManyTargets(usize),
    #[error("there is nothing to render to: give a color target or a depth/stencil state")]
    NoTarget,
    #[error("min and max ignore factors, and WebGPU asks for srcFactor and dstFactor to be one")]
    ExtremeFactors,
    #[error("a second-source factor needs exactly one color target, and there are {0}")]
    DualSourceTargets(usize),
    #[error("depthWriteEnabled is missing; a format with a depth aspect needs it")]
    DepthWriteMissing,
    #[error("depthCompare is missing; it is needed when depth is written or a depthFailOp is not keep")]
    DepthCompareMissing,
    #[error("the format has no depth aspect; leave depthCompare at always and depthWriteEnabled at false")]
    NoDepthAspect,
    #[error("the format has no stencil aspect; leave both stencil faces at their defaults")]
    NoStencilAspect,
    #[error("{0} samples; WebGPU has 1 and 4")]
    SampleCount(u32),
    #[error("alpha to coverage needs 4 samples and a blendable color target 0 with an alpha channel")]
    AlphaToCoverage,
    #[error("the range is {0} to {1}; it must satisfy 0 <= min <= max <= 1")]
    DepthRange(f32, f32),
    #[error("{0} is not a finite number")]
    NotFinite(f32),
}

/// A feature a state needs beyond WebGPU's core.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RequiredFeature {
    /// `float32-blendable`: blending on 32-bit float targets.
    Float32Blendable,
    /// `rg11b10ufloat-renderable`.
    Rg11b10UfloatRenderable,
    /// `texture-formats-tier1`: rendering to snorm and 16-bit normalised targets.
    TextureFormatsTier1,
    /// `dual-source-blending`.
    DualSourceBlending,
}

/// Checks a state by WebGPU's rules and tells which features it needs.
///
/// # Errors
/// The first [`ValidationError`].
pub fn validate(state: &MergerState) -> Result<Vec<RequiredFeature>, ValidationError> {
    let mut features = Vec::new();
    if state.targets.len() > MAX_COLOR_TARGETS {
        return Err(at("targets", Problem::TooManyTargets(state.targets.len())));
    }
    if state.targets.iter().all(Option::is_none) && state.depth_stencil.is_none() {
        return Err(at("targets", Problem::NoTarget));
    }
    let count = state.targets.iter().flatten().count();
    for (i, target) in state.targets.iter().enumerate() {
        if let Some(target) = target {
            color_target(target, &format!("targets[{i}]"), count, &mut features)?;
        }
    }
    if let Some(depth_stencil) = &state.depth_stencil {
        depth_stencil_state(depth_stencil)?;
    }
    multisample(state)?;
    let [min, max] = state.dynamic.depth_range;
    if !(0.0 <= min && min <= max && max <= 1.0) {
        return Err(at("dynamic.depthRange", Problem::DepthRange(min, max)));
    }
    for x in state.dynamic.blend_constant {
        finite("dynamic.blendConstant", x)?;
    }
    if let AlphaTest::On { reference, .. } = state.alpha_test {
        finite("alphaTest.reference", reference)?;
    }
    Ok(features)
}

fn at(path: impl Into<String>, problem: Problem) -> ValidationError {
    ValidationError { path: path.into(), problem }
}

fn finite(path: &str, x: f32) -> Result<(), ValidationError> {
    if x.is_finite() { Ok(()) } else { Err(at(path, Problem::NotFinite(x))) }
}

fn color_target(
    target: &ColorTargetState,
    path: &str,
    count: usize,
    features: &mut Vec<RequiredFeature>,
) -> Result<(), ValidationError> {
    let format = ColorFormat::new(target.format).map_err(|e| at(format!("{path}.format"), e.into()))?;
    let mut need = |feature| {
        if !features.contains(&feature) {
            features.push(feature);
        }
    };
    match format.channels()[0] {
        ChannelKind::Snorm(_) | ChannelKind::Unorm(16) => need(RequiredFeature::TextureFormatsTier1),
        ChannelKind::Float(layout) if !layout.signed => need(RequiredFeature::Rg11b10UfloatRenderable),
        ChannelKind::Float(layout) if layout.mantissa_bits == 23 && target.blend.is_some() => {
            need(RequiredFeature::Float32Blendable);
        }
        _ => {}
    }
    let Some(blend) = &target.blend else { return Ok(()) };
    for (name, component) in [("color", &blend.color), ("alpha", &blend.alpha)] {
        let path = format!("{path}.blend.{name}");
        let extreme = matches!(component.operation, BlendOperation::Min | BlendOperation::Max);
        if extreme && (component.src_factor, component.dst_factor) != (BlendFactor::One, BlendFactor::One) {
            return Err(at(path, Problem::ExtremeFactors));
        }
        if component_reads_second_source(component) {
            if count != 1 {
                return Err(at(path, Problem::DualSourceTargets(count)));
            }
            need(RequiredFeature::DualSourceBlending);
        }
    }
    Ok(())
}

fn depth_stencil_state(state: &DepthStencilState) -> Result<(), ValidationError> {
    let format = DepthFormat::new(state.format).map_err(|e| at("depthStencil.format", e.into()))?;
    let faces = [&state.stencil.front, &state.stencil.back];
    let fails_into_something = faces.iter().any(|face| face.depth_fail_op != StencilOperation::Keep);
    if format.depth().is_some() {
        if state.depth_write_enabled.is_none() {
            return Err(at("depthStencil.depthWriteEnabled", Problem::DepthWriteMissing));
        }
        if state.depth_compare.is_none() && (state.depth_write_enabled == Some(true) || fails_into_something) {
            return Err(at("depthStencil.depthCompare", Problem::DepthCompareMissing));
        }
    } else if state.depth_write_enabled == Some(true) || state.depth_compare.unwrap_or_default() != Default::default() {
        return Err(at("depthStencil", Problem::NoDepthAspect));
    }
    if !format.has_stencil() && faces.iter().any(|face| **face != wgpu_types::StencilFaceState::IGNORE) {
        return Err(at("depthStencil.stencil", Problem::NoStencilAspect));
    }
    finite("depthStencil.depthBiasSlopeScale", state.bias.slope_scale)?;
    finite("depthStencil.depthBiasClamp", state.bias.clamp)
}

fn multisample(state: &MergerState) -> Result<(), ValidationError> {
    let multisample = &state.multisample;
    if multisample.count != 1 && multisample.count != 4 {
        return Err(at("multisample.count", Problem::SampleCount(multisample.count)));
    }
    if multisample.alpha_to_coverage_enabled {
        let target = state.targets.first().and_then(Option::as_ref);
        let format = target.and_then(|target| ColorFormat::new(target.format).ok());
        let has_alpha = format.is_some_and(|format| format.channels()[3] != ChannelKind::Absent);
        if multisample.count == 1 || !has_alpha {
            return Err(at("multisample.alphaToCoverageEnabled", Problem::AlphaToCoverage));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu_types::{
        BlendComponent, BlendState, CompareFunction, DepthBiasState, StencilFaceState, StencilState, TextureFormat,
    };

    fn target(format: TextureFormat, blend: Option<BlendState>) -> MergerState {
        MergerState::single(ColorTargetState { blend, ..format.into() })
    }

    fn with_depth(format: TextureFormat, write: Option<bool>, compare: Option<CompareFunction>) -> MergerState {
        MergerState {
            depth_stencil: Some(DepthStencilState {
                format,
                depth_write_enabled: write,
                depth_compare: compare,
                stencil: StencilState::default(),
                bias: DepthBiasState::default(),
            }),
            ..MergerState::default()
        }
    }

    fn problem(state: &MergerState) -> (String, Problem) {
        let error = validate(state).expect_err("refused");
        (error.path, error.problem)
    }

    fn blend(src: BlendFactor, dst: BlendFactor, operation: BlendOperation) -> Option<BlendState> {
        let component = BlendComponent { src_factor: src, dst_factor: dst, operation };
        Some(BlendState { color: component, alpha: BlendComponent::REPLACE })
    }

    #[test]
    fn plain_states_pass_without_features() {
        let state = target(TextureFormat::Rgba8Unorm, Some(BlendState::ALPHA_BLENDING));
        assert_eq!(validate(&state), Ok(vec![]), "rgba8unorm blends in the core");
        let depth = with_depth(TextureFormat::Depth24Plus, Some(true), Some(CompareFunction::Less));
        assert_eq!(validate(&depth), Ok(vec![]), "a depth-only pass");
    }

    #[test]
    fn formats_and_factors_name_the_feature_they_need() {
        use RequiredFeature as R;
        let over = Some(BlendState::ALPHA_BLENDING);
        assert_eq!(validate(&target(TextureFormat::Rgba32Float, over)), Ok(vec![R::Float32Blendable]), "blended");
        assert_eq!(validate(&target(TextureFormat::Rgba32Float, None)), Ok(vec![]), "unblended");
        assert_eq!(
            validate(&target(TextureFormat::Rg11b10Ufloat, None)),
            Ok(vec![R::Rg11b10UfloatRenderable]),
            "11/10"
        );
        assert_eq!(validate(&target(TextureFormat::Rgba8Snorm, None)), Ok(vec![R::TextureFormatsTier1]), "snorm");
        assert_eq!(validate(&target(TextureFormat::R16Unorm, None)), Ok(vec![R::TextureFormatsTier1]), "16 bit");
        let dual = blend(BlendFactor::Src1, BlendFactor::Zero, BlendOperation::Add);
        assert_eq!(validate(&target(TextureFormat::R8Unorm, dual)), Ok(vec![R::DualSourceBlending]), "second source");
    }

    #[test]
    fn integer_and_depth_formats_are_no_color_targets() {
        let (path, found) = problem(&target(TextureFormat::Rgba8Uint, None));
        assert_eq!(path, "targets[0].format", "path");
        assert!(matches!(found, Problem::Format(_)), "{found}");
    }

    #[test]
    fn min_and_max_ask_for_factors_one() {
        let state = target(TextureFormat::R8Unorm, blend(BlendFactor::SrcAlpha, BlendFactor::One, BlendOperation::Max));
        assert_eq!(problem(&state), ("targets[0].blend.color".to_owned(), Problem::ExtremeFactors), "refused");
        let fine = target(TextureFormat::R8Unorm, blend(BlendFactor::One, BlendFactor::One, BlendOperation::Max));
        assert!(validate(&fine).is_ok(), "factors one");
    }

    #[test]
    fn dual_source_needs_exactly_one_target() {
        let dual = blend(BlendFactor::One, BlendFactor::OneMinusSrc1Alpha, BlendOperation::Add);
        let mut state = target(TextureFormat::Rgba8Unorm, dual);
        state.targets.push(Some(TextureFormat::R8Unorm.into()));
        assert_eq!(problem(&state).1, Problem::DualSourceTargets(2), "two targets");
    }

    #[test]
    fn depth_members_are_needed_where_depth_is_used() {
        let missing = with_depth(TextureFormat::Depth16Unorm, None, Some(CompareFunction::Less));
        assert_eq!(problem(&missing).1, Problem::DepthWriteMissing, "depthWriteEnabled");
        let missing = with_depth(TextureFormat::Depth16Unorm, Some(true), None);
        assert_eq!(problem(&missing).1, Problem::DepthCompareMissing, "depthCompare");
        let stencil_only = with_depth(TextureFormat::Stencil8, Some(true), None);
        assert_eq!(problem(&stencil_only).1, Problem::NoDepthAspect, "stencil8 has no depth");
        let mut fails = with_depth(TextureFormat::Depth24PlusStencil8, Some(false), None);
        if let Some(depth_stencil) = &mut fails.depth_stencil {
            depth_stencil.stencil.front =
                StencilFaceState { depth_fail_op: StencilOperation::Zero, ..StencilFaceState::IGNORE };
        }
        assert_eq!(problem(&fails).1, Problem::DepthCompareMissing, "a depthFailOp asks for a comparison");
    }

    #[test]
    fn stencil_needs_a_stencil_aspect() {
        let mut state = with_depth(TextureFormat::Depth32Float, Some(false), None);
        if let Some(depth_stencil) = &mut state.depth_stencil {
            depth_stencil.stencil.back =
                StencilFaceState { pass_op: StencilOperation::Zero, ..StencilFaceState::IGNORE };
        }
        assert_eq!(problem(&state).1, Problem::NoStencilAspect, "depth32float");
    }

    #[test]
    fn counts_ranges_and_numbers_are_checked() {
        let base = || target(TextureFormat::Rgba8Unorm, None);
        let mut state = base();
        state.multisample.count = 2;
        assert_eq!(problem(&state).1, Problem::SampleCount(2), "samples");
        let mut state = base();
        state.multisample.alpha_to_coverage_enabled = true;
        assert_eq!(problem(&state).1, Problem::AlphaToCoverage, "one sample");
        let mut state = base();
        state.dynamic.depth_range = [0.5, 0.25];
        assert_eq!(problem(&state).1, Problem::DepthRange(0.5, 0.25), "reversed");
        let mut state = base();
        state.dynamic.blend_constant[2] = f32::INFINITY;
        assert_eq!(problem(&state).1, Problem::NotFinite(f32::INFINITY), "constant");
        let mut state = base();
        state.targets = vec![None; 9];
        assert_eq!(problem(&state).1, Problem::TooManyTargets(9), "targets");
        assert_eq!(problem(&MergerState::default()).1, Problem::NoTarget, "nothing");
    }
}
