//! `outmerge stability`: stiff stacks, extreme values, depth ranges, drawing order.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{Failure, Outcome, output, render};
use crate::analysis::stability::{depth, extreme, order, stack};
use crate::model::{NumericModel, registry};
use crate::report::section::{Table, stability as section};

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
    #[arg(long, value_delimiter = ',', default_values_t = section::SCENES.map(str::to_owned))]
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
            output::print_json("stability", &found)?;
        } else {
            output::print(&text(&found))?;
        }
        Ok(Outcome::Done)
    }

    fn draw(&self, found: &Found) -> Result<(), Failure> {
        if let Some(path) = &self.plot {
            let rows = found.stacks.as_deref().ok_or("--plot draws stacks; add `stacks` to --parts")?;
            output::write_chart(path, &section::chart(rows, stack::Family::Thin))?;
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

fn text(found: &Found) -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut part = |finding: &str, tables: &[Table]| {
        let tables: Vec<String> = tables.iter().map(output::text).collect();
        let finding = if finding.is_empty() { String::new() } else { format!("{finding}\n\n") };
        parts.push(finding + &tables.join("\n"));
    };
    if let Some(rows) = &found.stacks {
        part(&stack::finding(rows), &[section::stack_table(rows, &found.models)]);
    }
    if let (Some(rows), Some(depths)) = (&found.extremes, &found.extreme_depths) {
        let tables = [section::extreme_table(rows, &found.models), section::extreme_depth_table(depths, &found.models)];
        part(&extreme::finding(rows), &tables);
    }
    if let Some(rows) = &found.depth {
        part(&depth::finding(rows), &[section::depth_table(rows)]);
    }
    for report in found.order.iter().flatten() {
        part("", &[section::order_table(report)]);
    }
    parts.join("\n")
}
