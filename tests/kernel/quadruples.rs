//! The arithmetic of 8-bit rows on every input it can have, against the models.
//!
//! A channel's code depends on four codes: source, its factor, destination, its factor. Here all 2^32 of them are merged:
//! the source's factor is the second source, the destination's the blend constant, one draw a constant. Every other state
//! only chooses which codes these are, which `states` and `exhaustive` compare. The sweep has its own command:
//! `cargo test --release --all-features --test kernel -- --ignored --nocapture`.

use std::time::Instant;

use outmerge::kernel::Isa;
use rayon::prelude::*;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState};

use super::{MODELS, equation, instruction_sets, kernel, model, reference, target};

/// Rows of 2^14 texels: every source, factor and destination, one in each channel.
const ROWS: u32 = 1 << 8;

/// Source, second source and destination of texel `i` of a row: four of the 2^24 triples.
fn triples(row: u32, i: u32) -> [[u8; 4]; 3] {
    let numbers = [0, 1, 2, 3].map(|channel| (row << 16 | i << 2 | channel).to_le_bytes());
    [0, 1, 2].map(|part| numbers.map(|bytes| bytes[part]))
}

fn check(name: &str, operation: Op, g: u8, rows: impl ParallelIterator<Item = u32>, isas: &[Isa]) {
    let both = equation(F::Src1, F::Constant, operation);
    let alpha = equation(F::Src1Alpha, F::Constant, operation);
    let target = target(Some(BlendState { color: both, alpha }));
    let constant = [f32::from(g) / 255.0; 4];
    let model = model(name);
    let kernel = kernel(&target, constant, name);
    rows.for_each(|row| {
        let texels: Vec<[[u8; 4]; 3]> = (0..1 << 14).map(|i| triples(row, i)).collect();
        let [src, src1, dst] = [0, 1, 2].map(|part| texels.iter().flat_map(|t| t[part]).collect::<Vec<u8>>());
        let expected: Vec<u8> = texels.iter().flat_map(|texel| reference(&*model, &target, constant, *texel)).collect();
        for isa in isas {
            let mut merged = dst.clone();
            kernel.merge_row_on(*isa, &src, Some(&src1), None, &mut merged);
            if merged != expected {
                let at = merged.iter().zip(&expected).position(|(a, b)| a != b).expect("they differ");
                let [s, f, d] = texels[at / 4].map(|codes| codes[at % 4]);
                panic!("{name}, {operation:?} on {isa:?}: {s} x {f}, {d} x {g}: {}, not {}", merged[at], expected[at]);
            }
        }
    });
}

#[test]
fn some_quadruples_of_codes_are_the_models() {
    let isas = instruction_sets();
    for name in MODELS {
        for operation in [Op::Add, Op::Subtract, Op::ReverseSubtract] {
            for g in [0, 1, 127, 128, 255] {
                check(name, operation, g, [0, 85, 128, 255].into_par_iter(), &isas);
            }
        }
    }
}

#[test]
#[ignore = "2^32 inputs, 3 operations, 4 models: half an hour or more on two cores"]
fn every_quadruple_of_codes_is_the_models() {
    let isas = instruction_sets();
    for name in MODELS {
        for operation in [Op::Add, Op::Subtract, Op::ReverseSubtract] {
            let start = Instant::now();
            (0..=255_u8).into_par_iter().for_each(|g| check(name, operation, g, (0..ROWS).into_par_iter(), &isas));
            println!(
                "{name}, {operation:?}: 2^32 inputs, {isas:?}, 0 mismatches, {:.0} s",
                start.elapsed().as_secs_f64()
            );
        }
    }
}
