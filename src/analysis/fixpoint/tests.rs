//! The laws of repeated blending, and what people report of it.

use super::sweep::sweep;
use super::*;
use crate::format::{ColorFormat, rounding::decompose};
use crate::model::registry;
use crate::state::shaderlab::Properties;
use crate::state::text;

fn question(state: &str, format: &str, alpha: f32, source: f32) -> Question {
    let blend = text::parse(state, &Properties::new()).expect("a state").blend[0];
    let format = ColorFormat::from_name(format).expect("a format");
    Question { format, blend, channel: Channel::Color, source, alpha, constant: [0.0; 4] }
}

fn answer(question: &Question, model: &str, from: u32) -> Answer {
    let model = registry::by_name(model).expect("a model");
    let exact = registry::by_name("exact").expect("a model");
    analyze(question, model.as_ref(), exact.as_ref(), from).expect("a map of codes")
}

/// The dead zone in integers: code d stays if alpha |255 S - d| is below half a code, or half a code and d even.
fn theory_says_fixed(alpha: f32, source: f32, code: u32) -> bool {
    let odd = |x: f32| {
        let (_, magnitude, exponent) = decompose(f64::from(x));
        let zeros = if magnitude == 0 { exponent.unsigned_abs() } else { magnitude.trailing_zeros() };
        (magnitude.checked_shr(zeros).unwrap_or(0), exponent.unsigned_abs() - zeros)
    };
    // Everything stays below 2^127: alphas and sources of this test are multiples of 2^-32.
    let ((a, a_exponent), (s, s_shift)) = (odd(alpha), odd(source));
    let distance = (255 * s).abs_diff(u128::from(code) << s_shift);
    let (move_twice, code_width) = (2 * a * distance, 1_u128 << (a_exponent + s_shift));
    move_twice < code_width || (move_twice == code_width && code.is_multiple_of(2))
}

#[test]
fn exact_fade_keeps_the_codes_of_the_dead_zone_and_no_others() {
    let exact = registry::by_name("exact").expect("a model");
    for alpha in 1..=255_u8 {
        for source in (0..=255_u8).step_by(17) {
            let (alpha, source) = (f32::from(alpha) / 255.0, f32::from(source) / 255.0);
            let map = question("fade", "rgba8unorm", alpha, source).map(exact.as_ref());
            for code in 0..=255 {
                let fixed = map[code as usize] == code;
                assert_eq!(
                    fixed,
                    theory_says_fixed(alpha, source, code),
                    "alpha {alpha}, source {source}, code {code}"
                );
            }
        }
    }
}

#[test]
fn a_trail_faded_by_a_fortieth_never_gets_below_a_code_near_20() {
    // 1 / (2 * 0.025) = 20 codes, which f32's own rounding turns into a tie; with alpha as 6/255 it is 255 / 12 = 21.25.
    let fade = question("fade", "rgba8unorm", 0.025, 0.0);
    for (model, expected) in [("exact", 19), ("f32", 20), ("fixed:8", 21), ("llvmpipe", 21)] {
        let answer = answer(&fade, model, 255);
        assert_eq!((&answer.ends_in[..], answer.stuck_by), (&[expected][..], Some(expected)), "{model}");
    }
}

#[test]
fn truncating_blenders_reach_black_and_stick_below_white() {
    for model in ["exact:toward-zero", "fixed:8,rounding=truncate", "fixed:8,rounding=shift"] {
        let to_black = answer(&question("fade", "rgba8unorm", 0.025, 0.0), model, 255);
        assert_eq!(to_black.ends_in, [0], "{model}: falling is never undone");
        let to_white = answer(&question("fade", "rgba8unorm", 0.025, 1.0), model, 0);
        assert!(to_white.stuck_by.is_some_and(|codes| codes > 20), "{model}: {:?} below white", to_white.stuck_by);
    }
}

#[test]
fn the_reason_of_an_eight_bit_blender_is_its_alpha() {
    let answer = answer(&question("fade", "rgba8unorm", 0.025, 0.0), "fixed:8", 255);
    let difference = answer.difference.expect("it ends elsewhere");
    let departure = difference.departure.expect("a step differs");
    assert!(departure.model.exact.contains("/255"), "{departure:?}");
}

