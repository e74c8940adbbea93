//! Premultiplied storage.

use super::{Failure, Figure, Section, Table, percent, short};
use crate::analysis::texture::{self, Options, Source, Space, composite::Background, table};
use crate::analysis::texture::{ImageReport, PipelineReport};
use crate::model::NumericModel;
use crate::model::exact::Exact;
use crate::report::plot::{Axis, Chart, Mark, Series};
use crate::scene::Picture;
use crate::scene::texture::Pattern;
use crate::scene::texture::pattern::PatternImage;

/// The section's anchor.
pub const ID: &str = "texture";

/// The technique whose scenes show what this section measures.
pub const TECHNIQUE: &str = "premultiplied-precision";

/// A row a storage, with the smallest PSNR over the models for each background.
#[must_use]
pub fn storages(report: &ImageReport) -> Table {
    let backgrounds = Background::ALL.map(|background| format!("over {}", background.name()));
    let fixed = ["storage", "worst", "mean", "texels changed"];
    let mut table = Table::new(
        "Colors made straight again, in codes of 8 bits; and the image drawn once: the smallest PSNR of any model",
        fixed.into_iter().chain(backgrounds.iter().map(String::as_str)),
    );
    for row in &report.pipelines {
        let cells = [row.pipeline.name().to_owned(), short(row.worst), short(row.mean), percent(row.texels_changed)];
        let drawn = Background::ALL.map(|background| psnr(row, background));
        table.add(cells.into_iter().chain(drawn));
    }
    table
}

/// The smallest PSNR over the models and the model that has it.
fn psnr(row: &PipelineReport, background: Background) -> String {
    let over = row.composites.iter().filter(|composite| composite.background == background);
    let lossy = over.filter_map(|composite| composite.psnr.map(|psnr| (psnr, composite)));
    match lossy.min_by(|(a, _), (b, _)| a.total_cmp(b)) {
        None => "exact".to_owned(),
        Some((psnr, composite)) => format!("{psnr:.1} dB {}", composite.model),
    }
}

/// A soft puff of fire and smoke, as straight colors.
fn sample() -> Source {
    const SIDE: u32 = 96;
    let picture = PatternImage {
        pattern: Pattern::Radial,
        size: [SIDE, SIDE],
        colors: [[1.0, 0.75, 0.3, 1.0], [0.9, 0.2, 0.05, 0.0]],
        cells: 1,
    };
    let texels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| picture.codes(x, y).map(u16::from))).collect();
    Source { name: "soft disc".to_owned(), width: SIDE, height: SIDE, bits: 8, space: Space::Srgb, texels }
}

/// Every (color, alpha) pair: color across, alpha down.
fn every_pair() -> Source {
    let texels = (0..=255).flat_map(|alpha| (0..=255).map(move |color| [color, color, color, alpha])).collect();
    Source { name: "every color and alpha".to_owned(), width: 256, height: 256, bits: 8, space: Space::Srgb, texels }
}

/// The section.
///
/// # Errors
/// None is expected.
pub fn section(models: &[&dyn NumericModel]) -> Result<Section, Failure> {
    let exact = Exact::default();
    let source = sample();
    let report = texture::measure(&source, &Options { models, exact: &exact, cutoff: 0.5 });
    let pairs = texture::measure(&every_pair(), &Options { models: &[], exact: &exact, cutoff: 0.5 });
    let bytes = |texel: &[u16; 4]| texel.map(|code| u8::try_from(code).unwrap_or(u8::MAX));
    let picture =
        Picture { width: source.width, height: source.height, rgba: source.texels.iter().flat_map(bytes).collect() };
    let mut figures = vec![Figure::chart("Largest error of a color that was stored premultiplied in 8 bits", chart())];
    figures.push(Figure::picture("A soft-edged sprite", picture));
    figures.extend(report.heat_map.clone().map(|map| Figure::picture("Its recovered colors' errors", map)));
    figures
        .extend(pairs.heat_map.map(|map| Figure::picture("The same for every color (across) and alpha (down)", map)));
    Ok(Section {
        id: ID,
        title: "What storing colors premultiplied costs",
        finding: format!("A soft-edged sprite: {}.", report.verdict),
        method: "A premultiplied 8-bit color keeps alpha + 1 levels and is missed by up to floor(127 / alpha + 1/2) codes \
                 when made straight again. Drawn once, the loss hides under the drawing's own rounding. Heat maps use the \
                 colors of the scenes' ones."
            .to_owned(),
        figures,
        tables: vec![storages(&report)],
        command: "outmerge texture IMAGE.png".to_owned(),
    })
}

/// The analytic worst error against alpha.
fn chart() -> Chart {
    let worst = |alpha: u8| (f64::from(alpha), f64::from(table::worst_error(alpha)));
    let levels = |alpha: u8| (f64::from(alpha), f64::from(table::levels(alpha)));
    let series = |name: &str, of: &dyn Fn(u8) -> (f64, f64)| Series {
        name: name.to_owned(),
        points: (1..=255).map(of).collect(),
        mark: Mark::Line,
    };
    Chart {
        x: Axis::new("alpha, code of 8 bits", 1.0),
        y: Axis::new("codes; levels", 0.5),
        series: vec![series("worst error", &worst), series("levels left", &levels)],
    }
}
