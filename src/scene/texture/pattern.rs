//! Pictures computed from a few parameters, so that bundled scenes need no binary files.
//!
//! A pattern is what an 8-bit image would hold: values are rounded to `code / 255` and then decoded from the declared
//! color space. Only additions, multiplications, divisions and square roots are used: the same codes everywhere.

use serde::Deserialize;

use super::{ColorSpace, Image, TextureError};
use crate::scene::number::{f64_to_f32, unit_to_u8};

/// What a pattern shows. Two colors: A is the first, B the second; missing ones are white and transparent black.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pattern {
    /// A everywhere.
    Solid,
    /// A and B in turn, `cells` squares across.
    Checker,
    /// A on the left to B on the right.
    Gradient,
    /// A at the top to B at the bottom.
    GradientDown,
    /// A in the middle to B on the inscribed circle and beyond.
    Radial,
    /// A where `cells` round holes across do not show B.
    Lattice,
    /// A leaf: A at its edge, B along its midrib, alpha 0 outside with a soft edge.
    Leaf,
    /// `cells` blades of grass: A at the tips, B at the roots, alpha 0 outside with a soft edge.
    Grass,
    /// A tree: crown A, trunk B, alpha 0 outside with a soft edge.
    Tree,
    /// Premultiplied fire (A, alpha 0: adds light) under smoke (B, alpha up to 1: covers).
    FireAndSmoke,
}

/// A pattern with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternImage {
    /// What it shows.
    pub pattern: Pattern,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Colors A and B, RGBA in `[0, 1]` as stored in the image.
    pub colors: [[f32; 4]; 2],
    /// Repetitions, where the pattern repeats.
    pub cells: u32,
}

impl PatternImage {
    /// The image of linear values.
    ///
    /// # Errors
    /// [`TextureError::Size`].
    pub fn draw(&self, space: ColorSpace) -> Result<Image, TextureError> {
        let [width, height] = self.size;
        Image::new(width, height, |x, y| {
            let [r, g, b, a] = self.codes(x, y).map(|code| f64::from(code) / 255.0);
            [space.decode(r), space.decode(g), space.decode(b), a].map(f64_to_f32)
        })
    }

    /// The 8-bit codes of one texel, as a PNG file would hold them.
    #[must_use]
    pub fn codes(&self, x: u32, y: u32) -> [u8; 4] {
        let at = |i: u32, size: u32| (f64::from(i) + 0.5) / f64::from(size);
        self.color(at(x, self.size[0]), at(y, self.size[1])).map(unit_to_u8)
    }

    /// The color at (u, v) in `[0, 1]`, v down.
    fn color(&self, u: f64, v: f64) -> [f64; 4] {
        let [a, b] = self.colors.map(|color| color.map(f64::from));
        let cells = f64::from(self.cells.max(1));
        match self.pattern {
            Pattern::Solid => a,
            Pattern::Checker => mix(a, b, ((u * cells).floor() + (v * cells).floor()).rem_euclid(2.0)),
            Pattern::Gradient => mix(a, b, u),
            Pattern::GradientDown => mix(a, b, v),
            Pattern::Radial => mix(a, b, smooth(2.0 * distance(u, v, 0.5, 0.5))),
            Pattern::Lattice => {
                let (x, y) = ((u * cells).fract(), (v * cells).fract());
                mix(b, a, ramp((distance(x, y, 0.5, 0.5) - 0.35) * 10.0))
            }
            Pattern::Leaf => leaf(a, b, u, v),
            Pattern::Grass => grass(a, b, cells, u, v),
            Pattern::Tree => tree(a, b, u, v),
            Pattern::FireAndSmoke => fire_and_smoke(a, b, u, v),
        }
    }
}