#[test]
fn inverting_swaps_codes_in_pairs() {
    // D' = 1 (1 - D): no code is its own mirror, for 255 is odd.
    for model in registry::NAMES {
        let answer = answer(&question("one-minus-dst zero", "rgba8unorm", 1.0, 1.0), model, 200);
        assert_eq!(answer.ends_in, [55, 200], "{model}");
        assert_eq!(answer.dynamics.cycles().count(), 128, "{model}: all codes are in pairs");
        assert_eq!((answer.fixed_points.len(), answer.goal), (0, None), "{model}: no rest, no goal");
    }
}

#[test]
fn the_smallest_alphas_of_exact_are_half_a_code_of_the_distance() {
    let answer = answer(&question("fade", "rgba8unorm", 0.5, 0.0), "exact", 255);
    let moves = answer.smallest_alpha.moves.expect("alpha 1 moves");
    // From 255 the tie at 254.5 goes to the even 254, so the first f32 not below 0.5 / 255 moves.
    let moved = |alpha: f32| f64::from(alpha) * 255.0 >= 0.5;
    assert!(moved(moves) && !moved(moves.next_down()), "{moves} moves 255 and nothing below does");
    // The last step, from 1, needs half: 1 - 0.5 is a tie, which goes to 0.
    assert_eq!(answer.smallest_alpha.reaches, Some(0.5), "to arrive at 0");
}

/// The smallest alphas against a plain search of the same multiples, by following every code to where it rests.
#[test]
fn the_smallest_alpha_arrives_at_the_goal_itself_and_none_of_the_grid_below_does() {
    for (model, source, from) in [
        ("exact", 1.0, 0_u32),
        ("exact:toward-zero", 1.0, 0),
        ("exact:toward-zero", 0.0, 255),
        ("fixed:8", 0.0, 255),
        ("fixed:8,rounding=truncate", 1.0, 0),
    ] {
        let found = answer(&question("fade", "rgba8unorm", 0.5, source), model, from).smallest_alpha.reaches;
        let blender = registry::by_name(model).expect("a model");
        let goal = if source == 0.0 { 0 } else { 255 };
        let arrives = |alpha: f32| {
            let question = question("fade", "rgba8unorm", alpha, source);
            let rest = (0..600).fold(from, |code, _| question.next(blender.as_ref(), code));
            // Alpha 0 has no goal.
            alpha > 0.0 && rest == goal && question.next(blender.as_ref(), rest) == rest
        };
        let first = (0..=4096_u16).map(|step| f32::from(step) / 4096.0).find(|alpha| arrives(*alpha));
        match (found, first) {
            (Some(found), Some(first)) => {
                assert!(arrives(found) && found <= first && found > first - 1.0 / 4096.0, "{model}: {found}, {first}");
            }
            (found, first) => assert_eq!(found, first, "{model}, source {source}"),
        }
    }
}

#[test]
fn other_channels_do_not_matter() {
    for model in registry::NAMES {
        let model = registry::by_name(model).expect("a model");
        for code in 0..=255_u32 {
            let question = question("fade", "rgba8unorm", 0.3, 0.7);
            let mut inputs = question.inputs(code);
            inputs.dst = [code, 255 - code, 77, code / 3];
            assert_eq!(
                model.merge_color(&inputs)[0],
                question.next(model.as_ref(), code),
                "{} at code {code}",
                model.name()
            );
        }
    }
}

#[test]
fn the_goal_is_the_source_of_a_fade_and_the_quotient_of_a_premultiplied_one() {
    assert_eq!(question("fade", "rgba8unorm", 0.25, 0.4).goal(), Some(102), "0.4 * 255");
    assert_eq!(question("premultiplied", "rgba8unorm", 0.5, 0.25).goal(), Some(128), "0.25 / 0.5, to even");
    assert_eq!(question("fade", "rgb10a2unorm", 0.25, 1.0).goal(), Some(1023), "ten bits");
    assert_eq!(question("fade", "rgba8unorm-srgb", 0.25, 0.5).goal(), Some(188), "encoded");
    assert_eq!(question("additive", "rgba8unorm", 0.25, 0.5).goal(), None, "grows without rest");
    assert_eq!(question("fade", "rgba8unorm", 0.0, 0.5).goal(), None, "alpha 0 moves nothing");
    assert_eq!(question("off", "rgba8unorm", 0.0, 0.4).goal(), Some(102), "overwriting");
}

