//! Depth: codes by the rule of color, but that 24-bit halves go up below 1/16; 32-bit depth without denormals, and with -0.

use super::normalised;
use crate::format::depth::DepthKind;

/// The code of a fragment's depth, clamped to the viewport's range first. NaN is 0.
#[must_use]
pub fn code(kind: DepthKind, z: f32, [near, far]: [f32; 2]) -> u32 {
    let z = match z {
        _ if z.is_nan() => 0.0,
        _ if z.abs() < f32::MIN_POSITIVE => 0.0_f32.copysign(z),
        _ => z,
    };
    let z = z.clamp(near.min(far), near.max(far));
    match kind {
        DepthKind::Float32 => z.to_bits(),
        DepthKind::Unorm(24) => code_24(z),
        DepthKind::Unorm(bits) => normalised::code(z, bits),
    }
}

/// Cut to 28 fractional bits as q; then q - q / 2^24 in sixteenths of a code to the nearest, halves down; below 1/16, where
/// q / 2^24 is less than one, it counts as nothing.
fn code_24(z: f32) -> u32 {
    if z < 1.0 / 16.0 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2^24")]
        let cut = (z * 268_435_456.0) as u32;
        return (cut + 8) >> 4;
    }
    normalised::code(z, 24)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(bits: u32, z: f32) -> u32 {
        super::code(DepthKind::Unorm(bits), z, [0.0, 1.0])
    }

    /// As recorded.
    #[test]
    fn halves_go_down_but_in_small_24_bit_depth() {
        assert_eq!(code(16, 0.725_177_47), 47524, "47524.505");
        assert_eq!(code(24, 0.021_839_947), 366_414, "366413.478, and 366413.5 of 2^24");
        assert_eq!(code(24, 0.542_871_65), 9_107_874, "9107874.457");
    }

    #[test]
    fn the_ends_are_codes() {
        for bits in [16, 24] {
            assert_eq!(
                [code(bits, 0.0), code(bits, 1.0), code(bits, 2.0)],
                [0, (1 << bits) - 1, (1 << bits) - 1],
                "{bits}"
            );
        }
    }
}
