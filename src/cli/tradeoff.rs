//! `outmerge tradeoff`: error against run time.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, output};
use crate::analysis::texture::Source;
use crate::analysis::tradeoff::clock::{self, Time};
use crate::analysis::tradeoff::fixed::{self, FixedRow};
use crate::analysis::tradeoff::front::{self, Point};
use crate::analysis::tradeoff::input::Inputs;
use crate::analysis::tradeoff::{FORMATS, LAYERS, Row, Survey, jobs, survey};
use crate::format::ColorFormat;
use crate::model::{NumericModel, registry};
use crate::report::plot::{Axis, Chart, Mark, Series};

/// Arguments of `tradeoff`.
#[derive(Debug, Args)]
pub(super) struct Tradeoff {
    /// Formats, comma separated; one of each kind unless given.
    #[arg(long, short, value_delimiter = ',')]
    formats: Vec<String>,
    /// Numeric models, comma separated; one of each kind unless given.
    #[arg(long, short, value_delimiter = ',')]
    models: Vec<String>,
    /// Depths of stacks, comma separated, of 1, 10, 100 and 1000; all unless given.
    #[arg(long, short = 'n', value_delimiter = ',')]
    layers: Vec<u32>,
    /// A PNG for the picture input instead of the built-in one.
    #[arg(long)]
    image: Option<PathBuf>,
    /// Seed of the random and adversarial inputs.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Texels of each stack, as a multiple of the usual number.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    effort: u32,
    /// Every row (state and input) instead of one a model, format and depth.
    #[arg(long)]
    rows: bool,
    /// Draw error against time (SVG).
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Draw error against bits of the fixed-point family (SVG).
    #[arg(long, value_name = "FILE")]
    plot_fixed: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Everything measured.
#[derive(Debug, serde::Serialize)]
struct Measured {
    points: Vec<Point>,
    rows: Vec<Row>,
    times: Vec<Time>,
    fixed: Vec<FixedRow>,
}

impl Tradeoff {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let models = if self.models.is_empty() {
            registry::all()
        } else {
            self.models.iter().map(|name| registry::by_name(name)).collect::<Result<_, _>>()?
        };
        let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
        let formats: Vec<&str> = if self.formats.is_empty() {
            FORMATS.to_vec()
        } else {
            self.formats
                .iter()
                .map(|name| ColorFormat::from_name(name).map(ColorFormat::name))
                .collect::<Result<_, _>>()?
        };
        let inputs = match &self.image {
            None => Inputs::new(self.seed),
            Some(path) => Inputs::with_picture(self.seed, &Source::load(path, None)?),
        };
        let layers = self.layers()?;
        let what = Survey { models: &models, inputs: &inputs, formats: &formats, layers: &layers };
        let times = clock::times(&models, &formats, &inputs)?;
        let bar = ProgressBar::new(jobs(&what) as u64)
            .with_style(ProgressStyle::with_template("drawing {bar:40} {pos}/{len} stacks {elapsed}")?);
        let rows = survey(&what, &|| bar.inc(1));
        bar.finish_and_clear();
        let fixed = fixed::sweep(&inputs, 4096 * self.effort);
        let measured = Measured { points: front::points(&rows, &times), rows, times, fixed };
        if let Some(path) = &self.plot {
            output::write_chart(path, &scatter(&measured.points))?;
        }
        if let Some(path) = &self.plot_fixed {
            output::write_chart(path, &fixed_chart(&measured.fixed))?;
        }
        if self.json {
            output::print_json(&measured)?;
        } else {
            output::print(&self.text(&measured))?;
        }
        Ok(Outcome::Fine)
    }

    fn layers(&self) -> Result<Vec<(u32, u32)>, Failure> {
        if let Some(unknown) = self.layers.iter().find(|n| LAYERS.iter().all(|(layers, _)| layers != *n)) {
            return Err(format!("--layers {unknown} is not surveyed; use 1, 10, 100 or 1000").into());
        }
        let wanted = LAYERS.into_iter().filter(|(layers, _)| self.layers.is_empty() || self.layers.contains(layers));
        Ok(wanted.map(|(layers, texels)| (layers, texels * self.effort)).collect())
    }

    fn text(&self, measured: &Measured) -> String {
        let mut text = format!("{}\n\n", front_finding(&measured.points));
        text.push_str(
            "Errors in codes of the target (numbers between, for floats), all states and inputs; * is on the front\n",
        );
        let table = if self.rows { row_table(&measured.rows) } else { point_table(&measured.points) };
        text.push_str(&table);
        let _ = writeln!(
            text,
            "\nThe fixed-point family, straight over on rgba8unorm: mean error in codes by width and rounding"
        );
        text.push_str(&fixed_table(&measured.fixed));
        text
    }
}

