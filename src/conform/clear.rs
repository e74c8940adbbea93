//! What `LoadOp::Clear` stores: drivers convert clear colors by other routines than shader outputs.

use fastrand::Rng;
use wgpu_types::TextureFormat;

use super::run::{Compared, Subject, Tally, compare};
use crate::crosscheck::clear::{clear, clear_depth};
use crate::crosscheck::{Device, ReplayError};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, ColorFormat, DepthFormat, snorm, unorm};
use crate::model::same_codes;

/// Colors of a unit.
const COLORS: usize = 4096;

/// Depths of a unit: each is a submission of its own.
const DEPTHS: usize = 384;

/// Runs a clear unit.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: TextureFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    tally.leave_out_specifications("clears are not judged");
    match ColorFormat::new(format) {
        Ok(format) => colors(device, subjects, format, tally),
        Err(_) => depths(device, subjects, format, tally),
    }
}

/// The colors that a format is cleared to, the same on every run.
fn colors_of(format: ColorFormat) -> Vec<[f32; 4]> {
    let mut random = Rng::with_seed(0xc1ea);
    (0..COLORS).map(|_| format.channels().map(|kind| value(&mut random, kind))).collect()
}

fn colors(
    device: &Device,
    subjects: &[Subject],
    format: ColorFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let colors = colors_of(format);
    let wide: Vec<[f64; 4]> = colors.iter().map(|color| color.map(f64::from)).collect();
    let stored = clear(device, format, &wide)?;
    tally.texels += stored.len() as u64;
    tally.states += 1;
    for (s, subject) in subjects.iter().enumerate() {
        if let Err(reason) = subject.model.supports(format, None) {
            tally.leave_out(s, reason.reason);
            continue;
        }
        let expected = |i: usize| subject.model.clear_color(format, colors[i]);
        let compared = compare(stored.len(), |i| same_codes(format, stored[i], expected(i)));
        tally.add(s, compared, |i| {
            format!("clear to {:?}: expected {:x?}, got {:x?}", colors[i], expected(i), stored[i])
        });
    }
    Ok(())
}

fn depths(
    device: &Device,
    subjects: &[Subject],
    format: TextureFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let Some(kind) = DepthFormat::new(format).ok().and_then(DepthFormat::depth) else { return Ok(()) };
    let mut random = Rng::with_seed(0xdea1);
    let channel = match kind {
        DepthKind::Unorm(bits) => ChannelKind::Unorm(bits),
        DepthKind::Float32 => ChannelKind::Unorm(24),
    };
    let values: Vec<f32> = std::iter::repeat_with(|| value(&mut random, channel))
        .filter(|z| (0.0..=1.0).contains(z))
        .take(DEPTHS)
        .collect();
    let stored = clear_depth(device, format, &values)?;
    tally.texels += stored.len() as u64;
    tally.states += 1;
    // WebGPU only loads 24-bit depth, and the last two codes load alike on some drivers.
    let known = |code: u32| if kind == DepthKind::Unorm(24) { code.min(0x00ff_fffe) } else { code };
    for (s, subject) in subjects.iter().enumerate() {
        let expected = |i: usize| subject.model.clear_depth(kind, values[i]);
        let compared: Compared = compare(stored.len(), |i| known(stored[i]) == known(expected(i)));
        tally.add(s, compared, |i| {
            format!("clear to depth {:e}: expected {:#x}, got {:#x}", values[i], expected(i), stored[i])
        });
    }
    Ok(())
}

/// A number worth clearing a channel to: the middle between two codes or a neighbour of it, a code, a special value, or any.
fn value(random: &mut Rng, kind: ChannelKind) -> f32 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::layout::FORMATS;
    use crate::model::NumericModel;
    use crate::model::llvmpipe::{Generation, Llvmpipe};

    /// Formats on which two generations clear some color of the sweep to different codes.
    fn told_apart(a: Generation, b: Generation) -> Vec<&'static str> {
        let [a, b] = [a, b].map(|generation| Llvmpipe { generation, ..Llvmpipe::default() });
        let differ = |format: ColorFormat| {
            let same =
                |color: &[f32; 4]| same_codes(format, a.clear_color(format, *color), b.clear_color(format, *color));
            !colors_of(format).iter().all(same)
        };
        let formats = FORMATS.iter().filter(|(_, format)| differ(ColorFormat::new(*format).expect("listed")));
        formats.map(|(name, _)| *name).collect()
    }

    #[test]
    fn the_sweep_tells_how_generations_round_clear_colors() {
        let rounds = |kind: &ChannelKind| match *kind {
            ChannelKind::Unorm(bits) => bits > 8,
            ChannelKind::Snorm(_) => true,
            ChannelKind::Float(layout) => !layout.signed,
            ChannelKind::Absent | ChannelKind::Srgb => false,
        };
        let expected: Vec<&str> = FORMATS
            .iter()
            .filter(|(_, format)| ColorFormat::new(*format).expect("listed").channels().iter().any(rounds))
            .map(|(name, _)| *name)
            .collect();
        let [old, middle, new] = Generation::ALL;
        assert_eq!(told_apart(old, middle), expected);
        assert_eq!(told_apart(middle, new), [""; 0], "no change since");
    }
}
