//! Names of llvmpipe models: `llvmpipe:mesa=22.3,width=128,rsqrt=host`.

use super::rsqrt::EstimateError;
use super::{Estimate, Generation, Llvmpipe, VectorWidth};

/// The part of a name that says which driver: what is not said is left to the adapter or the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LlvmpipeName {
    /// `mesa=`.
    pub generation: Option<Generation>,
    /// `width=`.
    pub vector_width: Option<VectorWidth>,
    /// `rsqrt=`.
    pub estimate: Option<Estimate>,
}

/// A name that begins with `llvmpipe` and goes on wrongly.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LlvmpipeNameError {
    /// No such parameter.
    #[error(
        "`{0}` is no parameter of model `llvmpipe`; write mesa=VERSION, width=128 or 256, rsqrt=host, intel-xeon or amd-zen5, separated by commas"
    )]
    Parameter(String),
    /// A parameter given twice.
    #[error("model `llvmpipe`: `{0}=` is given twice")]
    Twice(String),
    /// A version no generation was proven on.
    #[error("no model of Mesa {version}; llvmpipe is proven on {known}; name one of those with mesa={}", names())]
    Version {
        /// The version asked for.
        version: String,
        /// The versions there are.
        known: String,
    },
    /// Another width.
    #[error("llvmpipe's vectors have 128 or 256 bits, not `{0}`")]
    Width(String),
    /// No such estimate.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
}

/// `22.3, 25.0 or 26.1`.
fn names() -> String {
    let [first, rest @ ..] = Generation::ALL.map(|generation| generation.facts().name);
    rest.iter().fold(first.to_owned(), |all, name| format!("{all}, {name}"))
}

impl LlvmpipeName {
    /// Reads what follows `llvmpipe` in a name: nothing, or `:` and parameters. `None` if the name is another model's.
    ///
    /// # Errors
    /// [`LlvmpipeNameError`] for a wrong parameter.
    #[must_use]
    pub fn parse(name: &str) -> Option<Result<Self, LlvmpipeNameError>> {
        match name.strip_prefix("llvmpipe")? {
            "" => Some(Ok(Self::default())),
            // The short form of `llvmpipe:width=128`.
            ":128" => Some(Ok(Self { vector_width: Some(VectorWidth::Bits128), ..Self::default() })),
            rest => Some(Self::parameters(rest.strip_prefix(':')?)),
        }
    }

    fn parameters(text: &str) -> Result<Self, LlvmpipeNameError> {
        let mut name = Self::default();
        for parameter in text.split(',') {
            let unknown = || LlvmpipeNameError::Parameter(parameter.to_owned());
            let (key, value) = parameter.trim().split_once('=').ok_or_else(unknown)?;
            let twice = match key {
                "mesa" => name.generation.replace(generation(value)?).is_some(),
                "width" => name.vector_width.replace(vector_width(value)?).is_some(),
                "rsqrt" => name.estimate.replace(Estimate::from_name(value)?).is_some(),
                _ => return Err(unknown()),
            };
            if twice {
                return Err(LlvmpipeNameError::Twice(key.to_owned()));
            }
        }
        Ok(name)
    }

    /// The model: what the name does not say is as in `otherwise`.
    #[must_use]
    pub fn resolve(self, otherwise: Llvmpipe) -> Llvmpipe {
        Llvmpipe {
            generation: self.generation.unwrap_or(otherwise.generation),
            vector_width: self.vector_width.unwrap_or(otherwise.vector_width),
            estimate: self.estimate.unwrap_or(otherwise.estimate),
        }
    }
}

fn generation(version: &str) -> Result<Generation, LlvmpipeNameError> {
    Generation::from_name(version).ok_or_else(|| LlvmpipeNameError::Version {
        version: version.to_owned(),
        known: Generation::ALL.map(Generation::range).join(", "),
    })
}

fn vector_width(bits: &str) -> Result<VectorWidth, LlvmpipeNameError> {
    match bits {
        "128" => Ok(VectorWidth::Bits128),
        "256" => Ok(VectorWidth::Bits256),
        _ => Err(LlvmpipeNameError::Width(bits.to_owned())),
    }
}

/// The whole name, which selects the same model on every machine (`rsqrt=host` aside). Vectors of 256 bits are not named.
pub(super) fn name(model: Llvmpipe) -> String {
    let Llvmpipe { generation, vector_width, estimate } = model;
    let width = match vector_width {
        VectorWidth::Bits256 => "",
        VectorWidth::Bits128 => ",width=128",
    };
    format!("llvmpipe:mesa={generation}{width},rsqrt={}", estimate.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::NumericModel;

    fn model(name: &str) -> Result<Llvmpipe, LlvmpipeNameError> {
        let name = LlvmpipeName::parse(name).expect("llvmpipe's")?;
        Ok(name.resolve(Llvmpipe::default()))
    }

    #[test]
    fn parameters_come_in_any_order_and_what_is_not_said_is_the_default() {
        let narrow = Llvmpipe {
            generation: Generation::Mesa22_3,
            vector_width: VectorWidth::Bits128,
            estimate: Estimate::AmdZen5,
        };
        assert_eq!(model("llvmpipe:rsqrt=amd-zen5,mesa=22.3,width=128"), Ok(narrow));
        assert_eq!(model("llvmpipe:width=128, rsqrt=amd-zen5, mesa=22.3.6"), Ok(narrow));
        assert_eq!(model("llvmpipe"), Ok(Llvmpipe::default()));
        assert_eq!(model("llvmpipe:128"), model("llvmpipe:width=128"));
        assert_eq!(model("llvmpipe:mesa=26.2"), model("llvmpipe:mesa=26.1"));
    }

    #[test]
    fn every_model_is_found_by_its_name() {
        for generation in Generation::ALL {
            for vector_width in [VectorWidth::Bits128, VectorWidth::Bits256] {
                for estimate in Estimate::RECORDED.into_iter().chain(Estimate::host()) {
                    let this = Llvmpipe { generation, vector_width, estimate };
                    assert_eq!(model(&this.name()), Ok(this), "{}", this.name());
                }
            }
        }
    }

    #[test]
    fn wrong_parameters_are_named() {
        for (name, says) in [
            ("llvmpipe:", "no parameter"),
            ("llvmpipe:mesa", "no parameter"),
            ("llvmpipe:llvm=15", "`llvm=15` is no parameter"),
            ("llvmpipe:mesa=24.0", "proven on 22.3.6, 25.0.7, 26.1.6 to 26.2.6"),
            ("llvmpipe:width=512", "128 or 256"),
            ("llvmpipe:rsqrt=via", "intel-xeon"),
            ("llvmpipe:width=128,width=128", "twice"),
        ] {
            let error = model(name).expect_err(name).to_string();
            assert!(error.contains(says), "{name}: {error}");
        }
        assert!(LlvmpipeName::parse("llvmpipes").is_none() && LlvmpipeName::parse("f32").is_none());
    }
}
