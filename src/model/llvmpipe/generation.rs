//! Driver generations: which versions of Mesa store the same bytes, and by which rules they differ from the others.
//!
//! To add one: a variant, its entry in [`Generation::ALL`] and its [`Facts`] below. Everything else follows: names, the choice
//! by an adapter's version, the states of `outmerge conform` that tell generations apart, and the candidates of `outmerge
//! identify`. A new kind of rule becomes a member of [`Rules`].

use std::fmt;

use wgpu_types::TextureFormat;

use crate::format::{ChannelKind, ColorFormat, FloatLayout};

/// Versions of Mesa whose llvmpipe stores the same bytes, by the first of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Generation {
    /// Mesa 22.3.
    Mesa22_3,
    /// Mesa 25.0.
    Mesa25_0,
    /// Mesa 26.1, the newest.
    #[default]
    Mesa26_1,
}

/// What is known of a generation.
#[derive(Debug)]
pub struct Facts {
    /// The version that names it, e.g. `22.3`.
    pub name: &'static str,
    /// The first and the last version it was proven on. What lies between them is taken to be the same.
    pub proven: [[u32; 3]; 2],
    /// How, in words.
    pub evidence: &'static str,
    /// By which rules it differs from others.
    pub rules: Rules,
}

/// The rules that changed between generations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// Products of unorm codes.
    pub product: Product,
    /// Interpolation on unorm targets with one channel.
    pub interpolation: Interpolation,
    /// Denormals of half and 11/10-bit float targets.
    pub small_denormals: SmallDenormals,
    /// Factors that are the constant zero, on 11/10-bit float targets.
    pub zero_factor: ZeroFactor,
    /// A sample mask without bit 0 on a target with one sample.
    pub sample_mask: SampleMask,
    /// Colors of `LoadOp::Clear`.
    pub clear: Clear,
    /// The unit of the constant depth bias on unorm depth.
    pub bias_unit: BiasUnit,
    /// Color formats that, as the only target and without depth, are clipped at twice the target's size.
    pub guard_band: &'static [TextureFormat],
}

/// How two codes a and b of n bits are multiplied; t = a b.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Product {
    /// `(t + (t >> n) + 2^(n-1)) >> n`: near t / (2^n - 1), and off from the nearest code for 24 of 65,536 pairs at 8 bits.
    Near,
    /// `(u + (u >> n)) >> n` with `u = t + 2^(n-1)`: the nearest code to t / (2^n - 1).
    Nearest,
}

/// How v0 + x (v1 - v0) is formed of codes of n bits. The factor is widened first, X = x + (x >> (n-1)); delta = v1 - v0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// 8 bits: `v0 + floor((X delta + 128) / 256)`; 16 bits: `v0 + floor(X delta / 65536)`.
    Floor,
    /// `v0 + X delta / 2^n` to the nearest, ties to even.
    NearestEven,
}

/// What becomes of binary32 denormals while half and 11/10-bit float targets are blended. 32-bit float and sRGB targets flush
/// them in every generation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SmallDenormals {
    /// Kept. Where every fragment of a block fails the depth test, the thread keeps them afterwards on 32-bit targets too.
    Kept,
    /// Kept, and nothing is left behind.
    KeptAlone,
    /// Flushed, as on all other targets.
    Flushed,
}

/// What a factor that is the constant zero does to NaN and infinity on 11/10-bit float targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ZeroFactor {
    /// The term is dropped, so nothing of it shows.
    Dropped,
    /// Dropped or multiplied (0 NaN = NaN), by what the driver's memory held before: one draw may store one, the next the
    /// other.
    Undecided,
}

/// What a sample mask without bit 0 does on a target with one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleMask {
    /// Nothing, as long as the mask is not 0.
    Ignored,
    /// It covers nothing, as Vulkan says.
    Obeyed,
}

/// How clears convert colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Clear {
    /// Halves away from zero; 11/10-bit floats toward zero, without denormals.
    HalvesAway,
    /// Halves to even; 11/10-bit floats to the nearest, with denormals.
    HalvesEven,
}

