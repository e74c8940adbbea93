//! One color over many texels is a row of that color, which is the reference.

use outmerge::kernel::{Isa, Kernel};
use rayon::prelude::*;
use wgpu_types::{BlendState, ColorWrites};

use super::states::components;
use super::{Bytes, MODELS, instruction_sets, kernel, target};

/// Every code in every channel, and a few texels more than any vector holds.
fn destinations() -> Vec<u8> {
    (0..=255_u8).chain(0..=20).flat_map(|code| [code, code.wrapping_add(85), !code, code ^ 0x55]).collect()
}

fn check(kernel: &Kernel, isa: Isa, color: [u8; 4], dst: &[u8], what: &str) {
    let (mut row, mut flat) = (dst.to_vec(), dst.to_vec());
    kernel.merge_row_on(isa, &color.repeat(dst.len() / 4), None, None, &mut row);
    kernel.merge_color_on(isa, color, &mut flat);
    assert!(flat == row, "{what}, {isa:?}, color {color:?}");
}

#[test]
fn every_color_alpha_and_destination_of_over() {
    let dst = destinations();
    for name in MODELS {
        for (what, blend) in
            [("straight", BlendState::ALPHA_BLENDING), ("premultiplied", BlendState::PREMULTIPLIED_ALPHA_BLENDING)]
        {
            let kernel = kernel(&target(Some(blend)), [0.0; 4], name);
            for isa in instruction_sets() {
                (0..=255_u8).into_par_iter().for_each(|s| {
                    (0..=255).for_each(|a| check(&kernel, isa, [s, s, !s, a], &dst, &format!("{name}, {what}")));
                });
            }
        }
    }
}

#[test]
fn every_equation_and_some_write_masks() {
    let dst = destinations();
    let mut bytes = Bytes(3);
    for name in MODELS {
        for both in components() {
            let blend = BlendState { color: both, alpha: both };
            for mask in [ColorWrites::ALL, ColorWrites::GREEN | ColorWrites::ALPHA] {
                let mut target = target(Some(blend));
                target.write_mask = mask;
                let kernel = kernel(&target, [0.2, 0.4, 1.0, 0.6], name);
                if kernel.reads_second_source() {
                    continue;
                }
                for isa in instruction_sets() {
                    let color = [bytes.next(), bytes.next(), bytes.next(), bytes.next()];
                    check(&kernel, isa, color, &dst, &format!("{name}, {blend:?}, {mask:?}"));
                }
            }
        }
    }
}
