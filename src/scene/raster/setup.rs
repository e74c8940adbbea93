//! From a clipped triangle to a primitive on the pixel grid: division, viewport, snapping, facing and culling.

use wgpu_types::{Face, FrontFace};

use super::edge::{self, Edge, Span};
use super::llvmpipe::Planes;
use super::{MAX_SUBPIXEL_BITS, MIN_SUBPIXEL_BITS, RasterState, SUBPIXELS, Vertex, bias};
use crate::scene::number::{f64_to_f32, f64_to_i64, i64_to_f64, u32_to_f32};

/// A triangle on the pixel grid that faces the right way and has an area.
#[derive(Clone, Debug)]
pub struct Primitive<const N: usize> {
    /// Edge i lies opposite vertex i.
    pub(super) edges: [Edge; 3],
    /// Twice the area in squared sub-pixels, positive.
    pub(super) area: i64,
    /// The vertices, wound so that the edge functions are positive inside.
    pub(super) corners: [Corner<N>; 3],
    /// Depth bias, added to every depth that is interpolated by weights.
    pub(super) bias: f32,
    /// Interpolation by planes instead of weights, with a bias of its own.
    pub(super) planes: Option<Planes<N>>,
    /// Whether the second and third vertex changed places.
    pub(super) swapped: bool,
    front_facing: bool,
    size: [u32; 2],
}

/// A vertex in the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner<const N: usize> {
    /// Position in sub-pixels from the centre of pixel (0, 0), y down.
    position: [i64; 2],
    /// Window depth.
    pub(super) depth: f32,
    /// `1 / w`.
    pub(super) inverse_w: f32,
    pub(super) varyings: [f32; N],
}

impl<const N: usize> Corner<N> {
    /// Division and viewport in binary32: `x = x_c * (1/w) * W/2 + W/2`, y mirrored. The last product and sum are
    /// rounded once, as Mesa does it (measured: rounding twice covers one texel in a million differently on llvmpipe).
    fn new(vertex: &Vertex<N>, state: &RasterState) -> Self {
        let [x, y, z, w] = vertex.position;
        let inverse_w = 1.0 / w;
        let half = [u32_to_f32(state.extent.width) * 0.5, u32_to_f32(state.extent.height) * 0.5];
        let fused = |a: f32, b: f32| f64_to_f32(f64::from(a) * f64::from(b) + f64::from(b));
        let window = [fused(x * inverse_w, half[0]), fused(-(y * inverse_w), half[1])];
        let [near, far] = state.depth_range;
        let depth = z * inverse_w * (far - near) + near;
        Self::in_window([window[0], window[1], depth, inverse_w], vertex.varyings, state)
    }

    /// Snaps a vertex at `x`, `y` (in pixels, y down), `depth` and `1/w`.
    pub(super) fn in_window([x, y, depth, inverse_w]: [f32; 4], varyings: [f32; N], state: &RasterState) -> Self {
        Self { position: [x, y].map(|p| snap(p, state.subpixel_bits)), depth, inverse_w, varyings }
    }

    /// Whether the division went well: `z` or `1/w` may overflow for a `w` next to 0.
    fn is_usable(&self) -> bool {
        self.inverse_w > 0.0 && self.inverse_w.is_finite() && self.depth.is_finite()
    }
}

/// Bound on window positions in pixels. Clipping stays well below it, unless its last rounding loses a vertex whose
/// coordinates differ by more than binary32's 2^24; this keeps edge functions below 2^52 even then.
const MAX_POSITION: f32 = 65536.0;

const _: () = assert!(SUBPIXELS == 1 << MAX_SUBPIXEL_BITS, "the finest grid is that of positions");

/// A window position in sub-pixels from the centre of pixel 0, on a grid of `2^-bits` of a pixel.
fn snap(position: f32, bits: u8) -> i64 {
    let step = SUBPIXELS >> bits.clamp(MIN_SUBPIXEL_BITS, MAX_SUBPIXEL_BITS);
    let pixels = f64::from((position - 0.5).clamp(-MAX_POSITION, MAX_POSITION));
    // Both counts are powers of two, so only the conversion rounds.
    f64_to_i64(pixels * i64_to_f64(SUBPIXELS / step)) * step
}

impl<const N: usize> Primitive<N> {
    /// Sets a clipped triangle up; `None` when it has no area, is culled or its division overflows.
    pub(super) fn new(triangle: [Vertex<N>; 3], state: &RasterState) -> Option<Self> {
        let mut primitive = Self::from_corners(triangle.map(|vertex| Corner::new(&vertex, state)), state)?;
        primitive.bias = bias::offset(&primitive, state);
        Some(primitive)
    }

    /// The same of vertices in the window, without bias.
    pub(super) fn from_corners(mut corners: [Corner<N>; 3], state: &RasterState) -> Option<Self> {
        if corners.iter().any(|corner| !corner.is_usable()) {
            return None;
        }
        let [a, b, c] = corners.map(|corner| corner.position);
        let signed = Edge::new(a, b).toward(c);
        // With y down, positive means clockwise as the viewer sees it.
        let front_facing = (signed > 0) == (state.primitive.front_face == FrontFace::Cw);
        let facing = if front_facing { Face::Front } else { Face::Back };
        if signed == 0 || state.primitive.cull_mode == Some(facing) {
            return None;
        }
        if signed < 0 {
            corners.swap(1, 2);
        }
        let [a, b, c] = corners.map(|corner| corner.position);
        Some(Self {
            edges: [Edge::new(b, c), Edge::new(c, a), Edge::new(a, b)],
            area: signed.abs(),
            corners,
            bias: 0.0,
            planes: None,
            swapped: signed < 0,
            front_facing,
            size: [state.extent.width, state.extent.height],
        })
    }

    /// Whether the triangle faces the viewer.
    #[must_use]
    pub fn front_facing(&self) -> bool {
        self.front_facing
    }

    /// The covered pixels, row by row.
    pub fn spans(&self) -> impl Iterator<Item = Span> + use<N> {
        edge::spans(self.edges, self.size[0], self.size[1])
    }
}
