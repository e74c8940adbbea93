//! Homogeneous clipping of one triangle (Sutherland and Hodgman), in binary64.

use super::{RasterState, Vertex};
use crate::scene::number::{f64_to_f32, i64_to_f64};

/// Smallest `w` that is divided by: keeps `1 / w` finite.
const MIN_W: f64 = 1e-30;

/// Pixels from the middle of the target that positions may reach before x or y are clipped. With [`super::SUBPIXELS`]
/// and the largest target, snapped positions stay below 2^23 and edge functions below 2^50.
const GUARD_BAND: f64 = 16384.0;

/// A half-space `x*a + y*b + z*c + w*d + e >= 0` of clip space.
#[derive(Clone, Copy)]
struct Plane([f64; 5]);

impl Plane {
    /// Signed distance, up to scale; positive inside.
    fn distance(self, [x, y, z, w]: [f32; 4]) -> f64 {
        let [a, b, c, d, e] = self.0;
        f64::from(x) * a + f64::from(y) * b + f64::from(z) * c + f64::from(w) * d + e
    }
}

/// The convex polygon left of `triangle`, same winding; empty when nothing is left or a position is not finite.
pub(super) fn clip<const N: usize>(triangle: [Vertex<N>; 3], state: &RasterState) -> Vec<Vertex<N>> {
    if triangle.iter().flat_map(|vertex| vertex.position).any(|x| !x.is_finite()) {
        return Vec::new();
    }
    let mut polygon = triangle.to_vec();
    for plane in planes(state) {
        if polygon.iter().any(|vertex| plane.distance(vertex.position) < 0.0) {
            polygon = cut(&polygon, plane);
        }
    }
    polygon
}

fn planes(state: &RasterState) -> impl Iterator<Item = Plane> {
    let reach = |size: u32| 2.0 * GUARD_BAND / i64_to_f64(i64::from(size));
    let (x, y) = (reach(state.extent.width), reach(state.extent.height));
    let depth = [Plane([0.0, 0.0, 1.0, 0.0, 0.0]), Plane([0.0, 0.0, -1.0, 1.0, 0.0])];
    let always = [
        Plane([0.0, 0.0, 0.0, 1.0, -MIN_W]),
        Plane([1.0, 0.0, 0.0, x, 0.0]),
        Plane([-1.0, 0.0, 0.0, x, 0.0]),
        Plane([0.0, 1.0, 0.0, y, 0.0]),
        Plane([0.0, -1.0, 0.0, y, 0.0]),
    ];
    depth.into_iter().filter(|_| !state.primitive.unclipped_depth).chain(always)
}

fn cut<const N: usize>(polygon: &[Vertex<N>], plane: Plane) -> Vec<Vertex<N>> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, vertex) in polygon.iter().enumerate() {
        let next = &polygon[(i + 1) % polygon.len()];
        let (here, there) = (plane.distance(vertex.position), plane.distance(next.position));
        if here >= 0.0 {
            kept.push(*vertex);
        }
        // Always from the inside vertex to the outside one, so that neighbours agree on the new vertex.
        if here >= 0.0 && there < 0.0 {
            kept.push(between(vertex, next, here / (here - there)));
        } else if here < 0.0 && there >= 0.0 {
            kept.push(between(next, vertex, there / (there - here)));
        }
    }
    kept
}

/// The vertex at `t` in `[0, 1]` on the way from `a` to `b`.
fn between<const N: usize>(a: &Vertex<N>, b: &Vertex<N>, t: f64) -> Vertex<N> {
    let mix = |a: f32, b: f32| f64_to_f32(f64::from(a) + t * (f64::from(b) - f64::from(a)));
    Vertex {
        position: std::array::from_fn(|i| mix(a.position[i], b.position[i])),
        varyings: std::array::from_fn(|i| mix(a.varyings[i], b.varyings[i])),
    }
}
