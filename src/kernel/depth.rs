//! The depth test of a row of depth codes.

use wgpu_types::CompareFunction;

/// Tests the fragments' depth `codes` against what is `stored`, narrows `keep` (255 lives, 0 does not) to those that pass,
/// and stores the depth of these if `write`. Codes are those of [`crate::model::NumericModel::depth_code`]; codes of
/// non-negative floats compare as the floats do.
///
/// # Panics
/// When the slices differ in length.
pub fn test_row(function: CompareFunction, write: bool, codes: &[u32], stored: &mut [u32], keep: &mut [u8]) {
    assert!(codes.len() == stored.len() && codes.len() == keep.len(), "a code, a stored code and a byte each");
    match function {
        CompareFunction::Never => keep.fill(0),
        CompareFunction::Less => row(|z, d| z < d, write, codes, stored, keep),
        CompareFunction::Equal => row(|z, d| z == d, write, codes, stored, keep),
        CompareFunction::LessEqual => row(|z, d| z <= d, write, codes, stored, keep),
        CompareFunction::Greater => row(|z, d| z > d, write, codes, stored, keep),
        CompareFunction::NotEqual => row(|z, d| z != d, write, codes, stored, keep),
        CompareFunction::GreaterEqual => row(|z, d| z >= d, write, codes, stored, keep),
        CompareFunction::Always => row(|_, _| true, write, codes, stored, keep),
    }
}

#[inline(always)]
fn row(passes: impl Fn(u32, u32) -> bool, write: bool, codes: &[u32], stored: &mut [u32], keep: &mut [u8]) {
    for ((z, d), keep) in codes.iter().zip(stored.iter_mut()).zip(keep.iter_mut()) {
        let lives = *keep != 0 && passes(*z, *d);
        *keep = if lives { u8::MAX } else { 0 };
        *d = if lives && write { *z } else { *d };
    }
}
