//! Stiff stacks, extreme values, depth ranges, drawing order.

use super::{Failure, Figure, Section, Table, percent, short};
use crate::analysis::stability::{depth, extreme, order, stack};
use crate::model::NumericModel;
use crate::model::exact::Exact;
use crate::report::plot::{Axis, Chart, Mark, Series};
use crate::scene::Scene;

/// Layers of the report's stacks.
const LAYERS: u32 = 4096;

/// Scenes whose draws the report permutes.
pub const SCENES: [&str; 4] = ["order-near-first", "overlap-zwrite-off", "intersecting-sorted", "queue-order"];

/// Stacks of one family, drawn back to front in the first model: a line a format.
#[must_use]
pub fn chart(rows: &[stack::StackRow], family: stack::Family) -> Chart {
    let first = rows.first().map_or("", |row| row.model.as_str());
    let of = |row: &&stack::StackRow| {
        row.family == family && row.direction == stack::Direction::BackToFront && row.model == first
    };
    let series = rows.iter().filter(of).map(|row| Series {
        name: row.format.to_owned(),
        points: row.errors.iter().map(|(layers, error)| (f64::from(*layers), *error)).collect(),
        mark: Mark::Line,
    });
    Chart {
        x: Axis::new(&format!("layers, {}", family.name()), 1.0),
        y: Axis::new("error, codes of 8 bits", 1e-6),
        series: series.collect(),
    }
}

/// A row a family, direction and format; a column a model.
#[must_use]
pub fn stack_table(rows: &[stack::StackRow], models: &[String]) -> Table {
    let header = ["alphas", "direction", "format"].into_iter().chain(models.iter().map(String::as_str));
    let mut table = Table::new("Worst error after any layer, in codes of 8 bits", header.chain(["stuck from layer"]));
    let mut keys: Vec<_> = rows.iter().map(|row| (row.family, row.direction, row.format)).collect();
    keys.dedup();
    for key in keys {
        let cells: Vec<&stack::StackRow> =
            rows.iter().filter(|row| (row.family, row.direction, row.format) == key).collect();
        let cell = |model: &String| {
            cells.iter().find(|row| row.model == *model).map_or("-".to_owned(), |row| short(row.worst))
        };
        let stop = cells.iter().find_map(|row| row.stagnates_at.map(|at| format!("{at} ({})", row.model)));
        let names = [key.0.name().to_owned(), key.1.name().to_owned(), key.2.to_owned()];
        table.add(names.into_iter().chain(models.iter().map(cell)).chain([stop.unwrap_or_default()]));
    }
    table
}

/// A row a case; a column a model, and the rules.
#[must_use]
pub fn extreme_table(rows: &[extreme::ExtremeRow], models: &[String]) -> Table {
    let header = ["case", "format", "state"].into_iter().chain(models.iter().map(String::as_str));
    let mut table =
        Table::new("Extreme values: what red stores, and what the APIs say", header.chain(["Vulkan", "Direct3D"]));
    for row in rows {
        let names = [row.name, row.format, row.state].map(str::to_owned);
        let outcomes = row.outcomes.iter().map(|outcome| outcome.clone().unwrap_or("-".to_owned()));
        table.add(names.into_iter().chain(outcomes).chain([row.vulkan, row.d3d].map(str::to_owned)));
    }
    table
}

/// A row a depth and format; a column a model, and the rule.
#[must_use]
pub fn extreme_depth_table(rows: &[extreme::DepthRow], models: &[String]) -> Table {
    let header = ["depth", "format"].into_iter().chain(models.iter().map(String::as_str));
    let mut table = Table::new("Extreme depths, as stored", header.chain(["rule"]));
    for row in rows {
        let names = [row.name, row.format].map(str::to_owned);
        table.add(names.into_iter().chain(row.outcomes.iter().cloned()).chain([row.rule.to_owned()]));
    }
    table
}

/// A row a range, format and direction.
#[must_use]
pub fn depth_table(rows: &[depth::DepthRow]) -> Table {
    let gaps = depth::GAPS.map(|gap| format!("lost at {} %", 100.0 * gap));
    let header = ["far / near", "format", "depth"].into_iter().chain(gaps.iter().map(String::as_str));
    let mut table =
        Table::new("Pairs of surfaces that a depth target does not tell apart, by their relative gap", header);
    for row in rows {
        let direction = if row.reversed { "reversed" } else { "standard" };
        let names = [format!("{:e}", row.ratio), row.format.to_owned(), direction.to_owned()];
        table.add(names.into_iter().chain(row.lost.map(percent)));
    }
    table
}

