//! All 2^24 (source, destination, source alpha) of the states that need no more.

use outmerge::kernel::Isa;
use rayon::prelude::*;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState};

use super::{MODELS, equation, kernel, model, reference, target};

/// States whose color depends on source, destination and at most the source's alpha.
fn states() -> Vec<(&'static str, BlendState)> {
    let both = |src, dst, op| BlendState { color: equation(src, dst, op), alpha: equation(src, dst, op) };
    vec![
        ("over, straight", BlendState::ALPHA_BLENDING),
        ("over, premultiplied", BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        ("additive by alpha", both(F::SrcAlpha, F::One, Op::Add)),
        ("multiply", both(F::Dst, F::Zero, Op::Add)),
        ("screen", both(F::OneMinusDst, F::One, Op::Add)),
        ("subtract", both(F::SrcAlpha, F::One, Op::ReverseSubtract)),
    ]
}

#[test]
fn every_source_destination_and_alpha_of_the_common_states() {
    for name in MODELS {
        let model = model(name);
        for (state, blend) in states() {
            let target = target(Some(blend));
            let kernel = kernel(&target, [0.0; 4], name);
            (0..=255_u8).into_par_iter().for_each(|alpha| {
                // Three destinations a texel; alpha's own destination runs along with the source.
                let (mut src, mut dst) = (Vec::new(), Vec::new());
                for s in 0..=255_u8 {
                    for d in (0..=255_u8).step_by(3) {
                        src.extend([s, s, s, alpha]);
                        dst.extend([d, d.saturating_add(1), d.saturating_add(2), s]);
                    }
                }
                let before = dst.clone();
                kernel.merge_row_on(Isa::best(), &src, None, None, &mut dst);
                let texel = |bytes: &[u8], at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
                for at in (0..dst.len()).step_by(4) {
                    let (s, d) = (texel(&src, at), texel(&before, at));
                    let expected = reference(&*model, &target, [0.0; 4], [s, [0; 4], d]);
                    assert_eq!(texel(&dst, at), expected, "{name}, {state}: {s:?} on {d:?}");
                }
            });
        }
    }
}
