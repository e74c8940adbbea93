//! Stability's laws.

use super::depth::{DepthRow, depth, precision};
use super::extreme::{depths, extremes};
use super::order::sensitivity;
use super::stack::{Direction, Family, stack, stacks};
use crate::analysis::bound::Growth;
use crate::format::ColorFormat;
use crate::model::exact::Exact;
use crate::model::{NumericModel, registry};
use crate::scene::Scene;

fn format(name: &str) -> ColorFormat {
    ColorFormat::from_name(name).expect("a format")
}

#[test]
fn constant_stacks_stay_within_the_proven_bound() {
    let exact = Exact::default();
    for (family, alpha) in [(Family::Thin, 1.0 / 255.0), (Family::Fade, 0.025)] {
        for name in ["rgba8unorm", "rgb10a2unorm", "rgba16float"] {
            let row = stack(family, Direction::BackToFront, format(name), &exact, 600);
            let bound = 255.0 * Growth::new(format(name), &exact, alpha).expect("a bound").error(600);
            assert!(row.worst <= bound, "{}, {name}: {} of {bound}", family.name(), row.worst);
        }
    }
}

/// A stack of one color in closed form, and its codes by integers: 0.75 (1 - (1 - a)^n) against codes rounded each time.
#[test]
fn a_stack_s_errors_are_those_of_the_closed_form() {
    let alpha = f64::from(0.025_f32);
    let row = stack(Family::Fade, Direction::BackToFront, format("rgba8unorm"), &Exact::default(), 64);
    let (mut code, mut worst, mut shown) = (0.0_f64, 0.0_f64, Vec::new());
    for count in 1..=64_u32 {
        code = (alpha * 0.75 * 255.0 + (1.0 - alpha) * code).round_ties_even();
        let real = 0.75 * 255.0 * (1.0 - (1.0 - alpha).powi(count.cast_signed()));
        worst = worst.max((code - real).abs());
        if count.is_power_of_two() {
            shown.push((count, (code - real).abs()));
        }
    }
    assert!((row.worst - worst).abs() < 1e-9, "{} and {worst}", row.worst);
    assert_eq!(row.errors.iter().map(|(count, _)| *count).collect::<Vec<_>>(), [1, 2, 4, 8, 16, 32, 64], "doubled");
    for ((count, got), (_, expected)) in row.errors.iter().zip(&shown) {
        assert!((got - expected).abs() < 1e-9, "layer {count}: {got} and {expected}");
    }
}

#[test]
fn thin_layers_stagnate_on_eight_bits_and_not_on_wider_targets() {
    let exact = Exact::default();
    let worst = |name| stack(Family::Thin, Direction::BackToFront, format(name), &exact, 1000);
    let (eight, ten, single) = (worst("rgba8unorm"), worst("rgb10a2unorm"), worst("rgba32float"));
    assert!(eight.worst > 50.0, "moves of less than half a code are lost: {eight:?}");
    assert!(ten.worst < eight.worst / 2.0, "10 bits lose less: {} and {}", ten.worst, eight.worst);
    assert!(single.worst < 0.001 && single.stagnates_at.is_none(), "{single:?}");
}

#[test]
fn every_model_that_covers_a_format_has_a_row_for_every_family() {
    let models = registry::all();
    let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
    let rows = stacks(&models, 20);
    for family in Family::ALL {
        let of = |direction| {
            rows.iter().filter(|row| row.family == family && row.direction == direction && row.model == "exact").count()
        };
        assert_eq!(of(Direction::BackToFront), 6, "{}: every format", family.name());
        assert_eq!(of(Direction::FrontToBack), 4, "{}: formats with 8 bits of alpha or more", family.name());
    }
    assert!(rows.iter().all(|row| row.worst.is_finite()), "no NaN");
}

fn outcome(rows: &[super::extreme::ExtremeRow], name: &str, model: usize) -> String {
    let row = rows.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("no case `{name}`"));
    row.outcomes[model].clone().expect("covered")
}

