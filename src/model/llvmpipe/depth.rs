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
            #[expect(clippy::cast_precision_loss, reason = "2^24 - 1 is exact in binary32")]
            let steps = crate::format::unorm::steps(bits) as f32;
            // The product is rounded to binary32 before it is rounded to an integer.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "an integer from 0 to 2^24 - 1"
            )]
            let code = (clamped * steps).round_ties_even() as u32;
            code
        }
        DepthKind::Float32 => clamped.to_bits(),
    }
}
