//! WebGPU's defaults and validation. Sources: W, *Color target state*, *Depth/stencil state*, *Texture Format
//! Capabilities*, *Render pass* (initial blend constant and stencil reference).

use outmerge::format::layout::FORMATS;
use outmerge::format::{ColorFormat, DepthFormat};
use outmerge::state::validate::{RequiredFeature, validate};
use outmerge::state::webgpu::state_from_json;
use outmerge::state::{DynamicState, MergerState};
use wgpu_types::{
    BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthBiasState, DepthStencilState, StencilFaceState, StencilOperation, StencilState, TextureFormat as T,
};

use crate::texel::equation;

fn target(format: T, blend: Option<BlendState>) -> MergerState {
    MergerState::single(ColorTargetState { blend, ..format.into() })
}

fn depth(format: T, write: Option<bool>, compare: Option<CompareFunction>) -> MergerState {
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

#[test]
fn an_omitted_blend_is_blending_off_and_an_empty_component_is_one_zero_add() {
    let read = |blend: &str| {
        let json = format!(r#"{{"targets": [{{"format": "rgba8unorm"{blend}}}]}}"#);
        let state = state_from_json(&json).expect("a legal state");
        state.targets[0].clone().expect("a target")
    };
    assert_eq!(read("").blend, None, "no blend member");
    assert_eq!(read("").write_mask, ColorWrites::ALL, "writeMask 15");
    let empty = read(r#", "blend": {"color": {}, "alpha": {}}"#).blend.expect("a blend state");
    let one_zero = BlendComponent { src_factor: F::One, dst_factor: F::Zero, operation: Op::Add };
    assert_eq!(empty, BlendState { color: one_zero, alpha: one_zero }, "the default component");
}

#[test]
fn stencil_and_depth_defaults_keep_and_always_pass() {
    let json = r#"{"targets": [], "depthStencil": {"format": "depth24plus-stencil8",
        "depthWriteEnabled": true, "depthCompare": "less"}}"#;
    let state = state_from_json(json).expect("a legal state").depth_stencil.expect("depth and stencil");
    assert_eq!(state.stencil.front, StencilFaceState::IGNORE, "compare always, keep, keep, keep");
    assert_eq!(state.stencil.back, StencilFaceState::IGNORE, "the same behind");
    assert_eq!((state.stencil.read_mask, state.stencil.write_mask), (!0, !0), "all bits");
    assert_eq!(state.bias, DepthBiasState::default(), "no bias");
}

#[test]
fn a_pass_starts_with_constant_and_reference_zero() {
    let initial = DynamicState::default();
    assert_eq!((initial.blend_constant, initial.stencil_reference), ([0.0; 4], 0), "never inherited");
    assert_eq!(initial.depth_range, [0.0, 1.0], "the whole depth range");
}

#[test]
fn the_core_s_blendable_formats_need_no_feature() {
    let over = Some(BlendState::ALPHA_BLENDING);
    for format in [
        T::R8Unorm,
        T::Rg8Unorm,
        T::Rgba8Unorm,
        T::Rgba8UnormSrgb,
        T::Bgra8Unorm,
        T::Bgra8UnormSrgb,
        T::R16Float,
        T::Rg16Float,
        T::Rgba16Float,
        T::Rgb10a2Unorm,
    ] {
        assert_eq!(validate(&target(format, over)), Ok(vec![]), "{format:?}");
    }
}

#[test]
fn other_formats_name_the_feature_they_need() {
    let over = Some(BlendState::ALPHA_BLENDING);
    for format in [T::R32Float, T::Rg32Float, T::Rgba32Float] {
        assert_eq!(validate(&target(format, over)), Ok(vec![RequiredFeature::Float32Blendable]), "{format:?}");
        assert_eq!(validate(&target(format, None)), Ok(vec![]), "{format:?} renders without it");
    }
    for (name, format) in FORMATS {
        let tier1 = name.contains("snorm") || name.contains("16unorm");
        if tier1 {
            let needed = validate(&target(format, None)).expect("renderable");
            assert_eq!(needed, [RequiredFeature::TextureFormatsTier1], "{name}");
        }
    }
}

#[test]
fn integer_and_shared_exponent_formats_are_never_blended() {
    for format in [T::Rgba8Uint, T::Rgba8Sint, T::R32Uint, T::Rgb10a2Uint, T::Rgb9e5Ufloat] {
        assert!(ColorFormat::new(format).is_err() && validate(&target(format, None)).is_err(), "{format:?}");
    }
}

#[test]
fn min_and_max_need_factors_one() {
    for op in [Op::Min, Op::Max] {
        assert!(validate(&target(T::Rgba8Unorm, equation(F::One, F::One, op))).is_ok(), "{op:?} of one and one");
        assert!(validate(&target(T::Rgba8Unorm, equation(F::SrcAlpha, F::One, op))).is_err(), "{op:?}: source factor");
        assert!(validate(&target(T::Rgba8Unorm, equation(F::One, F::Zero, op))).is_err(), "{op:?}: destination factor");
    }
}

#[test]
fn dual_source_needs_its_feature_and_exactly_one_target() {
    for factor in [F::Src1, F::OneMinusSrc1, F::Src1Alpha, F::OneMinusSrc1Alpha] {
        let mut state = target(T::Rgba8Unorm, equation(F::One, factor, Op::Add));
        assert_eq!(validate(&state), Ok(vec![RequiredFeature::DualSourceBlending]), "{factor:?}");
        state.targets.push(Some(T::Rgba8Unorm.into()));
        assert!(validate(&state).is_err(), "{factor:?} with two targets");
    }
}

#[test]
fn depth_members_are_required_where_they_matter() {
    use CompareFunction::Less;
    assert!(validate(&depth(T::Depth24Plus, None, Some(Less))).is_err(), "depthWriteEnabled of a depth format");
    assert!(validate(&depth(T::Depth24Plus, Some(true), None)).is_err(), "depthCompare where depth is written");
    assert!(validate(&depth(T::Depth24Plus, Some(true), Some(Less))).is_ok(), "both given");
    let mut fails = depth(T::Depth24PlusStencil8, Some(false), None);
    let face = StencilFaceState { depth_fail_op: StencilOperation::Replace, ..StencilFaceState::IGNORE };
    fails.depth_stencil.as_mut().expect("depth").stencil.back = face;
    assert!(validate(&fails).is_err(), "depthCompare where depthFailOp is not keep");
}

#[test]
fn the_viewport_s_depth_range_is_ordered_and_within_zero_and_one() {
    let with_range = |depth_range| {
        let mut state = target(T::Rgba8Unorm, None);
        state.dynamic.depth_range = depth_range;
        validate(&state).is_ok()
    };
    assert!(with_range([0.0, 1.0]) && with_range([0.25, 0.25]), "ordered, also empty");
    assert!(!with_range([0.75, 0.25]) && !with_range([-0.5, 1.0]) && !with_range([0.0, 1.5]), "refused");
    assert!(!with_range([f32::NAN, 1.0]) && !with_range([0.0, f32::NAN]), "NaN is no bound");
}

#[test]
fn depth_and_stencil_formats_have_the_aspects_their_names_say() {
    for (format, has_depth, has_stencil) in [
        (T::Depth16Unorm, true, false),
        (T::Depth24Plus, true, false),
        (T::Depth24PlusStencil8, true, true),
        (T::Depth32Float, true, false),
        (T::Depth32FloatStencil8, true, true),
        (T::Stencil8, false, true),
    ] {
        let layout = DepthFormat::new(format).expect("a depth/stencil format");
        assert_eq!((layout.depth().is_some(), layout.has_stencil()), (has_depth, has_stencil), "{format:?}");
    }
}