/// What one unit of the constant depth bias is on unorm depth of n bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BiasUnit {
    /// Two codes: c units are 2 c / (2^n - 1).
    TwoCodes,
    /// One code, and half a code away from zero for all: (c + sign(c) / 2) / (2^n - 1).
    CodeAndHalf,
}

impl Rules {
    /// What these rules do on a color format, in words: only those by which generations differ there.
    #[must_use]
    pub fn words(&self, format: ColorFormat) -> Vec<&'static str> {
        let channels = format.channels();
        let single = channels[1] == ChannelKind::Absent;
        let mut words = Vec::new();
        match channels[0] {
            ChannelKind::Unorm(bits) => {
                words.push(match (self.product, bits) {
                    (Product::Nearest, _) => "every product of codes is the nearest code",
                    (Product::Near, 8) => "24 of 65,536 products of codes are not the nearest code",
                    (Product::Near, _) => "5,006 of 2^32 products of 16-bit codes are not the nearest code",
                });
                if single {
                    words.push(match self.interpolation {
                        Interpolation::NearestEven => "f S + (1 - f) D is rounded to the nearest code, ties to even",
                        Interpolation::Floor if bits == 8 => "f S + (1 - f) D is rounded to the nearest code, ties up",
                        Interpolation::Floor => "f S + (1 - f) D is rounded down",
                    });
                }
            }
            ChannelKind::Float(layout) if layout != FloatLayout::SINGLE => {
                words.push(match self.small_denormals {
                    SmallDenormals::Flushed => "binary32 denormals are 0",
                    SmallDenormals::Kept | SmallDenormals::KeptAlone => "binary32 denormals are kept",
                });
                if !layout.signed {
                    words.push(match self.zero_factor {
                        ZeroFactor::Dropped => "a term with factor zero is dropped",
                        ZeroFactor::Undecided => {
                            "a term with factor zero is dropped or multiplied (NaN), by the driver's history"
                        }
                    });
                }
            }
            _ => {}
        }
        words
    }
}

const OLDEST: Facts = Facts {
    name: "22.3",
    proven: [[22, 3, 6]; 2],
    evidence: "full level on Intel and AMD (Debian 12, LLVM 15.0.6)",
    rules: Rules {
        product: Product::Near,
        interpolation: Interpolation::Floor,
        small_denormals: SmallDenormals::Kept,
        zero_factor: ZeroFactor::Dropped,
        sample_mask: SampleMask::Ignored,
        clear: Clear::HalvesAway,
        bias_unit: BiasUnit::TwoCodes,
        guard_band: &[TextureFormat::Bgra8Unorm],
    },
};

const MIDDLE: Facts = Facts {
    name: "25.0",
    proven: [[25, 0, 7]; 2],
    evidence: "full level on Intel, quick level on AMD (Debian 13, LLVM 19.1.7)",
    rules: Rules {
        small_denormals: SmallDenormals::KeptAlone,
        zero_factor: ZeroFactor::Undecided,
        sample_mask: SampleMask::Obeyed,
        clear: Clear::HalvesEven,
        guard_band: &[TextureFormat::Bgra8Unorm, TextureFormat::Rgba8Unorm],
        ..OLDEST.rules
    },
};

const NEWEST: Facts = Facts {
    name: "26.1",
    proven: [[26, 1, 6], [26, 2, 6]],
    evidence: "full level of 26.2.6, quick level of 26.1.6, on AMD (Debian forky and sid, LLVM 21.1.8 and 22.1.8)",
    rules: Rules {
        product: Product::Nearest,
        interpolation: Interpolation::NearestEven,
        small_denormals: SmallDenormals::Flushed,
        bias_unit: BiasUnit::CodeAndHalf,
        ..MIDDLE.rules
    },
};

impl Generation {
    /// All of them, oldest first.
    pub const ALL: [Self; 3] = [Self::Mesa22_3, Self::Mesa25_0, Self::Mesa26_1];

