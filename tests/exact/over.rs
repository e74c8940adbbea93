//! Over on 8-bit targets for all source, destination and alpha codes, against integer arithmetic.
//!
//! Shader outputs are the binary32 numbers nearest to k / 255: multiples of 2^-32 below 1, so 255 times the result is an
//! integer over 2^64 and fits 128 bits.

use outmerge::format::ColorFormat;
use outmerge::model::exact::Exact;
use outmerge::model::{ColorInputs, NumericModel};
use rayon::prelude::*;
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

/// k / 255 in binary32.
fn output(k: u8) -> f32 {
    f32::from(k) / 255.0
}

/// A shader output in units of 2^-32.
fn units(k: u8) -> i128 {
    let scaled = f64::from(output(k)) * 4_294_967_296.0;
    assert_eq!(scaled.fract(), 0.0, "a multiple of 2^-32");
    #[expect(clippy::cast_possible_truncation, reason = "an integer, checked above")]
    let integer = scaled as i128;
    integer
}

/// n / 2^64 to the nearest integer, ties to even, at most 255.
fn nearest(n: i128) -> u32 {
    let (floor, rest) = (n >> 64, n & ((1 << 64) - 1));
    let half = 1_i128 << 63;
    let up = rest > half || (rest == half && floor & 1 == 1);
    u32::try_from(floor + i128::from(up)).expect("a code").min(255)
}

pub fn straight() {
    all(BlendFactor::SrcAlpha, |s, d, a| 255 * s * a + (d << 32) * ((1 << 32) - a));
}

pub fn premultiplied() {
    all(BlendFactor::One, |s, d, a| ((255 * s) << 32) + (d << 32) * ((1 << 32) - a));
}

/// Every (s, d, a), three a texel; `expected` gives 255 times the result over 2^64.
fn all(src_factor: BlendFactor, expected: impl Fn(i128, i128, i128) -> i128 + Sync) {
    let component =
        BlendComponent { src_factor, dst_factor: BlendFactor::OneMinusSrcAlpha, operation: BlendOperation::Add };
    let blend = Some(BlendState { color: component, alpha: component });
    let format = ColorFormat::from_name("rgba8unorm").expect("known");
    (0..=255_u8).into_par_iter().for_each(|alpha| {
        let a = units(alpha);
        for dst in 0..=255_u8 {
            for first in (0..=255_u8).step_by(3) {
                let src = [first, first.saturating_add(1), first.saturating_add(2)];
                let inputs = ColorInputs {
                    format,
                    blend,
                    constant: [0.0; 4],
                    src: [output(src[0]), output(src[1]), output(src[2]), output(alpha)],
                    src1: [0.0; 4],
                    dst: [u32::from(dst); 4],
                };
                let codes = Exact::default().merge_color(&inputs);
                for i in 0..3 {
                    let right = nearest(expected(units(src[i]), i128::from(dst), a));
                    assert_eq!(codes[i], right, "source {}, destination {dst}, alpha {alpha}", src[i]);
                }
            }
        }
    });
}
