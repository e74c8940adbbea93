//! Blending off, write mask, order of fragments. Sources: V, *Color Write Mask*, *Rasterization Order*; D 17.15.

use outmerge::format::Codes;
use outmerge::fragment::Fragment;
use outmerge::merger::Merger;
use outmerge::model::{ColorInputs, registry};
use outmerge::state::MergerState;
use outmerge::target::{Extent, Framebuffer};
use wgpu_types::{BlendFactor as F, BlendState, ColorTargetState, ColorWrites};

use crate::texel::{add, covering, exact, format, model, texel};

/// One texel of a masked target after some fragments.
fn merged(name: &str, blend: Option<BlendState>, write_mask: ColorWrites, before: Codes, colors: &[[f32; 4]]) -> Codes {
    let state = MergerState::single(ColorTargetState { format: format(name).texture_format(), blend, write_mask });
    let mut targets = Framebuffer::for_state(Extent::new(1, 1).expect("a texel"), &state).expect("targets");
    targets.colors[0].as_mut().expect("target 0").fill(before);
    let model = model("exact");
    let merger = Merger::new(&state, &*model, &targets).expect("a merger");
    for color in colors {
        merger.merge(&Fragment::new(*color), 0, 0, &mut targets);
    }
    targets.colors[0].as_ref().expect("target 0").codes(0, 0, 0)
}

#[test]
fn blending_off_stores_the_source_and_reads_no_destination() {
    for (name, _) in outmerge::format::layout::FORMATS {
        let src = [0.25, 0.5, 0.75, 0.125];
        for model in covering(registry::every_generation(), &texel(name)) {
            let one = model.merge_color(&ColorInputs { src, ..texel(name) });
            let dst = one.map(|code| code >> 1);
            let other = model.merge_color(&ColorInputs { src, dst, ..texel(name) });
            assert_eq!(one, other, "{} on {name}: the destination does not show", model.name());
        }
    }
}

#[test]
fn mask_bits_are_red_1_green_2_blue_4_alpha_8() {
    for bits in 0..16 {
        let mask = ColorWrites::from_bits(bits).expect("four bits");
        let after = merged("rgba8unorm", None, mask, [7; 4], &[[1.0; 4]]);
        let expected = std::array::from_fn(|i| if bits >> i & 1 == 1 { 255 } else { 7 });
        assert_eq!(after, expected, "mask {bits}");
    }
}

#[test]
fn the_mask_names_channels_not_bytes() {
    let after = merged("bgra8unorm", None, ColorWrites::RED, [0; 4], &[[1.0; 4]]);
    assert_eq!(after, [255, 0, 0, 0], "red, which BGRA stores third");
}

#[test]
fn masked_channels_keep_their_bits_not_just_their_value() {
    let spare = merged("rgba8snorm", add(F::One, F::One), ColorWrites::GREEN, [0x80; 4], &[[1.0; 4]]);
    assert_eq!([spare[0], spare[2], spare[3]], [0x80; 3], "snorm's spare -1 is not rewritten as -127");
    let payload = 0x7e55;
    let nan = merged("rgba16float", add(F::One, F::One), ColorWrites::GREEN, [payload; 4], &[[1.0; 4]]);
    assert_eq!([nan[0], nan[2], nan[3]], [payload; 3], "a NaN keeps its payload");
}

#[test]
fn masked_channels_still_feed_factors() {
    // D 17.15: the mask hides nothing from the factors.
    let blend = add(F::DstAlpha, F::Zero);
    let after = merged("rgba8unorm", blend, ColorWrites::RED, [0, 0, 0, 128], &[[1.0; 4]]);
    assert_eq!(after, [128, 0, 0, 128], "1 x 128/255 in red, alpha untouched");
}

#[test]
fn the_mask_comes_after_the_blend_and_the_conversion() {
    let blend = add(F::SrcAlpha, F::OneMinusSrcAlpha);
    let case = ColorInputs { blend, src: [1.0, 0.5, 0.25, 0.5], dst: [9, 99, 199, 255], ..texel("rgba8unorm-srgb") };
    let all = exact(&case);
    let masked = merged("rgba8unorm-srgb", blend, ColorWrites::GREEN, case.dst, &[case.src]);
    assert_eq!(masked, [9, all[1], 199, 255], "green as without a mask");
}

#[test]
fn fragments_merge_in_primitive_order_each_complete_before_the_next() {
    let blend = add(F::SrcAlpha, F::OneMinusSrcAlpha);
    let (red, green) = ([1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.5]);
    let all = ColorWrites::ALL;
    let first = merged("rgba8unorm", blend, all, [0; 4], &[red]);
    let both = merged("rgba8unorm", blend, all, [0; 4], &[red, green]);
    assert_eq!(both, merged("rgba8unorm", blend, all, first, &[green]), "one after the other");
    assert_ne!(both, merged("rgba8unorm", blend, all, [0; 4], &[green, red]), "the order shows");
}
