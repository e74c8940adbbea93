//! Borders, brute force, and the models inside the sets they claim.

use num_rational::Ratio;
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState, ColorWrites};

use super::*;
use crate::format::{ChannelKind, ColorFormat};
use crate::model::ColorInputs;

fn inputs(format: &str, blend: Option<BlendState>, src: [f32; 4], dst: [u32; 4]) -> ColorInputs {
    let format = ColorFormat::from_name(format).expect("known");
    ColorInputs { format, blend, constant: [0.0; 4], src, src1: [0.0; 4], dst }
}

fn codes(spec: Spec, class: Class, inputs: &ColorInputs) -> Vec<u32> {
    Judge::new(spec).sets(inputs, class)[0].codes(inputs.format.channels()[0], 16)
}

/// A shader output that scales to y codes of 255.
fn scaled(y: f64) -> [f32; 4] {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let x = (y / 255.0) as f32;
    [x; 4]
}

#[test]
fn d3d_admits_two_codes_only_from_0_4_to_0_6() {
    let set = |y| codes(Spec::D3d, Class::Wide, &inputs("rgba8unorm", None, scaled(y), [0; 4]));
    assert_eq!(set(100.399), [100], "below the border");
    assert_eq!(set(100.401), [100, 101], "above it");
    assert_eq!(set(100.599), [100, 101], "below the other");
    assert_eq!(set(100.601), [101], "above it");
}

#[test]
fn vulkan_admits_floor_and_ceil() {
    let set = |y| codes(Spec::Vulkan, Class::Wide, &inputs("rgba8unorm", None, scaled(y), [0; 4]));
    assert_eq!(set(100.001), [100, 101], "just above a code");
    assert_eq!(set(100.999), [100, 101], "just below the next");
    assert_eq!((set(0.0), set(255.0), set(300.0)), (vec![0], vec![255], vec![255]), "integers are exact");
    assert_eq!(set(f64::NAN).len(), 0, "no list: anything");
}

#[test]
fn exact_is_the_nearest_code_and_both_at_a_tie() {
    let set = |x| codes(Spec::Vulkan, Class::Exact, &inputs("rgba8unorm", None, [x; 4], [0; 4]));
    assert_eq!(set(0.5), [127, 128], "127.5");
    assert_eq!(set(0.5_f32.next_up()), [128], "just above");
}

#[test]
fn one_code_beyond_is_flagged_and_an_admitted_neighbour_is_not() {
    let over = Some(BlendState::ALPHA_BLENDING);
    let texel = inputs("rgba8unorm", over, [0.7, 0.7, 0.7, 0.3], [40; 4]);
    for spec in Spec::ALL {
        let judge = Judge::new(spec);
        for class in [Class::Exact, Class::Tight, Class::Wide] {
            let sets = judge.sets(&texel, class);
            let all = sets[0].codes(ChannelKind::Unorm(8), 99);
            let (first, last) = (all[0], all[all.len() - 1]);
            let others = |i: usize| sets[i].codes(ChannelKind::Unorm(8), 1)[0];
            let verdict = |red| judge.judge(&texel, ColorWrites::ALL, [red, others(1), others(2), others(3)]).verdict;
            for code in [first, last] {
                assert!(
                    matches!(verdict(code), Verdict::Within(c) if c <= class),
                    "{spec} {class:?}: {code} of {all:?}"
                );
            }
            for code in [first - 1, last + 1] {
                let beyond = verdict(code);
                let flagged = beyond == Verdict::Outside || matches!(beyond, Verdict::Within(c) if c > class);
                assert!(flagged, "{spec} {class:?}: {code} is not one of {all:?}, yet {beyond:?}");
                assert!(class < Class::Wide || beyond == Verdict::Outside, "{spec}: {code} is outside");
            }
        }
    }
}

