//! binary32 to half and to 11- and 10-bit floats. Sources: V, *16-bit, 11-bit, 10-bit Floating-Point Numbers*; D 3.2.2.

use outmerge::format::{ChannelKind, FloatLayout};
use outmerge::model::ColorInputs;

use crate::texel::{covering, exact, model, texel, textbook_models};

const HALF: FloatLayout = FloatLayout::HALF;

fn half(x: f32) -> u32 {
    exact(&ColorInputs { src: [x; 4], ..texel("rgba16float") })[0]
}

fn eleven(x: f32) -> u32 {
    exact(&ColorInputs { src: [x; 4], ..texel("rg11b10ufloat") })[0]
}

#[test]
fn the_nearest_neighbour_and_ties_to_even() {
    assert_eq!(half(1.0 + 2.0_f32.powi(-11)), 0x3c00, "tie between 1 and the next: even");
    assert_eq!(half(1.0 + 3.0 * 2.0_f32.powi(-11)), 0x3c02, "tie above an odd code: up");
    assert_eq!(half(1.0 + 2.0_f32.powi(-11) + 2.0_f32.powi(-20)), 0x3c01, "just above the tie");
}

#[test]
fn overflow_rounds_to_infinity_to_nearest_and_to_the_largest_toward_zero() {
    assert_eq!(half(65504.0), HALF.max_finite(), "the largest");
    assert_eq!(half(65519.996), HALF.max_finite(), "below the middle");
    assert_eq!(half(65520.0), HALF.infinity(), "from the middle on (V admits both)");
    // D's conversion never makes Inf from a finite number.
    let toward_zero =
        |x: f32| model("exact:toward-zero").merge_color(&ColorInputs { src: [x; 4], ..texel("rgba16float") });
    assert_eq!(toward_zero(1e30), [HALF.max_finite(); 4], "D 3.2.2");
    assert_eq!(toward_zero(1.0_f32.next_up()), [0x3c00; 4], "truncated");
    assert_eq!(toward_zero(f32::INFINITY), [HALF.infinity(); 4], "Inf stays Inf");
}

#[test]
fn infinities_stay() {
    for model in covering(textbook_models(), &texel("rgba16float")) {
        let stored = |x: f32| model.merge_color(&ColorInputs { src: [x; 4], ..texel("rgba16float") })[0];
        assert_eq!(stored(f32::INFINITY), HALF.infinity(), "{}", model.name());
        assert_eq!(stored(f32::NEG_INFINITY), HALF.sign() | HALF.infinity(), "{}", model.name());
    }
}

#[test]
fn nan_stays_nan() {
    // Drivers may do otherwise: SwiftShader stores NaN as 0 in 11- and 10-bit floats.
    for name in ["rgba16float", "rg11b10ufloat", "rgba32float"] {
        for model in covering(textbook_models(), &texel(name)) {
            let codes = model.merge_color(&ColorInputs { src: [f32::NAN; 4], ..texel(name) });
            for (code, kind) in codes.into_iter().zip(texel(name).format.channels()) {
                let ChannelKind::Float(layout) = kind else { continue };
                assert!(layout.is_nan(code), "{} on {name}: {code:#x}", model.name());
            }
        }
    }
}

#[test]
fn negatives_are_zero_on_unsigned_floats() {
    for x in [-1.0, f32::NEG_INFINITY, -0.0, f32::MIN] {
        assert_eq!(eleven(x), 0, "{x}");
    }
}

#[test]
fn denormals_of_the_target_are_kept() {
    assert_eq!(half(2.0_f32.powi(-24)), 1, "the smallest half");
    assert_eq!(half(2.0_f32.powi(-25)), 0, "a tie with zero: even");
    assert_eq!(half(3.0 * 2.0_f32.powi(-25)), 2, "a tie between 1 and 2: even");
    assert_eq!(eleven(2.0_f32.powi(-20)), 1, "the smallest 11-bit float");
}

#[test]
fn signed_zero_keeps_its_sign_with_blending_off() {
    assert_eq!(half(-0.0), HALF.sign(), "-0");
}

#[test]
fn float32_targets_take_bits_unchanged_with_blending_off() {
    // D 3.1.3.2: no denormal flush on pure moves.
    for x in [1.0e-45, -1.0e-40, f32::MAX, -0.0, f32::NEG_INFINITY] {
        for name in ["exact", "f32"] {
            let codes = model(name).merge_color(&ColorInputs { src: [x; 4], ..texel("rgba32float") });
            assert_eq!(codes, [x.to_bits(); 4], "{name}: {x:e}");
        }
    }
}
