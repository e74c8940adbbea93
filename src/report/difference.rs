//! How two targets of one format differ, in codes of the target.
//!
//! For normalised channels a difference is one of integers stored; for float channels it counts the representable
//! numbers between the two (units in the last place), with -0 and +0 at one point and any NaN equal to any NaN.

use serde::Serialize;

use crate::format::{ChannelKind, snorm};
use crate::scene::Picture;
use crate::scene::display::value;
use crate::target::ColorTarget;

/// Differences of two targets, summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The largest difference of a channel.
    pub max_codes: u32,
    /// Sum of all channels' differences.
    pub sum_codes: u64,
    /// Channels compared.
    pub channels: u64,
    /// Pixels with any difference.
    pub pixels_differing: u64,
    /// Pixels compared.
    pub pixels: u64,
}

impl Difference {
    /// Adds another target's differences.
    pub fn absorb(&mut self, other: &Self) {
        self.max_codes = self.max_codes.max(other.max_codes);
        self.sum_codes += other.sum_codes;
        self.channels += other.channels;
        self.pixels_differing += other.pixels_differing;
        self.pixels += other.pixels;
    }

    /// Mean difference of a channel, in codes.
    #[must_use]
    pub fn mean_codes(&self) -> f64 {
        ratio(self.sum_codes, self.channels)
    }

    /// Share of pixels with any difference, in percent.
    #[must_use]
    pub fn percent_differing(&self) -> f64 {
        100.0 * ratio(self.pixels_differing, self.pixels)
    }
}

fn ratio(part: u64, whole: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
    let ratio = part as f64 / whole as f64;
    if whole == 0 { 0.0 } else { ratio }
}

/// Per-pixel differences of two targets: the largest of a pixel's channels, and the sums.
#[derive(Clone, Debug)]
pub struct Differences {
    width: u32,
    height: u32,
    largest: Vec<u32>,
    summary: Difference,
}

/// Colors of the heat map: the largest difference of each class, and what a legend calls it.
pub const LEGEND: [(u32, [u8; 3], &str); 6] = [
    (0, [24, 26, 33], "equal"),
    (1, [38, 96, 214], "1 code"),
    (2, [24, 178, 196], "2 codes"),
    (4, [122, 200, 80], "3 to 4"),
    (16, [240, 180, 40], "5 to 16"),
    (u32::MAX, [226, 48, 48], "more"),
];

impl Differences {
    /// Compares two targets of one extent and format.
    #[must_use]
    pub fn between(a: &ColorTarget, b: &ColorTarget) -> Self {
        let (extent, channels) = (a.extent(), a.format().channels());
        let mut summary = Difference::default();
        let mut largest = Vec::with_capacity(extent.sample_total());
        for y in 0..extent.height {
            for x in 0..extent.width {
                let mut most = 0;
                for sample in 0..extent.samples {
                    let (a, b) = (a.codes(x, y, sample), b.codes(x, y, sample));
                    for i in (0..4).filter(|&i| channels[i] != ChannelKind::Absent) {
                        let codes = distance(channels[i], a[i], b[i]);
                        most = most.max(codes);
                        summary.sum_codes += u64::from(codes);
                        summary.channels += 1;
                    }
                }
                summary.pixels += 1;
                summary.pixels_differing += u64::from(most > 0);
                summary.max_codes = summary.max_codes.max(most);
                largest.push(most);
            }
        }
        Self { width: extent.width, height: extent.height, largest, summary }
    }

    /// The sums.
    #[must_use]
    pub fn summary(&self) -> Difference {
        self.summary
    }

    /// The largest difference of each pixel's channels, rows from the top.
    #[must_use]
    pub fn largest(&self) -> &[u32] {
        &self.largest
    }

    /// A picture with [`LEGEND`]'s colors.
    #[must_use]
    pub fn heat_map(&self) -> Picture {
        heat_map(self.width, self.height, &self.largest)
    }
}

/// A picture of differences, one a pixel, with [`LEGEND`]'s colors.
#[must_use]
pub fn heat_map(width: u32, height: u32, largest: &[u32]) -> Picture {
    let color = |codes: &u32| {
        let (_, [r, g, b], _) = LEGEND.iter().find(|(most, ..)| codes <= most).unwrap_or(&LEGEND[5]);
        [*r, *g, *b, u8::MAX]
    };
    Picture { width, height, rgba: largest.iter().flat_map(color).collect() }
}

/// Distance of two codes of a channel.
#[must_use]
pub fn distance(kind: ChannelKind, a: u32, b: u32) -> u32 {
    match kind {
        ChannelKind::Absent => 0,
        ChannelKind::Unorm(_) | ChannelKind::Srgb => a.abs_diff(b),
        ChannelKind::Snorm(bits) => snorm::signed_code(a, bits).abs_diff(snorm::signed_code(b, bits)),
        ChannelKind::Float(layout) => {
            if layout.is_nan(a) || layout.is_nan(b) {
                return if layout.is_nan(a) && layout.is_nan(b) { 0 } else { u32::MAX };
            }
            let ordered = |code: u32| {
                let magnitude = i64::from(code & !layout.sign());
                if code & layout.sign() == 0 { magnitude } else { -magnitude }
            };
            u32::try_from(ordered(a).abs_diff(ordered(b))).unwrap_or(u32::MAX)
        }
    }
}

/// [`distance`] of a code from the exact one with its sign, positive where the code stands for more; the whole range
/// where one of them alone is a NaN.
#[must_use]
pub fn signed_distance(kind: ChannelKind, code: u32, exact: u32) -> f64 {
    let magnitude = f64::from(distance(kind, code, exact));
    if value(kind, code) < value(kind, exact) { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FloatLayout;

    #[test]
    fn float_distances_count_representable_numbers() {
        let half = ChannelKind::Float(FloatLayout::HALF);
        assert_eq!(distance(half, 0x3c00, 0x3c01), 1, "one ulp above 1");
        assert_eq!(distance(half, 0x8000, 0x0000), 0, "-0 and +0");
        assert_eq!(distance(half, 0x8001, 0x0001), 2, "across zero");
        assert_eq!(distance(half, 0x7e00, 0x7c01), 0, "any NaN equals any NaN");
        assert_eq!(distance(half, 0x7e00, 0x3c00), u32::MAX, "NaN against a number");
    }

    #[test]
    fn signs_say_which_is_brighter() {
        assert_eq!(signed_distance(ChannelKind::Unorm(8), 3, 5), -2.0, "too dark");
        assert_eq!(signed_distance(ChannelKind::Srgb, 5, 3), 2.0, "too bright");
        assert_eq!(signed_distance(ChannelKind::Snorm(8), 0xff, 1), -2.0, "-1 against 1");
    }

    #[test]
    fn signed_codes_are_compared_as_numbers() {
        assert_eq!(distance(ChannelKind::Snorm(8), 0xff, 0x01), 2, "-1 and 1");
        assert_eq!(distance(ChannelKind::Snorm(8), 0x80, 0x81), 0, "both are -1.0");
    }
}
