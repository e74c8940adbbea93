//! Depth and varyings at a pixel centre, in binary64 with one rounding to binary32 at the end.
//!
//! Weight of vertex i: `l_i = E_i / (2 * area)`, from exact integers. Outside the triangle, where a neighbour of a
//! 2 x 2 quad may lie, the same formulas extrapolate.

use super::Primitive;
use crate::scene::number::{f64_to_f32, i64_to_f64};

impl<const N: usize> Primitive<N> {
    fn weights(&self, x: u32, y: u32) -> [f64; 3] {
        let area = i64_to_f64(self.area);
        self.edges.map(|edge| i64_to_f64(edge.at(i64::from(x), i64::from(y))) / area)
    }

    /// Window depth, linear in screen space, plus the depth bias: `z0 + l1 (z1 - z0) + l2 (z2 - z0)`. Exactly the
    /// vertices' depth where all three share one. Not clamped.
    #[must_use]
    pub fn depth(&self, x: u32, y: u32) -> f32 {
        if let Some(planes) = &self.planes {
            return planes.depth(x, y);
        }
        let [_, l1, l2] = self.weights(x, y);
        let [z0, z1, z2] = self.corners.map(|corner| f64::from(corner.depth));
        let depth = f64_to_f32(z0 + l1 * (z1 - z0) + l2 * (z2 - z0));
        // Without a bias the depth stays as it is, -0 included.
        if self.bias == 0.0 { depth } else { depth + self.bias }
    }

    /// Varyings, perspective-correct: `sum(l_i v_i / w_i) / sum(l_i / w_i)`, terms summed in vertex order.
    #[must_use]
    pub fn varyings(&self, x: u32, y: u32) -> [f32; N] {
        if let Some(planes) = &self.planes {
            return planes.varyings(x, y);
        }
        let weights = self.weights(x, y);
        let [p0, p1, p2] = std::array::from_fn(|i| weights[i] * f64::from(self.corners[i].inverse_w));
        let sum = p0 + p1 + p2;
        let [a, b, c] = &self.corners;
        std::array::from_fn(|i| {
            let value = |v: f32| f64::from(v);
            f64_to_f32((p0 * value(a.varyings[i]) + p1 * value(b.varyings[i]) + p2 * value(c.varyings[i])) / sum)
        })
    }

    /// Change of depth per pixel to the right and per pixel down.
    pub(super) fn depth_slope(&self) -> [f64; 2] {
        let area = i64_to_f64(self.area);
        let [z0, z1, z2] = self.corners.map(|corner| f64::from(corner.depth));
        let [_, s1, s2] = self.edges.map(super::edge::Edge::steps);
        std::array::from_fn(|axis| (i64_to_f64(s1[axis]) * (z1 - z0) + i64_to_f64(s2[axis]) * (z2 - z0)) / area)
    }
}
