//! Destination channels a format lacks read as (0, 0, 0, 1). Sources: V, *Component Substitution*; D 19.1.3.3.

use outmerge::model::{ColorInputs, registry};
use wgpu_types::BlendFactor as F;

use crate::texel::{add, covering, exact, texel};

/// Color formats without an alpha channel.
const NO_ALPHA: [&str; 8] =
    ["r8unorm", "rg8unorm", "r16unorm", "rg16unorm", "r16float", "rg16float", "rg11b10ufloat", "rg32float"];

/// The code of 0.5 in channel 0, as blending off stores it.
fn half(name: &str) -> u32 {
    exact(&ColorInputs { src: [0.5; 4], ..texel(name) })[0]
}

#[test]
fn destination_alpha_is_one() {
    for name in NO_ALPHA {
        let case = ColorInputs { blend: add(F::DstAlpha, F::Zero), src: [0.5; 4], ..texel(name) };
        for model in covering(registry::every_generation(), &case) {
            let off = model.merge_color(&ColorInputs { blend: None, ..case });
            assert_eq!(model.merge_color(&case)[0], off[0], "{} on {name}: 0.5 x 1", model.name());
        }
    }
}

#[test]
fn one_minus_destination_alpha_is_zero() {
    for name in NO_ALPHA {
        let case = ColorInputs { blend: add(F::OneMinusDstAlpha, F::Zero), src: [0.5; 4], ..texel(name) };
        for model in covering(registry::every_generation(), &case) {
            assert_eq!(model.merge_color(&case)[0], 0, "{} on {name}: 0.5 x 0", model.name());
        }
    }
}

#[test]
fn src_alpha_saturated_has_no_room_left() {
    for name in NO_ALPHA {
        let case = ColorInputs {
            blend: add(F::SrcAlphaSaturated, F::One),
            src: [1.0; 4],
            dst: [half(name), 0, 0, 0],
            ..texel(name)
        };
        assert_eq!(exact(&case)[0], half(name), "{name}: f = min(s.a, 1 - 1) = 0 adds nothing");
    }
}

#[test]
fn codes_of_missing_channels_stay_zero() {
    for name in NO_ALPHA {
        let codes = exact(&ColorInputs { src: [1.0; 4], ..texel(name) });
        assert_eq!(codes[3], 0, "{name}: nothing is stored for alpha");
    }
}