#[test]
fn identities_are_exact_in_every_class() {
    let component = |src_factor, dst_factor| BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add };
    for format in ["rgba8unorm", "rgba8unorm-srgb", "rgba8snorm", "rgb10a2unorm", "rgba16unorm"] {
        for code in [0_u32, 1, 2, 3] {
            let keep = component(BlendFactor::Zero, BlendFactor::One);
            let texel = inputs(format, Some(BlendState { color: keep, alpha: keep }), [0.3; 4], [code; 4]);
            for spec in Spec::ALL {
                assert_eq!(codes(spec, Class::Wide, &texel), [code], "{format}, {spec}: zero one keeps codes");
            }
        }
    }
}

#[test]
fn signed_factors_are_clamped_in_vulkan_only() {
    // S = -1 times 1 - S: -1 in Vulkan, -2 in D3D; with D = 1 added the results differ.
    let color = BlendComponent {
        src_factor: BlendFactor::OneMinusSrc,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    };
    let texel = inputs("rgba8snorm", Some(BlendState { color, alpha: color }), [-1.0; 4], [127; 4]);
    assert_eq!(codes(Spec::Vulkan, Class::Tight, &texel), [0], "-1 + 1");
    assert_eq!(codes(Spec::D3d, Class::Tight, &texel), [0x81], "-2 + 1");
    assert_eq!(codes(Spec::WebGpu, Class::Tight, &texel), [0x81, 0], "either");
}

#[test]
fn half_overflow_and_rounding_follow_each_text() {
    let set = |spec, x| codes(spec, Class::Wide, &inputs("r16float", None, [x; 4], [0; 4]));
    assert_eq!(set(Spec::D3d, 1e6), [0x7bff], "the largest number, never Inf");
    assert_eq!(set(Spec::Vulkan, 1e6), [0x7bff, 0x7c00], "or Inf");
    assert_eq!(set(Spec::D3d, 1.000_9), [0x3c00], "cut");
    assert_eq!(set(Spec::Vulkan, 1.000_9), [0x3c00, 0x3c01], "either neighbour");
    assert_eq!(set(Spec::D3d, f32::NAN), [0x7e00], "NaN stays NaN");
    assert_eq!(set(Spec::D3d, -0.0), [0x8000], "the sign stays");
    assert_eq!(set(Spec::Vulkan, -0.0), [0x8000, 0], "not named");
}

#[test]
fn a_half_target_may_saturate_its_source() {
    // 1e6 * 0.01: a wide blender, a clamped source, or Inf.
    let color = BlendComponent {
        src_factor: BlendFactor::Constant,
        dst_factor: BlendFactor::Zero,
        operation: BlendOperation::Add,
    };
    let mut texel = inputs("r16float", Some(BlendState { color, alpha: color }), [1e6; 4], [0; 4]);
    texel.constant = [0.01; 4];
    let red = |spec| Judge::new(spec).sets(&texel, Class::Wide)[0].clone();
    let kind = texel.format.channels()[0];
    let (wide, saturated, infinite) = (0x70e2, 0x611e, 0x7c00);
    for (code, d3d) in [(wide, true), (saturated, true), (infinite, false)] {
        assert!(red(Spec::Vulkan).contains(kind, code), "Vulkan: {code:#x} of {:x?}", red(Spec::Vulkan));
        assert_eq!(red(Spec::D3d).contains(kind, code), d3d, "D3D: {code:#x} of {:x?}", red(Spec::D3d));
    }
    assert!(!red(Spec::Vulkan).contains(kind, 0x6800), "nothing between");
}

#[test]
fn zero_times_nan_is_nan_in_d3d_and_undefined_in_vulkan() {
    let color =
        BlendComponent { src_factor: BlendFactor::One, dst_factor: BlendFactor::Zero, operation: BlendOperation::Add };
    let texel = inputs("r16float", Some(BlendState { color, alpha: color }), [1.0; 4], [0x7e00, 0, 0, 0]);
    assert_eq!(codes(Spec::D3d, Class::Wide, &texel), [0x7e00], "NaN");
    let verdict = |judge: Judge, got| judge.judge(&texel, ColorWrites::ALL, [got, 0, 0, 0]).verdict;
    assert_eq!(verdict(Judge::new(Spec::Vulkan), 0x3c00), Verdict::Undefined, "support is optional");
    let policy = Policy { vulkan_specials: true, ..Policy::default() };
    assert_eq!(verdict(Judge { spec: Spec::Vulkan, policy }, 0x3c00), Verdict::Outside, "1 where NaN is supported");
}

