//! Unsigned normalised channels: value = code / N with N = 2^n - 1.
//!
//! Source: Vulkan, *Fixed-Point Data Conversions*; D3D11.3 3.2.3.3.

/// N = 2^bits - 1, the largest code and the number of steps between 0 and 1.
///
/// `bits` is 1 to 32.
#[must_use]
pub const fn steps(bits: u32) -> u32 {
    u32::MAX >> (32 - bits)
}
