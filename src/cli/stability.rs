//! `outmerge stability`: stiff stacks, extreme values, depth ranges, drawing order.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{Failure, Outcome, output, render};
use crate::analysis::stability::{depth, extreme, order, stack};
use crate::model::{NumericModel, registry};
use crate::report::plot::{Axis, Chart, Mark, Series};

/// Arguments of `stability`.
#[derive(Debug, Args)]
pub(super) struct Stability {
    /// The parts to run; all unless given.
    #[arg(long, short, value_enum, value_delimiter = ',')]
    parts: Vec<Part>,
    /// Numeric models, comma separated; one of each kind unless given.
    #[arg(long, short, value_delimiter = ',')]
    models: Vec<String>,
    /// Layers of the deepest stack.
    #[arg(long, short = 'n', default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    layers: u32,
    /// Scenes whose draws are permuted (file or bundled name), comma separated.
    #[arg(long, value_delimiter = ',', default_value = "order-near-first,overlap-zwrite-off,intersecting-sorted")]
    scenes: Vec<String>,
    /// Draw the errors of stacks against their layers (SVG).
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Folder for pictures of the pixels that depend on the drawing order; made if missing.
    #[arg(long, value_name = "DIR")]
    heat_maps: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// A part of the analysis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Error against the number of layers.
    Stacks,
    /// NaN, infinities, overflow, clamps.
    Extremes,
    /// Depth formats against far / near.
    Depth,
    /// Other drawing orders.
    Order,
}

/// Everything found; parts that were not asked for are missing.
#[derive(Debug, Default, serde::Serialize)]
struct Found {
    models: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stacks: Option<Vec<stack::StackRow>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extremes: Option<Vec<extreme::ExtremeRow>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extreme_depths: Option<Vec<extreme::DepthRow>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<Vec<depth::DepthRow>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    order: Option<Vec<order::OrderReport>>,
}

impl Stability {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let models = if self.models.is_empty() {
            registry::all()
        } else {
            self.models.iter().map(|name| registry::by_name(name)).collect::<Result<_, _>>()?
        };
        let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
        let wanted = |part| self.parts.is_empty() || self.parts.contains(&part);
        let mut found = Found { models: models.iter().map(|model| model.name()).collect(), ..Found::default() };
        if wanted(Part::Stacks) {
            found.stacks = Some(stack::stacks(&models, self.layers));
        }
        if wanted(Part::Extremes) {
            found.extremes = Some(extreme::extremes(&models));
            found.extreme_depths = Some(extreme::depths(&models));
        }
        if wanted(Part::Depth) {
            found.depth = Some(depth::precision(models[0]));
        }
        if wanted(Part::Order) {
            let scenes = self
                .scenes
                .iter()
                .map(|name| -> Result<_, Failure> { Ok(order::sensitivity(&render::load(name)?, models[0])?) });
            found.order = Some(scenes.collect::<Result<_, _>>()?);
        }
        self.draw(&found)?;
        if self.json {
            output::print_json(&found)?;
        } else {
            output::print(&text(&found))?;
        }
        Ok(Outcome::Fine)
    }

    fn draw(&self, found: &Found) -> Result<(), Failure> {
        if let Some(path) = &self.plot {
            let rows = found.stacks.as_deref().ok_or("--plot draws stacks; add `stacks` to --parts")?;
            output::write_chart(path, &chart(rows, stack::Family::Thin))?;
        }
        if let Some(folder) = &self.heat_maps {
            let reports = found.order.as_deref().ok_or("--heat-maps shows orders; add `order` to --parts")?;
            std::fs::create_dir_all(folder)
                .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
            for (index, report) in reports.iter().enumerate() {
                let png = report.heat_map.to_png()?;
                let path = folder.join(format!("order-{index}.png"));
                output::write_file(&path, |file| Ok(file.write_all(&png)?))?;
            }
        }
        Ok(())
    }
}

