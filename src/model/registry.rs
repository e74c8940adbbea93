//! Numeric models by name.

use super::NumericModel;
use super::binary16::Binary16;
use super::binary32::Binary32;
use super::exact::Exact;
use super::fixed::{FixedPoint, FixedSpecError};
use super::llvmpipe::{Estimate, Generation, Llvmpipe, LlvmpipeName, LlvmpipeNameError, VectorWidth};
use super::nvidia::Nvidia;
use super::swiftshader::{self, SwiftShader};
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
    /// A SwiftShader of no known build.
    #[error(transparent)]
    SwiftShader(#[from] swiftshader::GenerationError),
    /// A llvmpipe with a wrong parameter.
    #[error(transparent)]
    Llvmpipe(#[from] LlvmpipeNameError),
}

/// The short names that [`by_name`] takes; `fixed` and `llvmpipe` also take other parameters after a colon.
pub const NAMES: [&str; 13] = [
    "exact",
    "exact:ties-away",
    "f32",
    "f16",
    "fixed:8",
    "llvmpipe",
    "llvmpipe:mesa=22.3",
    "llvmpipe:mesa=25.0",
    "llvmpipe:mesa=26.1",
    "llvmpipe:128",
    "swiftshader",
    "swiftshader:chromium=110",
    "nvidia",
];

/// The drivers that plain names stand for: those of an adapter where one is at hand, else the newest that were proven, with a
/// recorded processor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drivers {
    /// What a name that begins with `llvmpipe` leaves unsaid.
    pub llvmpipe: Llvmpipe,
    /// What `swiftshader` alone means.
    pub swiftshader: SwiftShader,
}

/// The model with this name.
///
/// # Errors
/// [`ModelNameError`], listing the names or the wrong parameter.
pub fn by_name(name: &str) -> Result<Box<dyn NumericModel>, ModelNameError> {
    by_name_among(name, Drivers::default())
}

/// The model with this name; what the name of a driver leaves unsaid is as in `drivers`.
///
/// # Errors
/// [`ModelNameError`], listing the names or the wrong parameter.
pub fn by_name_among(name: &str, drivers: Drivers) -> Result<Box<dyn NumericModel>, ModelNameError> {
    if let Some(llvmpipe) = llvmpipe(name, drivers)? {
        return Ok(Box::new(llvmpipe));
    }
    Ok(match name {
        "exact" => Box::new(Exact::default()),
        "exact:ties-away" => Box::new(Exact { rounding: Rounding::NearestAway }),
        "exact:toward-zero" => Box::new(Exact { rounding: Rounding::TowardZero }),
        "f32" => Box::new(Binary32),
        "f16" => Box::new(Binary16),
        "swiftshader" => Box::new(drivers.swiftshader),
        "nvidia" | "nvidia:gpu=h100" => Box::new(Nvidia),
        "fixed" => Box::new(FixedPoint::default()),
        _ => match name.strip_prefix("fixed:") {
            Some(spec) => Box::new(spec.parse::<FixedPoint>()?),
            None => match name.strip_prefix("swiftshader:") {
                Some(build) => Box::new(SwiftShader { generation: swiftshader::Generation::from_parameter(build)? }),
                None => return Err(ModelNameError::Unknown(name.to_owned())),
            },
        },
    })
}

/// The llvmpipe of this name; `None` for the name of another model.
///
/// # Errors
/// [`LlvmpipeNameError`] for a wrong parameter.
pub fn llvmpipe(name: &str, drivers: Drivers) -> Result<Option<Llvmpipe>, LlvmpipeNameError> {
    let name = LlvmpipeName::parse(name).transpose()?;
    Ok(name.map(|name| name.resolve(drivers.llvmpipe)))
}

/// One model of each kind, `exact` first.
#[must_use]
pub fn all() -> Vec<Box<dyn NumericModel>> {
    all_among(Drivers::default())
}

/// One model of each kind, `exact` first, the drivers' those given.
#[must_use]
pub fn all_among(drivers: Drivers) -> Vec<Box<dyn NumericModel>> {
    vec![
        Box::new(Exact::default()),
        Box::new(Binary32),
        Box::new(Binary16),
        Box::new(FixedPoint::default()),
        Box::new(drivers.llvmpipe),
        Box::new(drivers.swiftshader),
    ]
}

/// Every llvmpipe with a recorded processor: each generation, width and estimate.
pub fn every_llvmpipe() -> impl Iterator<Item = Llvmpipe> {
    let widths = [VectorWidth::Bits256, VectorWidth::Bits128];
    let each = move |generation| {
        let with_width =
            move |vector_width| Estimate::RECORDED.map(|estimate| Llvmpipe { generation, vector_width, estimate });
        widths.into_iter().flat_map(with_width)
    };
    Generation::ALL.into_iter().flat_map(each)
}

/// [`all`], with every generation of the drivers and the GPUs: what must hold of any model.
#[must_use]
pub fn every_generation() -> Vec<Box<dyn NumericModel>> {
    let newest = Llvmpipe::default();
    let older = every_llvmpipe()
        .filter(move |model| model.vector_width == newest.vector_width && model.estimate == newest.estimate)
        .filter(move |model| model.generation != newest.generation);
    let swiftshaders = swiftshader::Generation::ALL.into_iter().filter(|generation| *generation != Default::default());
    let swiftshaders = swiftshaders.map(|generation| Box::new(SwiftShader { generation }) as Box<dyn NumericModel>);
    let older = older.map(|model| Box::new(model) as Box<dyn NumericModel>);
    let hardware: [Box<dyn NumericModel>; 1] = [Box::new(Nvidia)];
    all().into_iter().chain(older).chain(swiftshaders).chain(hardware).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_names_name_every_generation() {
        for generation in Generation::ALL {
            assert!(NAMES.contains(&format!("llvmpipe:mesa={generation}").as_str()), "{generation}");
        }
        for name in NAMES {
            by_name(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    }

    #[test]
    fn an_adapter_s_driver_fills_in_what_a_name_leaves_unsaid() {
        let llvmpipe =
            Llvmpipe { generation: Generation::Mesa22_3, estimate: Estimate::AmdZen5, ..Llvmpipe::default() };
        let name = |name| by_name_among(name, Drivers { llvmpipe, ..Drivers::default() }).map(|model| model.name());
        assert_eq!(name("llvmpipe").as_deref(), Ok("llvmpipe:mesa=22.3,rsqrt=amd-zen5"));
        assert_eq!(name("llvmpipe:mesa=25.0").as_deref(), Ok("llvmpipe:mesa=25.0,rsqrt=amd-zen5"));
        assert_eq!(by_name("llvmpipe").map(|model| model.name()).as_deref(), Ok("llvmpipe:mesa=26.1,rsqrt=intel-xeon"));
    }
}
