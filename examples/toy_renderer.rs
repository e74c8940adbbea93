//! A property test of a toy renderer: its integer blender must agree with the model on every input, and a blender with
//! the popular `>> 8` instead of a division by 255 is caught with its smallest counter-example.
//!
//!     cargo run --features proptest --example toy_renderer

use outmerge::format::ColorFormat;
use outmerge::model::exact::Exact;
use outmerge::model::{ColorInputs, NumericModel};
use outmerge::state::preset;
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};

/// One channel of `SrcAlpha OneMinusSrcAlpha` in codes of 8 bits: source, its alpha, destination.
type Blender = fn(u32, u32, u32) -> u32;

fn divided(s: u32, alpha: u32, d: u32) -> u32 {
    (s * alpha + d * (255 - alpha) + 127) / 255
}

fn shifted(s: u32, alpha: u32, d: u32) -> u32 {
    (s * alpha + d * (255 - alpha)) >> 8
}

/// What the output merger writes into a channel of an rgba8unorm target.
fn model(s: u8, alpha: u8, d: u32) -> u32 {
    let unit = |code: u8| f32::from(code) / 255.0;
    let inputs = ColorInputs {
        format: ColorFormat::from_name("rgba8unorm").expect("a format"),
        blend: preset::by_name("fade").expect("a preset").blend,
        constant: [0.0; 4],
        src: [unit(s), 0.0, 0.0, unit(alpha)],
        src1: [0.0; 4],
        dst: [d, 0, 0, 0],
    };
    Exact::default().merge_color(&inputs)[0]
}

/// Runs the property; the smallest input that breaks it, if any.
fn test(blender: Blender) -> Option<(u8, u8, u8)> {
    let mut runner = TestRunner::new(ProptestConfig { cases: 20_000, failure_persistence: None, ..Default::default() });
    let outcome = runner.run(&any::<(u8, u8, u8)>(), |(s, alpha, d)| {
        let got = blender(s.into(), alpha.into(), d.into());
        prop_assert_eq!(got, model(s, alpha, d.into()));
        Ok(())
    });
    match outcome {
        Ok(()) => None,
        Err(TestError::Fail(_, input)) => Some(input),
        Err(error) => panic!("{error}"),
    }
}

fn main() {
    assert_eq!(test(divided), None, "dividing by 255 with rounding is what the model writes");
    println!("(s a + d (255 - a) + 127) / 255: agrees with the model");
    let (s, alpha, d) = test(shifted).expect("255 / 256 is not 1");
    let (got, expected) = (shifted(s.into(), alpha.into(), d.into()), model(s, alpha, d.into()));
    println!("(s a + d (255 - a)) >> 8: source {s}, alpha {alpha} over {d} gives {got}, the model writes {expected}");
    assert_ne!(got, expected, "a counter-example");
}
