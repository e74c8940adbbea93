//! An oracle for other crates' tests: read-back images against the model's prediction (feature `testkit`).
//!
//! No device is needed here: the image may come from wgpu, a software renderer or a file. Formats and states are
//! `wgpu-types`' own, which `wgpu` re-exports, so a test passes what it gave its pipeline.
//!
//! ```
//! use outmerge::assert_conforms;
//! use outmerge::model::exact::Exact;
//! use outmerge::testkit::{Actual, Draw, Prediction};
//! use outmerge::{Extent, Fragment, Framebuffer, MergerState};
//! use wgpu_types::{BlendState, ColorTargetState, TextureFormat};
//!
//! // The state the renderer uses, and the fragments its shader puts out: here a quad over the whole of 2 x 2 texels.
//! let target = ColorTargetState { blend: Some(BlendState::ALPHA_BLENDING), ..TextureFormat::Rgba8Unorm.into() };
//! let state = MergerState::single(target);
//! let cleared = Framebuffer::for_state(Extent::new(2, 2)?, &state)?;
//! let quad = Draw::covering("quad", state, cleared.extent, Fragment::new([1.0, 0.5, 0.0, 0.5]));
//! let expected = Prediction::of_draws(&cleared, vec![quad], &Exact::default())?;
//!
//! // What the renderer wrote, read back without row padding.
//! let read_back = [128, 64, 0, 128].repeat(4);
//! let actual = Actual::new(TextureFormat::Rgba8Unorm, 2, 2, &read_back)?;
//! assert_conforms!(actual, expected, "half_a_quad");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A failing [`assert_conforms!`](crate::assert_conforms) names the first wrong pixel, tells its fragments' history, the
//! bytes it should have and has, and which numeric model would explain it, and leaves `NAME.actual.png`,
//! `NAME.expected.png` and `NAME.diff.png` in [`folder`].
//!
//! [`Runner`] turns folders of scene and vector files into named tests.

mod actual;
mod explain;
mod pictures;
mod prediction;
mod runner;

pub use actual::{Actual, ActualError};
pub use explain::{Event, Mismatch, ModelMatch};
pub use pictures::folder;
pub use prediction::{Draw, Prediction, PredictionError};
pub use runner::Runner;

use std::path::PathBuf;

/// Why an image does not conform.
#[derive(Debug, thiserror::Error)]
pub enum Nonconformance {
    /// The images cannot be compared.
    #[error("the read-back image is {got} and the prediction {expected}; read back what was predicted")]
    Shape {
        /// Format and size of the read-back image.
        got: String,
        /// Format and size of the prediction.
        expected: String,
    },
    /// Pixels differ.
    #[error("{0}")]
    Pixels(Box<Mismatch>),
}

/// Compares a read-back image with a prediction, writing no files.
///
/// Every byte must be one the prediction's models write; in float channels any NaN equals any NaN.
///
/// # Errors
/// [`Nonconformance`], with everything known about the first pixel that differs.
pub fn conforms(actual: &Actual, expected: &Prediction) -> Result<(), Nonconformance> {
    let wanted = expected.target();
    if (actual.target.format(), actual.target.extent()) != (wanted.format(), wanted.extent()) {
        return Err(Nonconformance::Shape { got: actual::shape(&actual.target), expected: actual::shape(wanted) });
    }
    match explain::mismatch(actual, expected) {
        None => Ok(()),
        Some(mismatch) => Err(Nonconformance::Pixels(Box::new(mismatch))),
    }
}

/// The function form of [`assert_conforms!`](crate::assert_conforms): compares, and on failure writes the three pictures
/// and panics with the report.
///
/// # Panics
/// When the image does not conform.
#[track_caller]
pub fn assert_image_conforms(actual: &Actual, expected: &Prediction, name: &str) {
    if let Err(problem) = conforms(actual, expected) {
        let pictures = match &problem {
            Nonconformance::Shape { .. } => String::new(),
            Nonconformance::Pixels(_) => match pictures::write(actual, expected, &folder(), name) {
                Ok(files) => format!("\npictures: {}", list(&files)),
                Err(error) => format!("\nno pictures: {error}"),
            },
        };
        panic!("`{name}` does not conform: {problem}{pictures}");
    }
}

fn list(files: &[PathBuf]) -> String {
    files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Asserts that a read-back image ([`Actual`](crate::testkit::Actual)) is one the [`Prediction`](crate::testkit::Prediction)
/// allows. The third argument names the pictures that a failure leaves behind; without it they are called after module
/// and line.
#[macro_export]
macro_rules! assert_conforms {
    ($actual:expr, $expected:expr $(,)?) => {
        $crate::assert_conforms!($actual, $expected, concat!(module_path!(), "-", line!()))
    };
    ($actual:expr, $expected:expr, $name:expr $(,)?) => {
        $crate::testkit::assert_image_conforms(&$actual, &$expected, &$name)
    };
}

#[cfg(test)]
mod tests;
