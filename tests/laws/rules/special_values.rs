//! NaN, infinities and signed zeros inside the blender of float targets. Sources: D 3.1.3 and 17.5; V leaves Inf and NaN
//! optional.

use outmerge::model::ColorInputs;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState};

use crate::texel::{add, bits, equation, floats, model, texel};

const NAN: f32 = f32::NAN;
const INF: f32 = f32::INFINITY;

/// Channel 0 of a 32-bit float target in the models with IEEE rules.
fn ieee(blend: Option<BlendState>, s: f32, d: f32) -> [f32; 2] {
    let case = ColorInputs { blend, src: [s; 4], dst: bits([d; 4]), ..texel("rgba32float") };
    ["exact", "f32"].map(|name| floats(model(name).merge_color(&case))[0])
}

fn all_nan(blend: Option<BlendState>, s: f32, d: f32) -> bool {
    ieee(blend, s, d).into_iter().all(f32::is_nan)
}

#[test]
fn zero_times_infinity_and_nan_is_nan_zero_factors_included() {
    for special in [NAN, INF, -INF] {
        assert!(all_nan(add(F::Zero, F::One), special, 1.0), "source {special} with factor zero");
        assert!(all_nan(add(F::One, F::Zero), 1.0, special), "destination {special} with factor zero");
    }
}

#[test]
fn one_zero_differs_from_blending_off_where_the_destination_is_not_finite() {
    assert_eq!(ieee(None, 0.5, NAN), [0.5; 2], "off: the destination is not read");
    assert!(all_nan(add(F::One, F::Zero), 0.5, NAN), "one, zero: NaN x 0 shows");
}

#[test]
fn infinity_minus_infinity_is_nan() {
    assert!(all_nan(equation(F::One, F::One, Op::Subtract), INF, INF), "Inf - Inf");
    assert!(all_nan(add(F::One, F::One), INF, -INF), "Inf + -Inf");
    assert_eq!(ieee(add(F::One, F::One), INF, 1.0), [INF; 2], "Inf + 1");
}

#[test]
fn min_and_max_take_the_number_rather_than_nan() {
    for op in [Op::Min, Op::Max] {
        assert_eq!(ieee(equation(F::One, F::One, op), NAN, 0.5), [0.5; 2], "{op:?}");
        assert_eq!(ieee(equation(F::One, F::One, op), 0.5, NAN), [0.5; 2], "{op:?}");
    }
}

#[test]
fn minus_zero_plus_zero_is_zero() {
    let zero = [0.0_f32.to_bits(); 2];
    assert_eq!(ieee(add(F::One, F::Zero), -0.0, 1.0).map(f32::to_bits), zero, "-0 + 1 x 0");
    assert_eq!(ieee(add(F::Zero, F::One), 1.0, -0.0).map(f32::to_bits), zero, "1 x 0 + -0");
    let minus = [(-0.0_f32).to_bits(); 2];
    assert_eq!(ieee(add(F::One, F::One), -0.0, -0.0).map(f32::to_bits), minus, "-0 + -0 keeps the sign");
}

#[test]
fn half_denormals_are_preserved_inside_the_blender() {
    let case = ColorInputs { blend: add(F::Zero, F::One), dst: [1, 0x3ff, 1, 1], ..texel("rgba16float") };
    for name in ["exact", "f32", "f16"] {
        assert_eq!(model(name).merge_color(&case), case.dst, "{name}");
    }
}

#[test]
fn specials_from_the_shader_never_reach_a_unorm_target() {
    let blend = add(F::SrcAlpha, F::OneMinusSrcAlpha);
    for special in [NAN, INF, -INF] {
        let case = ColorInputs { blend, src: [special, special, special, 0.5], dst: [100; 4], ..texel("rgba8unorm") };
        let clamped = if special == INF { 1.0 } else { 0.0 };
        let plain = ColorInputs { src: [clamped, clamped, clamped, 0.5], ..case };
        for name in ["exact", "f32", "f16", "fixed:8"] {
            assert_eq!(model(name).merge_color(&case), model(name).merge_color(&plain), "{name}: {special}");
        }
    }
}
