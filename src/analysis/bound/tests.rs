//! No stack drifts farther than the bound; some come close.

use proptest::prelude::*;

use super::*;
use crate::model::ColorInputs;
use crate::model::registry;
use crate::scene::display::value;

fn growth(format: &str, model: &str, alpha: f32) -> (ColorFormat, Box<dyn NumericModel>, Growth) {
    let format = ColorFormat::from_name(format).expect("a format");
    let model = registry::by_name(model).expect("a model");
    let growth = Growth::new(format, model.as_ref(), alpha).expect("a bound");
    (format, model, growth)
}

#[test]
fn the_bound_is_the_geometric_sum() {
    for (alpha, layers) in [(0.5_f32, 3), (0.1, 40), (1.0, 7), (1.0 / 255.0, 1000)] {
        let (_, _, growth) = growth("rgba8unorm", "exact", alpha);
        let a = f64::from(alpha);
        let sum = 0.5 / 255.0 * (1.0 - (1.0 - a).powi(layers)) / a;
        let error = growth.error(layers.unsigned_abs());
        assert!(error >= sum * (1.0 - 1e-13) && error <= sum * (1.0 + 1e-9), "alpha {alpha}: {error} against {sum}");
    }
}

#[test]
fn searches_come_close_to_the_bound_and_never_pass_it() {
    for (format, model, alpha, layers, share) in [
        ("rgba8unorm", "exact", 0.1, 100, 0.9),
        ("rgba8unorm", "f32", 0.02, 200, 0.9),
        ("rgb10a2unorm", "exact", 0.05, 200, 0.9),
        ("rgba8unorm-srgb", "exact", 0.1, 60, 0.5),
        ("rgba16float", "exact", 0.05, 200, 0.9),
        ("rg11b10ufloat", "exact", 0.1, 60, 0.45),
        ("rgba8unorm", "fixed:8", 26.0 / 255.0, 60, 0.5),
        ("rgba8unorm", "llvmpipe", 26.0 / 255.0, 60, 0.5),
        ("rgba8unorm", "fixed:8,rounding=shift", 26.0 / 255.0, 60, 0.4),
    ] {
        let (format, model, growth) = growth(format, model, alpha);
        let reached = adversary(format, model.as_ref(), alpha, layers);
        let bound = growth.error(layers);
        let name = format!("{} in {}: {reached} of {bound}", format.name(), model.name());
        assert!(reached <= bound, "{name}");
        assert!(reached >= share * bound, "{name}, less than {share} of it");
    }
}

/// One layer, tried: sources at codes, just beside them and between, over every stored code. No blender may pass its bound,
/// and each comes near it, sources that are truncated included.
#[test]
fn one_layer_reaches_its_bound_and_does_not_pass_it() {
    for (model, share) in [
        ("exact", 0.99),
        ("exact:toward-zero", 0.99),
        ("fixed:8", 0.7),
        ("fixed:source=8,factor=8,product=8,rounding=nearest,take-in=truncate", 0.7),
        ("fixed:8,rounding=truncate", 0.7),
    ] {
        for alpha in [26.0 / 255.0, 0.5, 1.0] {
            let (format, model, growth) = growth("rgba8unorm", model, alpha);
            let (a, bound) = (f64::from(alpha), growth.after(0.0));
            let mut worst = 0.0_f64;
            for step in 0..=510_u16 {
                let at = f32::from(step) / 510.0;
                for color in [at, at.next_down().max(0.0), at.next_up().min(1.0)] {
                    for code in 0..=255_u32 {
                        let inputs = ColorInputs {
                            format,
                            blend: Some(STATE),
                            constant: [0.0; 4],
                            src: [color, color, color, alpha],
                            src1: [0.0; 4],
                            dst: [code; 4],
                        };
                        let real = a * f64::from(color) + (1.0 - a) * f64::from(code) / 255.0;
                        worst = worst.max((f64::from(model.merge_color(&inputs)[0]) / 255.0 - real).abs());
                    }
                }
            }
            let name = model.name();
            assert!(worst <= bound + 1e-12, "{name}, alpha {alpha}: {worst} of {bound}");
            assert!(worst >= share * bound, "{name}, alpha {alpha}: only {worst} of {bound}");
        }
    }
}

