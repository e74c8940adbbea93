//! States: formats, equations, depth, stencil and multisampling, and whole merger states.

use ::proptest::option;
use ::proptest::prelude::*;
use ::proptest::sample::select;
use wgpu_types::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthBiasState, DepthStencilState, MultisampleState, StencilFaceState, StencilOperation, StencilState,
    TextureFormat,
};

use super::{every, number};
use crate::format::{ChannelKind, ColorFormat, DepthFormat, TargetClass};
use crate::merger::blend::operation::ignores_factors;
use crate::state::spelling::{blend_factors, blend_operations, compare_functions, stencil_operations};
use crate::state::{AlphaTest, DynamicState, MergerState, Rect};

/// Any color format outmerge models.
pub fn format() -> impl Strategy<Value = ColorFormat> + Clone {
    select(every::formats().collect::<Vec<_>>())
}

/// A color format of one class.
///
/// # Panics
/// Never: each class has formats.
pub fn format_of(class: TargetClass) -> impl Strategy<Value = ColorFormat> + Clone {
    select(every::formats().filter(|format| format.class() == class).collect::<Vec<_>>())
}

/// Any of the 17 factors.
pub fn factor() -> impl Strategy<Value = BlendFactor> + Clone {
    select(blend_factors().collect::<Vec<_>>())
}

/// A factor that reads only the first source.
pub fn single_source_factor() -> impl Strategy<Value = BlendFactor> + Clone {
    select(blend_factors().filter(|factor| !factor.ref_second_blend_source()).collect::<Vec<_>>())
}

/// Any of the five operations.
pub fn operation() -> impl Strategy<Value = BlendOperation> + Clone {
    select(blend_operations().collect::<Vec<_>>())
}

/// Any factors and operation, also min and max with factors that WebGPU refuses and every blender ignores.
pub fn component() -> impl Strategy<Value = BlendComponent> + Clone {
    component_of(factor())
}

/// Factors from a strategy, with any operation.
pub fn component_of(
    factors: impl Strategy<Value = BlendFactor> + Clone,
) -> impl Strategy<Value = BlendComponent> + Clone {
    (factors.clone(), factors, operation()).prop_map(|(src_factor, dst_factor, operation)| BlendComponent {
        src_factor,
        dst_factor,
        operation,
    })
}

/// A blend state: one equation for color and alpha, or two.
pub fn blend_state() -> impl Strategy<Value = BlendState> + Clone {
    blend_state_of(factor())
}

/// A blend state with factors from a strategy.
pub fn blend_state_of(
    factors: impl Strategy<Value = BlendFactor> + Clone,
) -> impl Strategy<Value = BlendState> + Clone {
    let component = component_of(factors);
    prop_oneof![
        component.clone().prop_map(|both| BlendState { color: both, alpha: both }),
        (component.clone(), component).prop_map(|(color, alpha)| BlendState { color, alpha }),
    ]
}

/// A blend state, or blending off.
pub fn blend() -> impl Strategy<Value = Option<BlendState>> + Clone {
    option::weighted(0.85, blend_state())
}

/// A write mask; all channels as often as the other fifteen together.
pub fn write_mask() -> impl Strategy<Value = ColorWrites> + Clone {
    prop_oneof![Just(ColorWrites::ALL), (0..16_u32).prop_map(ColorWrites::from_bits_truncate)]
}

/// A color target of any format, blended or not.
pub fn color_target() -> impl Strategy<Value = ColorTargetState> + Clone {
    (format(), blend(), write_mask()).prop_map(|(format, blend, write_mask)| ColorTargetState {
        format: format.texture_format(),
        blend,
        write_mask,
    })
}

/// Any comparison.
pub fn compare() -> impl Strategy<Value = CompareFunction> + Clone {
    select(compare_functions().collect::<Vec<_>>())
}

/// Any stencil operation.
pub fn stencil_operation() -> impl Strategy<Value = StencilOperation> + Clone {
    select(stencil_operations().collect::<Vec<_>>())
}

