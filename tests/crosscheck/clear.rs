//! `LoadOp::Clear` stores what the driver's model says, which is not always what a fragment of that color stores.

use outmerge::crosscheck::clear::{clear, clear_depth};
use outmerge::format::ColorFormat;
use outmerge::format::depth::DepthKind;
use outmerge::format::layout::FORMATS;
use outmerge::model::llvmpipe::generation::Clear;
use outmerge::model::{ColorInputs, NumericModel};

use wgpu_types::TextureFormat;

use crate::harness::{llvmpipe, model};

/// Codes and half codes of every width with the numbers next to them, special values, and random ones. No signalling NaN:
/// wgpu takes clear colors in binary64, and narrowing makes them quiet.
fn values() -> Vec<f32> {
    let mut values = vec![f32::NAN, -f32::NAN, f32::from_bits(0x7fd2_3456), f32::INFINITY, f32::NEG_INFINITY];
    values.extend([
        -0.0, 1e-45, 1e-40, 6e-8, 3e-8, 1e-5, 2.0, -2.0, 64512.0, 65024.0, 65504.0, 65519.0, 65520.0, 65536.0,
    ]);
    values.extend([1e5, 3e38, -3e38]);
    let mut random = fastrand::Rng::with_seed(11);
    for steps in [1_u16, 3, 127, 255, 1023, 32767, 65535] {
        for _ in 0..200 {
            let code = f64::from(random.u16(0..steps));
            for number in [code, code + 0.5] {
                #[expect(clippy::cast_possible_truncation, reason = "the nearest number, and then its neighbours")]
                let near = (number / f64::from(steps)) as f32;
                values.extend([near.next_down(), near, near.next_up(), -near]);
            }
        }
    }
    for _ in 0..1000 {
        values.extend([random.f32(), random.f32() * 4.0 - 2.0]);
        values.push(Some(f32::from_bits(random.u32(..))).filter(|x| !x.is_nan()).unwrap_or(0.0));
    }
    values
}

#[test]
fn clears_of_every_format_store_the_models_codes() {
    let Some(device) = llvmpipe() else { return };
    let values = values();
    // A different value in each channel.
    let color = |k: usize| std::array::from_fn(|i| values[(k + 17 * i) % values.len()]);
    let colors: Vec<[f32; 4]> = (0..values.len()).map(color).collect();
    let wide: Vec<[f64; 4]> = colors.iter().map(|color| color.map(f64::from)).collect();
    let model = model(device);
    let mut unlike_fragments = Vec::new();
    for (name, texture_format) in FORMATS {
        let format = ColorFormat::new(texture_format).expect("listed");
        if !device.renders(texture_format) {
            continue;
        }
        let stored = clear(device, format, &wide).unwrap_or_else(|error| panic!("{name}: {error}"));
        for (color, codes) in colors.iter().zip(&stored) {
            assert_eq!(model.clear_color(format, *color), *codes, "{name} cleared to {color:?}");
        }
        let zeros = [0.0; 4];
        let drawn = |src: &[f32; 4]| {
            model.merge_color(&ColorInputs {
                format,
                blend: None,
                constant: zeros,
                src: *src,
                src1: zeros,
                dst: [0; 4],
            })
        };
        if colors.iter().zip(&stored).any(|(color, codes)| drawn(color) != *codes) {
            unlike_fragments.push(name);
        }
    }
    // Once halves go to even, a 16-bit unorm clear is what a fragment stores.
    let halves_away = model.generation.rules().clear == Clear::HalvesAway;
    assert_eq!(unlike_fragments.contains(&"rgba16unorm"), halves_away, "{unlike_fragments:?}");
    for name in ["rgba8unorm-srgb", "rgba8snorm", "rgb10a2unorm", "rg11b10ufloat"] {
        assert!(unlike_fragments.contains(&name), "{name}: a clear stores what a fragment does; {unlike_fragments:?}");
    }
    assert!(!unlike_fragments.contains(&"rgba8unorm"), "8-bit unorm: a clear stores what a fragment does");
}

#[test]
fn clears_of_every_depth_format_store_the_models_codes() {
    let Some(device) = llvmpipe() else { return };
    let mut values: Vec<f32> = values().into_iter().filter(|z| (0.0..=1.0).contains(z)).step_by(7).collect();
    values.extend([0.0, -0.0, 1.0, 1.0_f32.next_down(), 0.5, 0.25, f32::from_bits(1), f32::MIN_POSITIVE.next_down()]);
    let mut random = fastrand::Rng::with_seed(12);
    for steps in [65535_u32, 16_777_215] {
        for _ in 0..100 {
            let number = (f64::from(random.u32(0..steps)) + 0.5) / f64::from(steps);
            #[expect(clippy::cast_possible_truncation, reason = "the nearest number, and then its neighbours")]
            let near = number as f32;
            values.extend([near.next_down(), near, near.next_up()]);
        }
    }
    let model = model(device);
    for (format, kind) in [
        (TextureFormat::Depth16Unorm, DepthKind::Unorm(16)),
        (TextureFormat::Depth24Plus, DepthKind::Unorm(24)),
        (TextureFormat::Depth32Float, DepthKind::Float32),
    ] {
        let stored = clear_depth(device, format, &values).unwrap_or_else(|error| panic!("{format:?}: {error}"));
        assert_eq!(stored.len(), values.len(), "a code each");
        // The last two codes of 24 bits load alike, see the read-back.
        let known = |code: u32| if kind == DepthKind::Unorm(24) { code.min(16_777_214) } else { code };
        for (z, code) in values.iter().zip(&stored) {
            assert_eq!(known(model.clear_depth(kind, *z)), known(*code), "{format:?} cleared to {z:e}");
        }
    }
}