/// The fastest and the most accurate on 8 bits, in a sentence.
pub(super) fn front_finding(points: &[Point]) -> String {
    let mut eight: Vec<&Point> = points.iter().filter(|p| p.format == "rgba8unorm" && p.layers == 1).collect();
    eight.sort_by(|a, b| a.ns_per_fragment.total_cmp(&b.ns_per_fragment));
    let names: Vec<&str> = eight.iter().filter(|point| point.on_front).map(|point| point.model.as_str()).collect();
    match (eight.first(), eight.iter().find(|point| point.mean == 0.0)) {
        (Some(fast), Some(exact)) => format!(
            "On rgba8unorm {} takes {:.0} ns a fragment in the reference merger and errs in {:.1} % of pixels; no error at all \
             costs {:.0} ns ({}). On the front: {}.",
            fast.model,
            fast.ns_per_fragment,
            100.0 * fast.pixels_off,
            exact.ns_per_fragment,
            exact.model,
            names.join(", ")
        ),
        (Some(fast), None) => {
            format!("On rgba8unorm {} is the fastest: {:.0} ns a fragment.", fast.model, fast.ns_per_fragment)
        }
        _ => "Errors against exact, and time in the reference merger.".to_owned(),
    }
}

fn point_table(points: &[Point]) -> String {
    let mut table = output::table(["format", "layers", "model", "ns", "max", "mean", "bias", "pixels off", "front"]);
    for point in points {
        table.add_row([
            point.format.to_owned(),
            point.layers.to_string(),
            point.model.clone(),
            format!("{:.0}", point.ns_per_fragment),
            short(point.max),
            short(point.mean),
            short(point.bias),
            format!("{:.2} %", 100.0 * point.pixels_off),
            if point.on_front { "*".to_owned() } else { String::new() },
        ]);
    }
    output::lines(&table)
}

fn row_table(rows: &[Row]) -> String {
    let header = ["format", "state", "layers", "input", "model", "max", "mean", "RMS", "bias", "pixels off"];
    let mut table = output::table(header);
    for row in rows {
        let e = &row.errors;
        let names = [row.format.to_owned(), row.state.to_owned(), row.layers.to_string(), row.input.name().to_owned()];
        let figures =
            [short(e.max), short(e.mean), short(e.rms), short(e.bias), format!("{:.2} %", 100.0 * e.pixels_off)];
        table.add_row(names.into_iter().chain([row.model.clone()]).chain(figures));
    }
    output::lines(&table)
}

fn fixed_table(rows: &[FixedRow]) -> String {
    let mut roundings: Vec<&str> = Vec::new();
    for row in rows {
        if !roundings.contains(&row.rounding) {
            roundings.push(row.rounding);
        }
    }
    let mut table = output::table(["bits"].into_iter().chain(roundings.iter().copied()));
    for bits in fixed::WIDTHS {
        let cell = |rounding: &&str| {
            let row = rows.iter().find(|row| row.bits == bits && row.rounding == *rounding);
            row.map_or("-".to_owned(), |row| short(row.errors.mean))
        };
        table.add_row([bits.to_string()].into_iter().chain(roundings.iter().map(cell)));
    }
    output::lines(&table)
}

/// Error against time: a color a model, a dot a format and depth, and the front of rgba8unorm with one layer.
pub(super) fn scatter(points: &[Point]) -> Chart {
    let place = |point: &Point| (point.ns_per_fragment, point.mean);
    let mut series: Vec<Series> = Vec::new();
    for point in points {
        match series.iter_mut().find(|series| series.name == point.model) {
            Some(series) => series.points.push(place(point)),
            None => series.push(Series { name: point.model.clone(), points: vec![place(point)], mark: Mark::Dots }),
        }
    }
    let mut front: Vec<(f64, f64)> =
        points.iter().filter(|p| p.on_front && p.format == "rgba8unorm" && p.layers == 1).map(place).collect();
    if !front.is_empty() {
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        series.push(Series { name: "front, rgba8unorm, 1 layer".to_owned(), points: front, mark: Mark::Front });
    }
    Chart {
        x: Axis::new("ns per fragment, reference merger", 1.0),
        y: Axis::new("mean error, codes of the target (0 at the bottom)", 1e-5),
        series,
    }
}

/// Error against bits: a line a rounding.
pub(super) fn fixed_chart(rows: &[FixedRow]) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let point = (f64::from(row.bits), row.errors.mean);
        match series.iter_mut().find(|series| series.name == row.rounding) {
            Some(series) => series.points.push(point),
            None => series.push(Series { name: row.rounding.to_owned(), points: vec![point], mark: Mark::Line }),
        }
    }
    Chart {
        x: Axis::new("bits of source, factor and product", 1.0).linear(),
        y: Axis::new("mean error, codes of rgba8unorm", 1e-5),
        series,
    }
}

/// Three digits, with sign.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if !(0.001..1e5).contains(&size) => format!("{x:.1e}"),
        size if size < 1.0 => format!("{x:.4}"),
        _ => format!("{x:.2}"),
    }
}
