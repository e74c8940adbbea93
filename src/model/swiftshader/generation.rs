//! Driver generations: which builds of Chromium store the same bytes.
//!
//! SwiftShader reports no version of its own, so a generation goes by the browser it ships with. To add one: a variant, its entry
//! in [`Generation::ALL`], its range and evidence, and what its stores do in `Generation::unorm_code`.

use std::fmt;
use std::sync::LazyLock;

use num_traits::ToPrimitive;

use super::unit;
use crate::format::{ChannelKind, srgb};
use crate::model::binary32;

/// Builds of SwiftShader that store the same bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Generation {
    /// Chromium 109 and 110: normalised stores go through 16-bit codes.
    Chromium110,
    /// Chromium 111 and later.
    #[default]
    Chromium111,
}

/// A version that is no generation's, or no version.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no model of SwiftShader in `{0}`; write chromium=VERSION with one of the versions it was proven on: {ranges}", ranges = ranges())]
pub struct GenerationError(String);

fn ranges() -> String {
    Generation::ALL.map(Generation::range).join(", ")
}

impl Generation {
    /// All of them, oldest first.
    pub const ALL: [Self; 2] = [Self::Chromium110, Self::Chromium111];

    /// The first and the last major version of Chromium it was proven on.
    const fn versions(self) -> [u32; 2] {
        match self {
            Self::Chromium110 => [109, 110],
            Self::Chromium111 => [111, 156],
        }
    }

    /// How it was proven, in words.
    #[must_use]
    pub const fn evidence(self) -> &'static str {
        match self {
            Self::Chromium110 => "quick level on the builds of 109 and 110",
            Self::Chromium111 => "full and exhaustive levels on that of 156, quick level on eleven builds from 111 on",
        }
    }

    /// `109 to 110`.
    #[must_use]
    pub fn range(self) -> String {
        let [first, last] = self.versions();
        format!("{first} to {last}")
    }

    /// The generation that a parameter `chromium=VERSION` names.
    ///
    /// # Errors
    /// [`GenerationError`].
    pub fn from_parameter(text: &str) -> Result<Self, GenerationError> {
        let error = || GenerationError(text.to_owned());
        let version: u32 = text.strip_prefix("chromium=").ok_or_else(error)?.parse().map_err(|_| error())?;
        let has = |generation: &Self| {
            let [first, last] = generation.versions();
            (first..=last).contains(&version)
        };
        Self::ALL.into_iter().find(has).ok_or_else(error)
    }

    /// The code of a number, clamped to [0, 1], for a channel that this generation stores in a way of its own: through 16-bit codes, of which
    /// an sRGB channel looks at twelve bits. `None` for others.
    pub(super) fn unorm_code(self, x: f32, kind: ChannelKind) -> Option<u32> {
        if self != Self::Chromium110 {
            return None;
        }
        // A NaN that a blend constant brought is the largest code; the shader's are 0 before.
        let x = if x.is_nan() { 1.0 } else { unit(x) };
        match kind {
            ChannelKind::Unorm(bits) if bits < 16 => {
                let q = sixteen(x);
                Some((q - (q >> bits) + (1 << (15 - bits))) >> (16 - bits))
            }
            ChannelKind::Srgb => {
                let index = (sixteen(x) + 7) >> 4;
                Some(SRGB.iter().map(|first| u32::from(index >= u32::from(*first))).sum())
            }
            _ => None,
        }
    }
}

impl fmt::Display for Generation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Chromium110 => "110",
            Self::Chromium111 => "111",
        })
    }
}

/// The linear value that the older builds load for an sRGB code: the code is repeated to 16 bits, of which a table looks at twelve
/// and answers with the nearest 16-bit code.
pub(super) fn srgb_by_table(code: u32) -> f32 {
    static LINEAR: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|code| linear_16(code) * (1.0 / 65535.0)));
    LINEAR[code as usize & 0xff]
}

/// The 16-bit code, as a number, of the linear value that is loaded for an sRGB code.
fn linear_16(code: usize) -> f32 {
    let index = ((u32::try_from(code).expect("8 bits") * 257 + 7) >> 4).min(4095);
    let linear = srgb::enclose_linear(index, 4095, 64).lo.to_f64().unwrap_or(0.0);
    binary32::narrow((linear * 65535.0).round())
}

/// The 16-bit code below a number in [0, 1].
fn sixteen(x: f32) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an integer from 0 to 65535")]
    let code = (x * 65535.0) as u32;
    code
}