#[test]
fn the_alpha_channel_of_fade_goes_to_alpha_itself() {
    // A' = a a + (1 - a) A rests at A = a: one equation for color and alpha squares the source's alpha.
    let fade = Question { channel: Channel::Alpha, ..question("fade", "rgba8unorm", 0.6, 0.0) };
    assert_eq!(fade.goal(), Some(153), "0.6 * 255");
    let wrong = Question { channel: Channel::Alpha, ..question("fade", "rg8unorm", 0.6, 0.0) };
    assert!(matches!(wrong.check(), Err(FixpointError::NoAlpha(_))), "no alpha there");
}

#[test]
fn sweeps_stay_within_the_theory_of_exact_and_see_every_alpha() {
    let exact = registry::by_name("exact").expect("a model");
    let sweep = sweep(&question("fade", "r8unorm", 0.0, 0.0), exact.as_ref(), &|| ()).expect("a map of codes");
    assert_eq!(sweep.rows.len(), 256, "every alpha");
    for row in &sweep.rows[1..] {
        // The goal is the nearest code to the source, here the source itself.
        let widest = row.stuck_above.max(row.stuck_below);
        assert!(f64::from(widest) <= row.theory, "{row:?}: inside the dead zone");
        assert!(f64::from(widest) + 1.0 >= row.theory.min(255.0), "{row:?}: and at its edge");
        assert_eq!(row.sources_with_cycles, 0, "{row:?}: fade is monotone, so nothing oscillates");
    }
}

/// A sweep's rows by following every code for more frames than there are codes.
#[test]
fn sweeps_are_what_following_every_code_finds() {
    let cases = [
        ("fade", "exact", [1_u8, 6, 64, 255]),
        ("fade", "fixed:8,rounding=truncate", [1, 6, 64, 255]),
        ("premultiplied", "exact", [0, 3, 128, 254]),
        // Codes that swap places.
        ("one-minus-dst zero", "exact", [0, 1, 77, 255]),
        ("one-minus-dst one-minus-src", "fixed:8", [0, 1, 77, 255]),
    ];
    for (state, model, alphas) in cases {
        let model = registry::by_name(model).expect("a model");
        let swept = sweep(&question(state, "r8unorm", 0.0, 0.0), model.as_ref(), &|| ()).expect("a map of codes");
        for alpha in alphas {
            let (mut above, mut below, mut cycles, mut frames) = (0_i64, 0_i64, 0, 0);
            for source in 0..=255_u8 {
                let question = question(state, "r8unorm", f32::from(alpha) / 255.0, f32::from(source) / 255.0);
                let next: Vec<u32> = (0..256).map(|code| question.next(model.as_ref(), code)).collect();
                let follow = |from: u32, count: usize| (0..count).fold(from, |at, _| next[at as usize]);
                // After 256 frames every code is in its limit.
                let mut in_limit = [false; 256];
                (0..256).for_each(|code| in_limit[follow(code, 256) as usize] = true);
                cycles += u32::from((0..256_u32).any(|at| in_limit[at as usize] && next[at as usize] != at));
                for code in 0..256 {
                    let way = std::iter::successors(Some(code), |at| Some(next[*at as usize]));
                    let first = way.take_while(|at| !in_limit[*at as usize]).count();
                    frames = frames.max(u32::try_from(first).expect("small"));
                }
                let Some(goal) = question.goal().map(i64::from) else { continue };
                // The whole limit counts.
                let limit = |from: u32| (256..512).map(move |count| i64::from(follow(from, count)));
                above = above.max(limit(255).map(|code| code - goal).max().expect("codes"));
                below = below.max(limit(0).map(|code| goal - code).max().expect("codes"));
            }
            let row = swept.rows[usize::from(alpha)];
            let found = (i64::from(row.stuck_above), i64::from(row.stuck_below), row.sources_with_cycles, row.frames);
            assert_eq!(found, (above, below, cycles, frames), "{state}, {}, alpha {alpha}", model.name());
        }
    }
}

#[test]
fn questions_without_a_map_say_why() {
    let message = |question: Question| question.check().expect_err("no map").to_string();
    assert!(message(question("fade", "rgba16float", 0.1, 0.0)).contains("float"), "float");
    assert!(message(question("dst-alpha zero", "rgba8unorm", 0.1, 0.0)).contains("`dst-alpha`"), "destination alpha");
    assert!(message(question("src1 zero", "rgba8unorm", 0.1, 0.0)).contains("second source"), "second source");
    assert!(question("dst-alpha zero", "rg8unorm", 0.1, 0.0).check().is_ok(), "a missing alpha is constant 1");
}
