//! The reference output merger: one fragment at a time, one stage a file, in the order of the specification.
//!
//! It is generic over the numeric model, has no shortcut and no format's special case, and is the yardstick for every
//! fast path. [`Merger::merge`] runs the stages; [`Merger::trace`] runs the same stages and keeps what each one saw.

#[path = "1_coverage.rs"]
pub mod coverage;

#[path = "2_discard.rs"]
pub mod discard;

#[path = "3_depth_stencil.rs"]
pub mod depth_stencil;

#[path = "4_load.rs"]
pub mod load;

#[path = "5_blend/mod.rs"]
pub mod blend;

#[path = "6_encode.rs"]
pub mod encode;

#[path = "7_write_mask.rs"]
pub mod write_mask;

mod run;

pub use run::{Fate, Merger, MergerError, SampleTrace, Trace};
