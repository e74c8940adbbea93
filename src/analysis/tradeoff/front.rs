//! The Pareto front: points that no other beats in both error and time.

use serde::Serialize;

use super::Row;
use super::clock::Time;

/// One model on one format: error over all states and inputs of one depth, and its mean time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The numeric model.
    pub model: String,
    /// The format.
    pub format: &'static str,
    /// Layers drawn.
    pub layers: u32,
    /// Nanoseconds a fragment in the reference merger (of a driver: through it), mean over the states.
    pub ns_per_fragment: f64,
    /// The same in the row kernel, where there is one for every state.
    pub kernel_ns_per_fragment: Option<f64>,
    /// The largest error, in codes.
    pub max: f64,
    /// Mean error, in codes.
    pub mean: f64,
    /// Root of the mean square error, in codes.
    pub rms: f64,
    /// Mean error with sign, in codes.
    pub bias: f64,
    /// Share of pixels other than `exact`'s, 0 to 1.
    pub pixels_off: f64,
    /// Whether no other model on this format and depth is at least as good in mean error and time, and better in one.
    pub on_front: bool,
}

impl Point {
    /// Nanoseconds a fragment of what would really run: the kernel where there is one.
    #[must_use]
    pub fn ns_that_runs(&self) -> f64 {
        self.kernel_ns_per_fragment.unwrap_or(self.ns_per_fragment)
    }
}

/// A point a model, format and depth, with the fronts marked. States weigh alike.
#[must_use]
pub fn points(rows: &[Row], times: &[Time]) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    for row in rows {
        let key = |point: &Point| point.model == row.model && point.format == row.format && point.layers == row.layers;
        if points.iter().any(key) {
            continue;
        }
        let mine: Vec<&Row> = rows
            .iter()
            .filter(|other| other.model == row.model && other.format == row.format && other.layers == row.layers)
            .collect();
        let mean = |of: &dyn Fn(&Row) -> f64| mean(mine.iter().map(|row| of(row)));
        let timed = || times.iter().filter(|time| time.model == row.model && time.format == row.format);
        let kernels: Option<Vec<f64>> = timed().map(|time| time.kernel_ns_per_fragment).collect();
        points.push(Point {
            model: row.model.clone(),
            format: row.format,
            layers: row.layers,
            ns_per_fragment: self::mean(timed().map(|time| time.ns_per_fragment)),
            kernel_ns_per_fragment: kernels.filter(|kernels| !kernels.is_empty()).map(|k| self::mean(k.into_iter())),
            max: mine.iter().map(|row| row.errors.max).fold(0.0, f64::max),
            mean: mean(&|row| row.errors.mean),
            rms: mean(&|row| row.errors.rms * row.errors.rms).sqrt(),
            bias: mean(&|row| row.errors.bias),
            pixels_off: mean(&|row| row.errors.pixels_off),
            on_front: false,
        });
    }
    for i in 0..points.len() {
        let me = &points[i];
        let rivals = points.iter().filter(|p| p.format == me.format && p.layers == me.layers);
        let beaten = |p: &Point| dominates((p.ns_that_runs(), p.mean), (me.ns_that_runs(), me.mean));
        let on_front = !rivals.into_iter().any(beaten);
        points[i].on_front = on_front;
    }
    points
}

/// Whether (time, error) `a` is at least as good as `b` in both and better in one.
#[must_use]
pub fn dominates(a: (f64, f64), b: (f64, f64)) -> bool {
    a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count == 0.0 { f64::NAN } else { sum / count }
}
