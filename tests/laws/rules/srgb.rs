//! sRGB targets. Sources: Khronos Data Format, *sRGB transfer functions*; V, *Blending*; D 3.2.3.7-8.

use outmerge::format::srgb;
use outmerge::model::{ColorInputs, NumericModel, registry};
use wgpu_types::BlendFactor as F;

use crate::texel::{add, covering, exact, model, texel};

const SRGB: [&str; 2] = ["rgba8unorm-srgb", "bgra8unorm-srgb"];

/// The models wide enough for sRGB's linear values: eight bits between the stages lose dark codes.
fn wide_models(inputs: &ColorInputs) -> impl Iterator<Item = Box<dyn NumericModel>> {
    covering(registry::every_generation(), inputs).into_iter().filter(|model| !model.name().starts_with("fixed"))
}

#[test]
fn color_is_encoded_and_alpha_is_not() {
    for name in SRGB {
        assert_eq!(exact(&ColorInputs { src: [0.5; 4], ..texel(name) }), [188, 188, 188, 128], "{name}");
    }
}

#[test]
fn sources_are_encoded_with_blending_off() {
    for x in [0.0, 0.25, 0.5, 1.0] {
        let off = ColorInputs { src: [x; 4], ..texel("rgba8unorm-srgb") };
        let replaced = ColorInputs { blend: add(F::One, F::Zero), ..off };
        assert_eq!(exact(&off), exact(&replaced), "{x}");
    }
}

#[test]
fn the_linear_segment_ends_at_0_0031308() {
    // 12.92 x 255 codes for each unit below the joint.
    let stored = |x: f32| exact(&ColorInputs { src: [x; 4], ..texel("rgba8unorm-srgb") })[0];
    assert_eq!(stored(0.003), 10, "12.92 x 0.003 x 255 = 9.88");
    assert_eq!(stored(0.0031), 10, "10.21");
    assert_eq!(stored(0.0045), 14, "1.055 x 0.0045^(1/2.4) - 0.055 = 0.0561 is 14.3 codes");
}

#[test]
fn blending_is_in_linear_light() {
    // Half white over black is 0.5 in linear light: code 188. Blending codes would give 128.
    let case = ColorInputs {
        blend: add(F::SrcAlpha, F::OneMinusSrcAlpha),
        src: [1.0, 1.0, 1.0, 0.5],
        dst: [0, 0, 0, 255],
        ..texel("rgba8unorm-srgb")
    };
    assert_eq!(exact(&case)[..3], [188; 3], "half white over black");
    let grey = ColorInputs { src: [0.0, 0.0, 0.0, 0.5], dst: [255; 4], ..case };
    assert_eq!(exact(&grey)[..3], [188; 3], "half black over white");
}

#[test]
fn constants_are_linear_and_unconverted() {
    let case =
        ColorInputs { blend: add(F::Constant, F::Zero), constant: [0.5; 4], src: [1.0; 4], ..texel("rgba8unorm-srgb") };
    assert_eq!(exact(&case), [188, 188, 188, 128], "0.5 in linear light");
}

#[test]
fn every_code_survives_a_bare_round_trip() {
    for name in SRGB {
        let blend = add(F::Zero, F::One);
        for model in wide_models(&ColorInputs { blend, ..texel(name) }) {
            for code in 0..=255 {
                let case = ColorInputs { blend, dst: [code; 4], ..texel(name) };
                assert_eq!(model.merge_color(&case), [code; 4], "{} on {name}", model.name());
            }
        }
    }
}

#[test]
fn decoded_codes_are_stored_as_themselves() {
    for model in wide_models(&texel("rgba8unorm-srgb")) {
        for code in 0..=255 {
            let x = srgb::decode_f32(code);
            let got = model.merge_color(&ColorInputs { src: [x; 4], ..texel("rgba8unorm-srgb") });
            assert_eq!(got[..3], [code; 3], "{}", model.name());
        }
    }
}

#[test]
fn an_eight_bit_linear_intermediate_is_off_by_up_to_six_codes() {
    let fixed = model("fixed:8");
    let off = |code: u32| {
        let case = ColorInputs { blend: add(F::Zero, F::One), dst: [code; 4], ..texel("rgba8unorm-srgb") };
        fixed.merge_color(&case)[0].abs_diff(code)
    };
    let worst = (0..=255).max_by_key(|&code| off(code)).expect("256 codes");
    assert_eq!((worst, off(worst)), (7, 6), "the code that suffers most from a bare round trip");
}

#[test]
fn nan_is_stored_as_zero() {
    assert_eq!(exact(&ColorInputs { src: [f32::NAN; 4], ..texel("rgba8unorm-srgb") }), [0; 4], "D 3.2.3.8");
}
