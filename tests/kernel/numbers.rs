//! Sources that are any numbers, in planes, on 8-bit unorm targets: all equations, ties among the inputs. Half of the rows
//! are numbers from 0 to 1 alone, which models that quantise convert in one go.

use outmerge::format::ColorFormat;
use outmerge::kernel::{Colors, Span, SpanMerger};
use outmerge::model::ColorInputs;
use outmerge::{Extent, Framebuffer, MergerState};
use rayon::prelude::*;
use wgpu_types::{BlendComponent, BlendState, ColorTargetState, ColorWrites, TextureFormat};

use super::{Bytes, MODELS, instruction_sets, model, states};

const TEXELS: u32 = 101;

/// Numbers: codes, ties between them and their neighbours, powers of two that make sums ties, any from 0 to 1, and what
/// lies beyond.
fn number(bytes: &mut Bytes) -> f32 {
    const BEYOND: [f32; 10] = [
        f32::NAN,
        // Signalling ones, which some processors' maximum does not take for a missing number.
        f32::from_bits(0x7f80_0001),
        f32::from_bits(0xff80_0001),
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        -0.25,
        1.75,
        1e-40,
        3e38,
    ];
    let [kind, a, b, c] = std::array::from_fn(|_| bytes.next());
    let fraction = f32::from(u16::from_le_bytes([a, b])) / 65_536.0 + f32::from(c) / 16_777_216.0;
    let nudge = |x: f32| f32::from_bits(x.to_bits().saturating_add_signed(i32::from(b % 5) - 2));
    match kind % 8 {
        0 => f32::from(a) / 255.0,
        1 => nudge((2.0 * f32::from(a) + 1.0) / 510.0),
        2 => f32::from(a % 17) / 16.0,
        3 => nudge(f32::from(a) / 256.0),
        4 => BEYOND[usize::from(a) % BEYOND.len()],
        _ => fraction,
    }
}

/// Numbers of a span; `inside` leaves out what lies beyond 0 and 1.
fn planes(bytes: &mut Bytes, inside: bool) -> [Vec<f32>; 4] {
    let number = |bytes: &mut Bytes| match number(bytes) {
        x if inside && !(0.0..=1.0).contains(&x) => 0.5,
        x => x,
    };
    std::array::from_fn(|_| (0..TEXELS).map(|_| number(bytes)).collect())
}

fn check(name: &str, target: &ColorTargetState, seed: u64) {
    let mut bytes = Bytes(seed);
    let model = model(name);
    let mut state = MergerState { targets: vec![Some(target.clone())], ..MergerState::default() };
    state.dynamic.blend_constant = std::array::from_fn(|_| number(&mut bytes));
    let inside = seed.is_multiple_of(2);
    let (src, src1) = (planes(&mut bytes, inside), planes(&mut bytes, inside));
    let mut before = Framebuffer::for_state(Extent::new(TEXELS, 1).expect("a size"), &state).expect("memory");
    for byte in before.colors[0].as_mut().expect("a target").bytes_mut() {
        *byte = bytes.next();
    }
    // A target's every other texel is opaque black or white, where factors of the destination make ties.
    for (i, texel) in before.colors[0].as_mut().expect("a target").bytes_mut().chunks_exact_mut(4).enumerate() {
        if i % 2 == 0 {
            texel.iter_mut().for_each(|byte| *byte = if *byte % 2 == 0 { 0 } else { 255 });
        }
    }
    let keep: Vec<u8> = (0..TEXELS).map(|_| bytes.next() % 8).collect();
    let colors = |planes: &'_ [Vec<f32>; 4], x: u32| planes.each_ref().map(|plane| plane[x as usize]);
    let format = ColorFormat::new(target.format).expect("a color format");
    let mut expected = before.clone();
    let stored = expected.colors[0].as_mut().expect("a target");
    for x in (0..TEXELS).filter(|x| keep[*x as usize] != 0) {
        let dst = stored.codes(x, 0, 0);
        let constant = state.dynamic.blend_constant;
        let inputs =
            ColorInputs { format, blend: target.blend, constant, src: colors(&src, x), src1: colors(&src1, x), dst };
        let merged = model.merge_color(&inputs);
        let written = |i: usize| target.write_mask.contains(ColorWrites::from_bits_truncate(1 << i));
        stored.set_codes(x, 0, 0, std::array::from_fn(|i| if written(i) { merged[i] } else { dst[i] }));
    }
    for isa in instruction_sets() {
        let mut targets = before.clone();
        let mut merger = SpanMerger::new(&state, &*model, &targets).expect("a merger");
        let has_kernel = merger.kernels().all(|kernel| kernel);
        assert!(
            has_kernel || name.starts_with("llvmpipe"),
            "{name}, {target:?}: only a huge constant has none in llvmpipe"
        );
        let output = [Colors::Planes(src.each_ref().map(Vec::as_slice))];
        let second = Some(Colors::Planes(src1.each_ref().map(Vec::as_slice)));
        let span = Span { src1: second, keep: Some(&keep), ..Span::new(0, 0, &output) };
        merger.merge_on(isa, &span, &mut targets);
        for x in 0..TEXELS {
            let codes = |targets: &Framebuffer| targets.colors[0].as_ref().expect("a target").codes(x, 0, 0);
            let (at, constant) = (x as usize, state.dynamic.blend_constant);
            let inputs = || (src.each_ref().map(|p| p[at]), src1.each_ref().map(|p| p[at]), codes(&before), constant);
            assert_eq!(codes(&targets), codes(&expected), "{name} on {isa:?}: {:?}, {target:?}", inputs());
        }
    }
}

fn target(format: TextureFormat, blend: Option<BlendState>, write_mask: ColorWrites) -> ColorTargetState {
    ColorTargetState { format, blend, write_mask }
}

#[test]
fn every_equation_on_numbers_and_their_ties() {
    let components = states::components();
    for name in MODELS {
        components.par_iter().enumerate().for_each(|(i, color)| {
            let alpha: BlendComponent = components[(i * 577 + 91) % components.len()];
            let same = BlendState { color: *color, alpha: *color };
            let other = BlendState { color: *color, alpha };
            check(name, &target(TextureFormat::Rgba8Unorm, Some(same), ColorWrites::ALL), i as u64);
            check(name, &target(TextureFormat::Bgra8Unorm, Some(other), ColorWrites::ALL), !(i as u64));
        });
    }
}

#[test]
fn numbers_replace_and_masks_hold() {
    for name in MODELS {
        for mask in 0..16 {
            let mask = ColorWrites::from_bits_truncate(mask);
            for (seed, blend) in (0..40).flat_map(|seed| [(seed, None), (seed, Some(BlendState::ALPHA_BLENDING))]) {
                for format in [TextureFormat::Rgba8Unorm, TextureFormat::Bgra8Unorm] {
                    if mask != ColorWrites::empty() {
                        check(name, &target(format, blend, mask), seed);
                    }
                }
            }
        }
    }
}
