//! Levels, the units they consist of, and shards.

use std::fmt;
use std::str::FromStr;

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState, TextureFormat};

use crate::format::layout::FORMATS;
use crate::format::{ColorFormat, TargetClass};
use crate::state::spelling;

/// How thorough a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// About a minute: random states on every format, every equal-alpha state on rgba8unorm, samples of the stores.
    Quick,
    /// Every equal-alpha state on every blendable format, and more random ones: about half an hour.
    Full,
    /// Every input: all 2^32 `f32` through the stores, every 8-bit input of every state on rgba8unorm, 2^22 inputs of
    /// every state on the other formats: hours.
    Exhaustive,
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Quick => "quick",
            Self::Full => "full",
            Self::Exhaustive => "exhaustive",
        })
    }
}

/// Part `index` of `count` of a level, both from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 1.
    pub index: usize,
    /// How many parts.
    pub count: usize,
}

impl Shard {
    /// The whole level.
    pub const ALL: Self = Self { index: 1, count: 1 };

    /// Whether the unit at this place of the list belongs to the shard. Neighbours go to different shards, since they
    /// cost about the same.
    #[must_use]
    pub fn has(self, place: usize) -> bool {
        place % self.count == self.index - 1
    }
}

/// A shard that is not written `i/n`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a shard; write i/n with 1 <= i <= n, e.g. 2/8")]
pub struct ShardError(String);

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let error = || ShardError(text.to_owned());
        let (index, count) = text.split_once('/').ok_or_else(error)?;
        let (index, count) = (index.parse().map_err(|_| error())?, count.parse().map_err(|_| error())?);
        if index >= 1 && index <= count { Ok(Self { index, count }) } else { Err(error()) }
    }
}

impl serde::Serialize for Shard {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> serde::Deserialize<'de> for Shard {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// One piece of a level.
#[derive(Clone, Debug, PartialEq)]
pub enum Unit {
    /// Blend states on random and special inputs.
    Blend {
        /// The target's format.
        format: ColorFormat,
        /// Which states.
        states: States,
        /// Texels for each state.
        texels: u32,
    },
    /// Unblended stores of `f32` bit patterns: every `stride`-th of one of four channel rotations.
    Store {
        /// The target's format.
        format: ColorFormat,
        /// Distance of neighbouring bit patterns; 1 is all of them.
        stride: u32,
        /// Which value goes to which channel.
        rotation: u32,
    },
    /// Fragment depth of `f32` bit patterns into a depth target.
    Depth {
        /// The depth format.
        format: TextureFormat,
        /// Distance of neighbouring bit patterns; 1 is all of them.
        stride: u32,
    },
    /// States that tell versions, vector widths and processors of the modelled drivers apart.
    Telling {
        /// The target's format.
        format: ColorFormat,
    },
    /// What `LoadOp::Clear` stores for colors, or for depths where the format is one of depth.
    Clear {
        /// The target's format.
        format: TextureFormat,
    },
    /// Sample masks on a target with one sample.
    SampleMask,
    /// Triangles that leave the target, drawn into a single color target: clipping, coverage and interpolation.
    Raster {
        /// The target's format.
        format: ColorFormat,
    },
    /// Biased depths of triangles.
    DepthBias {
        /// The depth format.
        format: TextureFormat,
    },
    /// Every 8-bit input a state on rgba8unorm depends on, up to one input beside source and destination.
    Codes {
        /// The source factor of the states.
        src_factor: BlendFactor,
    },
    /// Every 8-bit source, destination, source alpha and destination alpha of one state on rgba8unorm: 2^32 inputs.
    CodesBothAlphas {
        /// Both equations.
        component: BlendComponent,
    },
}

/// Which blend states a unit goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum States {
    /// Random ones, separate alpha, masks and constants included.
    Random {
        /// Seed.
        seed: u64,
        /// How many.
        count: u32,
    },
    /// Color and alpha the same: this source factor with every destination factor and operation, with random constants.
    Equal {
        /// The source factor.
        factor: BlendFactor,
        /// Tells the inputs of several units with the same factor apart, from 0.
        part: u32,
    },
}

impl Unit {
    /// A name that is the same in every run.
    #[must_use]
    pub fn id(&self) -> String {
        match self {
            Self::Blend { format, states: States::Random { seed, count }, texels } => {
                format!("blend/{}/random-{seed}x{count}/{texels}", format.name())
            }
            Self::Blend { format, states: States::Equal { factor, part }, texels } => {
                let part = if *part == 0 { String::new() } else { format!("/{part}") };
                format!("blend/{}/{}/{texels}{part}", format.name(), spelling::factor_name(*factor))
            }
            Self::Store { format, stride, rotation } => format!("store/{}/{stride}/{rotation}", format.name()),
            Self::Depth { format, stride } => format!("depth/{}/{stride}", depth_name(*format)),
            Self::Telling { format } => format!("telling/{}", format.name()),
            Self::Clear { format } => format!("clear/{}", format_name(*format)),
            Self::SampleMask => "sample-mask/r8unorm".to_owned(),
            Self::Raster { format } => format!("raster/{}", format.name()),
            Self::DepthBias { format } => format!("depth-bias/{}", depth_name(*format)),
            Self::Codes { src_factor } => format!("codes/rgba8unorm/{}", spelling::factor_name(*src_factor)),
            Self::CodesBothAlphas { component } => format!("codes-2^32/rgba8unorm/{}", component_name(component)),
        }
    }

