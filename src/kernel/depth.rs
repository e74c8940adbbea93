//! The depth test of a row of depth codes.

use wgpu_types::CompareFunction;

use super::simd::{self, Isa, Simd};

/// Tests the fragments' depth `codes` against what is `stored`, narrows `keep` (255 lives, 0 does not) to those that pass,
/// and stores the depth of these if `write`. Codes are those of [`crate::model::NumericModel::depth_code`]; codes of
/// non-negative floats compare as the floats do.
///
/// # Panics
/// When the slices differ in length.
pub fn test_row(function: CompareFunction, write: bool, codes: &[u32], stored: &mut [u32], keep: &mut [u8]) {
    test_row_on(Isa::best(), function, write, codes, stored, keep);
}

/// [`test_row`] on a given instruction set.
///
/// # Panics
/// As `test_row`, and when the machine lacks the instruction set.
pub fn test_row_on(
    isa: Isa,
    function: CompareFunction,
    write: bool,
    codes: &[u32],
    stored: &mut [u32],
    keep: &mut [u8],
) {
    assert!(codes.len() == stored.len() && codes.len() == keep.len(), "a code, a stored code and a byte each");
    simd::run(isa, Test { function, write, codes, stored, keep });
}

struct Test<'a> {
    function: CompareFunction,
    write: bool,
    codes: &'a [u32],
    stored: &'a mut [u32],
    keep: &'a mut [u8],
}

impl simd::Task for Test<'_> {
    #[inline(always)]
    fn on_vectors<S: Simd>(self, _: S) {
        self.plain();
    }

    /// One loop a function, which the compiler turns into the vectors of the caller's instruction set.
    #[inline(always)]
    fn plain(self) {
        match self.function {
            CompareFunction::Never => self.keep.fill(0),
            CompareFunction::Less => self.row(|z, d| z < d),
            CompareFunction::Equal => self.row(|z, d| z == d),
            CompareFunction::LessEqual => self.row(|z, d| z <= d),
            CompareFunction::Greater => self.row(|z, d| z > d),
            CompareFunction::NotEqual => self.row(|z, d| z != d),
            CompareFunction::GreaterEqual => self.row(|z, d| z >= d),
            CompareFunction::Always => self.row(|_, _| true),
        }
    }
}

impl Test<'_> {
    #[inline(always)]
    fn row(self, passes: impl Fn(u32, u32) -> bool) {
        // Writing is a constant of each loop.
        if self.write {
            for ((z, d), keep) in self.codes.iter().zip(self.stored).zip(self.keep) {
                let lives = *keep != 0 && passes(*z, *d);
                *keep = if lives { u8::MAX } else { 0 };
                *d = if lives { *z } else { *d };
            }
        } else {
            for ((z, d), keep) in self.codes.iter().zip(self.stored).zip(self.keep) {
                *keep = if *keep != 0 && passes(*z, *d) { u8::MAX } else { 0 };
            }
        }
    }
}
