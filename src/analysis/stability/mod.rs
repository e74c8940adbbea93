//! Stability: what stiff stacks, extreme values, steep depth ranges and another drawing order do to the result.
//!
//! - [`stack`]: error against the number of layers, per family of alphas, drawing direction, format and model;
//! - [`extreme`]: NaN, infinities, overflow, clamps: outcomes per model beside the APIs' rules;
//! - [`depth`]: order errors of depth formats as far / near grows;
//! - [`order`]: which pixels of a scene depend on the order of its draws.

pub mod depth;
pub mod extreme;
pub mod order;
pub mod stack;
#[cfg(test)]
mod tests;

/// A value rounded to binary32, as a shader outputs it.
fn to_f32(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = x as f32;
    rounded
}