    /// The format's name, for tables.
    #[must_use]
    pub fn format_name(&self) -> &'static str {
        match self {
            Self::Blend { format, .. }
            | Self::Store { format, .. }
            | Self::Telling { format }
            | Self::Raster { format } => format.name(),
            Self::Depth { format, .. } | Self::DepthBias { format } => depth_name(*format),
            Self::Clear { format } => format_name(*format),
            Self::SampleMask => "r8unorm",
            Self::Codes { .. } | Self::CodesBothAlphas { .. } => "rgba8unorm",
        }
    }
}

/// `add src-alpha one`.
#[must_use]
pub fn component_name(c: &BlendComponent) -> String {
    let (src, dst) = (spelling::factor_name(c.src_factor), spelling::factor_name(c.dst_factor));
    format!("{} {src} {dst}", spelling::operation_name(c.operation))
}

/// WebGPU's name of a color or depth format.
fn format_name(format: TextureFormat) -> &'static str {
    ColorFormat::new(format).map_or_else(|_| depth_name(format), ColorFormat::name)
}

/// WebGPU's name of a depth format.
fn depth_name(format: TextureFormat) -> &'static str {
    match format {
        TextureFormat::Depth16Unorm => "depth16unorm",
        TextureFormat::Depth24Plus => "depth24plus",
        _ => "depth32float",
    }
}

/// The depth formats swept.
const DEPTHS: [TextureFormat; 3] =
    [TextureFormat::Depth16Unorm, TextureFormat::Depth24Plus, TextureFormat::Depth32Float];

/// Formats of the raster units: those that some driver clips otherwise, and neighbours of each.
const RASTERS: [&str; 5] = ["rgba8unorm", "bgra8unorm", "rgba8unorm-srgb", "r8unorm", "rgba16float"];

/// Formats whose stores the exhaustive level sends every `f32` through; one for each kind of channel.
const STORES: [&str; 9] = [
    "rgba8unorm",
    "rgba8unorm-srgb",
    "rgb10a2unorm",
    "rgba16unorm",
    "rgba8snorm",
    "rgba16snorm",
    "rgba16float",
    "rg11b10ufloat",
    "rgba32float",
];

/// Formats on which the exhaustive level gives every state 2^22 inputs.
const MANY_INPUTS: [&str; 4] = ["rgba16float", "rgba8unorm-srgb", "rg11b10ufloat", "rgb10a2unorm"];

/// The units of a level, in order.
#[must_use]
pub fn units(level: Level) -> Vec<Unit> {
    let formats: Vec<ColorFormat> = FORMATS.iter().filter_map(|(_, format)| ColorFormat::new(*format).ok()).collect();
    let named = |name: &&str| ColorFormat::from_name(name).ok();
    let equal_part = |format: ColorFormat, texels: u32, part: u32| {
        spelling::blend_factors().map(move |factor| Unit::Blend {
            format,
            states: States::Equal { factor, part },
            texels,
        })
    };
    let equal = |format: ColorFormat, texels: u32| equal_part(format, texels, 0);
    let blendable = |format: &ColorFormat| format.class() != TargetClass::Snorm;
    // Formats on which some two drivers differ. What is no blending costs little. Both are the same at the quick and the full level.
    let telling = formats.iter().copied().filter(|format| super::telling::has(*format));
    let telling = telling.map(|format| Unit::Telling { format });
    let others = || {
        let clears = formats.iter().map(|format| format.texture_format()).chain(DEPTHS);
        let clears = clears.map(|format| Unit::Clear { format });
        let rasters = RASTERS.iter().filter_map(named).map(|format| Unit::Raster { format });
        let biases = DEPTHS.map(|format| Unit::DepthBias { format });
        telling.chain(clears).chain([Unit::SampleMask]).chain(rasters).chain(biases)
    };
    let mut units = Vec::new();
    match level {
        Level::Quick => {
            for &format in &formats {
                units.push(Unit::Blend { format, states: States::Random { seed: 1, count: 24 }, texels: 4096 });
                units.push(Unit::Store { format, stride: 4099, rotation: 0 });
            }
            units.extend(equal(formats[2], 4096));
            units.extend(DEPTHS.map(|format| Unit::Depth { format, stride: 1021 }));
            units.extend(others());
        }
        Level::Full => {
            for &format in &formats {
                for seed in 2..10 {
                    units.push(Unit::Blend { format, states: States::Random { seed, count: 64 }, texels: 16_384 });
                }
                units.extend((0..4).map(|rotation| Unit::Store { format, stride: 127, rotation }));
            }
            units.extend(formats.iter().copied().filter(blendable).flat_map(|format| equal(format, 16_384)));
            units.extend(DEPTHS.map(|format| Unit::Depth { format, stride: 31 }));
            units.extend(others());
        }
        Level::Exhaustive => {
            for format in STORES.iter().filter_map(named) {
                units.extend((0..4).map(|rotation| Unit::Store { format, stride: 1, rotation }));
            }
            units.extend(DEPTHS.map(|format| Unit::Depth { format, stride: 1 }));
            units.extend(spelling::blend_factors().map(|src_factor| Unit::Codes { src_factor }));
            units.extend(both_alphas().into_iter().map(|component| Unit::CodesBothAlphas { component }));
            for format in MANY_INPUTS.iter().filter_map(named) {
                // In two parts: a layer of 2^22 fragments is larger than the buffer that every device binds.
                units.extend((0..2).flat_map(|part| equal_part(format, 1 << 21, part)));
            }
        }
    }
    units
}