#[test]
fn masked_channels_keep_their_bits() {
    let texel = inputs("rgba8snorm", None, [0.5; 4], [0x80, 1, 2, 3]);
    let judge = Judge::new(Spec::WebGpu);
    let verdict = |got| judge.judge(&texel, ColorWrites::empty(), got).verdict;
    assert_eq!(verdict([0x80, 1, 2, 3]), Verdict::Within(Class::Exact), "the spare code too");
    assert_eq!(verdict([0x81, 1, 2, 3]), Verdict::Outside, "the same value in other bits");
}

#[test]
fn an_8_bit_linear_srgb_blender_is_outside() {
    // Code 7 through 8 linear bits comes out as 13 or 0.
    let keep = BlendComponent {
        src_factor: BlendFactor::Zero,
        dst_factor: BlendFactor::SrcAlpha,
        operation: BlendOperation::Add,
    };
    let texel = inputs("rgba8unorm-srgb", Some(BlendState { color: keep, alpha: keep }), [0.999; 4], [7; 4]);
    let set = codes(Spec::Vulkan, Class::Wide, &texel);
    assert!(set.contains(&7) && !set.contains(&13) && !set.contains(&0), "{set:?}");
}

type Number = Ratio<i128>;

/// Every code between the smallest and the largest result of one term: quantised or not, rounded either way or not.
fn spread(x: Number, round: fn(Number) -> Vec<Number>) -> Vec<Number> {
    let mut all = round(x * 255).into_iter().map(|code| code / 255).collect::<Vec<_>>();
    all.push(x);
    all
}

fn either_neighbour(y: Number) -> Vec<Number> {
    vec![y.floor(), y.ceil()]
}

fn within_0_6(y: Number) -> Vec<Number> {
    let tolerance = Number::new(6, 10);
    [y.floor(), y.ceil()].into_iter().filter(|code| (*code - y) <= tolerance && (y - *code) <= tolerance).collect()
}

/// All results of source alpha over destination on an 8-bit channel, by trying every permitted rounding.
fn enumerate_over(s: Number, a: Number, d: Number, round: fn(Number) -> Vec<Number>) -> Vec<u32> {
    let one = Number::from_integer(1);
    let mut found = std::collections::BTreeSet::new();
    for s in spread(s, round) {
        for a in spread(a, round) {
            for source in spread(s * a, round) {
                for destination in spread(d * (one - a), round) {
                    for code in round((source + destination).min(one) * 255) {
                        found.insert(u32::try_from(code.to_integer()).expect("a code"));
                    }
                }
            }
        }
    }
    found.into_iter().collect()
}

#[test]
fn wide_sets_of_over_are_those_of_brute_force() {
    type Case = (Spec, fn(Number) -> Vec<Number>);
    let cases: [Case; 2] = [(Spec::Vulkan, either_neighbour), (Spec::D3d, within_0_6)];
    for (spec, round) in cases {
        for s in (0..=16_u8).step_by(3) {
            for a in 0..=16_u8 {
                for d in (0..=255_u32).step_by(17).chain([1, 254]) {
                    let sixteenth = |x: u8| (f32::from(x) / 16.0, Number::new(x.into(), 16));
                    let ((s, exact_s), (a, exact_a)) = (sixteenth(s), sixteenth(a));
                    let expected = enumerate_over(exact_s, exact_a, Number::new(d.into(), 255), round);
                    let texel = inputs("rgba8unorm", Some(BlendState::ALPHA_BLENDING), [s, s, s, a], [d; 4]);
                    let set = codes(spec, Class::Wide, &texel);
                    assert_eq!(set, expected, "{spec}: source {s}, alpha {a}, stored {d}");
                }
            }
        }
    }
}

