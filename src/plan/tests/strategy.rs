//! Random states, fragments and destinations, weighted towards what could betray an omission.

use proptest::prelude::*;
use proptest::sample::select;
use wgpu_types::{
    BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthBiasState, DepthStencilState, MultisampleState, StencilFaceState, StencilOperation, StencilState,
    TextureFormat as T,
};

use crate::format::layout::FORMATS;
use crate::fragment::Fragment;
use crate::model::{NumericModel, registry};
use crate::state::spelling::{blend_factors, blend_operations};
use crate::state::{AlphaTest, DynamicState, MergerState, Rect};
use crate::target::{Extent, Framebuffer};

/// A state, its target with something in it, and fragments for texel (0, 0).
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) state: MergerState,
    pub(super) framebuffer: Framebuffer,
    pub(super) fragments: Vec<Fragment>,
}

pub(super) const COMPARISONS: [CompareFunction; 8] = [
    CompareFunction::Never,
    CompareFunction::Less,
    CompareFunction::Equal,
    CompareFunction::LessEqual,
    CompareFunction::Greater,
    CompareFunction::NotEqual,
    CompareFunction::GreaterEqual,
    CompareFunction::Always,
];

pub(super) const STENCIL_OPERATIONS: [StencilOperation; 8] = [
    StencilOperation::Keep,
    StencilOperation::Zero,
    StencilOperation::Replace,
    StencilOperation::Invert,
    StencilOperation::IncrementClamp,
    StencilOperation::DecrementClamp,
    StencilOperation::IncrementWrap,
    StencilOperation::DecrementWrap,
];

/// One model of each kind, and the variants that a plan could treat alike by mistake.
pub(super) fn models() -> Vec<Box<dyn NumericModel>> {
    let mut models = registry::all();
    for name in ["llvmpipe:128", "fixed:12,fused", "fixed:8,rounding=truncate"] {
        models.push(registry::by_name(name).expect("a model"));
    }
    models
}

fn number() -> impl Strategy<Value = f32> {
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        2.0,
        1e-40,
        -1e-40,
        1e-5,
        65504.0,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    prop_oneof![4 => select(special.to_vec()), 3 => 0.0_f32..=1.0, 1 => any::<f32>()]
}

fn color() -> impl Strategy<Value = [f32; 4]> {
    prop::array::uniform4(number())
}

fn factor() -> impl Strategy<Value = F> {
    let all: Vec<F> = blend_factors().collect();
    prop_oneof![2 => Just(F::Zero), 2 => Just(F::One), 1 => Just(F::SrcAlpha), 5 => select(all)]
}

fn component() -> impl Strategy<Value = BlendComponent> {
    let all: Vec<Op> = blend_operations().collect();
    let operation = prop_oneof![2 => Just(Op::Add), 3 => select(all)];
    let any = (factor(), factor(), operation).prop_map(|(src_factor, dst_factor, operation)| BlendComponent {
        src_factor,
        dst_factor,
        operation,
    });
    prop_oneof![1 => Just(BlendComponent::REPLACE), 4 => any]
}

fn blend() -> impl Strategy<Value = Option<BlendState>> {
    let same = component().prop_map(|component| BlendState { color: component, alpha: component });
    let apart = (component(), component()).prop_map(|(color, alpha)| BlendState { color, alpha });
    prop_oneof![1 => Just(None), 3 => same.prop_map(Some), 2 => apart.prop_map(Some)]
}

fn color_target() -> impl Strategy<Value = ColorTargetState> {
    let formats: Vec<T> = FORMATS.iter().map(|(_, format)| *format).collect();
    let mask = prop_oneof![3 => Just(ColorWrites::ALL), 1 => (0_u32..16).prop_map(ColorWrites::from_bits_truncate)];
    (select(formats), blend(), mask).prop_map(|(format, blend, write_mask)| ColorTargetState {
        format,
        blend,
        write_mask,
    })
}

fn comparison() -> impl Strategy<Value = CompareFunction> {
    select(COMPARISONS.to_vec())
}

fn face() -> impl Strategy<Value = StencilFaceState> {
    let operation = || prop_oneof![2 => Just(StencilOperation::Keep), 3 => select(STENCIL_OPERATIONS.to_vec())];
    (comparison(), operation(), operation(), operation()).prop_map(|(compare, fail_op, depth_fail_op, pass_op)| {
        StencilFaceState { compare, fail_op, depth_fail_op, pass_op }
    })
}

fn stencil() -> impl Strategy<Value = StencilState> {
    let mask = || prop_oneof![Just(255_u32), Just(0), any::<u32>()];
    let any = (face(), face(), mask(), mask()).prop_map(|(front, back, read_mask, write_mask)| StencilState {
        front,
        back,
        read_mask,
        write_mask,
    });
    prop_oneof![1 => Just(StencilState::default()), 2 => any]
}