/// The same with another number of texels for each blend state.
#[must_use]
pub fn units_of(level: Level, texels: Option<u32>) -> Vec<Unit> {
    let mut units = units(level);
    for unit in &mut units {
        if let (Unit::Blend { texels, .. }, Some(wanted)) = (unit, texels) {
            *texels = wanted;
        }
    }
    units
}

/// Over, premultiplied over, additive, and every state whose factors read both source and destination alpha.
fn both_alphas() -> Vec<BlendComponent> {
    use BlendFactor as F;
    let component = |src_factor, dst_factor, operation| BlendComponent { src_factor, dst_factor, operation };
    let mut components = vec![
        component(F::SrcAlpha, F::OneMinusSrcAlpha, BlendOperation::Add),
        component(F::One, F::OneMinusSrcAlpha, BlendOperation::Add),
        component(F::One, F::One, BlendOperation::Add),
    ];
    let reads_src = |f| matches!(f, F::SrcAlpha | F::OneMinusSrcAlpha | F::SrcAlphaSaturated);
    let reads_dst = |f| matches!(f, F::DstAlpha | F::OneMinusDstAlpha | F::SrcAlphaSaturated);
    // Second sources and constants would add further inputs; the factors that stay are functions of the four.
    let further = |f: F| f.ref_second_blend_source() || matches!(f, F::Constant | F::OneMinusConstant);
    for src in spelling::blend_factors().filter(|f| !further(*f)) {
        for dst in spelling::blend_factors().filter(|f| !further(*f)) {
            if (reads_src(src) || reads_src(dst)) && (reads_dst(src) || reads_dst(dst)) {
                for operation in [BlendOperation::Add, BlendOperation::Subtract, BlendOperation::ReverseSubtract] {
                    components.push(component(src, dst, operation));
                }
            }
        }
    }
    components
}

/// The states of [`States::Equal`]: every destination factor with add, subtract and reverse-subtract; with factor one
/// also min and max, which WebGPU admits with factors one only.
#[must_use]
pub fn equal_states(src_factor: BlendFactor) -> Vec<BlendState> {
    let mut states = Vec::new();
    for dst_factor in spelling::blend_factors() {
        for operation in spelling::blend_operations() {
            let extreme = matches!(operation, BlendOperation::Min | BlendOperation::Max);
            if !extreme || (src_factor, dst_factor) == (BlendFactor::One, BlendFactor::One) {
                let both = BlendComponent { src_factor, dst_factor, operation };
                states.push(BlendState { color: both, alpha: both });
            }
        }
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn unit_names_are_unique() {
        for level in [Level::Quick, Level::Full, Level::Exhaustive] {
            let units = units(level);
            let names: BTreeSet<String> = units.iter().map(Unit::id).collect();
            assert_eq!(names.len(), units.len(), "{level}");
        }
    }

    #[test]
    fn shards_divide_a_level_without_rest_or_overlap() {
        let total = units(Level::Full).len();
        let mut seen = vec![0; total];
        for index in 1..=7 {
            let shard = Shard { index, count: 7 };
            (0..total).filter(|place| shard.has(*place)).for_each(|place| seen[place] += 1);
        }
        assert!(seen.iter().all(|count| *count == 1), "each unit is in one shard");
        assert!("0/3".parse::<Shard>().is_err() && "4/3".parse::<Shard>().is_err(), "out of range");
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }), "two of three");
    }

    #[test]
    fn every_equal_alpha_state_is_swept() {
        let states: usize = spelling::blend_factors().map(|factor| equal_states(factor).len()).sum();
        assert_eq!(states, 17 * 17 * 3 + 2, "three operations with all factors, and min and max");
    }
}
