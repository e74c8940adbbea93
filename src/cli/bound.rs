//! `outmerge bound`: how far a stack of layers can drift at most.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, Outcome, limits, output};
use crate::analysis::bound::{self, Bound, BoundError, Growth};
use crate::analysis::stability::stack;
use crate::format::ColorFormat;
use crate::model::{NumericModel, registry};
use crate::report::section::bound as section;

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

/// As JSON has it.
#[derive(serde::Serialize)]
struct Bounds<'a> {
    bounds: &'a [Row],
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
            match bound::bound_within(format, model.as_ref(), self.alpha, self.layers, self.tolerance, limits::get()) {
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
            output::write_chart(path, &section::chart(&curves, self.layers))?;
        }
        if self.json {
            output::print_json("bound", &Bounds { bounds: &rows })?;
        } else {
            output::print(&self.text(&rows))?;
        }
        Ok(Outcome::Done)
    }

    fn row(&self, format: ColorFormat, model: &dyn NumericModel, bound: Bound) -> Row {
        let found = self.search.then(|| 255.0 * bound::adversary(format, model, self.alpha, self.layers));
        Row { bound, found }
    }

    fn text(&self, rows: &[Row]) -> String {
        let bounds: Vec<Bound> = rows.iter().map(|row| row.bound.clone()).collect();
        let found: Option<Vec<f64>> = rows.iter().map(|row| row.found).collect();
        format!(
            "{} layers of alpha {}, any colors, straight over, in {}: the stored color is at most this far from real\n\
             arithmetic (linear light on sRGB targets)\n\n{}",
            self.layers,
            self.alpha,
            self.model,
            output::text(&section::table(&bounds, found.as_deref()))
        )
    }
}