fn depth_stencil() -> impl Strategy<Value = Option<DepthStencilState>> {
    let formats = vec![T::Depth16Unorm, T::Depth24PlusStencil8, T::Depth32Float, T::Depth32FloatStencil8, T::Stencil8];
    let any = (select(formats), any::<Option<bool>>(), prop::option::of(comparison()), stencil()).prop_map(
        |(format, depth_write_enabled, depth_compare, stencil)| {
            Some(DepthStencilState {
                format,
                depth_write_enabled,
                depth_compare,
                stencil,
                bias: DepthBiasState::default(),
            })
        },
    );
    prop_oneof![1 => Just(None), 2 => any]
}

fn alpha_test() -> impl Strategy<Value = AlphaTest> {
    let on = (comparison(), number()).prop_map(|(compare, reference)| AlphaTest::On { compare, reference });
    prop_oneof![2 => Just(AlphaTest::Off), 1 => on]
}

fn multisample() -> impl Strategy<Value = MultisampleState> {
    let mask = prop_oneof![3 => Just(!0_u64), 1 => 0_u64..16];
    (select(vec![1_u32, 4]), mask, prop::bool::weighted(0.2)).prop_map(|(count, mask, alpha_to_coverage_enabled)| {
        MultisampleState { count, mask, alpha_to_coverage_enabled }
    })
}

fn dynamic() -> impl Strategy<Value = DynamicState> {
    let scissor = prop_oneof![
        8 => Just(None),
        1 => Just(Some(Rect { x: 0, y: 0, width: 0, height: 1 })),
        1 => Just(Some(Rect { x: 0, y: 0, width: 1, height: 1 })),
    ];
    let range = select(vec![[0.0, 1.0], [0.25, 0.75]]);
    let reference = prop_oneof![Just(0_u32), Just(255), any::<u32>()];
    (color(), reference, range, scissor).prop_map(|(blend_constant, stencil_reference, depth_range, scissor)| {
        DynamicState { blend_constant, stencil_reference, depth_range, scissor }
    })
}

fn fragment() -> impl Strategy<Value = Fragment> {
    let depth = prop_oneof![select(vec![0.0, -0.0, 0.5, 1.0, f32::NAN]), 0.0_f32..=1.0];
    (color(), color(), color(), color(), depth, any::<u32>(), any::<bool>(), prop::bool::weighted(0.1)).prop_map(
        |(first, second, third, src1, depth, coverage, front_facing, discarded)| {
            let mut fragment = Fragment { src1, depth, coverage, front_facing, discarded, ..Fragment::new(first) };
            (fragment.outputs[1], fragment.outputs[2]) = (second, third);
            fragment
        },
    )
}

/// A case with exactly one or up to `targets` color targets.
pub(super) fn case(targets: usize) -> impl Strategy<Value = Case> {
    let colors = prop::collection::vec(prop::option::weighted(0.9, color_target()), 1..=targets);
    let state = (colors, depth_stencil(), multisample(), alpha_test(), dynamic()).prop_map(
        |(mut targets, depth_stencil, multisample, alpha_test, dynamic)| {
            if targets.len() == 1 && targets[0].is_none() {
                targets[0] = Some(T::Rgba8Unorm.into());
            }
            MergerState { targets, depth_stencil, multisample, alpha_test, dynamic }
        },
    );
    // Stored bytes: any, or a number in every channel's own format where special bit patterns are likely.
    let bytes = prop_oneof![
        prop::collection::vec(any::<u8>(), 16),
        select(vec![0x00_u8, 0x7c, 0x7e, 0x7f, 0x80, 0xfc, 0xff]).prop_map(|byte| vec![byte; 16]),
        number().prop_map(|x| x.to_le_bytes().repeat(4)),
        number().prop_map(|x| half::f16::from_f32(x).to_le_bytes().repeat(8)),
    ];
    let depths = prop_oneof![select(vec![0.0_f32, -0.0, 0.5, 1.0, f32::NAN]).prop_map(f32::to_bits), 0_u32..=0xffff];
    (state, prop::collection::vec(fragment(), 1..4), bytes, depths, any::<u8>()).prop_map(
        |(state, fragments, bytes, depth, stencil)| {
            let extent = Extent::with_samples(1, 1, state.multisample.count).expect("one or four");
            let mut framebuffer = Framebuffer::for_state(extent, &state).expect("small");
            for color in framebuffer.colors.iter_mut().flatten() {
                let each = color.format().bytes_per_texel();
                for texel in color.bytes_mut().chunks_exact_mut(each) {
                    texel.copy_from_slice(&bytes[..each]);
                }
            }
            if let Some(target) = &mut framebuffer.depth_stencil {
                let bits = target.format().depth().map_or(32, |kind| match kind {
                    crate::format::depth::DepthKind::Unorm(bits) => bits,
                    crate::format::depth::DepthKind::Float32 => 32,
                });
                target.depth_mut().fill(depth & (u32::MAX >> (32 - bits)));
                target.stencil_mut().fill(stencil);
            }
            Case { state, framebuffer, fragments }
        },
    )
}