/// One face's stencil test.
pub fn stencil_face() -> impl Strategy<Value = StencilFaceState> + Clone {
    (compare(), stencil_operation(), stencil_operation(), stencil_operation()).prop_map(
        |(compare, fail_op, depth_fail_op, pass_op)| StencilFaceState { compare, fail_op, depth_fail_op, pass_op },
    )
}

/// Both faces, with masks that are full, empty or anything.
pub fn stencil() -> impl Strategy<Value = StencilState> + Clone {
    let mask = || prop_oneof![Just(0xff_u32), Just(!0), Just(0), 0..256_u32];
    (stencil_face(), stencil_face(), mask(), mask()).prop_map(|(front, back, read_mask, write_mask)| StencilState {
        front,
        back,
        read_mask,
        write_mask,
    })
}

/// A depth/stencil state of any format, with members set for the aspects it has and valid for WebGPU.
pub fn depth_stencil() -> impl Strategy<Value = DepthStencilState> + Clone {
    let formats = vec![
        TextureFormat::Depth32Float,
        TextureFormat::Depth16Unorm,
        TextureFormat::Depth24Plus,
        TextureFormat::Depth24PlusStencil8,
        TextureFormat::Depth32FloatStencil8,
        TextureFormat::Stencil8,
    ];
    (select(formats), any::<bool>(), compare(), stencil()).prop_map(|(format, write, compare, stencil)| {
        let given = DepthStencilState {
            format,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil,
            bias: DepthBiasState::default(),
        };
        with_format(given, format)
    })
}

/// The state for another format: members of aspects it lacks are removed, those of aspects it gains set.
fn with_format(state: DepthStencilState, format: TextureFormat) -> DepthStencilState {
    let layout = DepthFormat::new(format).ok();
    let has_depth = layout.is_some_and(|layout| layout.depth().is_some());
    let has_stencil = layout.is_some_and(DepthFormat::has_stencil);
    DepthStencilState {
        format,
        depth_write_enabled: has_depth.then(|| state.depth_write_enabled.unwrap_or(true)),
        depth_compare: has_depth.then(|| state.depth_compare.unwrap_or(CompareFunction::Less)),
        stencil: if has_stencil { state.stencil } else { StencilState::default() },
        bias: state.bias,
    }
}

/// One or four samples, any mask, alpha to coverage now and then.
pub fn multisample() -> impl Strategy<Value = MultisampleState> + Clone {
    let mask = prop_oneof![3 => Just(!0_u64), 1 => 0..16_u64, 1 => any::<u64>()];
    (select(vec![1_u32, 4]), mask, ::proptest::bool::weighted(0.2)).prop_map(
        |(count, mask, alpha_to_coverage_enabled)| MultisampleState { count, mask, alpha_to_coverage_enabled },
    )
}

/// The fixed-function alpha test, mostly off.
pub fn alpha_test() -> impl Strategy<Value = AlphaTest> + Clone {
    prop_oneof![
        3 => Just(AlphaTest::Off),
        1 => (compare(), number::dyadic()).prop_map(|(compare, reference)| AlphaTest::On { compare, reference }),
    ]
}

/// Values set per draw, the constant from a strategy; the scissor covers part of a 4 x 4 target or is absent.
pub fn dynamic(constant: impl Strategy<Value = [f32; 4]>) -> impl Strategy<Value = DynamicState> {
    let reference = prop_oneof![4 => 0..256_u32, 1 => any::<u32>()];
    let range = prop_oneof![
        2 => Just([0.0, 1.0]),
        1 => (number::dyadic(), number::dyadic()).prop_map(|(a, b)| [a.min(b), a.max(b)]),
    ];
    let edges = (0..4_u32, 0..4_u32, 0..5_u32, 0..5_u32).prop_map(|(x, y, width, height)| Rect { x, y, width, height });
    (constant, reference, range, option::weighted(0.2, edges)).prop_map(
        |(blend_constant, stencil_reference, depth_range, scissor)| DynamicState {
            blend_constant,
            stencil_reference,
            depth_range,
            scissor,
        },
    )
}

