//! Numeric models by name.

use super::NumericModel;
use super::binary16::Binary16;
use super::binary32::Binary32;
use super::exact::Exact;
use super::fixed::{FixedPoint, FixedSpecError};
use super::llvmpipe::{Llvmpipe, VectorWidth};
use super::swiftshader::SwiftShader;
use crate::format::Rounding;

/// A model name that names nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ModelNameError {
    /// No such model.
    #[error("unknown numeric model `{0}`; use one of: {names}", names = NAMES.join(", "))]
    Unknown(String),
    /// A fixed-point model with a wrong parameter.
    #[error(transparent)]
    Fixed(#[from] FixedSpecError),
}

/// The names [`by_name`] takes; `fixed` also takes parameters after a colon.
pub const NAMES: [&str; 8] =
    ["exact", "exact:ties-away", "f32", "f16", "fixed:8", "llvmpipe", "llvmpipe:128", "swiftshader"];

/// The model with this name.
///
/// # Errors
/// [`ModelNameError`], listing the names or the wrong parameter.
pub fn by_name(name: &str) -> Result<Box<dyn NumericModel>, ModelNameError> {
    Ok(match name {
        "exact" => Box::new(Exact::default()),
        "exact:ties-away" => Box::new(Exact { rounding: Rounding::NearestAway }),
        "exact:toward-zero" => Box::new(Exact { rounding: Rounding::TowardZero }),
        "f32" => Box::new(Binary32),
        "f16" => Box::new(Binary16),
        "llvmpipe" => Box::new(Llvmpipe::default()),
        "llvmpipe:128" => Box::new(Llvmpipe { vector_width: VectorWidth::Bits128 }),
        "swiftshader" => Box::new(SwiftShader),
        "fixed" => Box::new(FixedPoint::default()),
        _ => match name.strip_prefix("fixed:") {
            Some(spec) => Box::new(spec.parse::<FixedPoint>()?),
            None => return Err(ModelNameError::Unknown(name.to_owned())),
        },
    })
}

/// One model of each kind, `exact` first.
#[must_use]
pub fn all() -> Vec<Box<dyn NumericModel>> {
    vec![
        Box::new(Exact::default()),
        Box::new(Binary32),
        Box::new(Binary16),
        Box::new(FixedPoint::default()),
        Box::new(Llvmpipe::default()),
        Box::new(SwiftShader),
    ]
}
