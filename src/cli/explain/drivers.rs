//! The same driver elsewhere: what llvmpipes of other versions of Mesa and of other processors store, and why.

use std::fmt::Write as _;

use serde::Serialize;

use super::Question;
use super::compare::table;
use super::layout::{bytes, wrap};
use crate::format::{ChannelKind, Codes};
use crate::merger::write_mask;
use crate::model::NumericModel;
use crate::model::llvmpipe::{Estimate, Generation, Llvmpipe};

/// Drivers that follow the same rules on the format in question.
#[derive(Debug, Serialize)]
pub(super) struct Variant {
    /// Their names, short: `mesa=26.1`, `rsqrt=amd-zen5`.
    names: Vec<String>,
    /// What tells them from the others, in words.
    rules: Vec<&'static str>,
    /// The codes stored, write mask applied.
    stored: Codes,
    /// The other codes that may be stored, where that depends on the driver's history.
    or: Option<Codes>,
}

/// The variants of a llvmpipe that differ by rule on the format in question; none where all are alike.
pub(super) fn variants(model: Llvmpipe, question: &Question) -> Vec<Variant> {
    let format = question.inputs.format;
    let mut variants: Vec<Variant> = Vec::new();
    for generation in Generation::ALL {
        let (name, rules) = (format!("mesa={generation}"), generation.rules().words(format));
        match variants.iter_mut().find(|known| known.rules == rules) {
            Some(known) => known.names.push(name),
            None => variants.push(variant(Llvmpipe { generation, ..model }, name, rules, question)),
        }
    }
    if variants.len() < 2 {
        variants.clear();
    }
    if format.channels().contains(&ChannelKind::Srgb) {
        for estimate in Estimate::RECORDED {
            let (name, rules) = (format!("rsqrt={}", estimate.name()), vec![estimate.processor()]);
            variants.push(variant(Llvmpipe { estimate, ..model }, name, rules, question));
        }
    }
    variants
}

fn variant(model: Llvmpipe, name: String, rules: Vec<&'static str>, question: &Question) -> Variant {
    let select = |codes| write_mask::select(question.mask, question.inputs.dst, codes);
    Variant {
        names: vec![name],
        rules,
        stored: select(model.merge_color(&question.inputs)),
        or: model.alternative(&question.inputs).map(select),
    }
}

/// The variants as a table of codes, and the rules below.
pub(super) fn text(variants: &[Variant], question: &Question) -> String {
    if variants.is_empty() {
        return String::new();
    }
    let format = question.inputs.format;
    let stored: Vec<usize> = (0..4).filter(|&i| question.stores(i)).collect();
    let row = |name: String, codes: Codes| {
        let mut row = vec![format!("  {name}")];
        row.extend(stored.iter().map(|&i| super::layout::code(codes[i], format)));
        row.push(format!("  {}", bytes(codes, format)));
        row
    };
    let mut rows = Vec::new();
    for variant in variants {
        rows.push(row(variant.names.join(", "), variant.stored));
        rows.extend(variant.or.map(|codes| row("  or".to_owned(), codes)));
    }
    let columns = rows[0].len();
    let mut text = format!("\nllvmpipe elsewhere\n{}", table(&rows, |column| column > 0 && column < columns - 1));
    for variant in variants {
        let line = wrap(&format!("{}: {}", variant.names.join(", "), variant.rules.join("; ")), 2);
        line.lines().for_each(|line| {
            let _ = writeln!(text, "  {line}");
        });
    }
    text
}