/// Any merger state: up to three color targets or gaps between them, depth and stencil, multisampling, alpha test.
///
/// WebGPU refuses some of them (factors with min and max, a second source with several targets), but the output merger
/// has an answer for each.
pub fn any_state() -> BoxedStrategy<MergerState> {
    let targets = ::proptest::collection::vec(option::weighted(0.9, color_target()), 0..=3);
    (targets, option::of(depth_stencil()), multisample(), alpha_test(), dynamic(constant()))
        .prop_map(|(targets, depth_stencil, multisample, alpha_test, dynamic)| MergerState {
            targets,
            depth_stencil,
            multisample,
            alpha_test,
            dynamic,
        })
        .boxed()
}

/// A state that WebGPU accepts, all features given ([`crate::state::validate::validate`] passes it).
pub fn valid_state() -> BoxedStrategy<MergerState> {
    any_state().prop_map(made_valid).boxed()
}

/// A valid state for a later draw into the targets of `first`: the same formats and sample count, everything else anew.
pub fn valid_state_over(first: &MergerState) -> BoxedStrategy<MergerState> {
    let first = first.clone();
    let blends = ::proptest::collection::vec((blend(), write_mask()), first.targets.len());
    (blends, depth_stencil(), multisample(), alpha_test(), dynamic(constant()))
        .prop_map(move |(blends, tests, multisample, alpha_test, dynamic)| {
            let over = |(target, (blend, write_mask)): (&Option<ColorTargetState>, _)| {
                target.as_ref().map(|target| ColorTargetState { format: target.format, blend, write_mask })
            };
            let depth_stencil = first.depth_stencil.as_ref().map(|state| with_format(tests, state.format));
            made_valid(MergerState {
                targets: first.targets.iter().zip(blends).map(over).collect(),
                depth_stencil,
                multisample: MultisampleState { count: first.multisample.count, ..multisample },
                alpha_test,
                dynamic,
            })
        })
        .boxed()
}

/// A state with one target that blends, and nothing else: no test can interfere.
pub fn blending_state() -> BoxedStrategy<MergerState> {
    (format(), blend_state(), write_mask(), dynamic(constant()))
        .prop_map(|(format, blend, write_mask, dynamic)| MergerState {
            dynamic: DynamicState { blend_constant: dynamic.blend_constant, ..DynamicState::default() },
            ..MergerState::single(ColorTargetState { format: format.texture_format(), blend: Some(blend), write_mask })
        })
        .boxed()
}

/// A blend constant that WebGPU takes: finite, also out of range.
pub fn constant() -> impl Strategy<Value = [f32; 4]> + Clone {
    let value = prop_oneof![4 => number::dyadic(), 4 => 0.0_f32..=1.0, 1 => -2.0_f32..=3.0, 1 => number::any_bits()];
    ::proptest::array::uniform4(value.prop_map(|x| if x.is_finite() { x } else { 0.0 }))
}

/// Changes what WebGPU refuses, and nothing else.
fn made_valid(mut state: MergerState) -> MergerState {
    if state.targets.iter().all(Option::is_none) && state.depth_stencil.is_none() {
        state.targets = vec![Some(TextureFormat::Rgba8Unorm.into())];
    }
    let count = state.targets.iter().flatten().count();
    for blend in state.targets.iter_mut().flatten().filter_map(|target| target.blend.as_mut()) {
        for component in [&mut blend.color, &mut blend.alpha] {
            for factor in [&mut component.src_factor, &mut component.dst_factor] {
                if ignores_factors(component.operation) || (count > 1 && factor.ref_second_blend_source()) {
                    *factor = BlendFactor::One;
                }
            }
        }
    }
    let first = state.targets.first().and_then(Option::as_ref).and_then(|target| ColorFormat::new(target.format).ok());
    if state.multisample.count == 1 || first.is_none_or(|format| format.channels()[3] == ChannelKind::Absent) {
        state.multisample.alpha_to_coverage_enabled = false;
    }
    state
}
