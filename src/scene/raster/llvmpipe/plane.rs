//! Planes through three vertices and their values at pixel centres, and the depth bias, all in binary32.

use super::{WindowVertex, multiply_add};
use crate::format::depth::DepthKind;
use crate::model::llvmpipe::generation::BiasUnit;
use crate::scene::number::{f64_to_f32, u32_to_f32};
use crate::scene::raster::RasterState;
use crate::scene::raster::bias::clamped;

/// A value that changes linearly over the window.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// At the centre of pixel (0, 0).
    origin: f32,
    dx: f32,
    dy: f32,
}

impl Plane {
    fn at(self, x: f32, y: f32, fused: bool) -> f32 {
        let across = multiply_add(self.dx, x, self.origin, fused);
        multiply_add(self.dy, y, across, fused)
    }
}

/// What all planes of a triangle share.
struct Setup {
    /// The first vertex, from the centre of pixel (0, 0).
    first: [f32; 2],
    /// First vertex minus second, and third minus first, in x, y and depth.
    d01: [f32; 3],
    d20: [f32; 3],
    /// 1 over twice the signed area.
    inverse_area: f32,
}

impl Setup {
    fn new<const N: usize>(vertices: &[WindowVertex<N>; 3]) -> Self {
        let [p0, p1, p2] = vertices.map(|vertex| vertex.window);
        let d01: [f32; 3] = std::array::from_fn(|i| p0[i] - p1[i]);
        let d20: [f32; 3] = std::array::from_fn(|i| p2[i] - p0[i]);
        let inverse_area = 1.0 / (d01[0] * d20[1] - d01[1] * d20[0]);
        Self { first: [p0[0] - 0.5, p0[1] - 0.5], d01, d20, inverse_area }
    }

    fn plane(&self, [v0, v1, v2]: [f32; 3]) -> Plane {
        let (v01, v20) = (v0 - v1, v2 - v0);
        let over_area = |x: f32| x * self.inverse_area;
        let dx = v01 * over_area(self.d20[1]) - v20 * over_area(self.d01[1]);
        let dy = v20 * over_area(self.d01[0]) - v01 * over_area(self.d20[0]);
        let [x, y] = self.first;
        Plane { origin: v0 - (dx * x + dy * y), dx, dy }
    }

    /// The larger of |dz/dx| and |dz/dy|.
    fn depth_slope(&self) -> f32 {
        let ([x01, y01, z01], [x20, y20, z20]) = (self.d01, self.d20);
        let dx = ((z20 * y01 - y20 * z01) * self.inverse_area).abs();
        let dy = ((x20 * z01 - z20 * x01) * self.inverse_area).abs();
        if dx > dy { dx } else { dy }
    }

    fn bias<const N: usize>(&self, vertices: &[WindowVertex<N>; 3], state: &RasterState) -> f32 {
        let bias = state.bias;
        let Some(kind) = state.depth.filter(|_| bias.is_enabled()) else { return 0.0 };
        let constant = f64_to_f32(f64::from(bias.constant));
        let slope = self.depth_slope() * bias.slope_scale;
        let offset = match kind {
            DepthKind::Unorm(bits) => {
                let codes = match state.rasteriser.generation().unwrap_or_default().rules().bias_unit {
                    BiasUnit::TwoCodes => 2.0 * f64::from(constant),
                    BiasUnit::CodeAndHalf if constant == 0.0 => 0.0,
                    BiasUnit::CodeAndHalf => f64::from(constant) + 0.5_f64.copysign(f64::from(constant)),
                };
                f64_to_f32(codes * (1.0 / (f64::from(bits).exp2() - 1.0))) + slope
            }
            // One unit in the last place.
            DepthKind::Float32 => {
                let largest = vertices.iter().fold(0.0, |top: f32, vertex| top.max(vertex.window[2].abs()));
                let exponent = (largest.to_bits() & 0x7f80_0000).saturating_sub(23 << 23);
                f32::from_bits(exponent) * constant + slope
            }
        };
        clamped(offset, bias.clamp)
    }
}

/// Everything interpolated over one triangle.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::raster) struct Planes<const N: usize> {
    depth: Plane,
    bias: f32,
    inverse_w: Plane,
    /// Varyings over `w`.
    varyings: [Plane; N],
    fused: bool,
}

impl<const N: usize> Planes<N> {
    pub(super) fn new(vertices: &[WindowVertex<N>; 3], state: &RasterState, fused: bool) -> Self {
        let setup = Setup::new(vertices);
        let through = |value: &dyn Fn(&WindowVertex<N>) -> f32| setup.plane(vertices.each_ref().map(value));
        Self {
            depth: through(&|vertex| vertex.window[2]),
            bias: setup.bias(vertices, state),
            inverse_w: through(&|vertex| vertex.window[3]),
            varyings: std::array::from_fn(|i| through(&|vertex| vertex.varyings[i] * vertex.window[3])),
            fused,
        }
    }

    pub(in crate::scene::raster) fn depth(&self, x: u32, y: u32) -> f32 {
        self.depth.at(u32_to_f32(x), u32_to_f32(y), self.fused) + self.bias
    }

    pub(in crate::scene::raster) fn varyings(&self, x: u32, y: u32) -> [f32; N] {
        let (x, y) = (u32_to_f32(x), u32_to_f32(y));
        let w = 1.0 / self.inverse_w.at(x, y, self.fused);
        self.varyings.map(|plane| plane.at(x, y, self.fused) * w)
    }
}
