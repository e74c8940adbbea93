//! What `LoadOp::Clear` stores: drivers convert clear colors by other routines than shader outputs.

use fastrand::Rng;
use wgpu_types::TextureFormat;

use super::run::{Compared, Subject, Tally, compare};
use crate::crosscheck::clear::{clear, clear_depth};
use crate::crosscheck::{Device, ReplayError};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, ColorFormat, DepthFormat};
use crate::identify::clears::{colors, number};
use crate::model::same_codes;

/// The same colors on every run.
const SEED: u64 = 0xc1ea;

/// Colors of a unit.
const COLORS: usize = 4096;

/// Depths of a unit: each is a submission of its own.
const DEPTHS: usize = 384;

/// Why a model is left out.
const UNKNOWN: &str = "the model does not know this driver's clears";

/// Runs a clear unit.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: TextureFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    tally.leave_out_specifications("clears are not judged");
    match ColorFormat::new(format) {
        Ok(format) => run_colors(device, subjects, format, tally),
        Err(_) => depths(device, subjects, format, tally),
    }
}

fn run_colors(
    device: &Device,
    subjects: &[Subject],
    format: ColorFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let colors = colors(format, COLORS, SEED);
    let wide: Vec<[f64; 4]> = colors.iter().map(|color| color.map(f64::from)).collect();
    let stored = clear(device, format, &wide)?;
    tally.texels += stored.len() as u64;
    tally.states += 1;
    for (s, subject) in subjects.iter().enumerate() {
        if !subject.model.knows_clears() {
            tally.leave_out(s, UNKNOWN);
            continue;
        }
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
    let values: Vec<f32> = std::iter::repeat_with(|| number(&mut random, channel))
        .filter(|z| (0.0..=1.0).contains(z))
        .take(DEPTHS)
        .collect();
    let stored = clear_depth(device, format, &values)?;
    tally.texels += stored.len() as u64;
    tally.states += 1;
    // WebGPU only loads 24-bit depth, and the last two codes load alike on some drivers.
    let known = |code: u32| if kind == DepthKind::Unorm(24) { code.min(0x00ff_fffe) } else { code };
    for (s, subject) in subjects.iter().enumerate() {
        if !subject.model.knows_clears() {
            tally.leave_out(s, UNKNOWN);
            continue;
        }
        let expected = |i: usize| subject.model.clear_depth(kind, values[i]);
        let compared: Compared = compare(stored.len(), |i| known(stored[i]) == known(expected(i)));
        tally.add(s, compared, |i| {
            format!("clear to depth {:e}: expected {:#x}, got {:#x}", values[i], expected(i), stored[i])
        });
    }
    Ok(())
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
            !colors(format, COLORS, SEED).iter().all(same)
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
