//! What Vulkan, Direct3D and WebGPU allow the output merger to write: sets of codes in nested classes, and verdicts.
//!
//! The sets come from interval arithmetic over the same blend equation as every model ([`crate::merger::blend`]), rounded
//! outward. A class holds every narrower one:
//!
//! | class | blender | store |
//! |---|---|---|
//! | [`Exact`](Class::Exact) | real numbers | the correctly rounded code, both at a tie |
//! | [`Tight`](Class::Tight) | binary32, in Vulkan rounded either way, in D3D to the nearest or not at all | the API's conversion rule |
//! | [`Wide`](Class::Wide) | as coarse as the target: sources may be quantised, each product rounded | the API's conversion rule |
//!
//! The conversion rules: Vulkan takes either neighbouring code, and of floats either neighbour, overflow as the largest
//! number or Inf. D3D takes codes within 0.6 and cuts floats toward zero; where it blends on half targets, the nearest
//! as well. WebGPU names no numeric rule: either API's set will do.
//!
//! Where a text is silent or contradicts itself, [`Policy`] says what is assumed; these assumptions are fixed:
//!
//! - the sign of a float zero is free while blending; D3D keeps it with blending off;
//! - binary32 denormals may be flushed or kept, in D3D too, whose min, max and bit-preserving cases keep them;
//! - the blender of a format with channels of several widths works at the widest one.
//!
//! Sources: Vulkan, *Framebuffer / Blending*, *Fixed-Point Data Conversions*, *Floating-Point Format Conversions*; D3D11.3
//! 3.1, 3.2, 17.5 to 17.18, 19.1.2; WebGPU, *Rendering Operations*.

mod blender;
mod counterexample;
mod counts;
mod coverage;
mod depth;
mod judge;
mod real;
mod span;
mod store;
#[cfg(test)]
mod tests;

pub use counts::Counts;
pub use coverage::judge_coverage;
pub use depth::{DepthStencilCase, channel_kind, depth_codes, judge_depth_stencil};
pub use judge::{Judge, Judgement};
pub use store::CodeSet;

use std::fmt;
use std::str::FromStr;

/// Whose rules a result is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Spec {
    /// Vulkan 1.4.
    Vulkan,
    /// Direct3D 11.3, still the numeric base of Direct3D 12.
    D3d,
    /// WebGPU: Vulkan's or D3D's.
    WebGpu,
}

/// The texts that have numeric rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Api {
    /// Vulkan.
    Vulkan,
    /// Direct3D 11 and 12.
    D3d,
}

impl Spec {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::Vulkan, Self::D3d, Self::WebGpu];

    /// The name it is selected by.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Vulkan => "vulkan",
            Self::D3d => "d3d",
            Self::WebGpu => "webgpu",
        }
    }

    /// The texts whose rules it admits.
    #[must_use]
    pub fn apis(self) -> &'static [Api] {
        match self {
            Self::Vulkan => &[Api::Vulkan],
            Self::D3d => &[Api::D3d],
            Self::WebGpu => &[Api::Vulkan, Api::D3d],
        }
    }
}

impl fmt::Display for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A specification's name that is not one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown specification `{0}`; use vulkan, d3d or webgpu")]
pub struct SpecError(String);

impl FromStr for Spec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        Self::ALL.into_iter().find(|spec| spec.name() == text).ok_or_else(|| SpecError(text.to_owned()))
    }
}

/// How far a result is from the exact one, in terms of what it takes to allow it; wider classes are greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Real arithmetic, rounded once.
    Exact,
    /// The store's tolerance and binary32.
    Tight,
    /// A blender as coarse as its target.
    Wide,
}

/// What is to be said of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Any result conforms, so this one says nothing.
    Undefined,
    /// It conforms, in this narrowest class.
    Within(Class),
    /// It does not conform.
    Outside,
}

impl Verdict {
    /// The names, in the order of [`index`](Self::index).
    pub const NAMES: [&'static str; 5] = ["exact", "tight", "wide", "outside", "undefined"];

    /// Place in tables.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::Within(Class::Exact) => 0,
            Self::Within(Class::Tight) => 1,
            Self::Within(Class::Wide) => 2,
            Self::Outside => 3,
            Self::Undefined => 4,
        }
    }

    /// `exact`, `tight`, `wide`, `outside` or `undefined`.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self.index()]
    }

    /// Of two parts of one result: the worse, undefined parts left out.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Undefined, x) | (x, Self::Undefined) => x,
            (a, b) if a.index() >= b.index() => a,
            (_, b) => b,
        }
    }

    /// Of two texts either of which will do: the better; one that defines the result before one that does not.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        let rank = |verdict| match verdict {
            Self::Within(class) => class as usize,
            Self::Undefined => 3,
            Self::Outside => 4,
        };
        if rank(self) <= rank(other) { self } else { other }
    }
}

/// What is assumed where a text is silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Policy {
    /// Whether a Vulkan driver supports Inf and NaN, which is optional. Where it does not, every result they went into is
    /// undefined. Default: it does not.
    pub vulkan_specials: bool,
    /// Bits of a linear value in the coarsest blender of sRGB targets. Vulkan asks for the target's precision, which does
    /// not say on which side of the curve; 12 linear bits are the fewest that keep all 256 codes. Default: 12.
    pub srgb_linear_bits: u32,
}

impl Default for Policy {
    fn default() -> Self {
        Self { vulkan_specials: false, srgb_linear_bits: 12 }
    }
}
