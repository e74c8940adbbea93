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
    fn on_vectors<S: Simd>(self, s: S) {
        let ones = s.splat8(u8::MAX);
        match self.function {
            CompareFunction::Never => self.keep.fill(0),
            CompareFunction::Less => self.vectors(
                s,
                #[inline(always)]
                |z, d| s.less_mask32(z, d),
            ),
            CompareFunction::Equal => self.vectors(
                s,
                #[inline(always)]
                |z, d| s.equal_mask32(z, d),
            ),
            CompareFunction::LessEqual => self.vectors(
                s,
                #[inline(always)]
                |z, d| s.xor(s.less_mask32(d, z), ones),
            ),
            CompareFunction::Greater => self.vectors(
                s,
                #[inline(always)]
                |z, d| s.less_mask32(d, z),
            ),
            CompareFunction::NotEqual => self.vectors(
                s,
                #[inline(always)]
                |z, d| s.xor(s.equal_mask32(z, d), ones),
            ),
            CompareFunction::GreaterEqual => self.vectors(
                s,
                #[inline(always)]
                |z, d| s.xor(s.less_mask32(z, d), ones),
            ),
            CompareFunction::Always => self.vectors(
                s,
                #[inline(always)]
                |_, _| ones,
            ),
        }
    }

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
    fn vectors<S: Simd>(self, s: S, passes: impl Fn(S::V, S::V) -> S::V) {
        /// How far ahead rows are asked for, in elements.
        const AHEAD: usize = 512;
        let count = S::BYTES / 4;
        let whole = self.codes.len() - self.codes.len() % count;
        let (codes, rest_codes) = self.codes.split_at(whole);
        let (stored, rest_stored) = self.stored.split_at_mut(whole);
        let (keep, rest_keep) = self.keep.split_at_mut(whole);
        let rows = codes.chunks_exact(count).zip(stored.chunks_exact_mut(count)).zip(keep.chunks_exact_mut(count));
        for ((codes, stored), keep) in rows {
            s.prefetch(codes.as_ptr().wrapping_add(AHEAD).cast());
            s.prefetch(stored.as_ptr().wrapping_add(AHEAD).cast());
            let (z, d) = (s.load32(codes), s.load32(stored));
            let lives = s.and(s.load_mask(keep), passes(z, d));
            s.store_mask(keep, lives);
            if self.write {
                s.store32(stored, s.select(lives, z, d));
            }
        }
        if !rest_codes.is_empty() {
            let rest = Test { codes: rest_codes, stored: rest_stored, keep: rest_keep, ..self };
            simd::Task::plain(rest);
        }
    }

    #[inline(always)]
    fn row(self, passes: impl Fn(u32, u32) -> bool) {
        for ((z, d), keep) in self.codes.iter().zip(self.stored).zip(self.keep) {
            let lives = *keep != 0 && passes(*z, *d);
            *keep = if lives { u8::MAX } else { 0 };
            *d = if lives && self.write { *z } else { *d };
        }
    }
}
