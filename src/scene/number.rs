//! Narrowing and widening of numbers, each with its rounding.

/// Nearest binary32, ties to even; overflow gives an infinity.
#[expect(clippy::cast_possible_truncation, reason = "`as` rounds to nearest even, which is what is wanted")]
pub(crate) fn f64_to_f32(x: f64) -> f32 {
    x as f32
}

/// Nearest integer, ties to even; values beyond `i64` saturate and NaN gives 0.
#[expect(clippy::cast_possible_truncation, reason = "`as` saturates, which is what is wanted")]
pub(crate) fn f64_to_i64(x: f64) -> i64 {
    x.round_ties_even() as i64
}

/// Nearest binary64, ties to even; exact below 2^53.
#[expect(clippy::cast_precision_loss, reason = "callers stay below 2^53, where it is exact")]
pub(crate) fn i64_to_f64(x: i64) -> f64 {
    x as f64
}

/// Nearest binary32, ties to even; exact below 2^24.
#[expect(clippy::cast_precision_loss, reason = "callers stay below 2^24, where it is exact")]
pub(crate) fn u32_to_f32(x: u32) -> f32 {
    x as f32
}

/// The nearest of 256 codes for `x` brought into `[0, 1]`, ties to even; NaN gives 0.
pub(crate) fn unit_to_u8(x: f64) -> u8 {
    u8::try_from(f64_to_i64(x.clamp(0.0, 1.0) * 255.0)).unwrap_or(0)
}
