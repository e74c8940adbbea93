//! Depth bias of one primitive: `o = constant * r + slope_scale * max(|dz/dx|, |dz/dy|)`, then the clamp.
//!
//! The unit `r` is `1 / (2^n - 1)` for an n-bit unorm depth attachment, and `2^(e - 23)` for a float one, e being the
//! exponent of the largest depth of the primitive. binary32 throughout. Source: D3D11.3 15.10; Vulkan also admits other
//! units and slopes.

use super::{Primitive, RasterState};
use crate::format::depth::DepthKind;
use crate::scene::number::f64_to_f32;

pub(super) fn offset<const N: usize>(primitive: &Primitive<N>, state: &RasterState) -> f32 {
    let bias = state.bias;
    let Some(kind) = state.depth.filter(|_| bias.is_enabled()) else { return 0.0 };
    let unit = match kind {
        DepthKind::Unorm(bits) => 1.0 / (f64::from(bits).exp2() - 1.0),
        DepthKind::Float32 => float_unit(primitive.corners.iter().fold(0.0, |top, corner| corner.depth.abs().max(top))),
    };
    let mut offset = f64_to_f32(f64::from(bias.constant)) * f64_to_f32(unit);
    if bias.slope_scale != 0.0 {
        let slope = primitive.depth_slope().into_iter().fold(0.0, |top: f64, slope| slope.abs().max(top));
        offset += bias.slope_scale * f64_to_f32(slope);
    }
    clamped(offset, bias.clamp)
}

/// An offset limited by the bias clamp, which is off at 0.
pub(super) fn clamped(offset: f32, clamp: f32) -> f32 {
    if clamp > 0.0 {
        offset.min(clamp)
    } else if clamp < 0.0 {
        offset.max(clamp)
    } else {
        offset
    }
}

/// `2^(e - 23)` for the exponent e of `largest`; the smallest subnormal for a subnormal or zero.
fn float_unit(largest: f32) -> f64 {
    let exponent = i32::try_from(largest.to_bits() >> 23).unwrap_or(0).max(1) - 127;
    f64::from(exponent - 23).exp2()
}
