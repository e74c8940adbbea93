//! A search for stacks that drift as far as the bound allows.

use super::STATE;
use crate::format::ColorFormat;
use crate::model::{ColorInputs, NumericModel};
use crate::scene::display::value;

/// Colors tried for each layer.
const CANDIDATES: u32 = 128;

/// Fractional part of the golden ratio: multiples of it fill the unit interval evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The largest error a greedy search reaches in this many layers, as a value: each layer takes the color that drives
/// the stored red channel farthest from real arithmetic, in either direction. Colors are taken from `[1/2, 1]`, where
/// floats are coarsest.
#[must_use]
pub fn adversary(format: ColorFormat, model: &dyn NumericModel, alpha: f32, layers: u32) -> f64 {
    let up = search(format, model, alpha, layers, 1.0);
    up.max(search(format, model, alpha, layers, -1.0))
}

fn search(format: ColorFormat, model: &dyn NumericModel, alpha: f32, layers: u32, sign: f64) -> f64 {
    let kind = format.channels()[0];
    let start = ColorInputs { format, blend: None, constant: [0.0; 4], src: [0.75; 4], src1: [0.0; 4], dst: [0; 4] };
    let mut codes = model.merge_color(&start);
    let mut real = value(kind, codes[0]);
    let mut worst: f64 = 0.0;
    let (a, mut phase) = (f64::from(alpha), 0.0);
    for _ in 0..layers {
        let draw = |i: u32| {
            let s = to_f32(0.5 + 0.5 * (f64::from(i) * GOLDEN + phase).fract());
            let src = [s, s, s, alpha];
            let after = model.merge_color(&ColorInputs { blend: Some(STATE), src, dst: codes, ..start });
            (after, a * f64::from(s) + (1.0 - a) * real)
        };
        let error = |(codes, real): &([u32; 4], f64)| sign * (value(kind, codes[0]) - real);
        let best = (0..CANDIDATES).map(draw).max_by(|x, y| error(x).total_cmp(&error(y)));
        let Some((after, truth)) = best else { break };
        (codes, real) = (after, truth);
        worst = worst.max((value(kind, codes[0]) - real).abs());
        phase = (phase + 0.381_966).fract();
    }
    worst
}

/// A shader's output: rounded to binary32.
pub(super) fn to_f32(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = x as f32;
    rounded
}
