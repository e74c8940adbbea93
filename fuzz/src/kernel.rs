//! Rows of arbitrary codes, and of arbitrary numbers in planes: every kernel there is stores what the reference stores, on
//! every instruction set, wherever a row is cut.

use outmerge::format::ColorFormat;
use outmerge::kernel::{Colors, Isa, Kernel, Span, SpanMerger};
use outmerge::merger::{Merger, write_mask};
use outmerge::model::{ColorInputs, NumericModel};
use outmerge::state::spelling::{blend_factors, blend_operations};
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{BlendComponent, BlendState, ColorTargetState, ColorWrites, TextureFormat};

use super::case::models;
use super::input::Input;

/// Longer than the widest vector, with a rest.
const MAX_TEXELS: usize = 75;

pub fn check(data: &[u8]) {
    let mut input = Input::new(data);
    let target = target(&mut input);
    let format = ColorFormat::new(target.format).expect("a color format");
    let constant = input.color();
    let count = 1 + usize::from(input.byte()) % MAX_TEXELS;
    let row = |input: &mut Input| -> Vec<[u8; 4]> { (0..count).map(|_| input.array()).collect() };
    let (src, src1, dst) = (row(&mut input), row(&mut input), row(&mut input));
    let keep: Option<Vec<u8>> = input.bool().then(|| (0..count).map(|_| if input.bool() { 255 } else { 0 }).collect());
    // A row from its middle on, so that no address is aligned.
    let start = usize::from(input.byte()) % count;
    let numbers: [Vec<f32>; 8] = std::array::from_fn(|_| (0..count).map(|_| input.number()).collect());
    for model in models() {
        spans(&target, constant, &numbers, &dst, keep.as_deref(), model.as_ref());
        let Some(kernel) = Kernel::new(&target, constant, model.as_ref()) else { continue };
        let expected: Vec<[u8; 4]> = (0..count)
            .map(|i| {
                if i < start || keep.as_ref().is_some_and(|keep| keep[i] == 0) {
                    return dst[i];
                }
                let color = |texel: [u8; 4]| format.unpack(&texel).map(code_value);
                let inputs = ColorInputs {
                    format,
                    blend: target.blend,
                    constant,
                    src: color(src[i]),
                    src1: color(src1[i]),
                    dst: format.unpack(&dst[i]),
                };
                let codes = write_mask::select(target.write_mask, inputs.dst, model.merge_color(&inputs));
                let mut texel = [0; 4];
                format.pack(codes, &mut texel);
                texel
            })
            .collect();
        for isa in Isa::ALL.into_iter().filter(|isa| isa.available()) {
            let mut got = dst.concat();
            let from = |texels: &[[u8; 4]]| texels[start..].concat();
            let second = kernel.reads_second_source().then(|| from(&src1));
            let keep = keep.as_ref().map(|keep| &keep[start..]);
            kernel.merge_row_on(isa, &from(&src), second.as_deref(), keep, &mut got[4 * start..]);
            assert_eq!(got, expected.concat(), "{} on {isa:?}: {target:?}, constant {constant:?}", model.name());
        }
    }
}

/// Numbers in planes, as a span: source, then second source.
fn spans(
    target: &ColorTargetState,
    constant: [f32; 4],
    numbers: &[Vec<f32>; 8],
    before: &[[u8; 4]],
    keep: Option<&[u8]>,
    model: &dyn NumericModel,
) {
    let mut state = MergerState { targets: vec![Some(target.clone())], ..MergerState::default() };
    state.dynamic.blend_constant = constant;
    let extent = Extent::new(u32::try_from(before.len()).expect("a short row"), 1).expect("a size");
    let mut initial = Framebuffer::for_state(extent, &state).expect("memory");
    initial.colors[0].as_mut().expect("a target").bytes_mut().copy_from_slice(&before.concat());
    let Ok(merger) = Merger::new(&state, model, &initial) else { return };
    let mut expected = initial.clone();
    for x in 0..before.len() {
        let color = |first: usize| std::array::from_fn(|i| numbers[first + i][x]);
        let discarded = keep.is_some_and(|keep| keep[x] == 0);
        let fragment = Fragment { src1: color(4), discarded, ..Fragment::new(color(0)) };
        merger.merge(&fragment, u32::try_from(x).expect("a short row"), 0, &mut expected);
    }
    let planes = |first: usize| Colors::Planes(std::array::from_fn(|i| &numbers[first + i][..]));
    for isa in Isa::ALL.into_iter().filter(|isa| isa.available()) {
        let mut got = initial.clone();
        let colors = [planes(0)];
        let span = Span { src1: Some(planes(4)), keep, ..Span::new(0, 0, &colors) };
        SpanMerger::new(&state, model, &got).expect("as the merger").merge_on(isa, &span, &mut got);
        assert!(got == expected, "{} on {isa:?}: {target:?}, {constant:?}, {numbers:?}", model.name());
    }
}

/// The shader output that an 8-bit code stands for.
fn code_value(code: u32) -> f32 {
    u8::try_from(code).map_or(1.0, f32::from) / 255.0
}

fn component(input: &mut Input) -> BlendComponent {
    let factors: Vec<_> = blend_factors().collect();
    let operations: Vec<_> = blend_operations().collect();
    BlendComponent {
        src_factor: input.pick(&factors),
        dst_factor: input.pick(&factors),
        operation: input.pick(&operations),
    }
}

fn target(input: &mut Input) -> ColorTargetState {
    let format = input.pick(&[TextureFormat::Rgba8Unorm, TextureFormat::Bgra8Unorm]);
    let color = component(input);
    let alpha = if input.bool() { color } else { component(input) };
    let mask = input.byte();
    let write_mask = if mask < 128 { ColorWrites::ALL } else { ColorWrites::from_bits_truncate(u32::from(mask)) };
    let blend = (input.byte() >= 16).then_some(BlendState { color, alpha });
    ColorTargetState { format, blend, write_mask }
}