#[test]
fn extreme_blends_come_out_by_the_rules() {
    let (exact, llvmpipe) = (Exact::default(), registry::by_name("llvmpipe").expect("a model"));
    let rows = extremes(&[&exact, llvmpipe.as_ref()]);
    for (name, in_exact) in [
        ("infinity into unorm", "1"),
        ("factor zero times stored NaN", "NaN"),
        ("Inf - Inf", "NaN"),
        ("alpha -1 on half", "0"),
        ("alpha 2 on half", "1.5"),
        ("alpha 2 on unorm", "0.6"),
        ("additive beyond 1 on unorm", "1"),
        ("subtract below 0 on unorm", "0"),
        ("subtract below 0 on half", "-0.5"),
        ("constant 2 on unorm", "0.502"),
        ("constant 2 on half", "1"),
    ] {
        assert_eq!(outcome(&rows, name, 0), in_exact, "{name}");
    }
    assert_eq!(outcome(&rows, "factor zero times stored NaN", 1), "0.5", "llvmpipe drops terms of factor zero");
    assert_eq!(outcome(&rows, "65504 + 65504 in half", 1), "65504", "llvmpipe truncates");
    assert_eq!(outcome(&rows, "65504 + 65504 in half", 0), "inf", "nearest goes to Inf");
}

#[test]
fn extreme_depths_are_clamped_in_every_model() {
    let models = registry::all();
    let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
    for row in depths(&models).iter().filter(|row| row.format == "depth16unorm") {
        let expected = match row.name {
            "-0" | "-0.5" => "code 0",
            "1.5" | "Inf" => "code 65535",
            _ => continue,
        };
        assert!(row.outcomes.iter().all(|outcome| outcome == expected), "{row:?}");
    }
}

#[test]
fn projection_maps_near_and_far_to_the_ends() {
    for far in [10.0, 1e6] {
        assert_eq!((depth(1.0, far, false), depth(1.0, far, true)), (0.0, 1.0), "near");
        assert!((depth(far, far, false) - 1.0).abs() < 1e-12 && depth(far, far, true).abs() < 1e-12, "far");
    }
}

#[test]
fn reversed_float_depth_is_the_one_that_stands_stiff_ranges() {
    let rows = precision(&Exact::default());
    let find = |format: &str, reversed: bool, ratio: f64| -> &DepthRow {
        let found = rows.iter().find(|row| row.format == format && row.reversed == reversed && row.ratio == ratio);
        found.expect("a row")
    };
    assert_eq!(find("depth32float", true, 1e6).lost, [0.0; 3], "nothing lost at any gap");
    assert!(find("depth32float", false, 1e6).lost[1] > 0.2, "standard float depth wastes its digits near the eye");
    assert!(find("depth16unorm", false, 1e3).lost[0] > find("depth16unorm", false, 1e1).lost[0], "stiffer is worse");
    assert!(rows.iter().all(|row| row.wrong == 0), "the projection and the store are monotone");
}

#[test]
fn draws_that_do_not_overlap_may_come_in_any_order_and_blended_ones_may_not() {
    let report = |name: &str| {
        let scene = Scene::bundled_by_name(name).expect("bundled").expect("valid");
        sensitivity(&scene, &Exact::default()).expect("renders")
    };
    let sensitive = report("overlap-zwrite-off");
    assert!(sensitive.pixels_sensitive > 0 && sensitive.worst > 0, "blended quads overlap");
    let [x, y] = sensitive.worst_at;
    let pixel = (y * sensitive.heat_map.width + x) as usize * 4;
    assert_ne!(sensitive.heat_map.rgba[pixel..pixel + 3], [24, 26, 33], "the worst pixel is not drawn as equal");
    // Every figure of the report from the picture of it: pixels that are not drawn as equal, and the worst among them.
    let colored = sensitive.heat_map.rgba.chunks(4).filter(|pixel| pixel[..3] != [24, 26, 33]).count() as u64;
    assert_eq!(sensitive.pixels_sensitive, colored, "pixels");
    assert_eq!(sensitive.pixels * 4, sensitive.heat_map.rgba.len() as u64, "all pixels");
    assert_eq!(
        sensitive.worst,
        sensitive.permutations.iter().map(|p| p.difference.max_codes).max().unwrap_or(0),
        "worst"
    );
    let still = report("cutout-cutoffs");
    assert!(!still.permutations.is_empty(), "several draws");
    assert!(
        still.permutations.iter().all(|p| p.difference.pixels_differing == 0),
        "depth-tested opaque draws: {still:?}"
    );
}
