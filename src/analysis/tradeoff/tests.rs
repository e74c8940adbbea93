//! What any survey must find.

use super::clock::Time;
use super::front::{dominates, points};
use super::*;
use crate::model::registry;

fn models() -> Vec<Box<dyn NumericModel>> {
    registry::all()
}

fn small(formats: &[&str], layers: &[(u32, u32)]) -> Vec<Row> {
    let models = models();
    let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
    let inputs = Inputs::new(1);
    survey(&Survey { models: &models, inputs: &inputs, formats, layers }, &|| ())
}

#[test]
fn exact_has_no_error_and_eight_bit_products_have() {
    let rows = small(&["rgba8unorm"], &[(1, 200), (10, 20)]);
    assert_eq!(rows.len(), models().len() * STATES.len() * 2 * 3, "models x states x depths x inputs");
    for row in rows.iter().filter(|row| row.model == "exact") {
        assert_eq!(row.errors, Errors { pixels: row.errors.pixels, ..Errors::default() }, "{row:?}");
    }
    let fixed = |row: &&Row| row.model == "fixed:8" && row.state == "straight over" && row.input == Input::Random;
    let fixed: Vec<&Row> = rows.iter().filter(fixed).collect();
    for row in &fixed {
        assert!(row.errors.pixels_off > 0.3 && row.errors.max >= 1.0, "8-bit products are often a code off: {row:?}");
    }
}

#[test]
fn figures_of_one_row_fit_together() {
    for row in small(&["rgba8unorm", "rgba16float"], &[(10, 30)]) {
        let e = row.errors;
        assert!(e.mean <= e.rms * (1.0 + 1e-12) && e.rms <= e.max * (1.0 + 1e-12), "mean <= RMS <= max: {row:?}");
        assert!(e.bias.abs() <= e.mean * (1.0 + 1e-12), "the bias is at most the mean: {row:?}");
        assert_eq!(e.pixels_off > 0.0, e.max > 0.0, "a pixel off has an error: {row:?}");
    }
}

/// Every figure of a row, from the codes themselves, in other arithmetic: integers and sorted lists.
#[test]
fn figures_are_those_of_the_codes() {
    let (exact, fixed) = (registry::by_name("exact").expect("a model"), registry::by_name("fixed:8").expect("a model"));
    let inputs = Inputs::new(5);
    let format = ColorFormat::from_name("rgba8unorm").expect("a format");
    let blend = state(STATES[0].1);
    let (layers, texels) = (3, 80);
    let (mut errors, mut off) = (Vec::new(), 0_u32);
    for texel in 0..texels {
        let stack = inputs.stack(Input::Random, format, &blend, texel, layers);
        let draw = |model: &dyn NumericModel| {
            let mut dst = stack.dst;
            for src in &stack.layers {
                let blend = Some(blend);
                dst = model.merge_color(&ColorInputs {
                    format,
                    blend,
                    constant: [0.0; 4],
                    src: *src,
                    src1: [0.0; 4],
                    dst,
                });
            }
            dst.map(i64::from)
        };
        let (mine, truth) = (draw(fixed.as_ref()), draw(exact.as_ref()));
        errors.extend(mine.iter().zip(truth).map(|(mine, truth)| mine - truth));
        off += u32::from(mine != truth);
    }
    let job = Job { format, blend, layers, texels, input: Input::Random };
    let (_, got) = job.run(&[fixed.as_ref()], &inputs).remove(0);
    let number = |n: i64| f64::from(i32::try_from(n).expect("small"));
    let count = number(i64::try_from(errors.len()).expect("small"));
    let mean = |of: fn(i64) -> i64| number(errors.iter().map(|error| of(*error)).sum()) / count;
    errors.iter().for_each(|error| assert!(error.abs() < 256));
    assert!(off > 0, "the sample shows something");
    assert_eq!(got.max, number(errors.iter().map(|error| error.abs()).max().expect("some")), "max");
    assert!((got.mean - mean(i64::abs)).abs() < 1e-12, "mean");
    assert!((got.rms * got.rms - mean(|error| error * error)).abs() < 1e-9, "root of the mean square");
    assert!((got.bias - mean(|error| error)).abs() < 1e-12, "bias");
    assert_eq!((got.pixels, got.pixels_off), (u64::from(texels), f64::from(off) / f64::from(texels)), "pixels");
}