/// Stacks of one family, drawn back to front in `exact`: a line a format.
pub(super) fn chart(rows: &[stack::StackRow], family: stack::Family) -> Chart {
    let of = |row: &&stack::StackRow| row.family == family && row.direction == stack::Direction::BackToFront;
    let first = rows.first().map_or("", |row| row.model.as_str());
    let series = rows.iter().filter(of).filter(|row| row.model == first).map(|row| Series {
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

fn text(found: &Found) -> String {
    let mut text = String::new();
    let mut part = |finding: String, tables: &[String]| {
        if !text.is_empty() {
            text.push('\n');
        }
        let _ = writeln!(text, "{finding}\n");
        tables.iter().for_each(|table| text.push_str(table));
    };
    if let Some(rows) = &found.stacks {
        let intro = format!("{}\nWorst error after any layer, in codes of 8 bits", stack::finding(rows));
        part(intro.trim_start().to_owned(), &[stack_table(rows, &found.models)]);
    }
    if let (Some(rows), Some(depths)) = (&found.extremes, &found.extreme_depths) {
        part(
            extreme::finding(rows),
            &[extreme_table(rows, &found.models), "\n".to_owned(), depth_rules(depths, &found.models)],
        );
    }
    if let Some(rows) = &found.depth {
        part(depth::finding(rows), &[depth_table(rows)]);
    }
    for report in found.order.iter().flatten() {
        part(order_finding(report), &[order_table(report)]);
    }
    text
}

/// A row a family, direction and format; a column a model.
fn stack_table(rows: &[stack::StackRow], models: &[String]) -> String {
    let header = ["alphas", "direction", "format"].into_iter().chain(models.iter().map(String::as_str));
    let mut table = output::table(header.chain(["last layer to count"]));
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
        table.add_row(names.into_iter().chain(models.iter().map(cell)).chain([stop.unwrap_or_default()]));
    }
    output::lines(&table)
}

fn extreme_table(rows: &[extreme::ExtremeRow], models: &[String]) -> String {
    let header = ["case", "format", "state"].into_iter().chain(models.iter().map(String::as_str));
    let mut table = output::table(header.chain(["Vulkan", "Direct3D"]));
    for row in rows {
        let names = [row.name, row.format, row.state].map(str::to_owned);
        let outcomes = row.outcomes.iter().map(|outcome| outcome.clone().unwrap_or("-".to_owned()));
        table.add_row(names.into_iter().chain(outcomes).chain([row.vulkan, row.d3d].map(str::to_owned)));
    }
    output::lines(&table)
}

fn depth_rules(rows: &[extreme::DepthRow], models: &[String]) -> String {
    let header = ["depth", "format"].into_iter().chain(models.iter().map(String::as_str));
    let mut table = output::table(header.chain(["rule"]));
    for row in rows {
        let names = [row.name, row.format].map(str::to_owned);
        table.add_row(names.into_iter().chain(row.outcomes.iter().cloned()).chain([row.rule.to_owned()]));
    }
    output::lines(&table)
}

fn depth_table(rows: &[depth::DepthRow]) -> String {
    let gaps = depth::GAPS.map(|gap| format!("lost at {} %", 100.0 * gap));
    let header = ["far / near", "format", "depth"].into_iter().chain(gaps.iter().map(String::as_str));
    let mut table = output::table(header);
    for row in rows {
        let direction = if row.reversed { "reversed" } else { "standard" };
        let names = [format!("{:e}", row.ratio), row.format.to_owned(), direction.to_owned()];
        table.add_row(names.into_iter().chain(row.lost.map(|share| format!("{:.1} %", 100.0 * share))));
    }
    output::lines(&table)
}

fn order_finding(report: &order::OrderReport) -> String {
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

fn order_table(report: &order::OrderReport) -> String {
    let mut table = output::table(["order", "pixels differing", "max error", "mean error"]);
    for permutation in &report.permutations {
        let d = &permutation.difference;
        table.add_row([
            permutation.name.clone(),
            d.pixels_differing.to_string(),
            d.max_codes.to_string(),
            format!("{:.4}", d.mean_codes()),
        ]);
    }
    output::lines(&table)
}

/// Three digits.
fn short(x: f64) -> String {
    match x {
        0.0 => "0".to_owned(),
        x if x < 0.001 => format!("{x:.1e}"),
        x if x < 1.0 => format!("{x:.4}"),
        x => format!("{x:.2}"),
    }
}
