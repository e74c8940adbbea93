//! Where the merger clamps, by target class. Sources: V, *Blending* (after the basic operations); D 17.5.

use outmerge::model::ColorInputs;
use wgpu_types::{BlendFactor as F, BlendOperation as Op};

use crate::texel::{add, covering, equation, exact, floats, texel, textbook_models};

#[test]
fn sources_clamp_to_unorm_range_before_factors() {
    let case = ColorInputs {
        blend: add(F::Constant, F::Zero),
        constant: [0.25; 4],
        src: [3.0, -3.0, 0.5, 1.0],
        ..texel("rgba8unorm")
    };
    assert_eq!(exact(&case), [64, 0, 32, 64], "3 x 0.25 is 0.25, not 0.75");
}

#[test]
fn second_sources_clamp_too() {
    let case = ColorInputs { blend: add(F::Src1, F::Zero), src: [0.25; 4], src1: [3.0; 4], ..texel("rgba8unorm") };
    assert_eq!(exact(&case), [64; 4], "0.25 x 1");
}

#[test]
fn constants_clamp_to_unorm_range() {
    let case = ColorInputs {
        blend: add(F::Constant, F::Zero),
        constant: [2.0, -1.0, 2.0, -1.0],
        src: [1.0; 4],
        ..texel("rgba8unorm")
    };
    assert_eq!(exact(&case), [255, 0, 255, 0], "(2, -1) acts as (1, 0)");
    let inverse = ColorInputs { blend: add(F::OneMinusConstant, F::Zero), ..case };
    assert_eq!(exact(&inverse), [0, 255, 0, 255], "1 - (2, -1) acts as (0, 1)");
}

#[test]
fn float_targets_clamp_neither_source_nor_constant() {
    let case = ColorInputs {
        blend: add(F::Constant, F::Zero),
        constant: [2.0, -1.0, 0.5, 4.0],
        src: [3.0, 3.0, -3.0, 0.5],
        ..texel("rgba32float")
    };
    assert_eq!(floats(exact(&case)), [6.0, -3.0, -1.5, 2.0], "nothing clamped");
}

#[test]
fn snorm_clamps_to_minus_one_and_one() {
    let case = ColorInputs {
        blend: add(F::Constant, F::Zero),
        constant: [5.0, -5.0, 0.5, 1.0],
        src: [-7.0, 1.0, -1.0, 7.0],
        ..texel("rgba8snorm")
    };
    let signed = exact(&case).map(|code| i32::from(code.to_le_bytes()[0].cast_signed()));
    assert_eq!(signed, [-127, -127, -64, 127], "-1 x 1, 1 x -1, -1 x 0.5 (tie to even), 1 x 1");
}

#[test]
fn snorm_factors_clamp_as_vulkan_has_it() {
    // 1 - (-1) = 2, clamped to 1 by V (D keeps 2, and would store -127 here).
    let case = ColorInputs { blend: add(F::OneMinusSrc, F::One), src: [-1.0; 4], dst: [64; 4], ..texel("rgba8snorm") };
    let signed = exact(&case).map(|code| i32::from(code.to_le_bytes()[0].cast_signed()));
    assert_eq!(signed, [64 - 127; 4], "-1 x 1 + 64/127");
}

#[test]
fn products_and_sums_are_not_clamped_before_the_result() {
    // On snorm the sum of two products of 1 and -1 comes back in range only because nothing is clamped between.
    let case = ColorInputs {
        blend: equation(F::One, F::One, Op::Subtract),
        src: [1.0; 4],
        dst: [127; 4],
        ..texel("rgba8snorm")
    };
    assert_eq!(exact(&case), [0; 4], "1 - 1");
    let negative = ColorInputs { src: [-1.0; 4], ..case };
    assert_eq!(exact(&negative), [0x81; 4], "-2 is clamped once, at the end");
}

#[test]
fn subtract_below_zero_stores_zero_on_unorm_and_the_number_elsewhere() {
    let blend = equation(F::One, F::One, Op::Subtract);
    let unorm = ColorInputs { blend, src: [0.25; 4], dst: [255; 4], ..texel("rgba8unorm") };
    for model in covering(textbook_models(), &unorm) {
        assert_eq!(model.merge_color(&unorm), [0; 4], "{}", model.name());
    }
    let float = ColorInputs { blend, src: [0.25; 4], dst: [1.0_f32.to_bits(); 4], ..texel("rgba32float") };
    assert_eq!(floats(exact(&float)), [-0.75; 4], "float keeps the sign");
}

#[test]
fn sums_above_one_saturate_on_unorm() {
    let case = ColorInputs { blend: add(F::One, F::One), src: [0.75; 4], dst: [128; 4], ..texel("rgba8unorm") };
    for model in covering(textbook_models(), &case) {
        assert_eq!(model.merge_color(&case), [255; 4], "{}", model.name());
    }
}

#[test]
fn alpha_clamps_as_a_factor_even_where_the_target_has_no_alpha() {
    let case = ColorInputs { blend: add(F::SrcAlpha, F::Zero), src: [0.5, 0.0, 0.0, 3.0], ..texel("r8unorm") };
    assert_eq!(exact(&case), [128, 0, 0, 0], "0.5 x 1 (D 17.5: missing channels clamp like the present ones)");
}