#[test]
fn single_precision_on_eight_bits_is_off_at_ties_only() {
    let rows = small(&["rgba8unorm"], &[(1, 500)]);
    let rows = rows.iter().filter(|row| row.model == "f32" && row.input == Input::Random);
    for row in rows {
        assert!(row.errors.max <= 1.0 && row.errors.pixels_off < 0.01, "{row:?}");
    }
}

#[test]
fn truncation_darkens_and_rounding_to_nearest_does_not() {
    let rows = fixed::sweep(&Inputs::new(2), 2000);
    let find = |rounding: &str, bits: u32| {
        rows.iter().find(|row| row.rounding == rounding && row.bits == bits).expect("swept").errors
    };
    assert!(find("truncate", 8).bias < -0.3, "two truncated products: {:?}", find("truncate", 8));
    assert!(find("nearest", 8).bias.abs() < 0.1, "{:?}", find("nearest", 8));
    assert!(find("nearest", 16).mean < find("nearest", 8).mean / 20.0, "bits buy accuracy");
    assert!(find("fused", 8).mean <= find("nearest", 8).mean, "one rounding is better than two");
}

#[test]
fn the_front_is_what_nothing_dominates() {
    let rows = small(&["rgba8unorm"], &[(1, 40)]);
    let time = |model: &str, ns: f64| {
        STATES.map(|(state, _)| Time {
            model: model.to_owned(),
            format: "rgba8unorm",
            state,
            ns_per_fragment: ns,
            kernel_ns_per_fragment: None,
        })
    };
    let driver = registry::by_name("llvmpipe").expect("a model").name();
    // f16 is made slower than exact, so that it loses in both.
    let times =
        [time("exact", 500.0), time("f32", 50.0), time("f16", 600.0), time("fixed:8", 40.0), time(&driver, 30.0)];
    let points = points(&rows, &times.concat());
    let on_front: Vec<&str> = points.iter().filter(|point| point.on_front).map(|point| point.model.as_str()).collect();
    assert!(
        on_front.contains(&"exact") && on_front.contains(&driver.as_str()),
        "least error, least time: {on_front:?}"
    );
    assert!(!on_front.contains(&"f16"), "beaten in both: {on_front:?}");
    for a in points.iter().filter(|point| point.on_front) {
        let beaten = points.iter().any(|b| dominates((b.ns_that_runs(), b.mean), (a.ns_that_runs(), a.mean)));
        assert!(!beaten, "{} is on the front", a.model);
    }
}

#[test]
fn survey_inputs_are_the_same_in_every_run() {
    let format = ColorFormat::from_name("rgba8unorm").expect("a format");
    let stack = |seed| Inputs::new(seed).stack(Input::Adversarial, format, &state(STATES[1].1), 7, 5);
    assert_eq!(stack(3), stack(3), "one seed");
    assert_ne!(stack(3), stack(4), "two seeds");
    assert!(stack(3).layers.iter().flatten().all(|x| (0.0..=1.0).contains(x)), "in range");
}

#[test]
fn kernels_are_timed_where_they_run_and_count_for_the_front() {
    let models = models();
    let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
    let formats = ["rgba8unorm", "r8snorm", "rgba8unorm-srgb", "rgba16float"];
    let times = clock::times(&models, &formats, &Inputs::new(1)).expect("timed");
    for format in ["rgba8unorm-srgb", "rgba16float"] {
        let timed = times.iter().filter(|time| time.format == format && time.kernel_ns_per_fragment.is_some());
        assert!(timed.count() >= 3, "{format}: over in the models with kernels");
    }
    for time in times.iter().filter(|time| ["rgba8unorm", "r8snorm"].contains(&time.format)) {
        let kernels = ["exact", "f32", "fixed:8"].contains(&time.model.as_str()) || time.model.starts_with("llvmpipe:");
        let has_kernel = time.format == "rgba8unorm" && kernels;
        assert_eq!(time.kernel_ns_per_fragment.is_some(), has_kernel, "{time:?}");
    }
    let points = points(&small(&["rgba8unorm"], &[(1, 40)]), &times);
    for point in &points {
        assert_eq!(point.ns_that_runs(), point.kernel_ns_per_fragment.unwrap_or(point.ns_per_fragment), "{point:?}");
    }
}
