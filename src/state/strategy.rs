//! Strategies for state blocks, for the round trips of the readers.

use proptest::prelude::*;
use proptest::sample::select;
use wgpu_types::{
    BlendComponent, BlendOperation, BlendState, ColorWrites, DepthBiasState, Face, StencilFaceState, StencilState,
};

use super::{AlphaTest, StateBlock, spelling};

/// One blend component; min and max have factors one.
pub(super) fn blend_component() -> impl Strategy<Value = BlendComponent> {
    let factor = || select(spelling::blend_factors().collect::<Vec<_>>());
    (factor(), factor(), select(spelling::blend_operations().collect::<Vec<_>>())).prop_map(|(src, dst, operation)| {
        match operation {
            BlendOperation::Min | BlendOperation::Max => BlendComponent {
                src_factor: wgpu_types::BlendFactor::One,
                dst_factor: wgpu_types::BlendFactor::One,
                operation,
            },
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
    let bias = (any::<i32>(), finite()).prop_map(|(constant, slope_scale)| DepthBiasState {
        constant,
        slope_scale,
        clamp: 0.0,
    });
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
        .prop_map(
            |(blend, write_mask, (depth_write, depth_compare, cull, depth_bias), alpha_test, stencil, tags)| {
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
            },
        )
}
