//! States that are the same as simpler ones.

use outmerge::format::{ChannelKind, TargetClass, snorm, srgb, unorm};
use outmerge::model::{ColorInputs, registry};
use outmerge::proptest::{number, state, target};
use outmerge::state::preset;
use proptest::prelude::*;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState};

use crate::texel::{add, covering, equation, model, narrow};

/// Inputs in any format with a blend state, without NaN and infinities.
fn finite(blend: Option<BlendState>) -> BoxedStrategy<ColorInputs> {
    state::format().prop_flat_map(move |format| target::finite_color_inputs_with(format, blend)).boxed()
}

/// Inputs in a normalised format, any numbers from the shader.
fn normalised(blend: Option<BlendState>) -> BoxedStrategy<ColorInputs> {
    let format = state::format().prop_filter("normalised", |format| format.class() != TargetClass::Float);
    format.prop_flat_map(move |format| target::color_inputs_with(format, blend)).boxed()
}

/// Codes with what a no-op may still change taken out: snorm's spare code, -0 of a float.
fn canonical(inputs: &ColorInputs, codes: [u32; 4]) -> [u32; 4] {
    std::array::from_fn(|i| match inputs.format.channels()[i] {
        ChannelKind::Snorm(bits) if codes[i] == 1 << (bits - 1) => codes[i] + 1,
        ChannelKind::Float(layout) if codes[i] == layout.sign() => 0,
        _ => codes[i],
    })
}

fn preset(name: &str) -> Option<BlendState> {
    preset::by_name(name).expect("a preset").blend
}

