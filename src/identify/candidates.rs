//! What a blender may turn out to be.

use crate::format::Rounding;
use crate::model::NumericModel;
use crate::model::fixed::{FixedPoint, ProductRounding};
use crate::model::llvmpipe::{Estimate, Llvmpipe};
use crate::model::registry;

/// A model under suspicion.
#[derive(Debug)]
pub enum Candidate {
    /// A named model.
    Named(Box<dyn NumericModel>),
    /// A member of the fixed-point family.
    Fixed(FixedPoint),
}

impl Candidate {
    /// The model.
    #[must_use]
    pub fn model(&self) -> &dyn NumericModel {
        match self {
            Self::Named(model) => model.as_ref(),
            Self::Fixed(model) => model,
        }
    }

    /// The name that selects it.
    #[must_use]
    pub fn name(&self) -> String {
        self.model().name()
    }
}

/// Widths the family is searched over: those of 8- to 16-bit hardware and coarser, and one that stands for sources that
/// are not quantised at all.
pub const WIDTHS: [u32; 16] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 24];

/// Every fixed-point blender of these widths that can be told from the others.
///
/// To the nearest even and to the nearest away are the same. A store never ties, as codes have odd denominators; of the
/// sources only 1/2 does, and goes up to an even code. A fused blender rounds no product, so its product's width and rounding count for nothing.
pub fn family() -> impl Iterator<Item = FixedPoint> {
    const ROUNDINGS: [Rounding; 2] = [Rounding::NearestEven, Rounding::TowardZero];
    let pairs = WIDTHS.into_iter().flat_map(|source_bits| WIDTHS.map(|factor_bits| (source_bits, factor_bits)));
    let bases = pairs.flat_map(|(source_bits, factor_bits)| {
        ROUNDINGS.into_iter().flat_map(move |source_rounding| {
            ROUNDINGS.map(|store_rounding| FixedPoint {
                source_bits,
                factor_bits,
                source_rounding,
                store_rounding,
                ..FixedPoint::default()
            })
        })
    });
    bases.flat_map(|base| {
        let products = WIDTHS.into_iter().flat_map(move |product_bits| {
            ProductRounding::ALL.map(|product_rounding| FixedPoint { product_bits, product_rounding, ..base })
        });
        products.chain([FixedPoint { fused: true, product_bits: base.factor_bits, ..base }])
    })
}

/// Every llvmpipe: all generations and widths with every recorded processor, and with this machine's where it is none of
/// those.
fn llvmpipes() -> impl Iterator<Item = Llvmpipe> {
    let unknown = Estimate::host().filter(|host| Estimate::RECORDED.iter().all(|known| known.table() != host.table()));
    let first = Estimate::RECORDED[0];
    let here = unknown.into_iter().flat_map(move |estimate| {
        let each = registry::every_llvmpipe().filter(move |model| model.estimate == first);
        each.map(move |model| Llvmpipe { estimate, ..model })
    });
    registry::every_llvmpipe().chain(here)
}

/// Every candidate: the named models, then the family.
///
/// # Panics
/// Never: the names are those of the registry.
#[must_use]
pub fn candidates() -> Vec<Candidate> {
    let apart = |name: &&&str| !name.starts_with("fixed") && !name.starts_with("llvmpipe");
    let plain = registry::NAMES.iter().chain(&["exact:toward-zero"]).filter(apart);
    let plain = plain.map(|name| Candidate::Named(registry::by_name(name).expect("a name of the registry")));
    let llvmpipes = llvmpipes().map(|model| Candidate::Named(Box::new(model)));
    plain.chain(llvmpipes).chain(family().map(Candidate::Fixed)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn members_of_the_family_are_all_different() {
        let members: Vec<FixedPoint> = family().collect();
        assert_eq!(members.len(), 16 * 16 * 2 * 2 * (16 * 5 + 1), "widths, roundings, and the fused ones");
        assert_eq!(members.iter().collect::<HashSet<_>>().len(), members.len(), "no member twice");
        assert!(members.contains(&FixedPoint::default()), "8 bits throughout");
    }
}
