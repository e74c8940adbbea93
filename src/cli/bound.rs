//! `outmerge bound`: how far a stack of layers can drift at most.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, Outcome, output};
use crate::analysis::bound::{self, Bound, BoundError, Growth};
use crate::analysis::stability::stack;
use crate::format::ColorFormat;
use crate::model::{NumericModel, registry};
use crate::report::plot::{Axis, Chart, Mark, Series};

/// Arguments of `bound`.
#[derive(Debug, Args)]
pub(super) struct BoundCommand {
    /// Layers drawn straight over each other, of any colors.
    #[arg(long, short = 'n', default_value_t = 100)]
    layers: u32,
    /// Alpha of every layer, 0 to 1.
    #[arg(long, short, default_value_t = 0.1, allow_hyphen_values = true)]
    alpha: f32,
    /// The target's format, or `all`: one of each kind.
    #[arg(long, short, default_value = "all")]
    format: String,
    /// The numeric model: exact, f32, llvmpipe (8 bits), or fixed with products of the target's width.
    #[arg(long, short, default_value = "exact")]
    model: String,
    /// The error that may be, in codes of an 8-bit target: from how many layers on is a wider target needed?
    #[arg(long, default_value_t = 1.0)]
    tolerance: f64,
    /// Also search for a stack that comes close to the bound; takes long for many layers.
    #[arg(long)]
    search: bool,
    /// Draw the bounds against the number of layers (SVG).
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// A bound, and the farthest a search came.
#[derive(Debug, serde::Serialize)]
struct Row {
    #[serde(flatten)]
    bound: Bound,
    /// In codes of an 8-bit target.
    found: Option<f64>,
}

impl BoundCommand {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        if !self.tolerance.is_finite() || self.tolerance < 0.0 {
            return Err(format!("--tolerance {} is not a number of codes; use 0 or more", self.tolerance).into());
        }
        let names: &[&str] = if self.format == "all" { &stack::FORMATS } else { &[&self.format] };
        let (mut rows, mut curves) = (Vec::new(), Vec::new());
        for name in names {
            let format = ColorFormat::from_name(name)?;
            match bound::bound(format, model.as_ref(), self.alpha, self.layers, self.tolerance) {
                Ok(bound) => rows.push(self.row(format, model.as_ref(), bound)),
                // Among all formats some may have no bound; asked for alone it is an error.
                Err(BoundError::Model { .. } | BoundError::Unsupported(_)) if names.len() > 1 => continue,
                Err(error) => return Err(error.into()),
            }
            curves.push((format.name(), Growth::new(format, model.as_ref(), self.alpha)?));
        }
        if rows.is_empty() {
            return Err(format!("no bound is proven for model `{}` on any of: {}", self.model, names.join(", ")).into());
        }
        if let Some(path) = &self.plot {
            output::write_chart(path, &chart(&curves, self.layers))?;
        }
        if self.json {
            output::print_json(&rows)?;
        } else {
            output::print(&self.text(&rows))?;
        }
        Ok(Outcome::Fine)
    }

    fn row(&self, format: ColorFormat, model: &dyn NumericModel, bound: Bound) -> Row {
        let found = self.search.then(|| 255.0 * bound::adversary(format, model, self.alpha, self.layers));
        Row { bound, found }
    }

    fn text(&self, rows: &[Row]) -> String {
        let within = format!("layers within {}", self.tolerance);
        let header = ["format", "one layer", "all layers", "any number", within.as_str(), "found"];
        let mut table = output::table(header.into_iter().take(if self.search { 6 } else { 5 }));
        for Row { bound, found } in rows {
            let cells = [
                bound.format.to_owned(),
                codes(255.0 * bound.step),
                codes(bound.codes),
                codes(255.0 * bound.limit),
                bound.layers_within.map_or("any number".to_owned(), |layers| layers.to_string()),
            ];
            table.add_row(cells.into_iter().chain(found.map(codes)));
        }
        format!(
            "{} layers of alpha {}, any colors, straight over, in {}: the stored color is at most this far from real\n\
             arithmetic, in codes of an 8-bit target (linear light on sRGB targets)\n\n{}",
            self.layers,
            self.alpha,
            self.model,
            output::lines(&table)
        )
    }
}

/// Four digits of a bound, rounded up.
fn codes(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let scale = 10_f64.powf((3.0 - x.log10().floor()).max(0.0));
    let up = (x * scale * (1.0 - 1e-12)).ceil() / scale;
    if up < 1e-3 { format!("{up:.3e}") } else { up.to_string() }
}

/// The bounds against the number of layers.
fn chart(curves: &[(&str, Growth)], layers: u32) -> Chart {
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
