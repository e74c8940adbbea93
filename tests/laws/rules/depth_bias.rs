//! Depth bias: o = constant x r + slope scale x slope, then its clamp. Sources: D 15.10; V, *Depth Bias*; W.

use outmerge::format::depth::DepthKind;
use outmerge::scene::raster::{RasterState, Vertex, assemble};
use outmerge::target::Extent;
use wgpu_types::DepthBiasState;

const SIZE: u32 = 16;

/// Depth at the target's first texel of a triangle through the corners' depths, under a bias.
fn biased(kind: DepthKind, depths: [f32; 3], constant: i32, slope_scale: f32, clamp: f32) -> f32 {
    let mut state = RasterState::new(Extent::new(SIZE, SIZE).expect("a small target"));
    state.depth = Some(kind);
    state.bias = DepthBiasState { constant, slope_scale, clamp };
    let corner = |x: f32, y: f32, z: f32| Vertex::<0> { position: [x, y, z, 1.0], varyings: [] };
    let triangle = [corner(-1.0, 1.0, depths[0]), corner(1.0, 1.0, depths[1]), corner(-1.0, -1.0, depths[2])];
    assemble(triangle, &state)[0].depth(0, 0)
}

const FLAT: [f32; 3] = [0.5; 3];

#[test]
fn the_unit_of_unorm_depth_is_one_code() {
    // D: 1 / (2^n - 1); V admits up to 2 x 2^-n.
    assert_eq!(biased(DepthKind::Unorm(16), FLAT, 1, 0.0, 0.0), 0.5 + 1.0 / 65_535.0, "16 bits");
    assert_eq!(biased(DepthKind::Unorm(24), FLAT, 64, 0.0, 0.0), 0.5 + 64.0 / 16_777_215.0, "24 bits");
}

#[test]
fn the_unit_of_float_depth_is_the_ulp_of_the_primitive_s_largest_depth() {
    assert_eq!(biased(DepthKind::Float32, FLAT, 2, 0.0, 0.0), 0.5 + 2.0 * 2.0_f32.powi(-24), "2^(-1 - 23)");
    let tilted = biased(DepthKind::Float32, [0.25, 0.25, 1.0], 1 << 10, 0.0, 0.0);
    let plain = biased(DepthKind::Float32, [0.25, 0.25, 1.0], 0, 0.0, 0.0);
    assert_eq!(tilted - plain, 2.0_f32.powi(10 - 23), "the largest depth is 1, though this texel's is smaller");
}

#[test]
fn the_slope_is_the_larger_of_the_two() {
    // Depth rises by 0.25 over 16 texels to the right and by 0.125 downwards.
    let slope = biased(DepthKind::Unorm(24), [0.25, 0.5, 0.375], 0, 1.0, 0.0);
    let plain = biased(DepthKind::Unorm(24), [0.25, 0.5, 0.375], 0, 0.0, 0.0);
    assert_eq!(slope - plain, 0.25 / 16.0, "max(|dz/dx|, |dz/dy|)");
}

#[test]
fn the_clamp_limits_a_bias_of_its_own_sign_only() {
    let kind = DepthKind::Unorm(16);
    let offset = |constant, clamp| biased(kind, FLAT, constant, 0.0, clamp) - 0.5;
    assert_eq!(offset(6554, 0.0625), 0.0625, "a positive clamp from above");
    assert_eq!(offset(-6554, -0.0625), -0.0625, "a negative clamp from below");
    assert!(offset(-6554, 0.0625) < -0.09, "a positive clamp leaves a negative bias alone");
    assert!(offset(6554, -0.0625) > 0.09, "and the other way round");
    assert!(offset(6554, 0.0) > 0.09, "zero is no clamp");
}

#[test]
fn without_bias_depth_is_unchanged() {
    for z in [0.1_f32, 0.3, 0.7] {
        for kind in [DepthKind::Unorm(16), DepthKind::Float32] {
            assert_eq!(biased(kind, [z; 3], 0, 0.0, 0.5).to_bits(), z.to_bits(), "{z}: a clamp alone does nothing");
        }
    }
}
