//! The same fragments through a real driver: replay on a Vulkan device, by way of wgpu (feature `gpu`).
//!
//! - [`adapter`]: which devices there are, choosing one by name, and the environment they must run in;
//! - [`device`]: an open device whose faults come back as errors, never as panics or hangs;
//! - [`shader`], [`pipeline`]: the WGSL that hands arbitrary bits to the output merger, built once per state;
//! - [`batch`], [`record`], [`painter`]: layers of fragments, checked, laid out for the device, and drawn in one pass;
//! - [`upload`], [`readback`]: target bytes to the device and back, exactly;
//! - [`replay`]: a batch of layers over given targets, and the bytes afterwards;
//! - [`clear`]: what `LoadOp::Clear` stores;
//! - [`sweep`], [`program`]: the fast path, fragments uploaded once or computed on the device;
//! - `scene`: the fragments of a scene as a batch; `raster`, `drawn`: what the device's own rasteriser makes of its
//!   triangles, and whole scenes drawn by the device, shading included (feature `scene`).

pub mod adapter;
pub mod batch;
pub mod clear;
pub mod device;
#[cfg(feature = "scene")]
pub mod drawn;
mod library;
pub mod painter;
pub mod pipeline;
pub mod program;
#[cfg(feature = "scene")]
pub mod raster;
pub mod readback;
pub mod record;
pub mod replay;
#[cfg(feature = "scene")]
pub mod scene;
pub mod shader;
pub mod sweep;
pub mod upload;
pub mod vector;

pub use adapter::{AdapterReport, OpenError, OpenOptions};
pub use batch::{Batch, DepthSource, Layer, ReplayError};
pub use device::{Device, DeviceError};
pub use program::{Input, Program};
pub use replay::Replay;
pub use sweep::{Destination, Fragments, Job, Outcome, Sources, Sweep};