/// For each sRGB code from 1 on, the first index that stores it, read back from the builds of 109 and 110 for every 16-bit code.
///
/// A unit test recomputes it: the curve of index / 4095 as a 16-bit code, rounded, and that narrowed to 8 bits as linear ones are.
#[rustfmt::skip]
const SRGB: [u16; 255] = [
    1, 2, 4, 5, 6, 7, 9, 10, 11, 12, 14, 15, 16, 18, 19, 21,
    23, 24, 26, 28, 30, 32, 34, 37, 39, 42, 44, 47, 49, 52, 55, 58,
    61, 64, 68, 71, 74, 78, 82, 85, 89, 93, 97, 102, 106, 110, 115, 119,
    124, 129, 134, 139, 144, 149, 154, 160, 165, 171, 177, 183, 189, 195, 201, 207,
    214, 220, 227, 234, 241, 248, 255, 262, 270, 277, 285, 292, 300, 308, 317, 325,
    333, 342, 350, 359, 368, 377, 386, 395, 405, 414, 424, 434, 444, 454, 464, 474,
    485, 495, 506, 517, 528, 539, 550, 562, 573, 585, 597, 609, 621, 633, 645, 658,
    670, 683, 696, 709, 722, 736, 749, 763, 776, 790, 804, 819, 833, 848, 862, 877,
    892, 907, 922, 938, 953, 969, 985, 1001, 1017, 1033, 1049, 1066, 1083, 1100, 1117, 1134,
    1151, 1169, 1186, 1204, 1222, 1240, 1259, 1277, 1296, 1314, 1333, 1352, 1372, 1391, 1410, 1430,
    1450, 1470, 1490, 1510, 1531, 1552, 1572, 1593, 1615, 1636, 1657, 1679, 1701, 1723, 1745, 1767,
    1790, 1812, 1835, 1858, 1881, 1904, 1928, 1951, 1975, 1999, 2023, 2048, 2072, 2097, 2122, 2146,
    2172, 2197, 2222, 2248, 2274, 2300, 2326, 2352, 2379, 2406, 2433, 2460, 2487, 2514, 2542, 2570,
    2597, 2626, 2654, 2682, 2711, 2740, 2769, 2798, 2827, 2857, 2886, 2916, 2946, 2977, 3007, 3038,
    3068, 3099, 3130, 3162, 3193, 3225, 3257, 3289, 3321, 3354, 3386, 3419, 3452, 3485, 3518, 3552,
    3586, 3620, 3654, 3688, 3722, 3757, 3792, 3827, 3862, 3897, 3933, 3969, 4005, 4041, 4077,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_srgb_table_is_the_curve_through_16_bits() {
        let code = |index: u16| {
            let linear = f64::from(index) / 4095.0;
            let curve = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 65535")]
            let s = (curve * 65535.0 + 0.5) as u32;
            (s - (s >> 8) + 128) >> 8
        };
        for index in 0..=4095_u16 {
            let stored: u32 = SRGB.iter().map(|first| u32::from(index >= *first)).sum();
            assert_eq!(stored, code(index), "index {index}");
        }
    }

    /// What a reverse-subtracting blend shows of the loaded value on the build of 110.
    #[test]
    fn srgb_codes_load_as_they_were_measured() {
        for (code, linear) in
            [(0, 0.0), (1, 20.0), (9, 180.0), (41, 1455.0), (100, 8353.0), (184, 31_416.0), (255, 65_535.0)]
        {
            assert_eq!(linear_16(code), linear, "code {code}");
        }
    }

    #[test]
    fn versions_select_generations() {
        let of = |text| Generation::from_parameter(text).ok();
        assert_eq!([of("chromium=109"), of("chromium=110")], [Some(Generation::Chromium110); 2]);
        assert_eq!([of("chromium=111"), of("chromium=156")], [Some(Generation::Chromium111); 2]);
        for wrong in ["chromium=108", "chromium=157", "chromium=", "110", "mesa=22.3"] {
            let error = Generation::from_parameter(wrong).expect_err(wrong).to_string();
            assert!(error.contains("109 to 110, 111 to 156"), "{error}");
        }
    }

    #[test]
    fn codes_survive_the_way_through_16_bits() {
        for code in 0..=255_u16 {
            let x = f32::from(code) / 255.0;
            assert_eq!(Generation::Chromium110.unorm_code(x, ChannelKind::Unorm(8)), Some(code.into()), "{code}");
        }
        assert_eq!(Generation::Chromium110.unorm_code(1.0, ChannelKind::Unorm(2)), Some(3));
        assert_eq!(Generation::Chromium111.unorm_code(1.0, ChannelKind::Unorm(2)), None, "as ever");
    }
}