/// Pairs lost at the middle gap, against far / near: a line a format and direction.
#[must_use]
pub fn depth_chart(rows: &[depth::DepthRow]) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let name = format!("{}{}", row.format, if row.reversed { ", reversed" } else { "" });
        let point = (row.ratio, 100.0 * row.lost[1]);
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(Series { name, points: vec![point], mark: Mark::Line }),
        }
    }
    Chart {
        x: Axis::new("far / near", 1.0),
        y: Axis::new("% of pairs 0.1 % apart that are lost", 0.0).linear(),
        series,
    }
}

/// What other orders did to one scene, in a sentence.
#[must_use]
pub fn order_finding(report: &order::OrderReport) -> String {
    let [x, y] = report.worst_at;
    format!(
        "{}, {} draws in {}: {} of {} pixels depend on the order{}",
        report.scene,
        report.draws.len(),
        report.model,
        report.pixels_sensitive,
        report.pixels,
        if report.worst == 0 { String::new() } else { format!(", by up to {} codes at ({x}, {y})", report.worst) }
    )
}

/// A row an order.
#[must_use]
pub fn order_table(report: &order::OrderReport) -> Table {
    let mut table = Table::new(&order_finding(report), ["order", "pixels differing", "max error", "mean error"]);
    for permutation in &report.permutations {
        let d = &permutation.difference;
        let mean = format!("{:.4}", d.mean_codes());
        table.add([permutation.name.clone(), d.pixels_differing.to_string(), d.max_codes.to_string(), mean]);
    }
    table
}

/// Stacks.
///
/// # Errors
/// None is expected.
pub fn stack_section(models: &[&dyn NumericModel]) -> Result<Section, Failure> {
    let names: Vec<String> = models.iter().map(|model| model.name()).collect();
    let stacks = stack::stacks(models, LAYERS);
    Ok(Section {
        id: "stacks",
        title: "Stiff stacks of layers",
        finding: stack::finding(&stacks),
        method:
            "Every stack is compared with the same layers in real numbers. Front to back needs the target's alpha, \
                 whose rounding ends the stack early."
                .to_owned(),
        figures: vec![
            Figure::chart(
                "One color in layers of alpha 1/255: the error grows until the target is stuck",
                chart(&stacks, stack::Family::Thin),
            ),
            Figure::chart(
                "Alphas 1/255 and 254/255 in turn: strong layers wipe old errors out",
                chart(&stacks, stack::Family::Stiff),
            ),
        ],
        tables: vec![stack_table(&stacks, &names)],
        command: format!("outmerge stability --parts stacks --layers {LAYERS}"),
    })
}

/// Extreme values and depth.
///
/// # Errors
/// None is expected.
pub fn extreme_section(models: &[&dyn NumericModel]) -> Result<Section, Failure> {
    let names: Vec<String> = models.iter().map(|model| model.name()).collect();
    let extremes = extreme::extremes(models);
    let depths = depth::precision(&Exact::default());
    Ok(Section {
        id: "extremes",
        title: "Extreme values and steep depth ranges",
        finding: format!("{} {}", extreme::finding(&extremes), depth::finding(&depths)),
        method:
            "Extreme values are single blends; WebGPU leaves their outcome to its back ends. Depth: pairs of surfaces \
                 all over the range go through projection and depth store."
                .to_owned(),
        figures: vec![Figure::chart("Depth formats as far / near grows", depth_chart(&depths))],
        tables: vec![
            extreme_table(&extremes, &names),
            extreme_depth_table(&extreme::depths(models), &names),
            depth_table(&depths),
        ],
        command: "outmerge stability --parts extremes,depth".to_owned(),
    })
}

/// Drawing orders.
///
/// # Errors
/// When a bundled scene does not render.
pub fn order_section(models: &[&dyn NumericModel]) -> Result<Section, Failure> {
    let exact = Exact::default();
    let model = models.first().copied().unwrap_or(&exact);
    let mut reports = Vec::new();
    for name in SCENES {
        let scene = Scene::bundled_by_name(name).ok_or_else(|| format!("no bundled scene `{name}`"))??;
        reports.push(order::sensitivity(&scene, model)?);
    }
    let worst = reports.iter().max_by_key(|report| report.worst);
    Ok(Section {
        id: "order",
        title: "Which pixels depend on the drawing order",
        finding: worst.map_or(String::new(), |report| format!("The most sensitive scene: {}.", order_finding(report))),
        method:
            "The draws of a scene are reversed, swapped with their neighbours and shuffled; pictures show the largest \
                 difference of each pixel over all orders, in the heat maps' colors."
                .to_owned(),
        figures: reports.iter().map(|report| Figure::picture(&report.scene, report.heat_map.clone())).collect(),
        tables: reports.iter().map(order_table).collect(),
        command: format!("outmerge stability --parts order --scenes {}", SCENES.join(",")),
    })
}