proptest! {
    /// `Blend Zero One` leaves the target's bytes untouched. Two codes are not kept but rewritten as the equal number they
    /// stand for: snorm's spare -1, and -0 on float targets (0 x s + -0 = +0). Infinite sources are another matter: see
    /// `rules::special_values`.
    #[test]
    fn zero_one_is_a_no_op(inputs in finite(add(F::Zero, F::One))) {
        for model in covering(registry::every_generation(), &inputs) {
            let name = model.name();
            // Drivers and GPUs flush denormals of 32-bit floats; the numbers are equal after the flush.
            let driver = ["llvmpipe", "swiftshader", "nvidia"].iter().any(|driver| name.starts_with(driver));
            if driver && inputs.format.class() == TargetClass::Float { continue }
            // binary16 blenders cannot hold 32-bit numbers, nor more than 11 bits of a 16-bit code.
            if name == "f16" && (wide(&inputs) || overflows_half(&inputs)) { continue }
            if name.starts_with("fixed") && !eight_bit(&inputs) { continue }
            let got = canonical(&inputs, model.merge_color(&inputs));
            prop_assert_eq!(got, canonical(&inputs, inputs.dst), "{}", name);
        }
    }

    /// `Blend One Zero` is blending off, on normalised targets for any numbers at all.
    #[test]
    fn one_zero_is_blending_off_on_normalised_targets(inputs in normalised(add(F::One, F::Zero))) {
        for name in ["exact", "f32", "fixed:8", "llvmpipe", "swiftshader"] {
            let model = model(name);
            if model.supports(inputs.format, inputs.blend.as_ref()).is_err() { continue }
            let off = ColorInputs { blend: None, ..inputs };
            prop_assert_eq!(model.merge_color(&inputs), model.merge_color(&off), "{}", name);
        }
    }

    /// On float targets `Blend One Zero` is blending off as far as everything is finite, -0 aside.
    #[test]
    fn one_zero_is_blending_off_on_float_targets_while_all_is_finite(inputs in finite(add(F::One, F::Zero))) {
        for name in ["exact", "f32"] {
            let model = model(name);
            let off = ColorInputs { blend: None, ..inputs };
            let (blended, off) = (model.merge_color(&inputs), model.merge_color(&off));
            prop_assert_eq!(canonical(&inputs, blended), canonical(&inputs, off), "{}", name);
        }
    }

    /// Fade and Transparent at alpha 1 are Opaque.
    #[test]
    fn fade_and_transparent_at_alpha_one_are_opaque(inputs in finite(None)) {
        let inputs = ColorInputs { src: [inputs.src[0], inputs.src[1], inputs.src[2], 1.0], ..inputs };
        for name in ["exact", "f32"] {
            let model = model(name);
            let opaque = canonical(&inputs, model.merge_color(&inputs));
            for state in ["fade", "transparent"] {
                let blended = model.merge_color(&ColorInputs { blend: preset(state), ..inputs });
                prop_assert_eq!(canonical(&inputs, blended), opaque, "{} in {}", state, name);
            }
        }
    }

    /// Fade at alpha 0 is not drawing at all.
    #[test]
    fn fade_at_alpha_zero_is_not_drawing(inputs in finite(preset("fade"))) {
        let inputs = ColorInputs { src: [inputs.src[0], inputs.src[1], inputs.src[2], 0.0], ..inputs };
        for name in ["exact", "f32"] {
            let codes = canonical(&inputs, model(name).merge_color(&inputs));
            prop_assert_eq!(codes, canonical(&inputs, inputs.dst), "{}", name);
        }
    }

    /// A premultiplied source under premultiplied over is the straight one under straight over, when the product is
    /// exact: here alpha is a power of two.
    #[test]
    fn premultiplied_over_is_straight_over_before_the_store(
        inputs in finite(None),
        exponent in -4..=0_i32,
    ) {
        let alpha = 2.0_f32.powi(exponent);
        let [r, g, b, _] = inputs.src.map(|x| x.clamp(0.0, 1.0).max(2.0_f32.powi(-20)));
        let straight = ColorInputs { blend: preset("alpha-blending"), src: [r, g, b, alpha], ..inputs };
        let premultiplied =
            ColorInputs { blend: preset("transparent"), src: [r * alpha, g * alpha, b * alpha, alpha], ..inputs };
        let model = model("exact");
        prop_assert_eq!(model.merge_color(&straight), model.merge_color(&premultiplied));
    }

    /// Min and max ignore their factors.
    #[test]
    fn min_and_max_ignore_factors(
        inputs in finite(None),
        op in prop::sample::select(vec![Op::Min, Op::Max]),
        (src, dst) in (state::single_source_factor(), state::single_source_factor()),
    ) {
        for model in registry::every_generation() {
            let plain = ColorInputs { blend: equation(F::One, F::One, op), ..inputs };
            let with_factors = ColorInputs { blend: equation(src, dst, op), ..inputs };
            if model.supports(inputs.format, plain.blend.as_ref()).is_err() { continue }
            prop_assert_eq!(model.merge_color(&plain), model.merge_color(&with_factors), "{}", model.name());
        }
    }

    /// A source equal to the destination, as nearly as binary32 can say, stays under over: a fixed point, for any alpha in
    /// [0, 1] and every format.
    #[test]
    fn over_of_the_destination_on_itself_is_a_fixed_point(
        (format, codes) in state::format().prop_flat_map(|format| (Just(format), target::finite_codes(format))),
        alpha in number::unit_color(),
    ) {
        let kinds = format.channels();
        let src: [f32; 3] = std::array::from_fn(|i| match kinds[i] {
            ChannelKind::Absent => 0.0,
            ChannelKind::Unorm(bits) => narrow(f64::from(codes[i]) / f64::from(unorm::steps(bits))),
            ChannelKind::Snorm(bits) => {
                narrow(f64::from(snorm::signed_code(codes[i], bits)) / f64::from(snorm::steps(bits)))
            }
            ChannelKind::Srgb => srgb::decode_f32(codes[i]),
            ChannelKind::Float(layout) => narrow(layout.decode(codes[i])),
        });
        let inputs = ColorInputs {
            format,
            blend: preset("alpha-blending"),
            constant: [0.0; 4],
            src: [src[0], src[1], src[2], alpha[3]],
            src1: [0.0; 4],
            dst: codes,
        };
        let after = model("exact").merge_color(&inputs);
        prop_assert_eq!(&canonical(&inputs, after)[..3], &canonical(&inputs, codes)[..3]);
    }
}

/// Whether a format has numbers that binary16 cannot hold.
fn wide(inputs: &ColorInputs) -> bool {
    inputs.format.channels().iter().any(|kind| match kind {
        ChannelKind::Unorm(bits) => *bits > 8,
        ChannelKind::Snorm(bits) => *bits > 8,
        ChannelKind::Float(layout) => layout.exponent_bits > 5,
        ChannelKind::Srgb => true,
        ChannelKind::Absent => false,
    })
}

/// Whether binary16 takes in a source as infinite, so that zero times it is NaN.
fn overflows_half(inputs: &ColorInputs) -> bool {
    inputs.format.class() == TargetClass::Float && inputs.src.iter().any(|x| x.abs() >= 65_520.0)
}

/// Whether every channel is an 8-bit unorm, which is what `fixed:8` computes in.
fn eight_bit(inputs: &ColorInputs) -> bool {
    inputs.format.channels().iter().all(|kind| matches!(kind, ChannelKind::Unorm(8) | ChannelKind::Absent))
}
