//! Colors that show how a driver converts those of `LoadOp::Clear`.

use fastrand::Rng;

use crate::format::{ChannelKind, ColorFormat, snorm, unorm};

/// Colors for a format, RGBA. Equal seeds give equal colors.
#[must_use]
pub fn colors(format: ColorFormat, count: usize, seed: u64) -> Vec<[f32; 4]> {
    let mut random = Rng::with_seed(seed);
    (0..count).map(|_| format.channels().map(|kind| number(&mut random, kind))).collect()
}

/// A number worth clearing a channel to: the middle between two codes or a neighbour of it, a code, a special value, or any.
pub(crate) fn number(random: &mut Rng, kind: ChannelKind) -> f32 {
    // No signalling NaN: wgpu takes colors in binary64, and narrowing makes them quiet.
    const SPECIAL: [f32; 12] =
        [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-45, 1e-40, 2.0, -2.0, 65_519.9, 65_520.0, 1e9];
    match random.u8(..16) {
        0 => return SPECIAL[random.usize(..SPECIAL.len())],
        1 => return random.f32() * 4.0 - 2.0,
        2 => return Some(f32::from_bits(random.u32(..))).filter(|x| !x.is_nan()).unwrap_or(0.0),
        _ => {}
    }
    let halves = f64::from(random.u8(..4).min(1));
    let middle = match kind {
        ChannelKind::Absent => 0.5,
        ChannelKind::Srgb => random.f64(),
        ChannelKind::Unorm(bits) => {
            let steps = unorm::steps(bits);
            (f64::from(random.u32(..steps)) + halves / 2.0) / f64::from(steps)
        }
        ChannelKind::Snorm(bits) => {
            let steps = snorm::steps(bits);
            (f64::from(random.i32(-steps..steps)) + halves / 2.0) / f64::from(steps)
        }
        ChannelKind::Float(layout) => {
            // Half of them denormal, where there is more to get wrong.
            let top = if random.bool() { 2 << layout.mantissa_bits.min(20) } else { layout.infinity() - 1 };
            let code = random.u32(..top);
            layout.decode(code) + halves * (layout.decode(code + 1) - layout.decode(code)) / 2.0
        }
    };
    let near = crate::model::binary32::narrow(middle);
    [near, near, near.next_down(), near.next_up()][random.usize(..4)]
}
