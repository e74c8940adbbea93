//! llvmpipe's rasteriser, bit for bit: its clipping, its planes, its depth bias.
//!
//! What it does otherwise than the reference:
//! 1. (`clip`) Triangles are cut at the edges of the target, in binary32.
//! 2. (`plane`) Depth, `1/w` and varyings over `w` are planes `a + x dx + y dy` in binary32, through the vertices as they
//!    are and not as they are snapped; `a` is the value at pixel (0, 0), so much of it may cancel far from there.
//!
//! Snapping, facing and coverage are the reference's. Where a target of some formats is the only one and there is no depth
//! target, the driver cuts in x and y at twice the target's size only ([`super::Rasteriser::has_guard_band`]).
//!
//! Source: Mesa 22.3's public source (draw's clip stage, llvmpipe's setup and its fragment interpolation), held against
//! the driver by `cargo test --all-features --test crosscheck raster`.

mod clip;
mod plane;

pub(super) use plane::Planes;

use super::setup::Corner;
use super::{Primitive, RasterState, Vertex};
use crate::scene::number::u32_to_f32;

/// A vertex in the window, not yet snapped.
#[derive(Clone, Copy, Debug)]
struct WindowVertex<const N: usize> {
    /// Before the division; clipping goes on with it.
    clip: [f32; 4],
    /// x and y in pixels, y down, depth, and `1/w`.
    window: [f32; 4],
    varyings: [f32; N],
}

/// Scale and offset of x, y and z from normalised device coordinates to the window.
struct Viewport([[f32; 2]; 3]);

impl Viewport {
    fn new(state: &RasterState) -> Self {
        let [x, y] = [state.extent.width, state.extent.height].map(|size| u32_to_f32(size) * 0.5);
        let [near, far] = state.depth_range;
        Self([[x, x], [-y, y], [far - near, near]])
    }

    /// The vertex shader's own end: one reciprocal, then products, the last of them fused with the sum or not.
    fn of_vertex<const N: usize>(&self, vertex: &Vertex<N>, fused: bool) -> WindowVertex<N> {
        self.divided(vertex.position, vertex.varyings, fused)
    }

    fn divided<const N: usize>(&self, clip: [f32; 4], varyings: [f32; N], fused: bool) -> WindowVertex<N> {
        let inverse_w = 1.0 / clip[3];
        let place = |i: usize| {
            let [scale, offset] = self.0[i];
            multiply_add(clip[i] * inverse_w, scale, offset, fused)
        };
        WindowVertex { clip, window: [place(0), place(1), place(2), inverse_w], varyings }
    }
}

/// `x y + z`, rounded once where the processor has fused instructions.
#[expect(clippy::disallowed_methods, reason = "fused where the driver fuses")]
fn multiply_add(x: f32, y: f32, z: f32, fused: bool) -> f32 {
    if fused { x.mul_add(y, z) } else { x * y + z }
}

/// The parts of one triangle that may cover pixels.
pub(super) fn assemble<const N: usize>(
    triangle: [Vertex<N>; 3],
    state: &RasterState,
    fused: bool,
) -> Vec<Primitive<N>> {
    if triangle.iter().flat_map(|vertex| vertex.position).any(|x| !x.is_finite()) {
        return Vec::new();
    }
    let viewport = Viewport::new(state);
    let vertices = triangle.map(|vertex| viewport.of_vertex(&vertex, fused));
    let polygon = clip::clip(vertices, &viewport, state);
    super::fan(&polygon).filter_map(|part| primitive(part, state, fused)).collect()
}

fn primitive<const N: usize>(vertices: [WindowVertex<N>; 3], state: &RasterState, fused: bool) -> Option<Primitive<N>> {
    let corners = vertices.map(|vertex| Corner::in_window(vertex.window, vertex.varyings, state));
    let mut primitive = Primitive::from_corners(corners, state)?;
    // The driver's setup wants the other winding than the edge functions here, and its own first vertex first.
    let [a, b, c] = vertices;
    let ordered = if primitive.swapped { [a, b, c] } else { [a, c, b] };
    primitive.planes = Some(Planes::new(&ordered, state, fused));
    Some(primitive)
}
