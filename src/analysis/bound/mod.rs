//! A proven bound on how far a stack of translucent layers can drift from real arithmetic.
//!
//! N layers of one alpha A and any colors are drawn straight over a stored color (`src-alpha`, `one-minus-src-alpha`).
//! In real numbers D' = A s + (1 - A) D. The target stores d' = A s + (1 - A) d + r, where |r| is at most the [`step`]
//! error of one layer, whatever s and d are. So the error E = |d - D| obeys
//!
//! E' <= (1 - A) E + r, from E = 0, hence E after N layers <= r (1 - (1 - A)^N) / A <= r / A.
//!
//! Colors lie in `[0, 1]` (`[-1, 1]` on snorm targets), where every stored value then stays. The recurrence is run in
//! binary64 with every operation rounded up, so the printed bound is one.

mod adversary;
mod step;
#[cfg(test)]
mod tests;

use serde::Serialize;
use wgpu_types::BlendState;

pub use adversary::adversary;
pub use step::step;

use crate::format::{ColorFormat, TargetClass};
use crate::limit::Limits;
use crate::model::{NumericModel, Unsupported};

/// The state the bound is for.
pub const STATE: BlendState = BlendState::ALPHA_BLENDING;

/// Layers that [`Growth::layers_within`] follows at most.
pub const MAX_LAYERS: u32 = 10_000_000;

/// A question without a proven bound.
#[derive(Debug, thiserror::Error)]
pub enum BoundError {
    /// Alpha outside the range in which errors shrink.
    #[error("alpha {0} is outside [0, 1]; beyond it errors grow with every layer and no bound holds")]
    Alpha(f32),
    /// Too many layers.
    #[error(
        "{layers} layers are more than the limit `layers`, {limit}; the bound hardly grows any more, see its limit"
    )]
    Layers {
        /// As many were asked for.
        layers: u32,
        /// The limit.
        limit: u64,
    },
    /// The model's rounding of one layer has no proven bound here.
    #[error(
        "no bound is proven for model `{model}` on {format}; use exact or f32 on any format, llvmpipe on rgba8unorm or \
         bgra8unorm, or a fixed model whose products have the target's width (fixed:8 on 8 bits), not fused"
    )]
    Model {
        /// The model.
        model: String,
        /// The format.
        format: &'static str,
    },
    /// The model does not cover the format.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
}

/// The bound for one format and model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// The format.
    pub format: &'static str,
    /// The numeric model.
    pub model: String,
    /// Alpha of every layer.
    pub alpha: f32,
    /// Layers.
    pub layers: u32,
    /// The largest error one layer adds, as a value (1 = white).
    pub step: f64,
    /// The largest error after all layers, as a value; linear light on sRGB targets.
    pub error: f64,
    /// The same in codes of an 8-bit target, for comparing formats.
    pub codes: f64,
    /// The bound for any number of layers, as a value: step / alpha, at most the whole range.
    pub limit: f64,
    /// The most layers with which the bound stays within `tolerance`; `None` if any number of them does.
    pub layers_within: Option<u32>,
    /// The tolerance of `layers_within`, in codes of an 8-bit target.
    pub tolerance: f64,
}

/// The growth of the bound, layer by layer.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    step: f64,
    keep: f64,
    range: f64,
}

impl Growth {
    /// Bounds of this format, model and alpha.
    ///
    /// # Errors
    /// [`BoundError`].
    pub fn new(format: ColorFormat, model: &dyn NumericModel, alpha: f32) -> Result<Self, BoundError> {
        if !(0.0..=1.0).contains(&alpha) {
            return Err(BoundError::Alpha(alpha));
        }
        model.supports(format, Some(&STATE))?;
        let step = step(format, model, alpha)?;
        let keep = 1.0 - f64::from(alpha);
        // 1 - A is exact unless A is tiny; then one step up covers the rounding.
        let keep = if 1.0 - keep == f64::from(alpha) { keep } else { keep.next_up() };
        let range = if format.class() == TargetClass::Snorm { 2.0 } else { 1.0 };
        Ok(Self { step, keep, range })
    }

    /// The error one layer adds.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The bound after one more layer.
    #[must_use]
    pub fn after(&self, error: f64) -> f64 {
        if self.step == 0.0 && error == 0.0 {
            return 0.0;
        }
        ((self.keep * error).next_up() + self.step).next_up().min(self.range)
    }

    /// The bound after this many layers. Stops early once it no longer grows.
    #[must_use]
    pub fn error(&self, layers: u32) -> f64 {
        let mut error = 0.0;
        for _ in 0..layers {
            let next = self.after(error);
            if next <= error {
                break;
            }
            error = next;
        }
        error
    }

    /// The most layers with a bound of at most `error`, `None` if any number of them has.
    #[must_use]
    pub fn layers_within(&self, limit: f64) -> Option<u32> {
        let mut error = 0.0;
        for layers in 0..MAX_LAYERS {
            let next = self.after(error);
            if next > limit {
                return Some(layers);
            }
            if next <= error {
                return None;
            }
            error = next;
        }
        Some(MAX_LAYERS)
    }
}

/// The bound for `layers` layers of one alpha; `tolerance` in codes of an 8-bit target. The default limits hold.
///
/// # Errors
/// [`BoundError`].
pub fn bound(
    format: ColorFormat,
    model: &dyn NumericModel,
    alpha: f32,
    layers: u32,
    tolerance: f64,
) -> Result<Bound, BoundError> {
    bound_within(format, model, alpha, layers, tolerance, &Limits::default())
}

/// [`bound`] within other limits.
///
/// # Errors
/// [`BoundError`].
pub fn bound_within(
    format: ColorFormat,
    model: &dyn NumericModel,
    alpha: f32,
    layers: u32,
    tolerance: f64,
    limits: &Limits,
) -> Result<Bound, BoundError> {
    if u64::from(layers) > limits.layers {
        return Err(BoundError::Layers { layers, limit: limits.layers });
    }
    let growth = Growth::new(format, model, alpha)?;
    let error = growth.error(layers);
    let limit = match (growth.step, alpha) {
        (0.0, _) => 0.0,
        (_, 0.0) => growth.range,
        (step, alpha) => (step / f64::from(alpha)).next_up().min(growth.range),
    };
    Ok(Bound {
        format: format.name(),
        model: model.name(),
        alpha,
        layers,
        step: growth.step,
        error,
        codes: 255.0 * error,
        limit,
        layers_within: growth.layers_within(tolerance / 255.0),
        tolerance,
    })
}
