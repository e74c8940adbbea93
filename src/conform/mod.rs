//! Conformance of a device with numeric models, bit for bit, and with specifications, by what they admit: sweeps through
//! a real output merger.
//!
//! A level is a list of [`Unit`]s, each a few seconds to minutes of work with a name that does not change between runs:
//! units are what shards divide, what a log resumes from, and what results are merged by.
//!
//! - [`level`]: which units a level has;
//! - [`blend`], [`telling`], [`store`], [`depth`], [`codes`], [`clear`], [`sample_mask`], `raster`: how each kind of unit is run;
//! - [`run`](mod@run): a list of units on a device; [`result`] and [`spec`]: what was found, and what is missing;
//! - [`file`](mod@file) and [`log`]: the same on disk, sealed by checksums;
//! - [`table`] and [`junit`]: the same for people and for CI; [`compare`]: of several devices.

pub mod blend;
mod checksum;
pub mod clear;
pub mod codes;
pub mod compare;
pub mod depth;
pub mod file;
pub mod junit;
pub mod level;
pub mod log;
#[cfg(feature = "scene")]
pub mod raster;
pub mod result;
pub mod run;
pub mod sample_mask;
pub mod spec;
pub mod store;
pub mod table;
pub mod telling;

pub use checksum::{SealError, open as unseal};
pub use level::{Level, Shard, Unit};
pub use result::{Asked, ModelOutcome, Results, UnitOutcome};
pub use run::{Panel, run};
pub use spec::SpecOutcome;
