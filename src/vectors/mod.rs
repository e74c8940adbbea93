//! Test vectors: blend inputs and results as JSON lines, to be replayed anywhere.
//!
//! Format version 1, one JSON object a line; byte strings are lower-case hex, floats in them binary32 little-endian,
//! n texels a line:
//!
//! ```json
//! {"format":"rgba8unorm",
//!  "blend":{"color":{"src":"src-alpha","dst":"one-minus-src-alpha","op":"add"},"alpha":{"src":"one","dst":"zero","op":"add"}},
//!  "mask":15,
//!  "constant":"00000000000000000000000000000000",
//!  "dual":false,
//!  "src":"n x 4 f32", "src1":null,
//!  "dst":"n raw texels before", "out":"n raw texels after"}
//! ```
//!
//! `blend` may be `null` (blending off). Factor and operation names are WebGPU's; raw texels are in the format's memory
//! layout. Where results are compared, any NaN of a float channel equals any NaN.
//!
//! A recorded file begins with a line of kind `driver` ([`DriverRecord`]), which names the driver and is read past.
//!
//! Lines with `"kind":"depth"` ([`DepthLine`]) and `"kind":"layers"` ([`LayersLine`]) are of the same spirit; the
//! repository's `docs/vectors.md` describes all three.

mod bytes;
mod check;
mod depth;
mod describe;
mod driver;
mod generate;
mod hex;
mod judge;
mod kind;
mod layers;
mod line;

pub use crate::model::same_codes;
pub use check::{Checked, Mismatch, Report, apply, apply_within, check, check_within, fill};
pub use depth::DepthLine;
pub use describe::equations as describe_state;
pub use driver::{DriverRecord, Library};
pub use generate::{Generator, generate, generate_kind};
pub use judge::{Judged, Judgements, Violation, judge};
pub use kind::{Entry, Kind, Line};
pub use layers::LayersLine;
pub use line::{ColorDraw, LineError, VectorLine};

/// A vector file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum VectorError {
    /// A line is malformed.
    #[error("line {line}: {source}")]
    Line {
        /// Line number, from 1.
        line: usize,
        /// What is wrong.
        source: LineError,
    },
    /// The model does not define a line's result.
    #[error("line {line}: {source}")]
    Unsupported {
        /// Line number, from 1.
        line: usize,
        /// Why not.
        source: crate::model::Unsupported,
    },
    /// Reading or writing failed.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}
