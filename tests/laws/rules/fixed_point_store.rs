//! Float to unorm and snorm and back. Sources: V, *Fixed-Point Data Conversions*; D 3.2.3.

use outmerge::format::{ChannelKind, snorm, unorm};
use outmerge::model::{ColorInputs, NumericModel, StepKind, registry};
use wgpu_types::BlendFactor as F;

use crate::texel::{add, covering, exact, model, texel, textbook_models};

const UNORM: [&str; 3] = ["rgba8unorm", "rgb10a2unorm", "rgba16unorm"];
const SNORM: [&str; 2] = ["rgba8snorm", "rgba16snorm"];

fn stored(model: &dyn NumericModel, name: &str, x: f32) -> u32 {
    model.merge_color(&ColorInputs { src: [x; 4], ..texel(name) })[0]
}

/// Steps of channel 0.
fn steps(name: &str) -> u32 {
    match texel(name).format.channels()[0] {
        ChannelKind::Unorm(bits) => unorm::steps(bits),
        ChannelKind::Snorm(bits) => snorm::steps(bits).unsigned_abs(),
        _ => panic!("{name} is normalised"),
    }
}

#[test]
fn zero_and_one_are_stored_exactly() {
    for name in UNORM.into_iter().chain(SNORM) {
        for model in covering(registry::every_generation(), &texel(name)) {
            assert_eq!(stored(&*model, name, 0.0), 0, "{} on {name}", model.name());
            assert_eq!(stored(&*model, name, 1.0), steps(name), "{} on {name}", model.name());
        }
    }
}

#[test]
fn minus_one_is_stored_exactly_and_the_spare_code_never() {
    for (name, bits) in [("rgba8snorm", 8), ("rgba16snorm", 16)] {
        for model in covering(textbook_models(), &texel(name)) {
            for x in [-1.0, -1.5, f32::NEG_INFINITY, f32::MIN] {
                assert_eq!(snorm::signed_code(stored(&*model, name, x), bits), -snorm::steps(bits), "{x} on {name}");
            }
        }
    }
}

#[test]
fn an_integer_on_the_code_scale_has_one_answer() {
    // V: exact if y is an integer. c / 255 is not a binary fraction; the nearest binary32 number must give c.
    for model in covering(registry::every_generation(), &texel("rgba8unorm")) {
        for code in 0..=255_u8 {
            let x = f32::from(code) / 255.0;
            assert_eq!(stored(&*model, "rgba8unorm", x), u32::from(code), "{}", model.name());
        }
    }
}

#[test]
fn stored_codes_are_one_of_the_two_neighbours() {
    // V: floor or ceiling, for every model and a spread of numbers in [0, 1].
    for model in covering(registry::every_generation(), &texel("rgba8unorm")) {
        for i in 0..=100_000_u32 {
            let x = i as f32 / 100_000.0;
            let y = f64::from(x) * 255.0;
            let code = f64::from(stored(&*model, "rgba8unorm", x));
            assert!((y - code).abs() < 1.0, "{}: {x} stored as {code}", model.name());
        }
    }
}

#[test]
fn nearest_code_and_ties_to_even() {
    // 0.5 x 255 = 127.5 is a tie; so is 0.5 x 1023 = 511.5, on the odd side.
    assert_eq!(stored(&*model("exact"), "rgba8unorm", 0.5), 128, "127.5");
    assert_eq!(stored(&*model("exact"), "rgb10a2unorm", 0.5), 512, "511.5");
    assert_eq!(stored(&*model("exact"), "rgba8unorm", 0.5_f32.next_down()), 127, "just below the tie");
    assert_eq!(stored(&*model("exact:ties-away"), "rgba8unorm", 0.5), 128, "D adds 0.5 and truncates");
}

#[test]
fn nan_is_stored_as_zero() {
    for name in UNORM.into_iter().chain(SNORM) {
        for model in covering(textbook_models(), &texel(name)) {
            assert_eq!(stored(&*model, name, f32::NAN), 0, "{} on {name} (D 3.2.3)", model.name());
        }
    }
}

#[test]
fn infinities_clamp() {
    for name in UNORM {
        for model in covering(registry::every_generation(), &texel(name)) {
            assert_eq!(stored(&*model, name, f32::INFINITY), steps(name), "{} on {name}", model.name());
            assert_eq!(stored(&*model, name, f32::NEG_INFINITY), 0, "{} on {name}", model.name());
        }
    }
}

#[test]
fn stored_codes_never_decrease_and_reach_every_code() {
    // D 19.1.2.
    for model in covering(registry::every_generation(), &texel("rgba8unorm")) {
        let codes: Vec<u32> = (0..=65_536_u32).map(|i| stored(&*model, "rgba8unorm", i as f32 / 65_536.0)).collect();
        assert!(codes.is_sorted(), "{}: nondecreasing", model.name());
        let mut reached = codes;
        reached.dedup();
        assert_eq!(reached, (0..=255).collect::<Vec<_>>(), "{}: every code", model.name());
    }
}

#[test]
fn unorm_codes_read_as_code_over_steps() {
    for name in UNORM {
        for code in [0, 1, 2, steps(name) / 2, steps(name) - 1, steps(name)] {
            let case = ColorInputs { blend: add(F::Zero, F::One), dst: [code, 0, 0, 0], ..texel(name) };
            let explanation = model("exact").explain_color(&case);
            let read = explanation.value(StepKind::Destination, 0).expect("the destination is read");
            let expected = f64::from(code) / f64::from(steps(name));
            assert_eq!(read.decimal, expected, "{name} code {code}");
        }
    }
}

#[test]
fn snorm_s_spare_code_reads_as_minus_one() {
    let case = ColorInputs { blend: add(F::Zero, F::One), dst: [0x80; 4], ..texel("rgba8snorm") };
    assert_eq!(exact(&case), [0x81; 4], "-128 reads as -1, which is stored as -127");
}

#[test]
fn reading_and_writing_a_code_keeps_it() {
    // D 19.1.2: with blending off, and with a source factor of one and a destination factor of zero.
    for name in ["rgba8unorm", "rgba8snorm"] {
        for blend in [None, add(F::One, F::Zero)] {
            let case = ColorInputs { blend, ..texel(name) };
            for model in covering(registry::every_generation(), &case) {
                for code in 0..=255_u32 {
                    let x = match case.format.channels()[0] {
                        ChannelKind::Snorm(8) if code == 0x80 => continue,
                        ChannelKind::Snorm(bits) => snorm::signed_code(code, bits) as f32 / 127.0,
                        _ => code as f32 / 255.0,
                    };
                    let got = model.merge_color(&ColorInputs { src: [x; 4], ..case })[0];
                    assert_eq!(got, code, "{} on {name}, {blend:?}", model.name());
                }
            }
        }
    }
}
