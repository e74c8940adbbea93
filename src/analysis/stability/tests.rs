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
    // Each by hand, from the factors and the format.
    let by_hand = [
        ("NaN stored in unorm", "0"),
        // 0 a + (1 - a) 1 with a NaN that counts as 0: 1/2 is 127.5 of 255, to even.
        ("NaN blended into unorm", "0.502"),
        ("NaN alpha into unorm", "0.2"),
        ("infinity into unorm", "1"),
        ("NaN stored in half", "NaN"),
        ("factor zero times stored NaN", "NaN"),
        ("factor zero times source Inf", "NaN"),
        ("Inf - Inf", "NaN"),
        ("min of NaN and 1", "1"),
        ("max of NaN and 1", "1"),
        ("-0 by factors one, zero", "0"),
        ("subnormal half added", "5.960e-8"),
        ("subnormal f32 added", "1.000e-40"),
        // Halves lie 32 apart up to 65504; 65520 is the tie to infinity, and 65504 the odd code.
        ("65504 + 16 in half", "inf"),
        ("65504 + 65504 in half", "inf"),
        // 1e6 times the binary32 next to 0.01 is 9999.99978, halves there lie 8 apart.
        ("1e6 times 0.01 in half", "10000"),
        ("alpha -1 on half", "0"),
        ("alpha 2 on half", "1.5"),
        ("alpha 2 on unorm", "0.6"),
        ("additive beyond 1 on unorm", "1"),
        ("subtract below 0 on unorm", "0"),
        ("subtract below 0 on half", "-0.5"),
        ("constant 2 on unorm", "0.502"),
        ("constant 2 on half", "1"),
    ];
    assert_eq!(rows.iter().map(|row| row.name).collect::<Vec<_>>(), by_hand.map(|(name, _)| name), "every case");
    for (name, in_exact) in by_hand {
        assert_eq!(outcome(&rows, name, 0), in_exact, "{name}");
    }
    let differ = rows.iter().filter(|row| row.outcomes[0] != row.outcomes[1]).count();
    let told = super::extreme::finding(&rows);
    assert!(told.starts_with(&format!("{differ} of 24 extreme blends have different outcomes")), "{differ}: {told}");
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

/// The depths that `exact` stores, by hand: clamped to 0 to 1, a half of an odd number of steps away from zero.
#[test]
fn extreme_depths_are_those_by_hand() {
    let exact = Exact::default();
    let rows = depths(&[&exact]);
    let all: Vec<_> = rows.iter().map(|row| (row.name, row.format, row.outcomes[0].as_str())).collect();
    let by_hand = |name, [sixteen, twenty_four, float]: [&'static str; 3]| {
        [(name, "depth16unorm", sixteen), (name, "depth24plus", twenty_four), (name, "depth32float", float)]
    };
    let expected = [
        by_hand("NaN", ["code 0", "code 0", "0"]),
        by_hand("-0", ["code 0", "code 0", "0"]),
        by_hand("-0.5", ["code 0", "code 0", "0"]),
        by_hand("1.5", ["code 65535", "code 16777215", "1"]),
        by_hand("Inf", ["code 65535", "code 16777215", "1"]),
        by_hand("0.5", ["code 32768", "code 8388608", "0.5"]),
    ];
    assert_eq!(all, expected.concat());
}

#[test]
fn projection_maps_near_and_far_to_the_ends() {
    for far in [10.0, 1e6] {
        assert_eq!((depth(1.0, far, false), depth(1.0, far, true)), (0.0, 1.0), "near");
        assert!((depth(far, far, false) - 1.0).abs() < 1e-12 && depth(far, far, true).abs() < 1e-12, "far");
    }
}

/// Every row of the depth table from a projection matrix and codes counted by hand.
#[test]
fn depth_precision_is_that_of_a_projection_matrix_and_a_plain_count() {
    for row in precision(&Exact::default()) {
        let far = row.ratio;
        // Right-handed, depth 0 to 1; swapping the planes reverses it.
        let (near_plane, far_plane) = if row.reversed { (far, 1.0) } else { (1.0, far) };
        let matrix = glam::dcamera::rh::proj::directx::perspective(1.0, 1.0, near_plane, far_plane);
        let code = |z: f64| {
            let clip = matrix * glam::DVec4::new(0.0, 0.0, -z, 1.0);
            #[expect(clippy::cast_possible_truncation, reason = "the rounding under test")]
            let depth = (clip.z / clip.w) as f32;
            match row.format {
                "depth16unorm" => (f64::from(depth) * 65_535.0).round(),
                "depth24plus" => (f64::from(depth) * 16_777_215.0).round(),
                _ => f64::from(depth),
            }
        };
        for (gap, lost) in [0.01, 0.001, 0.0001].into_iter().zip(row.lost) {
            let same = (0..1000_u32).filter(|i| {
                let z = ((far / (1.0 + gap)).ln() * (f64::from(*i) + 0.5) / 1000.0).exp();
                let (near, far) = (code(z), code(z * (1.0 + gap)));
                if row.reversed { near <= far } else { near >= far }
            });
            let expected = f64::from(u32::try_from(same.count()).expect("at most 1000")) / 1000.0;
            // The two ways round differently in the last digits of binary64, which moves a few pairs over an edge.
            assert!((lost - expected).abs() <= 0.005, "{row:?}, gap {gap}: {expected}");
        }
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
