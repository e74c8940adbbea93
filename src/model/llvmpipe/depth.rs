//! Depth: clamped to [0, 1] with NaN as 1, then rounded before the test.

use super::integer::quantize16;
use crate::format::depth::DepthKind;

/// The depth code the driver tests and stores: min(z, 1), then max(., 0); -0 becomes +0 and denormals 0.
pub(super) fn depth_code(kind: DepthKind, z: f32) -> u32 {
    let below = if z < 1.0 { z } else { 1.0 };
    let clamped = if below >= f32::MIN_POSITIVE { below } else { 0.0 };
    match kind {
        DepthKind::Unorm(16) => quantize16(clamped),
        DepthKind::Unorm(bits) => {
            let steps = f64::from(crate::format::unorm::steps(bits));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "an integer from 0 to 2^24 - 1"
            )]
            let code = (f64::from(clamped) * steps).round_ties_even() as u32;
            code
        }
        DepthKind::Float32 => clamped.to_bits(),
    }
}
