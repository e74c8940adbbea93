//! Cutting one triangle at the sides of the view volume, in binary32, as Mesa's draw module does it.

use super::{Viewport, WindowVertex};
use crate::scene::raster::RasterState;

/// The sides of the view volume: inside is where the sum of coordinates times these is not negative. `reach` is how many
/// times as far as the target's edges x and y may go.
fn sides(reach: f32) -> [[f32; 4]; 6] {
    let edge = 1.0 / reach;
    [
        [-edge, 0.0, 0.0, 1.0],
        [edge, 0.0, 0.0, 1.0],
        [0.0, -edge, 0.0, 1.0],
        [0.0, edge, 0.0, 1.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, -1.0, 1.0],
    ]
}

/// Sides of depth in [`sides`].
const DEPTH_SIDES: std::ops::Range<usize> = 4..6;

/// Which sides a position is outside of, by comparisons and not by [`distance`].
fn outside([x, y, z, w]: [f32; 4], reach: f32) -> [bool; 6] {
    let (x, y) = (x / reach, y / reach);
    [x > w, x + w < 0.0, y > w, y + w < 0.0, z < 0.0, z > w]
}

fn distance(position: [f32; 4], side: [f32; 4]) -> f32 {
    let [x, y, z, w]: [f32; 4] = std::array::from_fn(|i| position[i] * side[i]);
    x + y + z + w
}

/// The convex polygon left of a triangle; empty where nothing is.
pub(super) fn clip<const N: usize>(
    triangle: [WindowVertex<N>; 3],
    viewport: &Viewport,
    state: &RasterState,
) -> Vec<WindowVertex<N>> {
    // A power of two, so that dividing by it rounds nothing.
    let reach = if state.guard_band { 2.0 } else { 1.0 };
    let masks = triangle.map(|vertex| outside(vertex.clip, reach));
    let sides = sides(reach);
    let cuts = |side: usize| !state.primitive.unclipped_depth || !DEPTH_SIDES.contains(&side);
    let mut polygon = triangle.to_vec();
    if (0..sides.len()).any(|side| cuts(side) && masks.iter().all(|mask| mask[side])) {
        return Vec::new();
    }
    for (side, plane) in sides.into_iter().enumerate() {
        if cuts(side) && masks.iter().any(|mask| mask[side]) {
            polygon = cut(&polygon, plane, viewport);
        }
    }
    polygon
}

fn cut<const N: usize>(polygon: &[WindowVertex<N>], side: [f32; 4], viewport: &Viewport) -> Vec<WindowVertex<N>> {
    let distances: Vec<f32> = polygon.iter().map(|vertex| distance(vertex.clip, side)).collect();
    if distances.iter().any(|distance| !distance.is_finite()) {
        return Vec::new();
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for i in 0..polygon.len() {
        let next = (i + 1) % polygon.len();
        let (here, there) = (distances[i], distances[next]);
        if here >= 0.0 {
            kept.push(polygon[i]);
        }
        if (here >= 0.0) != (there >= 0.0) {
            // From the end that lies nearer to the side, so that little is multiplied; of equals from the first where
            // the edge leaves, from the second where it enters.
            let from_next = if here >= 0.0 { -there < here } else { -here >= there };
            let (start, end, t) =
                if from_next { (next, i, there / (there - here)) } else { (i, next, -here / (there - here)) };
            kept.push(between(&polygon[start], &polygon[end], t, viewport));
        }
    }
    kept
}

/// The vertex at `t` in `[0, 1]` on the way from `a` to `b`; its division is never fused.
fn between<const N: usize>(a: &WindowVertex<N>, b: &WindowVertex<N>, t: f32, viewport: &Viewport) -> WindowVertex<N> {
    let mix = |a: f32, b: f32| a + t * (b - a);
    let clip = std::array::from_fn(|i| mix(a.clip[i], b.clip[i]));
    viewport.divided(clip, std::array::from_fn(|i| mix(a.varyings[i], b.varyings[i])), false)
}
