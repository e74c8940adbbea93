//! # outmerge
//!
//! An exact, fast model of the GPU output-merger stage: *given this state, these fragments and this target, what bytes
//! must the GPU write, and why?*
#![forbid(unsafe_code)]

pub mod format;
pub mod fragment;
#[cfg(feature = "scene")]
pub mod scene;
pub mod state;
pub mod target;

pub use fragment::Fragment;
pub use state::{AlphaTest, DynamicState, MergerState};
