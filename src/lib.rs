//! # outmerge
//!
//! An exact, fast model of the GPU output-merger stage: *given this state, these fragments and this target, what bytes
//! must the GPU write, and why?*
#![forbid(unsafe_code)]

pub mod state;

pub mod format;

pub mod target;

pub mod fragment;

pub mod merger;

pub mod model;

pub mod limit;

pub mod plan;

#[cfg(feature = "scene")]
pub mod scene;

#[cfg(feature = "json")]
pub mod vectors;

#[cfg(feature = "report")]
pub mod analysis;

#[cfg(feature = "report")]
pub mod report;

#[cfg(feature = "gpu")]
pub mod crosscheck;

#[cfg(feature = "gpu")]
pub mod conform;

#[cfg(feature = "proptest")]
pub mod proptest;

#[cfg(feature = "cli")]
pub mod cli;

pub use fragment::Fragment;
pub use limit::Limits;
pub use merger::Merger;
pub use model::NumericModel;
pub use state::{AlphaTest, DynamicState, MergerState};
pub use target::{Extent, Framebuffer};
