//! proptest strategies for states, for the round trips of the readers.

use proptest::prelude::*;
use proptest::sample::select;
use wgpu_types::{
    BlendComponent, BlendOperation, BlendState, ColorTargetState, ColorWrites, DepthBiasState, DepthStencilState, Face,
    MultisampleState, StencilFaceState, StencilState, TextureFormat,
};

use super::{AlphaTest, DynamicState, MergerState, Rect, StateBlock, spelling};
use crate::format::layout::FORMATS;

/// One blend component; min and max have factors one.
pub(super) fn blend_component() -> impl Strategy<Value = BlendComponent> {
    let factor = || select(spelling::blend_factors().collect::<Vec<_>>());
    (factor(), factor(), select(spelling::blend_operations().collect::<Vec<_>>())).prop_map(|(src, dst, operation)| {
        match operation {
            BlendOperation::Min | BlendOperation::Max => {
                BlendComponent { src_factor: wgpu_types::BlendFactor::One, dst_factor: wgpu_types::BlendFactor::One, operation }
            }
            _ => BlendComponent { src_factor: src, dst_factor: dst, operation },
        }
    })
}

/// Blending, or none.
pub(super) fn blend() -> impl Strategy<Value = Option<BlendState>> {
    proptest::option::of((blend_component(), blend_component()).prop_map(|(color, alpha)| BlendState { color, alpha }))
}

fn write_mask() -> impl Strategy<Value = ColorWrites> {
    (0_u32..16).prop_map(ColorWrites::from_bits_truncate)
}

fn stencil_face() -> impl Strategy<Value = StencilFaceState> {
    let operation = || select(spelling::stencil_operations().collect::<Vec<_>>());
    let compare = select(spelling::compare_functions().collect::<Vec<_>>());
    (compare, operation(), operation(), operation()).prop_map(|(compare, fail_op, depth_fail_op, pass_op)| {
        StencilFaceState { compare, fail_op, depth_fail_op, pass_op }
    })
}

fn stencil(masks: impl Strategy<Value = u32> + Clone) -> impl Strategy<Value = StencilState> {
    (stencil_face(), stencil_face(), masks.clone(), masks)
        .prop_map(|(front, back, read_mask, write_mask)| StencilState { front, back, read_mask, write_mask })
}

/// A finite number of any size.
fn finite() -> impl Strategy<Value = f32> {
    use proptest::num::f32;
    f32::NORMAL | f32::SUBNORMAL | f32::ZERO | f32::POSITIVE
}

fn alpha_test() -> impl Strategy<Value = AlphaTest> {
    let compare = select(spelling::compare_functions().collect::<Vec<_>>());
    prop_oneof![
        Just(AlphaTest::Off),
        (compare, finite()).prop_map(|(compare, reference)| AlphaTest::On { compare, reference }),
    ]
}

/// Whatever ShaderLab can say.
pub(super) fn state_block() -> impl Strategy<Value = StateBlock> {
    let compare = select(spelling::compare_functions().collect::<Vec<_>>());
    let cull = select(vec![None, Some(Face::Front), Some(Face::Back)]);
    let bias = (any::<i32>(), finite())
        .prop_map(|(constant, slope_scale)| DepthBiasState { constant, slope_scale, clamp: 0.0 });
    let tags = proptest::collection::btree_map("[a-z]{1,8}", "[A-Za-z0-9+ ]{0,12}", 0..4);
    (
        proptest::array::uniform8(blend()),
        proptest::array::uniform8(write_mask()),
        (any::<bool>(), compare, cull, bias),
        alpha_test(),
        proptest::option::of((stencil(0_u32..256), 0_u32..256)),
        // A queue has a grammar of its own.
        tags.prop_filter("no queue", |tags| !tags.contains_key("queue")),
    )
        .prop_map(|(blend, write_mask, (depth_write, depth_compare, cull, depth_bias), alpha_test, stencil, tags)| {
            StateBlock {
                blend,
                write_mask,
                depth_write,
                depth_compare,
                cull,
                depth_bias,
                alpha_test,
                stencil,
                tags: tags.into_iter().collect(),
            }
        })
}

fn color_target() -> impl Strategy<Value = ColorTargetState> {
    let format = select(FORMATS.map(|(_, format)| format).to_vec());
    (format, blend(), write_mask()).prop_map(|(format, blend, write_mask)| ColorTargetState { format, blend, write_mask })
}

fn depth_stencil() -> impl Strategy<Value = DepthStencilState> {
    use TextureFormat as T;
    let formats = [T::Stencil8, T::Depth16Unorm, T::Depth24Plus, T::Depth24PlusStencil8, T::Depth32Float, T::Depth32FloatStencil8];
    let compare = select(spelling::compare_functions().collect::<Vec<_>>());
    let bias = (any::<i32>(), finite(), finite())
        .prop_map(|(constant, slope_scale, clamp)| DepthBiasState { constant, slope_scale, clamp });
    (select(formats.to_vec()), any::<Option<bool>>(), proptest::option::of(compare), stencil(any::<u32>()), bias).prop_map(
        |(format, depth_write_enabled, depth_compare, stencil, bias)| DepthStencilState {
            format,
            depth_write_enabled,
            depth_compare,
            stencil,
            bias,
        },
    )
}

/// Any state of finite numbers, valid for WebGPU or not.
pub(super) fn merger_state() -> impl Strategy<Value = MergerState> {
    // The sample mask has 32 bits in WebGPU and 64 in `wgpu-types`; all ones is one value in both.
    let mask = prop_oneof![Just(u64::MAX), any::<u32>().prop_filter("all ones", |m| *m != u32::MAX).prop_map(u64::from)];
    let multisample = (select(vec![1_u32, 4]), mask, any::<bool>())
        .prop_map(|(count, mask, alpha_to_coverage_enabled)| MultisampleState { count, mask, alpha_to_coverage_enabled });
    let scissor = proptest::option::of(any::<[u32; 4]>())
        .prop_map(|r| r.map(|[x, y, width, height]| Rect { x, y, width, height }));
    let dynamic = (proptest::array::uniform4(finite()), any::<u32>(), proptest::array::uniform2(0.0_f32..=1.0), scissor).prop_map(
        |(blend_constant, stencil_reference, depth_range, scissor)| DynamicState {
            blend_constant,
            stencil_reference,
            depth_range,
            scissor,
        },
    );
    (
        proptest::collection::vec(proptest::option::of(color_target()), 0..=8),
        proptest::option::of(depth_stencil()),
        multisample,
        alpha_test(),
        dynamic,
    )
        .prop_map(|(targets, depth_stencil, multisample, alpha_test, dynamic)| MergerState {
            targets,
            depth_stencil,
            multisample,
            alpha_test,
            dynamic,
        })
}
