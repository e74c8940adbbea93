//! sRGB targets: all 2^24 (source, destination, alpha), and what rows may be.

use outmerge::format::ColorFormat;
use outmerge::kernel::{Isa, Kernel};
use outmerge::model::{ColorInputs, NumericModel};
use rayon::prelude::*;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites, TextureFormat};

use super::{Bytes, equation, instruction_sets, model};

/// Encodes of `llvmpipe` depend on the processor, and on nothing else that generations differ in.
const MODELS: &[&str] = &[
    "exact",
    "f32",
    "llvmpipe:rsqrt=intel-xeon",
    "llvmpipe:rsqrt=amd-zen5",
    #[cfg(target_arch = "x86_64")]
    "llvmpipe:rsqrt=host",
];

fn target(format: TextureFormat, blend: BlendState, write_mask: ColorWrites) -> ColorTargetState {
    ColorTargetState { format, blend: Some(blend), write_mask }
}

/// The reference, on bytes in the target's order.
fn reference(model: &dyn NumericModel, target: &ColorTargetState, src: [u8; 4], dst: [u8; 4]) -> [u8; 4] {
    let format = ColorFormat::new(target.format).expect("a color format");
    let mut rgba = src;
    if target.format == TextureFormat::Bgra8UnormSrgb {
        rgba.swap(0, 2);
    }
    let before = format.unpack(&dst);
    let inputs = ColorInputs {
        format,
        blend: target.blend,
        constant: [0.0; 4],
        src: rgba.map(|code| f32::from(code) / 255.0),
        src1: [0.0; 4],
        dst: before,
    };
    let merged = model.merge_color(&inputs);
    let mut out = dst;
    let written = |i: usize| target.write_mask.contains(ColorWrites::from_bits_truncate(1 << i));
    format.pack(std::array::from_fn(|i| if written(i) { merged[i] } else { before[i] }), &mut out);
    out
}

fn texel(bytes: &[u8], at: usize) -> [u8; 4] {
    [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]
}

/// Every source, destination and alpha, three destinations a texel.
fn exhaustive(name: &str, blend: BlendState) {
    let model = model(name);
    let target = target(TextureFormat::Rgba8UnormSrgb, blend, ColorWrites::ALL);
    let kernel = Kernel::new(&target, [0.0; 4], &*model).expect("a kernel");
    (0..=255_u8).into_par_iter().for_each(|alpha| {
        let (mut src, mut before) = (Vec::new(), Vec::new());
        for s in 0..=255_u8 {
            for d in (0..=255_u8).step_by(3) {
                src.extend([s, s, s, alpha]);
                before.extend([d, d.saturating_add(1), d.saturating_add(2), s]);
            }
        }
        let mut expected = Vec::with_capacity(before.len());
        for at in (0..before.len()).step_by(4) {
            expected.extend(reference(&*model, &target, texel(&src, at), texel(&before, at)));
        }
        for isa in instruction_sets() {
            let mut dst = before.clone();
            kernel.merge_row_on(isa, &src, None, None, &mut dst);
            for at in (0..dst.len()).step_by(4) {
                let (s, d) = (texel(&src, at), texel(&before, at));
                assert_eq!(texel(&dst, at), texel(&expected, at), "{name} on {isa:?}, {blend:?}: {s:?} on {d:?}");
            }
        }
    });
}

#[test]
fn every_source_destination_and_alpha_of_straight_over() {
    MODELS.iter().for_each(|name| exhaustive(name, BlendState::ALPHA_BLENDING));
}

#[test]
fn every_source_destination_and_alpha_of_premultiplied_over() {
    MODELS.iter().for_each(|name| exhaustive(name, BlendState::PREMULTIPLIED_ALPHA_BLENDING));
}

#[test]
fn byte_orders_write_masks_additive_states_and_texels_that_are_not_kept() {
    let additive = equation(F::SrcAlpha, F::One, Op::Add);
    let same = equation(F::SrcAlpha, F::OneMinusSrcAlpha, Op::Add);
    for name in MODELS {
        let model = model(name);
        for format in [TextureFormat::Rgba8UnormSrgb, TextureFormat::Bgra8UnormSrgb] {
            for (mask, texels) in (0..16).zip([0, 1, 7, 8, 9, 15, 16, 17, 31, 32, 33, 100, 203, 5, 6, 4099]) {
                for blend in [
                    BlendState { color: additive, alpha: equation(F::One, F::One, Op::Add) },
                    BlendState { color: same, alpha: same },
                ] {
                    let target = target(format, blend, ColorWrites::from_bits_truncate(mask));
                    let kernel = Kernel::new(&target, [0.0; 4], &*model).expect("a kernel");
                    let mut bytes = Bytes(u64::from(mask));
                    let (src, before) = (bytes.fill(4 * texels), bytes.fill(4 * texels));
                    let keep: Vec<u8> = (0..texels).map(|i| if i % 3 == 0 { 0 } else { 255 }).collect();
                    for (isa, keep) in instruction_sets().into_iter().flat_map(|isa| [(isa, None), (isa, Some(&keep))])
                    {
                        let mut dst = before.clone();
                        kernel.merge_row_on(isa, &src, None, keep.map(Vec::as_slice), &mut dst);
                        for at in (0..dst.len()).step_by(4) {
                            let (s, d) = (texel(&src, at), texel(&before, at));
                            let kept = keep.is_none_or(|keep| keep[at / 4] != 0);
                            let expected = if kept { reference(&*model, &target, s, d) } else { d };
                            assert_eq!(texel(&dst, at), expected, "{name} on {isa:?}, {target:?}: {s:?} on {d:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn other_states_have_no_kernel() {
    let blend = BlendState { color: equation(F::Dst, F::Zero, Op::Add), alpha: equation(F::One, F::Zero, Op::Add) };
    let target = target(TextureFormat::Rgba8UnormSrgb, blend, ColorWrites::ALL);
    assert!(Kernel::new(&target, [0.0; 4], &*model("exact")).is_none(), "multiply");
    assert!(Isa::Baseline.available(), "every machine has the plain loops");
}
