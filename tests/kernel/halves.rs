//! Half-float targets: special values against special values, ties, and any bits.

use outmerge::format::{Codes, ColorFormat};
use outmerge::kernel::{Isa, Kernel};
use outmerge::model::{ColorInputs, NumericModel};
use rayon::prelude::*;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites, TextureFormat};

use super::{Bytes, equation, instruction_sets, model};

const MODELS: [&str; 5] = ["exact", "f32", "llvmpipe:mesa=22.3", "llvmpipe:mesa=25.0", "llvmpipe:mesa=26.1"];

/// Zeros, the least and the largest subnormals and normals, ones and their neighbours, halves, NaNs and infinities.
const SPECIAL: [u16; 40] = [
    0x0000, 0x8000, 0x0001, 0x8001, 0x0002, 0x0003, 0x01ff, 0x03ff, 0x83ff, 0x0400, 0x8400, 0x0401, 0x0801, 0x1400,
    0x1401, 0x2e66, 0x3555, 0x3800, 0x3801, 0xb800, 0x39ff, 0x3bff, 0x3c00, 0xbc00, 0x3c01, 0x3e01, 0x4000, 0xc000,
    0x4201, 0x5bff, 0x7800, 0x7bff, 0xfbff, 0x7bfe, 0x7c00, 0xfc00, 0x7c01, 0x7e00, 0xfe55, 0xfd01,
];

fn states() -> Vec<(&'static str, BlendState)> {
    let additive = equation(F::SrcAlpha, F::One, Op::Add);
    let plus = equation(F::One, F::One, Op::Add);
    vec![
        ("over, straight", BlendState::ALPHA_BLENDING),
        ("over, premultiplied", BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        ("additive by alpha, plus in alpha", BlendState { color: additive, alpha: plus }),
    ]
}

fn target(blend: BlendState, write_mask: ColorWrites) -> ColorTargetState {
    ColorTargetState { format: TextureFormat::Rgba16Float, blend: Some(blend), write_mask }
}

fn bytes(texels: &[[u16; 4]]) -> Vec<u8> {
    texels.iter().flatten().flat_map(|code| code.to_le_bytes()).collect()
}

fn texels(bytes: &[u8]) -> Vec<[u16; 4]> {
    let code = |texel: &[u8], i: usize| u16::from_le_bytes([texel[2 * i], texel[2 * i + 1]]);
    bytes.chunks_exact(8).map(|texel| std::array::from_fn(|i| code(texel, i))).collect()
}

/// What the merger stores: the model's codes where written, its way with what it may not write elsewhere.
fn reference(
    model: &dyn NumericModel,
    target: &ColorTargetState,
    src: [u16; 4],
    dst: [u16; 4],
    kept: bool,
) -> [u16; 4] {
    let format = ColorFormat::new(target.format).expect("a color format");
    let wide = |codes: [u16; 4]| -> Codes { codes.map(u32::from) };
    let inputs = ColorInputs {
        format,
        blend: target.blend,
        constant: [0.0; 4],
        src: src.map(|code| half::f16::from_bits(code).to_f32()),
        src1: [0.0; 4],
        dst: wide(dst),
    };
    let (merged, left) = (model.merge_color(&inputs), model.rewrite_untouched(format, wide(dst)));
    std::array::from_fn(|i| {
        let written = kept && target.write_mask.contains(ColorWrites::from_bits_truncate(1 << i));
        u16::try_from(if written { merged[i] } else { left[i] }).expect("16-bit codes")
    })
}

/// Compares a row on every instruction set.
fn check(name: &str, target: &ColorTargetState, src: &[[u16; 4]], dst: &[[u16; 4]], keep: Option<&[u8]>) {
    let model = model(name);
    let kernel = Kernel::new(target, [0.0; 4], &*model).expect("a kernel");
    let expected: Vec<[u16; 4]> = (0..src.len())
        .into_par_iter()
        .map(|i| reference(&*model, target, src[i], dst[i], keep.is_none_or(|keep| keep[i] != 0)))
        .collect();
    for isa in instruction_sets() {
        let mut merged = bytes(dst);
        kernel.merge_row_on(isa, &bytes(src), None, keep, &mut merged);
        for (i, got) in texels(&merged).into_iter().enumerate() {
            let (s, d) = (src[i], dst[i]);
            assert_eq!(got, expected[i], "{name} on {isa:?}, texel {i}: {s:x?} on {d:x?}, {target:?}");
        }
    }
}

#[test]
fn every_special_source_alpha_and_destination() {
    let (mut src, mut dst) = (Vec::new(), Vec::new());
    for a in SPECIAL {
        for s in SPECIAL {
            for d in SPECIAL.chunks_exact(4) {
                // Three colors a texel; the fourth is alpha's destination.
                src.push([s, s, s, a]);
                dst.push([d[0], d[1], d[2], d[3]]);
                src.push([s, s, s, a]);
                dst.push([d[3], d[3], d[0], d[0]]);
            }
        }
    }
    for name in MODELS {
        for (_, blend) in states() {
            check(name, &target(blend, ColorWrites::ALL), &src, &dst, None);
        }
    }
}

/// Texels of any bits, of numbers in [0, 1] and of numbers with few bits, whose sums are often ties.
fn random(count: usize, seed: u64) -> Vec<[u16; 4]> {
    let mut bytes = Bytes(seed);
    let mut code = |kind: usize| {
        let any = u16::from_le_bytes([bytes.next(), bytes.next()]);
        match kind {
            0 => any,
            1 => any % 0x3c01,
            2 => any & 0xffc0,
            _ => 0x3800 | any & 0x7ff,
        }
    };
    (0..count).map(|i| std::array::from_fn(|_| code(i / 7 % 4))).collect()
}

#[test]
fn random_texels_ties_among_them() {
    for name in MODELS {
        for (_, blend) in states() {
            let (mut src, dst) = (random(60_000, 1), random(60_000, 2));
            // An alpha of one half makes a tie of every second sum.
            src.iter_mut().step_by(3).for_each(|texel| texel[3] = 0x3800);
            check(name, &target(blend, ColorWrites::ALL), &src, &dst, None);
        }
    }
}

#[test]
fn write_masks_and_fragments_that_are_not_kept() {
    let (src, dst) = (random(1003, 3), random(1003, 4));
    let keep: Vec<u8> = (0..1003).map(|i| if i % 3 == 0 { 0 } else { 255 }).collect();
    for name in MODELS {
        for mask in 0..16 {
            let target = target(BlendState::ALPHA_BLENDING, ColorWrites::from_bits_truncate(mask));
            check(name, &target, &src, &dst, None);
            check(name, &target, &src, &dst, Some(&keep));
        }
    }
}

#[test]
fn rows_of_any_length() {
    for count in 0..20 {
        let (src, dst) = (random(count, 5), random(count, 6));
        check("exact", &target(BlendState::ALPHA_BLENDING, ColorWrites::ALL), &src, &dst, None);
    }
}

#[test]
fn other_states_have_no_kernel() {
    for (src, dst, op) in
        [(F::Dst, F::Zero, Op::Add), (F::SrcAlpha, F::OneMinusSrcAlpha, Op::Subtract), (F::One, F::One, Op::Max)]
    {
        let blend = BlendState { color: equation(src, dst, op), alpha: equation(src, dst, op) };
        let target = target(blend, ColorWrites::ALL);
        assert!(Kernel::new(&target, [0.0; 4], &*model("exact")).is_none(), "{src:?} {dst:?} {op:?}");
    }
    assert!(Isa::Baseline.available(), "every machine has the plain loops");
}
