//! The parameters of a fixed-point blender, and their one-line form.

use std::fmt;
use std::str::FromStr;

use super::ProductRounding;
use crate::format::Rounding;

/// A member of the fixed-point family.
///
/// Written `fixed:8`, or `fixed:source=8,factor=8,product=10,rounding=truncate,store=truncate,fused`; what is left out
/// takes the default: all widths 8, everything to nearest, not fused. A bare number sets all three widths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedPoint {
    /// Width of source, constant and destination codes, 2 to 24.
    pub source_bits: u32,
    /// Width of a factor, 2 to 24.
    pub factor_bits: u32,
    /// Width of a product, 2 to 24.
    pub product_bits: u32,
    /// Rounding of shader outputs and constants to `source_bits`.
    pub source_rounding: Rounding,
    /// Rounding of products to `product_bits`.
    pub product_rounding: ProductRounding,
    /// Rounding of the result to the target's width.
    pub store_rounding: Rounding,
    /// Whether products keep all their bits until the store.
    pub fused: bool,
}

impl Default for FixedPoint {
    fn default() -> Self {
        Self {
            source_bits: 8,
            factor_bits: 8,
            product_bits: 8,
            source_rounding: Rounding::NearestEven,
            product_rounding: ProductRounding::Nearest,
            store_rounding: Rounding::NearestEven,
            fused: false,
        }
    }
}

/// A fixed-point specification that does not parse.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{item}` in a fixed-point model: {problem}; write e.g. `fixed:8` or \
     `fixed:source=8,factor=8,product=10,rounding=nearest|truncate|shift|shift-twice|stretch,\
     take-in=nearest|truncate,store=nearest|truncate,fused`"
)]
pub struct FixedSpecError {
    /// The part that is wrong.
    pub item: String,
    /// What is wrong with it.
    pub problem: &'static str,
}

/// Rounding names of the source and the store.
const ROUNDINGS: [(&str, Rounding); 3] =
    [("nearest", Rounding::NearestEven), ("nearest-away", Rounding::NearestAway), ("truncate", Rounding::TowardZero)];

impl FromStr for FixedPoint {
    type Err = FixedSpecError;

    fn from_str(text: &str) -> Result<Self, FixedSpecError> {
        let mut spec = Self::default();
        for item in text.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let error = |problem| FixedSpecError { item: item.to_owned(), problem };
            let width = |text: &str| {
                let bits: u32 = text.parse().map_err(|_| error("not a number of bits"))?;
                if (2..=24).contains(&bits) { Ok(bits) } else { Err(error("widths are 2 to 24 bits")) }
            };
            let rounding = |text: &str| {
                let found = ROUNDINGS.iter().find(|(name, _)| *name == text);
                found.map(|(_, rounding)| *rounding).ok_or_else(|| error("unknown rounding"))
            };
            match item.split_once('=') {
                None if item == "fused" => spec.fused = true,
                None => {
                    let bits = width(item)?;
                    (spec.source_bits, spec.factor_bits, spec.product_bits) = (bits, bits, bits);
                }
                Some(("source", value)) => spec.source_bits = width(value)?,
                Some(("factor", value)) => spec.factor_bits = width(value)?,
                Some(("product", value)) => spec.product_bits = width(value)?,
                Some(("take-in", value)) => spec.source_rounding = rounding(value)?,
                Some(("store", value)) => spec.store_rounding = rounding(value)?,
                Some(("rounding", value)) => {
                    let found = ProductRounding::ALL.into_iter().find(|rounding| rounding.name() == value);
                    spec.product_rounding = found.ok_or_else(|| error("unknown product rounding"))?;
                }
                Some(_) => return Err(error("unknown parameter")),
            }
        }
        Ok(spec)
    }
}

impl fmt::Display for FixedPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let default = Self::default();
        let (source, factor, product) = (self.source_bits, self.factor_bits, self.product_bits);
        if source == factor && factor == product {
            write!(f, "fixed:{source}")?;
        } else {
            write!(f, "fixed:source={source},factor={factor},product={product}")?;
        }
        let name = |rounding| ROUNDINGS.iter().find(|(_, known)| *known == rounding).map_or("", |(name, _)| name);
        if self.product_rounding != default.product_rounding {
            write!(f, ",rounding={}", self.product_rounding.name())?;
        }
        if self.source_rounding != default.source_rounding {
            write!(f, ",take-in={}", name(self.source_rounding))?;
        }
        if self.store_rounding != default.store_rounding {
            write!(f, ",store={}", name(self.store_rounding))?;
        }
        if self.fused { write!(f, ",fused") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specifications_survive_printing_and_parsing() {
        for text in ["fixed:8", "fixed:12,fused", "fixed:source=8,factor=9,product=16,rounding=stretch,store=truncate"]
        {
            let spec: FixedPoint = text.strip_prefix("fixed:").expect("prefix").parse().expect("valid");
            assert_eq!(spec.to_string(), text, "round trip");
        }
    }

    #[test]
    fn mistakes_are_named() {
        for (text, problem) in [
            ("1", "widths are 2 to 24 bits"),
            ("rounding=up", "unknown product rounding"),
            ("x=3", "unknown parameter"),
        ] {
            let error = text.parse::<FixedPoint>().expect_err(text);
            assert_eq!(error.problem, problem, "{text}");
        }
    }
}
