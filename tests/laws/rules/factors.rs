//! Factors and operations. Sources: V, *Blend Factors* and *Blend Operations*; D 17.1; W, *Blend State*.

use outmerge::model::{ColorInputs, registry};
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState};

use crate::texel::{add, bits, covering, equation, exact, floats, texel};

const S: [f32; 4] = [0.5, 0.25, 0.75, 0.125];
const S1: [f32; 4] = [0.375, 0.625, 0.875, 0.0625];
const K: [f32; 4] = [0.75, 0.25, 0.5, 0.375];
const D: [f32; 4] = [0.125, 0.5, 0.25, 0.75];

/// Every factor with its value for the numbers above: few bits, so that every model computes with them exactly.
const FACTORS: [(F, [f32; 4]); 17] = [
    (F::Zero, [0.0; 4]),
    (F::One, [1.0; 4]),
    (F::Src, [0.5, 0.25, 0.75, 0.125]),
    (F::OneMinusSrc, [0.5, 0.75, 0.25, 0.875]),
    (F::SrcAlpha, [0.125; 4]),
    (F::OneMinusSrcAlpha, [0.875; 4]),
    (F::Dst, [0.125, 0.5, 0.25, 0.75]),
    (F::OneMinusDst, [0.875, 0.5, 0.75, 0.25]),
    (F::DstAlpha, [0.75; 4]),
    (F::OneMinusDstAlpha, [0.25; 4]),
    (F::SrcAlphaSaturated, [0.125, 0.125, 0.125, 1.0]),
    (F::Constant, [0.75, 0.25, 0.5, 0.375]),
    (F::OneMinusConstant, [0.25, 0.75, 0.5, 0.625]),
    (F::Src1, [0.375, 0.625, 0.875, 0.0625]),
    (F::OneMinusSrc1, [0.625, 0.375, 0.125, 0.9375]),
    (F::Src1Alpha, [0.0625; 4]),
    (F::OneMinusSrc1Alpha, [0.9375; 4]),
];

fn inputs(blend: Option<BlendState>) -> ColorInputs {
    ColorInputs { blend, constant: K, src: S, src1: S1, dst: bits(D), ..texel("rgba32float") }
}

fn products(x: [f32; 4], factor: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| x[i] * factor[i])
}

/// What every model that covers the state stores.
fn in_every_model(inputs: &ColorInputs, expected: [f32; 4]) {
    let models = covering(registry::every_generation(), inputs);
    assert!(models.len() >= 2, "exact and f32 cover every state of float targets");
    for model in models {
        assert_eq!(floats(model.merge_color(inputs)), expected, "{} with {:?}", model.name(), inputs.blend);
    }
}

#[test]
fn every_factor_has_its_value_as_source_factor() {
    for (factor, value) in FACTORS {
        in_every_model(&inputs(add(factor, F::Zero)), products(S, value));
    }
}

#[test]
fn any_factor_may_stand_on_the_destination_side_saturate_included() {
    for (factor, value) in FACTORS {
        in_every_model(&inputs(add(F::Zero, factor)), products(D, value));
    }
}

#[test]
fn src_alpha_saturated_is_the_smaller_of_src_alpha_and_room_left() {
    let mut case = inputs(add(F::SrcAlphaSaturated, F::Zero));
    case.src[3] = 0.875;
    in_every_model(&case, [0.125, 0.0625, 0.1875, 0.875]);
}

#[test]
fn a_color_factor_in_the_alpha_slot_means_alpha() {
    for (factor, value) in FACTORS {
        let mut blend = add(F::Zero, F::Zero).expect("a state");
        blend.alpha.src_factor = factor;
        in_every_model(&inputs(Some(blend)), [0.0, 0.0, 0.0, S[3] * value[3]]);
    }
}

#[test]
fn color_and_alpha_have_their_own_factors_and_operations() {
    let mut blend = equation(F::One, F::One, Op::Add).expect("a state");
    blend.alpha.operation = Op::ReverseSubtract;
    blend.alpha.dst_factor = F::DstAlpha;
    in_every_model(&inputs(Some(blend)), [0.625, 0.75, 1.0, 0.5625 - 0.125]);
}

#[test]
fn add_subtract_and_reverse_subtract() {
    let (fs, fd) = ([0.125; 4], [0.75; 4]);
    let (s, d) = (products(S, fs), products(D, fd));
    let expected = |op: fn(f32, f32) -> f32| std::array::from_fn(|i| op(s[i], d[i]));
    in_every_model(&inputs(equation(F::SrcAlpha, F::DstAlpha, Op::Add)), expected(|s, d| s + d));
    in_every_model(&inputs(equation(F::SrcAlpha, F::DstAlpha, Op::Subtract)), expected(|s, d| s - d));
    in_every_model(&inputs(equation(F::SrcAlpha, F::DstAlpha, Op::ReverseSubtract)), expected(|s, d| d - s));
}

#[test]
fn min_and_max_ignore_factors() {
    for (factor, _) in FACTORS {
        for (other, _) in FACTORS {
            in_every_model(&inputs(equation(factor, other, Op::Min)), [0.125, 0.25, 0.25, 0.125]);
            in_every_model(&inputs(equation(factor, other, Op::Max)), [0.5, 0.5, 0.75, 0.75]);
        }
    }
}

#[test]
fn min_and_max_still_clamp_and_convert() {
    let case = |name: &str, op| ColorInputs { blend: equation(F::One, F::One, op), src: [7.0; 4], ..texel(name) };
    assert_eq!(exact(&case("rgba8unorm", Op::Max)), [255; 4], "clamped to 1 before the comparison");
    let linear_half = ColorInputs { src: [0.5; 4], ..case("rgba8unorm-srgb", Op::Max) };
    assert_eq!(exact(&linear_half), [188, 188, 188, 128], "compared in linear light, encoded at the store");
}

#[test]
fn destination_factors_read_the_value_before_the_fragment() {
    // s = 1 and d = 0.5 under `one-minus-dst, one`: 1 * (1 - 0.5) + 0.5, not a factor from the sum.
    let case = ColorInputs { src: [1.0; 4], dst: bits([0.5; 4]), ..inputs(add(F::OneMinusDst, F::One)) };
    in_every_model(&case, [1.0; 4]);
}

#[test]
fn srgb_destinations_are_linear_in_factors() {
    let code = 188;
    let case = ColorInputs {
        blend: add(F::Dst, F::Zero),
        src: [1.0; 4],
        dst: [code, code, code, 128],
        ..texel("rgba8unorm-srgb")
    };
    assert_eq!(exact(&case), [188, 188, 188, 128], "white times the destination is the destination");
}
