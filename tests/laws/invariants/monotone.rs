//! More in gives no less out.

use outmerge::format::ChannelKind;
use outmerge::model::ColorInputs;
use outmerge::proptest::{state, target};
use outmerge::state::preset;
use proptest::prelude::*;

use crate::texel::model;

/// Whether `a` stands for a number at most that of `b`.
fn at_most(kind: ChannelKind, a: u32, b: u32) -> bool {
    match kind {
        ChannelKind::Absent => true,
        ChannelKind::Unorm(_) | ChannelKind::Srgb => a <= b,
        ChannelKind::Snorm(bits) => {
            outmerge::format::snorm::signed_code(a, bits) <= outmerge::format::snorm::signed_code(b, bits)
        }
        ChannelKind::Float(layout) => layout.decode(a) <= layout.decode(b),
    }
}

/// Finite inputs under over, with alpha in [0, 1], and a second color.
fn over() -> BoxedStrategy<(ColorInputs, [f32; 4], [u32; 4])> {
    let blend = preset::by_name("alpha-blending").expect("a preset").blend;
    state::format()
        .prop_flat_map(move |format| {
            let one = target::finite_color_inputs_with(format, blend);
            let other = target::finite_color_inputs_with(format, blend);
            (one, other, 0.0_f32..=1.0).prop_map(|(mut one, other, alpha)| {
                one.src[3] = alpha;
                (one, other.src, other.dst)
            })
        })
        .boxed()
}

proptest! {
    #[test]
    fn over_is_monotone_in_the_source((inputs, other, _) in over()) {
        let mut more = inputs;
        for (i, x) in other.into_iter().enumerate().take(3) {
            more.src[i] = inputs.src[i].max(x);
        }
        let (low, high) = (model("exact").merge_color(&inputs), model("exact").merge_color(&more));
        for (i, kind) in inputs.format.channels().into_iter().take(3).enumerate() {
            prop_assert!(at_most(kind, low[i], high[i]), "channel {}: {:?} then {:?}", i, low, high);
        }
    }

    #[test]
    fn over_is_monotone_in_the_destination((inputs, _, other) in over()) {
        let kinds = inputs.format.channels();
        let mut more = inputs;
        for (i, code) in other.into_iter().take(3).enumerate() {
            if at_most(kinds[i], inputs.dst[i], code) {
                more.dst[i] = code;
            }
        }
        let (low, high) = (model("exact").merge_color(&inputs), model("exact").merge_color(&more));
        for i in 0..3 {
            prop_assert!(at_most(kinds[i], low[i], high[i]), "channel {}: {:?} then {:?}", i, low, high);
        }
    }
}
