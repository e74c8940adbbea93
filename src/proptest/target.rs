//! Destinations: stored codes by channel and format, filled framebuffers, and what the blender sees of a texel.

use ::proptest::collection::vec;
use ::proptest::prelude::*;
use wgpu_types::BlendState;

use super::{number, state};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, Rounding};
use crate::model::ColorInputs;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// A stored code: 0, the largest, its neighbours and anything; in float channels numbers in `[0, 2)` as often as any
/// bit pattern, NaN and Inf among them.
pub fn code(kind: ChannelKind) -> BoxedStrategy<u32> {
    let top = match kind {
        ChannelKind::Absent => return Just(0).boxed(),
        _ => u32::MAX >> (32 - kind.bits()),
    };
    let any_code =
        prop_oneof![2 => 0..=top, 1 => Just(top), 1 => Just(top / 2), 1 => Just(top / 2 + 1), 1 => 0..=3.min(top)];
    match kind {
        ChannelKind::Float(layout) => prop_oneof![
            1 => number::dyadic().prop_map(move |x| layout.encode(f64::from(x), Rounding::NearestEven)),
            1 => (0.0..2.0_f64).prop_map(move |x| layout.encode(x, Rounding::NearestEven)),
            1 => any_code,
            1 => prop_oneof![
                Just(layout.sign()),
                Just(layout.infinity()),
                Just(layout.sign() | layout.infinity()),
                Just(layout.nan()),
                // A signalling NaN with a payload.
                Just(layout.infinity() | 1),
                Just(layout.max_finite()),
                Just(1),
            ],
        ]
        .boxed(),
        _ => any_code.boxed(),
    }
}

/// The codes of one texel.
pub fn codes(format: ColorFormat) -> BoxedStrategy<Codes> {
    let [r, g, b, a] = format.channels().map(code);
    (r, g, b, a).prop_map(|(r, g, b, a)| [r, g, b, a]).boxed()
}

/// The codes of one texel, without NaN and infinities.
pub fn finite_codes(format: ColorFormat) -> BoxedStrategy<Codes> {
    let finite = move |codes: &Codes| {
        codes.iter().zip(format.channels()).all(|(code, kind)| match kind {
            ChannelKind::Float(layout) => layout.decode(*code).is_finite(),
            _ => true,
        })
    };
    codes(format).prop_filter("finite destination", finite).boxed()
}

/// What the blender sees of a texel, in any blend state or with blending off.
pub fn color_inputs(format: ColorFormat) -> BoxedStrategy<ColorInputs> {
    state::blend().prop_flat_map(move |blend| color_inputs_with(format, blend)).boxed()
}

/// What the blender sees of a texel in a given blend state.
pub fn color_inputs_with(format: ColorFormat, blend: Option<BlendState>) -> BoxedStrategy<ColorInputs> {
    let color = || number::color(format);
    gathered(format, blend, color(), color(), color(), codes(format))
}

/// The same with finite numbers everywhere.
pub fn finite_color_inputs_with(format: ColorFormat, blend: Option<BlendState>) -> BoxedStrategy<ColorInputs> {
    let color = || number::finite_color(format);
    gathered(format, blend, color(), color(), color(), finite_codes(format))
}

fn gathered(
    format: ColorFormat,
    blend: Option<BlendState>,
    src: BoxedStrategy<[f32; 4]>,
    src1: BoxedStrategy<[f32; 4]>,
    constant: BoxedStrategy<[f32; 4]>,
    dst: BoxedStrategy<Codes>,
) -> BoxedStrategy<ColorInputs> {
    (src, src1, constant, dst)
        .prop_map(move |(src, src1, constant, dst)| ColorInputs { format, blend, constant, src, src1, dst })
        .boxed()
}

/// A stored depth code: the ends and anything a test can have written, in `[0, 1]`.
pub fn depth_code(kind: DepthKind) -> BoxedStrategy<u32> {
    number::depth(Some(kind)).prop_map(move |z| kind.encode(z, [0.0, 1.0])).boxed()
}

/// Every attachment a state names, with any contents.
///
/// # Panics
/// When the state names a format without that role; states from [`super::state`] do not.
pub fn framebuffer(state: &MergerState, extent: Extent) -> BoxedStrategy<Framebuffer> {
    let empty = Framebuffer::for_state(extent, state).expect("strategies name formats of the right role");
    let total = extent.sample_total();
    let texels: Vec<_> = empty.colors.iter().flatten().map(|target| vec(codes(target.format()), total)).collect();
    let depth_format = empty.depth_stencil.as_ref().map(crate::target::DepthStencilTarget::format);
    let depth = match depth_format.and_then(crate::format::DepthFormat::depth) {
        Some(kind) => vec(depth_code(kind), total).boxed(),
        None => Just(Vec::new()).boxed(),
    };
    let stencil = vec(any::<u8>(), if depth_format.is_some_and(|format| format.has_stencil()) { total } else { 0 });
    (texels, depth, stencil)
        .prop_map(move |(texels, depth, stencil)| {
            let mut filled = empty.clone();
            for (target, texels) in filled.colors.iter_mut().flatten().zip(texels) {
                let (format, each) = (target.format(), target.format().bytes_per_texel());
                for (codes, bytes) in texels.into_iter().zip(target.bytes_mut().chunks_exact_mut(each)) {
                    format.pack(codes, bytes);
                }
            }
            if let Some(target) = &mut filled.depth_stencil {
                target.depth_mut().copy_from_slice(&depth);
                target.stencil_mut().copy_from_slice(&stencil);
            }
            filled
        })
        .boxed()
}
