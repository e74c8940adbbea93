//! The `exact` model against an independent evaluation in arbitrary precision.
//!
//! The oracle in `oracle.rs` is written from the specifications with other libraries (dashu) and other methods (binary
//! search over decoded codes, powers through logarithms) than the crate. Everyday tests take a sample; the full check is
//!
//! ```text
//! cargo test --release --all-features --test exact -- --ignored --nocapture
//! ```

mod number;
mod oracle;
mod over;
mod thresholds;

use std::sync::atomic::{AtomicU64, Ordering};

use outmerge::format::layout::FORMATS;
use outmerge::format::{ChannelKind, ColorFormat, Rounding};
use outmerge::model::exact::Exact;
use outmerge::model::{ColorInputs, NumericModel};
use outmerge::vectors::Generator;
use rayon::prelude::*;

/// Formats that between them have every kind of channel, one or two for each target class.
const CLASSES: [(&str, &[&str]); 8] = [
    ("unorm 8", &["rgba8unorm", "rg8unorm"]),
    ("unorm 10 and 2", &["rgb10a2unorm"]),
    ("unorm 16", &["rgba16unorm"]),
    ("snorm", &["rgba8snorm", "rgba16snorm"]),
    ("srgb", &["rgba8unorm-srgb"]),
    ("half", &["rgba16float", "r16float"]),
    ("11/10-bit float", &["rg11b10ufloat"]),
    ("float32", &["rgba32float", "rg32float"]),
];

/// Channels compared, and how the crate came to them.
#[derive(Default)]
struct Counts {
    channels: AtomicU64,
    fallbacks: AtomicU64,
}

/// Every rounding that `exact` has.
const ROUNDINGS: [Rounding; 3] = [Rounding::NearestEven, Rounding::NearestAway, Rounding::TowardZero];

/// Compares one texel by every path of the crate and every rounding; panics with the replayable inputs where they differ.
fn compare(inputs: &ColorInputs, counts: &Counts) {
    for rounding in ROUNDINGS {
        let expected = oracle::merge(inputs, rounding);
        let exact = Exact { rounding };
        let got = exact.merge_color(inputs);
        assert!(
            same(inputs.format, got, expected),
            "{} {got:x?}, oracle {expected:x?}\n{inputs:?}\nsource bits {:x?}",
            exact.name(),
            inputs.src.map(f32::to_bits)
        );
        if exact.merge_color_bounded(inputs).is_none() {
            counts.fallbacks.fetch_add(1, Ordering::Relaxed);
        }
    }
    let stored = inputs.format.channels().iter().filter(|kind| **kind != ChannelKind::Absent).count() as u64;
    counts.channels.fetch_add(stored, Ordering::Relaxed);
}

fn same(format: ColorFormat, a: [u32; 4], b: [u32; 4]) -> bool {
    format.channels().into_iter().enumerate().all(|(i, kind)| match kind {
        ChannelKind::Float(layout) => a[i] == b[i] || (layout.is_nan(a[i]) && layout.is_nan(b[i])),
        _ => a[i] == b[i],
    })
}

/// Random states and inputs of a class until `channels` channels were compared.
fn sweep(formats: &[&str], channels: u64, seed: u64) -> Counts {
    const TEXELS: usize = 64;
    let counts = Counts::default();
    let stored = |name: &&str| {
        let format = ColorFormat::from_name(name).expect("a listed format");
        format.channels().iter().filter(|kind| **kind != ChannelKind::Absent).count() as u64
    };
    let lines = channels.div_ceil(formats.iter().map(stored).sum::<u64>() * TEXELS as u64);
    (0..lines).into_par_iter().for_each(|i| {
        for (j, name) in formats.iter().enumerate() {
            let format = ColorFormat::from_name(name).expect("a listed format");
            let line = Generator::new(seed ^ (i << 8) ^ j as u64).line(format, TEXELS);
            (0..line.len()).for_each(|texel| compare(&line.inputs(texel), &counts));
        }
    });
    counts
}

#[test]
fn exact_agrees_with_the_oracle_on_a_sample_of_every_class() {
    for (class, formats) in CLASSES {
        let counts = sweep(formats, 20_000, 1);
        assert!(counts.channels.into_inner() >= 20_000, "{class}: the sample is as large as it says");
    }
}

#[test]
fn every_format_is_sampled() {
    for (name, _) in FORMATS {
        sweep(&[name], 2_000, 2);
    }
}

#[test]
fn the_rational_path_agrees_with_the_fast_one() {
    for (name, _) in FORMATS {
        let format = ColorFormat::from_name(name).expect("a listed format");
        let line = Generator::new(3).line(format, 300);
        for (texel, rounding) in (0..line.len()).flat_map(|texel| ROUNDINGS.map(|rounding| (texel, rounding))) {
            let inputs = line.inputs(texel);
            let exact = Exact { rounding };
            let (fast, slow) = (exact.merge_color(&inputs), exact.merge_color_rational(&inputs));
            assert!(same(format, fast, slow), "{name}: {fast:x?}, {slow:x?}\n{inputs:?}");
        }
    }
}

#[test]
fn values_on_a_threshold_are_stored_as_the_rounding_says() {
    thresholds::kept();
    thresholds::ties();
}

#[test]
fn over_is_exact_for_all_8_bit_codes() {
    over::straight();
    over::premultiplied();
}

#[test]
#[ignore = "10 million inputs a class take minutes; the command is at the top of this file"]
fn exact_agrees_with_the_oracle_on_ten_million_inputs_of_every_class() {
    for (class, formats) in CLASSES {
        let start = std::time::Instant::now();
        let counts = sweep(formats, 10_000_000, 100);
        let (channels, fallbacks) = (counts.channels.into_inner(), counts.fallbacks.into_inner());
        println!(
            "{class:16} {channels:>9} inputs, 0 mismatches, {fallbacks} texels by rational arithmetic, {:.0} s",
            start.elapsed().as_secs_f64()
        );
        assert!(channels >= 10_000_000, "{class}: as many as promised");
    }
}
