//! `f64` arithmetic that carries a bound on its own error: the fast path of `exact`.
//!
//! **Claim.** Let x be the real number a [`Value`] stands for. Then |x - `near`| <= `error`, and `error` is 0 only if
//! `near` is x, with x's IEEE 754 sign if x is zero.
//!
//! **Why it holds.** Shader outputs are `f32`, hence exact. Decoded codes are correctly rounded quotients, so half a
//! unit in the last place bounds their error. The rounding error of one addition or multiplication is itself an `f64`
//! (Knuth's two-sum, and a fused multiply-add), and is added to what the operands' errors contribute:
//! |xy - near(xy)| <= |x| e_y + |y| e_x + e_x e_y + r. That sum of non-negative terms is computed in `f64` with a
//! relative error below 2^-50, and `SLOP` covers it. Nothing overflows or underflows: finite `f32` inputs are below
//! 2^128 and, if not zero, at least 2^-149; the equation multiplies at most two of them, so every term lies between
//! 2^-500 and 2^260.
//!
//! **Store.** Encoding is monotone, so if both ends of the enclosing interval encode to one code, so does x. If they do
//! not, the rounding is in doubt and the caller starts again with exact numbers. A value without error needs no
//! interval, and its ties are decided as ties.

use std::cell::Cell;

use super::super::{Arithmetic, ColorInputs, Number};
use crate::format::srgb::Approximation;
use crate::format::{ChannelKind, ColorFormat, Rounding, TargetClass, snorm, srgb, unorm};

/// Covers the rounding of the error bounds' own arithmetic.
const SLOP: f64 = 1.0 + 1.0 / (1_u64 << 48) as f64;

/// A real number near an `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The `f64`, finite.
    pub near: f64,
    /// |real - near| <= error; 0 means equal.
    pub error: f64,
}

/// `f64` arithmetic with error bounds.
#[derive(Debug)]
pub struct Bounded {
    rounding: Rounding,
    in_doubt: Cell<bool>,
}

impl Bounded {
    /// An arithmetic that stores with this rounding.
    #[must_use]
    pub fn new(rounding: Rounding) -> Self {
        Self { rounding, in_doubt: Cell::new(false) }
    }

    /// Whether a rounding could not be decided since the last question.
    pub fn in_doubt(&self) -> bool {
        self.in_doubt.replace(false)
    }

    /// Whether all inputs are finite, as this arithmetic needs them.
    #[must_use]
    pub fn covers(inputs: &ColorInputs) -> bool {
        let finite = |color: &[f32; 4]| color.iter().all(|x| x.is_finite());
        let stored_finite = |(code, kind): (&u32, ChannelKind)| match kind {
            ChannelKind::Float(layout) => layout.decode(*code).is_finite(),
            _ => true,
        };
        [&inputs.src, &inputs.src1, &inputs.constant].into_iter().all(finite)
            && inputs.dst.iter().zip(inputs.format.channels()).all(stored_finite)
    }

    /// The code both ends of the interval store as, or doubt.
    fn encode_by(&self, x: &Value, encode: impl Fn(f64) -> Option<u32>) -> u32 {
        let code = if x.error == 0.0 {
            encode(x.near)
        } else {
            let low = encode((x.near - x.error).next_down());
            let high = encode((x.near + x.error).next_up());
            low.filter(|_| low == high)
        };
        code.unwrap_or_else(|| {
            self.in_doubt.set(true);
            0
        })
    }
}

/// A number that is its `f64`.
fn exact(near: f64) -> Value {
    Value { near, error: 0.0 }
}

/// A quotient of small integers, correctly rounded: half an ulp of error, none where it is an integer.
fn quotient(numerator: f64, denominator: f64) -> Value {
    let near = numerator / denominator;
    let error = if near * denominator == numerator && near.fract() == 0.0 { 0.0 } else { near.abs() * f64::EPSILON };
    Value { near, error }
}

impl Arithmetic for Bounded {
    type Value = Value;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> Value {
        exact(f64::from(x))
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> Value {
        match kind {
            ChannelKind::Absent => exact(0.0),
            ChannelKind::Unorm(bits) => quotient(f64::from(code), f64::from(unorm::steps(bits))),
            ChannelKind::Snorm(bits) => {
                quotient(f64::from(snorm::signed_code(code, bits)), f64::from(snorm::steps(bits)))
            }
            ChannelKind::Srgb => {
                let Approximation { value, error } = srgb::decode(code);
                Value { near: value, error }
            }
            ChannelKind::Float(layout) => exact(layout.decode(code)),
        }
    }

    fn zero(&self) -> Value {
        exact(0.0)
    }

    fn one(&self) -> Value {
        exact(1.0)
    }

    fn complement(&self, x: &Value) -> Value {
        self.subtract(&exact(1.0), x)
    }

    #[expect(clippy::disallowed_methods, reason = "a fused multiply-add is what gives a product's rounding error")]
    fn multiply(&self, x: &Value, factor: &Value) -> Value {
        let near = x.near * factor.near;
        let residual = x.near.mul_add(factor.near, -near).abs();
        let inherited = x.near.abs() * factor.error + factor.near.abs() * x.error + x.error * factor.error;
        Value { near, error: (inherited + residual) * SLOP }
    }

    fn add(&self, x: &Value, y: &Value) -> Value {
        let near = x.near + y.near;
        // Knuth's two-sum: the rounding error of an addition, exactly.
        let y_part = near - x.near;
        let residual = ((x.near - (near - y_part)) + (y.near - y_part)).abs();
        Value { near, error: (x.error + y.error + residual) * SLOP }
    }

    fn subtract(&self, x: &Value, y: &Value) -> Value {
        self.add(x, &Value { near: -y.near, error: y.error })
    }

    fn minimum(&self, x: &Value, y: &Value) -> Value {
        let y_is_less = y.near < x.near || (y.near == x.near && y.near.is_sign_negative());
        let near = if y_is_less { y.near } else { x.near };
        // Minimum and maximum move by no more than the operand that moves most.
        Value { near, error: x.error.max(y.error) }
    }

    fn maximum(&self, x: &Value, y: &Value) -> Value {
        let negated = |v: &Value| Value { near: -v.near, error: v.error };
        negated(&self.minimum(&negated(x), &negated(y)))
    }

    fn clamp(&self, x: &Value, class: TargetClass) -> Value {
        // Clamping brings numbers no further apart. -0 clamps to +0 on unsigned targets, where no code tells them apart.
        let near = match class {
            TargetClass::Unorm => x.near.clamp(0.0, 1.0),
            TargetClass::Snorm => x.near.clamp(-1.0, 1.0),
            TargetClass::Float => x.near,
        };
        Value { near, error: x.error }
    }

    fn encode(&self, x: &Value, kind: ChannelKind) -> u32 {
        let rounding = self.rounding;
        self.encode_by(x, |near| match kind {
            ChannelKind::Absent => Some(0),
            ChannelKind::Unorm(bits) => Some(unorm::encode(near, bits, rounding)),
            ChannelKind::Snorm(bits) => Some(snorm::encode(near, bits, rounding)),
            ChannelKind::Srgb if rounding == Rounding::TowardZero => srgb::encode_toward_zero(near),
            ChannelKind::Srgb => srgb::encode(near),
            ChannelKind::Float(layout) => Some(layout.encode(near, rounding)),
        })
    }

    fn describe(&self, x: &Value) -> Number {
        Number::near(x.near)
    }
}
