//! Bytes and bits travel to the device and back unchanged.

use std::io::Write as _;

use outmerge::format::layout::FORMATS;
use outmerge::{Extent, Fragment};
use wgpu_types::TextureFormat as T;

use crate::harness::{bytes, device, draw, run, single, targets};
use outmerge::crosscheck::Batch;

/// Every byte value in every place, and patterns between.
fn pattern(texel: usize) -> Vec<u8> {
    let low = u8::try_from(texel % 256).expect("below 256");
    let high = u8::try_from(texel / 256 % 256).expect("below 256");
    (0..16_u8).map(|i| low.wrapping_add(high.wrapping_mul(i)).wrapping_add(i.wrapping_mul(91))).collect()
}

#[test]
fn every_format_the_adapter_renders_round_trips_its_bytes() {
    let Some(device) = device() else { return };
    let mut not_run = Vec::new();
    for (name, format) in FORMATS {
        if !device.renders(format) {
            not_run.push(name);
            continue;
        }
        let state = single(format, None);
        let initial = targets(&state, 67, 61, pattern);
        let result = run(device, Batch { initial: initial.clone(), layers: Vec::new() });
        assert_eq!(bytes(&result), bytes(&initial), "{name}");
    }
    if !not_run.is_empty() {
        let _ =
            writeln!(std::io::stderr(), "not run, {} does not render: {}", device.report().name, not_run.join(", "));
    }
    assert!(!not_run.contains(&"rgba8unorm"), "WebGPU guarantees rgba8unorm");
}

#[test]
fn the_shader_hands_over_exact_bits() {
    let Some(device) = device() else { return };
    let state = single(T::Rgba32Float, None);
    let special =
        [0x7fc0_0001, 0x7f80_0001, 0xffc1_2345, 0x0000_0001, 0x807f_ffff, 0x7f80_0000, 0x8000_0000, 0x3f80_0001];
    let bits = |k: u32| special[(k % 8) as usize] ^ (k / 8);
    let extent = Extent::new(64, 64).expect("legal");
    let fragments = (0..4096_u32).map(|k| Fragment::new([k, k + 1, k + 2, k + 3].map(|k| f32::from_bits(bits(k)))));
    let result =
        draw(device, targets(&state, extent.width, extent.height, |_| vec![0; 16]), state, fragments.collect());
    for (k, texel) in (0_u32..).zip(bytes(&result).chunks_exact(16)) {
        for (channel, word) in (0_u32..).zip(texel.chunks_exact(4)) {
            let got = u32::from_le_bytes(word.try_into().expect("four bytes"));
            assert_eq!(got, bits(k + channel), "texel {k}, channel {channel}: {got:#010x}");
        }
    }
}