fn mix(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

/// `color` with its alpha multiplied by the coverage of a shape.
fn cover([r, g, b, a]: [f64; 4], coverage: f64) -> [f64; 4] {
    [r, g, b, a * coverage]
}

/// 0 up to -1/2, 1 from 1/2 on, linear between: a soft edge around 0.
fn ramp(x: f64) -> f64 {
    (x + 0.5).clamp(0.0, 1.0)
}

/// 0 to 1 with horizontal ends.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn distance(x: f64, y: f64, cx: f64, cy: f64) -> f64 {
    ((x - cx) * (x - cx) + (y - cy) * (y - cy)).sqrt()
}

/// The overlap of two discs, upright, with side veins.
fn leaf(a: [f64; 4], b: [f64; 4], u: f64, v: f64) -> [f64; 4] {
    let depth = 0.62 - distance(u, v, 0.2, 0.5).max(distance(u, v, 0.8, 0.5));
    let side = (u - 0.5).abs();
    let vein = ((v + side) * 8.0).fract();
    let rib = ramp((0.02 - side) * 60.0).max(0.5 * ramp((0.08 - vein) * 20.0));
    cover(mix(a, b, rib), ramp(depth * 14.0))
}

/// Curved, tapering blades of several heights.
fn grass(a: [f64; 4], b: [f64; 4], cells: f64, u: f64, v: f64) -> [f64; 4] {
    let height = 1.0 - v;
    let mut coverage: f64 = 0.0;
    let mut blade = 0.0;
    while blade < cells {
        // A fixed irregular sequence: multiples of the golden ratio, without their integer part.
        let irregular = (blade * 0.618_034).fract();
        let tall = 0.6 + 0.35 * irregular;
        let lean = (irregular - 0.5) * 0.5 / cells;
        let t = height / tall;
        let middle = (blade + 0.5) / cells + lean * 2.0 * t * t;
        let half_width = 0.42 / cells * (1.0 - t);
        coverage = coverage.max(ramp((half_width - (u - middle).abs()) * 6.0 * cells) * f64::from(u8::from(t < 1.0)));
        blade += 1.0;
    }
    cover(mix(b, a, height), coverage)
}

/// A crown of overlapping discs over a trunk, with gaps that let the background through.
fn tree(a: [f64; 4], b: [f64; 4], u: f64, v: f64) -> [f64; 4] {
    const DISCS: [[f64; 3]; 6] = [
        [0.5, 0.26, 0.2],
        [0.3, 0.38, 0.17],
        [0.7, 0.36, 0.18],
        [0.42, 0.52, 0.15],
        [0.62, 0.54, 0.14],
        [0.5, 0.4, 0.16],
    ];
    let crown = DISCS.iter().map(|[x, y, radius]| radius - distance(u, v, *x, *y)).fold(f64::MIN, f64::max);
    let holes = distance((u * 9.0).fract(), ((v + 0.1 * u) * 9.0).fract(), 0.5, 0.5);
    let leaves = ramp(crown * 10.0) * ramp((holes - 0.22) * 5.0);
    let trunk = ramp((0.045 + 0.03 * v - (u - 0.5).abs()) * 40.0) * f64::from(u8::from(v > 0.45));
    let shade = mix(a, [a[0] * 0.55, a[1] * 0.55, a[2] * 0.55, a[3]], smooth(1.5 * v));
    cover(mix(b, shade, leaves), leaves.max(trunk))
}

/// A flame that widens and fades upwards into a puff of smoke; premultiplied, alpha and light independent.
fn fire_and_smoke(a: [f64; 4], b: [f64; 4], u: f64, v: f64) -> [f64; 4] {
    let fire = 1.0 - smooth(distance(u * 1.6, v, 0.8, 0.68) / 0.32);
    let puff = |x, y, radius| 1.0 - smooth(distance(u, v, x, y) / radius);
    let smoke = puff(0.5, 0.28, 0.28_f64).max(puff(0.34, 0.36, 0.18)).max(puff(0.66, 0.34, 0.2));
    let alpha = smoke * (1.0 - 0.8 * fire) * b[3];
    let light = |i: usize| a[i] * fire * (1.0 - 0.4 * alpha) + b[i] * alpha;
    [light(0), light(1), light(2), alpha]
}
