//! Replay on a real Vulkan driver.
//!
//! With `OUTMERGE_REQUIRE_ADAPTER` set (part of an adapter's name, e.g. `llvmpipe`) a missing adapter fails every test
//! here; without it the tests say that they are skipped.
#![cfg(feature = "gpu")]

mod clear;
mod depth;
mod depth_stencil;
#[cfg(feature = "scene")]
mod drawn;
mod faults;
mod formats;
mod harness;
mod layers;
#[cfg(feature = "proptest")]
mod random;
#[cfg(feature = "scene")]
mod raster;
#[cfg(feature = "scene")]
mod scenes;
mod sweeps;
mod vectors;
#[cfg(feature = "cli")]
mod width;
