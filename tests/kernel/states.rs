//! All factors and operations.

use outmerge::state::spelling::{blend_factors, blend_operations};
use rayon::prelude::*;
use wgpu_types::{BlendComponent, BlendState, ColorTargetState, ColorWrites, TextureFormat};

use super::{Bytes, MODELS, equation, instruction_sets, kernel, model, reference, target};

/// An odd number of texels, so that the last block of a row is not whole.
const TEXELS: usize = 203;

/// Compares one state on random texels on every instruction set.
fn check(name: &str, target: &ColorTargetState, constant: [f32; 4], seed: u64) {
    let model = model(name);
    let kernel = kernel(target, constant, name);
    let mut bytes = Bytes(seed);
    let (src, src1, before) = (bytes.fill(4 * TEXELS), bytes.fill(4 * TEXELS), bytes.fill(4 * TEXELS));
    let swap = target.format == TextureFormat::Bgra8Unorm;
    // The reference speaks RGBA.
    let rgba = |bytes: &[u8], at: usize| {
        let mut texel = [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        if swap {
            texel.swap(0, 2);
        }
        texel
    };
    for isa in instruction_sets() {
        let mut dst = before.clone();
        kernel.merge_row_on(isa, &src, Some(&src1), None, &mut dst);
        for at in (0..dst.len()).step_by(4) {
            let inputs = [rgba(&src, at), rgba(&src1, at), rgba(&before, at)];
            let expected = reference(&*model, target, constant, inputs);
            assert_eq!(rgba(&dst, at), expected, "{name} on {isa:?}: {inputs:?}, {target:?}, {constant:?}");
        }
    }
}

pub fn components() -> Vec<BlendComponent> {
    let pairs = || blend_factors().flat_map(|src| blend_factors().map(move |dst| (src, dst)));
    blend_operations().flat_map(|op| pairs().map(move |(src, dst)| equation(src, dst, op))).collect()
}

const CONSTANT: [f32; 4] = [51.0 / 255.0, 1.0, 0.0, 200.0 / 255.0];

#[test]
fn every_factor_pair_and_operation_as_one_equation() {
    let components = components();
    assert_eq!(components.len(), 17 * 17 * 5, "every state of one equation");
    for name in MODELS {
        components.par_iter().enumerate().for_each(|(i, component)| {
            let blend = BlendState { color: *component, alpha: *component };
            check(name, &target(Some(blend)), CONSTANT, i as u64);
        });
    }
}

#[test]
fn different_equations_for_color_and_alpha() {
    let components = components();
    for name in MODELS {
        (0..600_usize).into_par_iter().for_each(|i| {
            // Steps without a common factor with 1445 meet every component in both places.
            let (color, alpha) = (components[i * 7 % components.len()], components[i * 131 % components.len()]);
            check(name, &target(Some(BlendState { color, alpha })), CONSTANT, i as u64);
        });
    }
}

#[test]
fn every_write_mask_with_and_without_blending_in_both_byte_orders() {
    for name in MODELS {
        for mask in 0..16 {
            for format in [TextureFormat::Rgba8Unorm, TextureFormat::Bgra8Unorm] {
                for blend in [None, Some(BlendState::ALPHA_BLENDING)] {
                    let write_mask = ColorWrites::from_bits_truncate(mask);
                    check(name, &ColorTargetState { format, blend, write_mask }, CONSTANT, u64::from(mask));
                }
            }
        }
    }
}

#[test]
fn constants_out_of_range_clamp() {
    use wgpu_types::{BlendFactor as F, BlendOperation as Op};
    let blend = BlendState {
        color: equation(F::Constant, F::OneMinusConstant, Op::Add),
        alpha: equation(F::OneMinusConstant, F::Constant, Op::Add),
    };
    for name in MODELS {
        for bgra in [TextureFormat::Rgba8Unorm, TextureFormat::Bgra8Unorm] {
            let target = ColorTargetState { format: bgra, ..target(Some(blend)) };
            check(name, &target, [2.0, -1.0, 0.2, f32::NAN], 9);
        }
    }
}