    /// What is known of it.
    #[must_use]
    pub const fn facts(self) -> &'static Facts {
        match self {
            Self::Mesa22_3 => &OLDEST,
            Self::Mesa25_0 => &MIDDLE,
            Self::Mesa26_1 => &NEWEST,
        }
    }

    /// Its rules.
    #[must_use]
    pub const fn rules(self) -> &'static Rules {
        &self.facts().rules
    }

    /// The generation to compare a driver of this version with, and how well that choice is founded.
    #[must_use]
    pub fn of_version(version: [u32; 3]) -> (Self, Footing) {
        let last = |generation: Self| generation.facts().proven[1];
        let from = |generation: &Self| generation.facts().proven[0] <= version;
        match Self::ALL.into_iter().rev().find(from) {
            Some(generation) if version <= last(generation) => (generation, Footing::Proven),
            Some(generation) if generation == Self::default() => (generation, Footing::Newer),
            Some(generation) => (generation, Footing::Between),
            None => (Self::Mesa22_3, Footing::Older),
        }
    }

    /// The generation that was proven on the version of this name, `26`, `26.1` or `26.1.6`; the newest of several.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let fits = |version: &[u32; 3]| {
            let [major, minor, patch] = version;
            name == format!("{major}.{minor}") || name == format!("{major}.{minor}.{patch}")
        };
        Self::ALL.into_iter().rev().find(|generation| generation.facts().proven.iter().any(fits))
    }

    /// The versions it was proven on: `26.1.6 to 26.2.6`.
    #[must_use]
    pub fn range(self) -> String {
        let text = |[major, minor, patch]: [u32; 3]| format!("{major}.{minor}.{patch}");
        let [first, last] = self.facts().proven;
        if first == last { text(first) } else { format!("{} to {}", text(first), text(last)) }
    }
}

impl fmt::Display for Generation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.facts().name)
    }
}

/// How a driver's version relates to those a generation was proven on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Footing {
    /// Proven on this version, or on one before and one after it.
    Proven,
    /// Newer than any proven.
    Newer,
    /// Between two generations: compared with the older one.
    Between,
    /// Older than any proven.
    Older,
}

impl Footing {
    /// What to tell the user of a driver that is compared with `generation`; `None` where it is proven.
    #[must_use]
    pub fn warning(self, version: [u32; 3], generation: Generation) -> Option<String> {
        let [major, minor, patch] = version;
        let relation = match self {
            Self::Proven => return None,
            Self::Newer => "newer than any proven",
            Self::Between => "between two proven generations",
            Self::Older => "older than any proven",
        };
        Some(format!(
            "Mesa {major}.{minor}.{patch} is {relation}; compared with {generation}, proven on {}",
            generation.range()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_find_their_generation() {
        use Generation as G;
        for (version, generation, footing) in [
            ([20, 3, 5], G::Mesa22_3, Footing::Older),
            ([22, 3, 6], G::Mesa22_3, Footing::Proven),
            ([24, 2, 0], G::Mesa22_3, Footing::Between),
            ([25, 0, 7], G::Mesa25_0, Footing::Proven),
            ([26, 0, 1], G::Mesa25_0, Footing::Between),
            ([26, 1, 6], G::Mesa26_1, Footing::Proven),
            ([26, 2, 1], G::Mesa26_1, Footing::Proven),
            ([26, 2, 6], G::Mesa26_1, Footing::Proven),
            ([27, 0, 0], G::Mesa26_1, Footing::Newer),
        ] {
            assert_eq!(G::of_version(version), (generation, footing), "{version:?}");
        }
        let warning = Footing::Newer.warning([27, 0, 0], G::Mesa26_1).expect("a warning");
        assert!(warning.contains("Mesa 27.0.0 is newer than any proven; compared with 26.1"), "{warning}");
        assert_eq!(Footing::Proven.warning([22, 3, 6], G::Mesa22_3), None, "nothing to say");
    }

    #[test]
    fn names_are_versions_that_were_proven() {
        for generation in Generation::ALL {
            assert_eq!(Generation::from_name(generation.facts().name), Some(generation), "its own name");
            assert!(generation.facts().proven.is_sorted(), "oldest first");
        }
        assert_eq!(Generation::from_name("26.2"), Some(Generation::Mesa26_1), "in its range");
        assert_eq!(Generation::from_name("26.1.6"), Some(Generation::Mesa26_1), "in full");
        assert_eq!([Generation::from_name("24.0"), Generation::from_name("")], [None; 2], "not proven");
    }
}
