//! The bound on stacks.

use super::{Failure, Figure, Section, Table};
use crate::analysis::bound::{self, Bound, Growth};
use crate::analysis::stability::stack;
use crate::format::ColorFormat;
use crate::model::exact::Exact;
use crate::report::plot::{Axis, Chart, Mark, Series};

/// A row a bound; `found` adds the column of what a search reached.
#[must_use]
pub fn table(bounds: &[Bound], found: Option<&[f64]>) -> Table {
    let within = bounds.first().map_or(String::new(), |bound| format!("layers within {}", bound.tolerance));
    let header = ["format", "one layer", "all layers", "any number", within.as_str(), "found"];
    let mut table = Table::new(
        "In codes of an 8-bit target, rounded up",
        header.into_iter().take(5 + usize::from(found.is_some())),
    );
    for (i, bound) in bounds.iter().enumerate() {
        let cells = [
            bound.format.to_owned(),
            codes(255.0 * bound.step),
            codes(bound.codes),
            codes(255.0 * bound.limit),
            bound.layers_within.map_or("any number".to_owned(), |layers| layers.to_string()),
        ];
        table.add(cells.into_iter().chain(found.and_then(|found| found.get(i)).map(|error| codes(*error))));
    }
    table
}

/// Four digits of a bound, rounded up.
fn codes(x: f64) -> String {
    if x <= 0.0 {
        return "0".to_owned();
    }
    let scale = 10_f64.powf((3.0 - x.log10().floor()).max(0.0));
    let up = (x * scale * (1.0 - 1e-12)).ceil() / scale;
    if up < 1e-3 { format!("{up:.3e}") } else { up.to_string() }
}

/// The bounds against the number of layers, a line a format.
#[must_use]
pub fn chart(curves: &[(&str, Growth)], layers: u32) -> Chart {
    let series = curves.iter().map(|(name, growth)| {
        let mut points = Vec::new();
        let (mut error, mut shown) = (0.0, 1);
        for layer in 1..=layers {
            error = growth.after(error);
            if layer == shown || layer == layers {
                points.push((f64::from(layer), 255.0 * error));
                shown = (shown + shown.div_ceil(8)).max(shown + 1);
            }
        }
        Series { name: (*name).to_owned(), points, mark: Mark::Line }
    });
    Chart {
        x: Axis::new("layers", 1.0),
        y: Axis::new("largest possible error, codes of 8 bits", 1e-6),
        series: series.collect(),
    }
}

/// What the bounds say, in a sentence.
#[must_use]
pub fn finding(bounds: &[Bound]) -> String {
    let find = |format| bounds.iter().find(|bound| bound.format == format);
    let (Some(eight), Some(half)) = (find("rgba8unorm"), find("rgba16float")) else { return String::new() };
    let within = |bound: &Bound| match bound.layers_within {
        None => "any number of layers".to_owned(),
        Some(1) => "1 layer".to_owned(),
        Some(layers) => format!("{layers} layers"),
    };
    format!(
        "At alpha {} an 8-bit target is sure to be within {} code for {}, a half target for {}; {} layers can drift by {} \
         and {} codes.",
        eight.alpha,
        eight.tolerance,
        within(eight),
        within(half),
        eight.layers,
        codes(eight.codes),
        codes(half.codes)
    )
}

/// The section.
///
/// # Errors
/// None is expected: the question is a fixed one.
pub fn section() -> Result<Section, Failure> {
    const ALPHA: f32 = 0.1;
    const LAYERS: u32 = 100;
    let exact = Exact::default();
    let (mut bounds, mut found, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for name in stack::FORMATS {
        let format = ColorFormat::from_name(name)?;
        bounds.push(bound::bound(format, &exact, ALPHA, LAYERS, 1.0)?);
        found.push(255.0 * bound::adversary(format, &exact, ALPHA, LAYERS));
        curves.push((name, Growth::new(format, &exact, ALPHA)?));
    }
    Ok(Section {
        id: "bound",
        title: "How far stacks of layers can drift at most",
        finding: finding(&bounds),
        method: "Each layer adds at most one rounding r and shrinks the error so far by 1 - A: N layers are off by at most \
                 r (1 - (1 - A)^N) / A. The column `found` is what a search for a bad stack reached; sRGB errors are in \
                 linear light. For `exact`; the command knows bounds of other models."
            .to_owned(),
        figures: vec![Figure::chart("Proven bound on the error of N layers of alpha 0.1", chart(&curves, 1000))],
        tables: vec![table(&bounds, Some(&found))],
        command: format!("outmerge bound --layers {LAYERS} --alpha {ALPHA} --search"),
    })
}