#[cfg(feature = "proptest")]
mod models {
    use super::*;
    use crate::format::{FloatLayout, TargetClass};
    use crate::model::registry;
    use crate::proptest::{state, target};
    use ::proptest::prelude::*;
    use ::proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

    /// The class a model claims; `None` where it claims nothing.
    fn claim(model: &str, spec: Spec, format: ColorFormat) -> Option<Class> {
        let kinds = format.channels();
        let float = format.class() == TargetClass::Float;
        let linear8 = kinds.iter().all(|kind| matches!(kind, ChannelKind::Unorm(8) | ChannelKind::Absent));
        let small = kinds.iter().all(|kind| kind.bits() <= 8 && *kind != ChannelKind::Srgb);
        let srgb = kinds.contains(&ChannelKind::Srgb);
        let driver = model.split(':').next().unwrap_or(model);
        let model = if driver == "llvmpipe" { driver } else { model };
        match (model, spec) {
            // The driver's polynomials for the curve are coarser than one part in 10^5: differences of near numbers show it.
            ("llvmpipe", _) if srgb => None,
            // It stores values below -1 as the spare code.
            ("llvmpipe", _) if kinds.contains(&ChannelKind::Snorm(8)) => None,
            // Its 16-bit lerps of one channel keep neither 1 x nor 0 x, and older ones round down.
            ("llvmpipe", _) if kinds[0] == ChannelKind::Unorm(16) && kinds[1] == ChannelKind::Absent => None,
            // Its lerps d + (s - d) a do not keep 1 x and 0 x exact, which float targets show by an ulp and more.
            ("llvmpipe", _) if float => None,
            ("exact", Spec::Vulkan) => Some(Class::Exact),
            ("f32" | "llvmpipe" | "swiftshader", Spec::Vulkan) => Some(Class::Wide),
            ("f16", Spec::Vulkan) if small => Some(Class::Wide),
            ("fixed:8", Spec::Vulkan | Spec::D3d) if linear8 => Some(Class::Wide),
            // D3D cuts floats toward zero, and does not clamp signed factors.
            ("exact", Spec::D3d) if format.class() == TargetClass::Unorm => Some(Class::Exact),
            ("exact:toward-zero", Spec::D3d) if float => Some(Class::Exact),
            ("f32", Spec::D3d) if format.class() == TargetClass::Unorm => Some(Class::Wide),
            _ => None,
        }
    }