#[test]
fn alpha_zero_and_one_are_the_ends() {
    let (_, _, still) = growth("rgba16float", "exact", 0.0);
    assert_eq!(still.error(1000), 0.0, "layers of alpha 0 change nothing");
    let (_, _, fresh) = growth("rgba8unorm", "exact", 1.0);
    assert!(fresh.error(1000) <= (0.5 / 255.0) * (1.0 + 1e-9), "every layer starts afresh");
}

#[test]
fn questions_without_a_proof_are_refused() {
    let format = ColorFormat::from_name("rgba8unorm").expect("a format");
    let wide = ColorFormat::from_name("rgba16float").expect("a format");
    let model = |name| registry::by_name(name).expect("a model");
    for (format, name, alpha) in
        [(format, "exact", 1.5), (format, "exact", f32::NAN), (wide, "llvmpipe", 0.5), (format, "fixed:12", 0.5)]
    {
        assert!(Growth::new(format, model(name).as_ref(), alpha).is_err(), "{name}, alpha {alpha}");
    }
    let error = bound(format, model("exact").as_ref(), 0.5, u32::MAX, 1.0).expect_err("too many layers");
    assert!(matches!(error, BoundError::Layers { .. }), "{error}");
}

fn any_case() -> impl Strategy<Value = (&'static str, &'static str, f32, f32, Vec<f32>)> {
    let pairs = prop::sample::select(vec![
        ("rgba8unorm", "exact"),
        ("rgba8unorm", "exact:toward-zero"),
        ("rgba8unorm", "f32"),
        ("rgba8unorm", "llvmpipe"),
        ("rgba8unorm", "fixed:8"),
        ("rgba8unorm", "fixed:8,rounding=truncate"),
        ("rgba8unorm", "fixed:source=10,factor=9,product=8,rounding=nearest,take-in=truncate"),
        ("rgba8snorm", "exact"),
        ("rgba8unorm-srgb", "f32"),
        ("rgb10a2unorm", "fixed:10"),
        ("rgba16unorm", "f32"),
        ("rgba16float", "exact"),
        ("rgba16float", "f32"),
        ("rg11b10ufloat", "exact"),
        ("rgba32float", "f32"),
    ]);
    let alpha = prop_oneof![0.0_f32..=1.0, (0_u8..=255).prop_map(|a| f32::from(a) / 255.0), 1e-9_f32..1e-3];
    let color = || prop_oneof![0.0_f32..=1.0, (0_u8..=255).prop_map(|a| f32::from(a) / 255.0)];
    (pairs, alpha, color(), prop::collection::vec(color(), 1..60)).prop_map(|((f, m), a, d, s)| (f, m, a, d, s))
}

proptest! {
    #[test]
    fn no_stack_exceeds_the_bound((format, model, alpha, start, colors) in any_case()) {
        let (format, model, growth) = growth(format, model, alpha);
        let kind = format.channels()[0];
        let mut inputs =
            ColorInputs { format, blend: None, constant: [0.0; 4], src: [start; 4], src1: [0.0; 4], dst: [0; 4] };
        inputs.dst = model.merge_color(&inputs);
        inputs.blend = Some(STATE);
        let mut real = value(kind, inputs.dst[0]);
        let a = f64::from(alpha);
        let mut bound = 0.0;
        for color in colors {
            inputs.src = [color, color, color, alpha];
            inputs.dst = model.merge_color(&inputs);
            real = a * f64::from(color) + (1.0 - a) * real;
            bound = growth.after(bound);
            let error = (value(kind, inputs.dst[0]) - real).abs();
            // The real numbers are carried in binary64, off by less than 2^-50 a layer.
            prop_assert!(error <= bound + 1e-13, "{} in {}: {} of {}", format.name(), model.name(), error, bound);
        }
    }
}
