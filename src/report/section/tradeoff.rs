//! Error against run time.

use super::{Failure, Figure, Section, Table, percent, short};
use crate::analysis::tradeoff::clock;
use crate::analysis::tradeoff::fixed::{self, FixedRow};
use crate::analysis::tradeoff::front::{self, Point};
use crate::analysis::tradeoff::input::Inputs;
use crate::analysis::tradeoff::{FORMATS, LAYERS, Row, Survey, survey};
use crate::model::NumericModel;
use crate::report::plot::{Axis, Chart, Mark, Series};

/// The fastest and the most accurate on 8 bits, in a sentence.
#[must_use]
pub fn finding(points: &[Point]) -> String {
    let mut eight: Vec<&Point> = points.iter().filter(|p| p.format == "rgba8unorm" && p.layers == 1).collect();
    eight.sort_by(|a, b| a.ns_that_runs().total_cmp(&b.ns_that_runs()));
    let names: Vec<&str> = eight.iter().filter(|point| point.on_front).map(|point| point.model.as_str()).collect();
    match (eight.first(), eight.iter().find(|point| point.mean == 0.0)) {
        (Some(fast), Some(exact)) => format!(
            "On rgba8unorm {} takes {} ns a fragment and errs in {:.1} % of pixels; no error at all costs {} ns ({}; {:.0} ns \
             in the reference merger). On the front: {}.",
            fast.model,
            short(fast.ns_that_runs()),
            100.0 * fast.pixels_off,
            short(exact.ns_that_runs()),
            exact.model,
            exact.ns_per_fragment,
            names.join(", ")
        ),
        (Some(fast), None) => {
            format!("On rgba8unorm {} is the fastest: {} ns a fragment.", fast.model, short(fast.ns_that_runs()))
        }
        _ => "Errors against exact, and time.".to_owned(),
    }
}

/// A row a format, depth and model.
#[must_use]
pub fn point_table(points: &[Point]) -> Table {
    let mut table = Table::new(
        "Errors in codes of the target (numbers between, for floats), all states and inputs; * is on the front of error and the time that counts, the kernel's where there is one",
        ["format", "layers", "model", "ns", "kernel ns", "max", "mean", "RMS", "bias", "pixels off", "front"],
    );
    for point in points {
        table.add([
            point.format.to_owned(),
            point.layers.to_string(),
            point.model.clone(),
            format!("{:.0}", point.ns_per_fragment),
            point.kernel_ns_per_fragment.map_or("-".to_owned(), short),
            short(point.max),
            short(point.mean),
            short(point.rms),
            short(point.bias),
            percent(point.pixels_off),
            if point.on_front { "*".to_owned() } else { String::new() },
        ]);
    }
    table
}

/// A row a state and input too.
#[must_use]
pub fn row_table(rows: &[Row]) -> Table {
    let header = ["format", "state", "layers", "input", "model", "max", "mean", "RMS", "bias", "pixels off"];
    let mut table = Table::new("Errors in codes of the target (numbers between, for floats)", header);
    for row in rows {
        let e = &row.errors;
        let names = [row.format.to_owned(), row.state.to_owned(), row.layers.to_string(), row.input.name().to_owned()];
        let figures = [short(e.max), short(e.mean), short(e.rms), short(e.bias), percent(e.pixels_off)];
        table.add(names.into_iter().chain([row.model.clone()]).chain(figures));
    }
    table
}

/// Mean error of the fixed-point family: a row a width, a column a rounding.
#[must_use]
pub fn fixed_table(rows: &[FixedRow]) -> Table {
    let mut roundings: Vec<&str> = Vec::new();
    for row in rows {
        if !roundings.contains(&row.rounding) {
            roundings.push(row.rounding);
        }
    }
    let mut table = Table::new(
        "The fixed-point family, straight over on rgba8unorm: mean error in codes by width and rounding",
        ["bits"].into_iter().chain(roundings.iter().copied()),
    );
    for bits in fixed::WIDTHS {
        let cell = |rounding: &&str| {
            let row = rows.iter().find(|row| row.bits == bits && row.rounding == *rounding);
            row.map_or("-".to_owned(), |row| short(row.errors.mean))
        };
        table.add([bits.to_string()].into_iter().chain(roundings.iter().map(cell)));
    }
    table
}

/// Error against time: a color a model, a dot a format and depth, and the front of rgba8unorm with one layer.
#[must_use]
pub fn scatter(points: &[Point]) -> Chart {
    let place = |point: &Point| (point.ns_that_runs(), point.mean);
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
        x: Axis::new("ns per fragment: the kernel's where there is one, else the reference merger's", 0.1),
        y: Axis::new("mean error, codes of the target (0 at the bottom)", 1e-5),
        series,
    }
}

/// Error against bits: a line a rounding.
#[must_use]
pub fn fixed_chart(rows: &[FixedRow]) -> Chart {
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

/// The section.
///
/// # Errors
/// None is expected.
pub fn section(models: &[&dyn NumericModel]) -> Result<Section, Failure> {
    let inputs = Inputs::new(1);
    let times = clock::times(models, &FORMATS, &inputs)?;
    let rows = survey(&Survey { models, inputs: &inputs, formats: &FORMATS, layers: &LAYERS }, &|| ());
    let points = front::points(&rows, &times);
    let fixed = fixed::sweep(&inputs, 4096);
    Ok(Section {
        id: "tradeoff",
        title: "Error against run time",
        finding: finding(&points),
        method: "Every model draws the same random, adversarial (ties, boundaries) and picture fragments in five states and \
                 is compared with `exact`. Times are of this machine: of the reference, which is written to be read, and of the row kernel where the \
                 format and model have one."
            .to_owned(),
        figures: vec![
            Figure::chart("A dot a format and depth of stack; rings are the Pareto front", scatter(&points)),
            Figure::chart("Fixed-point blenders: bits spent against error", fixed_chart(&fixed)),
        ],
        tables: vec![point_table(&points), fixed_table(&fixed)],
        command: "outmerge tradeoff --rows".to_owned(),
    })
}