    /// The deviations that the claims leave out, each with the rule it breaks: they must be flagged.
    #[test]
    fn known_driver_deviations_are_outside() {
        let both = |src_factor, dst_factor, operation| {
            let component = BlendComponent { src_factor, dst_factor, operation };
            Some(BlendState { color: component, alpha: component })
        };
        let near = both(BlendFactor::One, BlendFactor::One, BlendOperation::Subtract);
        let fade16 = both(BlendFactor::Src, BlendFactor::OneMinusSrc, BlendOperation::Add);
        let lerp = both(BlendFactor::DstAlpha, BlendFactor::OneMinusDstAlpha, BlendOperation::ReverseSubtract);
        let scaled = both(BlendFactor::OneMinusSrc, BlendFactor::Zero, BlendOperation::Add);
        let saturated = both(BlendFactor::SrcAlphaSaturated, BlendFactor::Constant, BlendOperation::ReverseSubtract);
        let linear =
            inputs("rgba8unorm-srgb", saturated, [0.846_479_24, 0.0, 0.190_196_08, 0.292_156_85], [190, 213, 74, 22]);
        let huge = inputs("r16float", saturated, [-0.919_592_26, 0.0, 0.0, -2.312_064_8e32], [0x6eb6, 0, 0, 0]);
        let cases = [
            // Vulkan: values below -1 are clamped to -1, code -127.
            ("llvmpipe", inputs("r8snorm", None, [-1.1, 0.0, 0.0, 0.0], [0; 4])),
            // Vulkan: the curve to about one part in 10^5.
            ("llvmpipe", inputs("rgba8unorm-srgb", near, [0.8, 0.0, 0.0, 0.0], [230, 0, 0, 0])),
            // Vulkan: either neighbour of the real result, 6329.08.
            ("llvmpipe:mesa=25.0", inputs("r16unorm", fade16, [0.310_766, 0.0, 0.0, 0.0], [0; 4])),
            // Vulkan: 0 x is 0 and 1 x is x; the missing alpha is 1, so the result is -S.
            ("llvmpipe", inputs("r32float", lerp, [1.0, 0.0, 0.0, 0.0], [1_063_281_889, 0, 0, 0])),
            // Vulkan: a finite number beyond the largest one is that, or Inf; never NaN.
            ("swiftshader", inputs("r16float", None, [89_581.3, 0.0, 0.0, 0.0], [0; 4])),
            // Vulkan: the curve, for the stored color that is read as well.
            ("nvidia", ColorInputs { constant: [0.668_342_6; 4], ..linear }),
            // Vulkan: factors of signed targets are clamped to 1.
            ("nvidia", inputs("r8snorm", scaled, [-0.705, 0.0, 0.0, 0.0], [0; 4])),
            // Vulkan: sources of float targets are not clamped; here the difference gets the other sign.
            ("nvidia", ColorInputs { constant: [6670.934; 4], ..huge }),
        ];
        for (name, texel) in cases {
            let got = registry::by_name(name).expect("known").merge_color(&texel);
            let verdict = Judge::new(Spec::Vulkan).judge(&texel, ColorWrites::ALL, got).verdict;
            assert_eq!(verdict, Verdict::Outside, "{name} on {}: {got:x?}", texel.format.name());
        }
    }

    /// SwiftShader's stores of halves and small floats break Vulkan's rule for overflow: finite numbers from 65520 on
    /// become codes that read as Inf or NaN, and NaN on small floats becomes 0. Real deviations, counted elsewhere.
    fn deviates(inputs: &ColorInputs, got: [u32; 4]) -> bool {
        inputs.format.channels().into_iter().zip(got).any(|(kind, code)| match kind {
            ChannelKind::Float(layout) if layout != FloatLayout::SINGLE => {
                code & layout.infinity() == layout.infinity()
            }
            _ => false,
        })
    }

    #[test]
    fn every_model_lies_inside_the_set_it_claims() {
        let names =
            ["exact", "exact:toward-zero", "f32", "f16", "fixed:8", "llvmpipe", "llvmpipe:mesa=22.3", "swiftshader"];
        let mut failures = Vec::new();
        for name in names {
            let model = registry::by_name(name).expect("known");
            for spec in [Spec::Vulkan, Spec::D3d] {
                let judge = Judge::new(spec);
                let run = |inputs: ColorInputs| {
                    let Some(class) = claim(name, spec, inputs.format) else { return Ok(()) };
                    if model.supports(inputs.format, inputs.blend.as_ref()).is_err() {
                        return Ok(());
                    }
                    let got = model.merge_color(&inputs);
                    if name == "swiftshader" && deviates(&inputs, got) {
                        return Ok(());
                    }
                    let judged = judge.judge(&inputs, ColorWrites::ALL, got);
                    let holds = match judged.verdict {
                        Verdict::Undefined => true,
                        Verdict::Within(found) => found <= class,
                        Verdict::Outside => false,
                    };
                    let sets = judge.sets(&inputs, Class::Wide);
                    prop_assert!(holds, "{name}, {spec}: {judged:?} for {got:x?} of {sets:x?}");
                    Ok(())
                };
                let cases = std::env::var("OUTMERGE_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(2000);
                let config = Config { cases, failure_persistence: None, ..Config::default() };
                // The same cases every time; OUTMERGE_CASES gives more of them.
                let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
                let result = runner.run(&state::format().prop_flat_map(target::color_inputs), run);
                if let Err(error) = result {
                    failures.push(error.to_string());
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n\n"));
    }
}
