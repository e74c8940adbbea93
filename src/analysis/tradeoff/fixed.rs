//! The fixed-point family: bits spent against error.

use rayon::prelude::*;
use serde::Serialize;

use super::input::{Input, Inputs};
use super::{Errors, Job, STATES, state};
use crate::format::ColorFormat;
use crate::model::NumericModel;
use crate::model::fixed::{FixedPoint, ProductRounding};

/// Widths swept, in bits; all three widths of a blender alike.
pub const WIDTHS: std::ops::RangeInclusive<u32> = 6..=16;

/// One member of the family.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FixedRow {
    /// Its name as a model.
    pub model: String,
    /// Width of source, factor and product.
    pub bits: u32,
    /// How products are rounded: `nearest` ..., or `fused`.
    pub rounding: &'static str,
    /// Straight over on rgba8unorm, random fragments, one layer.
    pub errors: Errors,
}

/// Every width and rounding, and blenders that round only the sum (fused).
#[must_use]
pub fn sweep(inputs: &Inputs, texels: u32) -> Vec<FixedRow> {
    let Ok(format) = ColorFormat::from_name("rgba8unorm") else { return Vec::new() };
    let job = Job { format, blend: state(STATES[0].1), layers: 1, texels, input: Input::Random };
    let mut members = Vec::new();
    for bits in WIDTHS {
        let widths = FixedPoint { source_bits: bits, factor_bits: bits, product_bits: bits, ..FixedPoint::default() };
        for rounding in ProductRounding::ALL {
            members.push((rounding.name(), FixedPoint { product_rounding: rounding, ..widths }));
        }
        members.push(("fused", FixedPoint { fused: true, ..widths }));
    }
    let row = |(rounding, member): &(&'static str, FixedPoint)| {
        let model: &dyn NumericModel = member;
        let (model, errors) = job.run(&[model], inputs).pop()?;
        Some(FixedRow { model, bits: member.source_bits, rounding, errors })
    };
    members.par_iter().filter_map(row).collect()
}
