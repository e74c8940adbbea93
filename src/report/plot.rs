//! Charts as SVG: lines and points on linear and logarithmic axes.

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

/// Width and height of a chart in pixels.
const SIZE: (u32, u32) = (760, 420);

/// Width of the legend beside it.
const LEGEND_WIDTH: u32 = 190;

/// Height of letters in pixels.
const TEXT: u32 = 14;

/// Colors that people with any color vision tell apart (Okabe and Ito).
const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(110, 110, 110),
    RGBColor(0, 0, 0),
];

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line through the points in their order.
    Line,
    /// A dot each.
    Dots,
    /// A ring each, joined by a thin line: a Pareto front.
    Front,
}

/// Points with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// x and y.
    pub points: Vec<(f64, f64)>,
    /// How they are drawn.
    pub mark: Mark,
}

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences.
    Linear,
    /// Equal ratios.
    Logarithmic,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// The smallest value drawn; smaller ones, zero included, are drawn there.
    pub floor: f64,
    /// How they are spread.
    pub scale: Scale,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// What is drawn, the first at the bottom.
    pub series: Vec<Series>,
}

/// A chart that cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a chart cannot be drawn: {0}")]
pub struct PlotError(String);

impl Axis {
    /// A logarithmic axis from `floor` on.
    #[must_use]
    pub fn new(label: &str, floor: f64) -> Self {
        Self { label: label.to_owned(), floor, scale: Scale::Logarithmic }
    }

    /// The same axis with equal differences.
    #[must_use]
    pub fn linear(self) -> Self {
        Self { scale: Scale::Linear, ..self }
    }

    /// From the floor, or the smallest value above it, to a little beyond the largest.
    fn range(&self, values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            low = low.min(value.max(self.floor));
            high = high.max(value.max(self.floor));
        }
        match self.scale {
            Scale::Linear => low - 0.02 * (high - low)..high + 0.02 * (high - low) + f64::MIN_POSITIVE,
            // Whole decades, at least one, so that there are ticks to read.
            Scale::Logarithmic => {
                let (low, high) = (low.log10().floor(), high.log10().ceil());
                10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
            }
        }
    }
}

/// The chart as an SVG element.
///
/// # Errors
/// [`PlotError`] when nothing in it is a number.
pub fn svg(chart: &Chart) -> Result<String, PlotError> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    if !points().any(|(x, y)| x.is_finite() && y.is_finite()) {
        return Err(PlotError("no point is a number".to_owned()));
    }
    let (x, y) = (chart.x.range(points().map(|p| p.0)), chart.y.range(points().map(|p| p.1)));
    let mut text = String::new();
    let drawn = match (chart.x.scale, chart.y.scale) {
        (Scale::Logarithmic, Scale::Logarithmic) => draw(chart, x.log_scale(), y.log_scale(), &mut text),
        (Scale::Linear, Scale::Logarithmic) => draw(chart, x, y.log_scale(), &mut text),
        (Scale::Logarithmic, Scale::Linear) => draw(chart, x.log_scale(), y, &mut text),
        (Scale::Linear, Scale::Linear) => draw(chart, x, y, &mut text),
    };
    drawn.map_err(|error| PlotError(error.to_string()))?;
    Ok(text)
}

fn draw<X, Y>(chart: &Chart, x: X, y: Y, text: &mut String) -> Result<(), Box<dyn std::error::Error>>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(boxed)?;
    let (plot, legend) = root.split_horizontally(SIZE.0 - LEGEND_WIDTH);
    let mut area = ChartBuilder::on(&plot)
        .margin(12)
        .x_label_area_size(48)
        .y_label_area_size(78)
        .build_cartesian_2d(x, y)
        .map_err(boxed)?;
    area.configure_mesh()
        .x_desc(chart.x.label.as_str())
        .y_desc(chart.y.label.as_str())
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", TEXT))
        .axis_desc_style(("sans-serif", TEXT + 1))
        .light_line_style(BLACK.mix(0.04))
        .bold_line_style(BLACK.mix(0.12))
        .draw()
        .map_err(boxed)?;
    for (index, series) in chart.series.iter().enumerate() {
        let color = PALETTE[index % PALETTE.len()];
        let place = |(x, y): &(f64, f64)| (x.max(chart.x.floor), y.max(chart.y.floor));
        let finite = series.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
        let points: Vec<(f64, f64)> = finite.map(place).collect();
        let drawn = match series.mark {
            Mark::Line => area.draw_series(LineSeries::new(points, color.stroke_width(2))),
            Mark::Dots => area.draw_series(points.iter().map(|point| Circle::new(*point, 3, color.mix(0.75).filled()))),
            Mark::Front => {
                area.draw_series(LineSeries::new(points.clone(), color.mix(0.6))).map_err(boxed)?;
                area.draw_series(points.iter().map(|point| Circle::new(*point, 7, color.stroke_width(2))))
            }
        };
        drawn.map_err(boxed)?;
        let y = 16 + 20 * i32::try_from(index).unwrap_or(0);
        legend.draw(&Rectangle::new([(4, y), (16, y + 12)], color.filled())).map_err(boxed)?;
        legend.draw(&Text::new(series.name.clone(), (22, y), ("sans-serif", TEXT).into_font())).map_err(boxed)?;
    }
    root.present().map_err(boxed)?;
    Ok(())
}

/// A tick as people write it: at most three digits.
fn number(x: &f64) -> String {
    let (mantissa, exponent) = match format!("{x:.2e}").split_once('e') {
        Some((mantissa, exponent)) => (mantissa.to_owned(), exponent.parse::<i32>().unwrap_or(0)),
        None => return x.to_string(),
    };
    if (-3..5).contains(&exponent) {
        let text = format!("{x:.5}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
}

fn boxed<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> Box<dyn std::error::Error> {
    error.to_string().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: &[(f64, f64)]) -> Chart {
        let series = Series { name: "a < b".to_owned(), points: points.to_vec(), mark: Mark::Front };
        Chart { x: Axis::new("ns", 1.0), y: Axis::new("codes", 1e-6), series: vec![series] }
    }

    #[test]
    fn every_finite_point_is_drawn_and_zero_lies_on_the_floor() {
        let svg = svg(&chart(&[(10.0, 0.5), (100.0, 0.0), (5.0, f64::NAN)])).expect("two points");
        assert!(svg.starts_with("<svg"), "an element: {}", &svg[..40.min(svg.len())]);
        assert_eq!(svg.matches("<circle").count(), 2, "a ring a finite point");
        assert!(svg.contains("a &lt; b"), "names are escaped");
    }

    #[test]
    fn ticks_are_short() {
        for (x, text) in [(1e-6_f64.next_up(), "1e-6"), (0.1, "0.1"), (1000.0, "1000"), (2.5e7, "2.5e7"), (0.0, "0")] {
            assert_eq!(number(&x), text, "{x}");
        }
    }

    #[test]
    fn a_chart_without_numbers_is_an_error() {
        assert!(svg(&chart(&[(f64::NAN, 1.0)])).is_err(), "NaN alone");
        assert!(svg(&chart(&[])).is_err(), "nothing");
    }
}
