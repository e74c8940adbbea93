//! Reading a texture: addressing, nearest and bilinear filtering, choice of mip level.
//!
//! Texel centres lie at half-integers; weights are formed in binary64 and the result is rounded to binary32 once.
//! Source: Vulkan, *Image Operations / Texel Input Operations*. Drivers differ in the last bits: Vulkan only asks for
//! a few bits of weight precision.

use wgpu_types::{AddressMode, FilterMode, MipmapFilterMode};

use super::{Image, Texture};
use crate::scene::number::{f64_to_f32, f64_to_i64, i64_to_f64};

/// How a texture is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    /// Between texels.
    pub filter: FilterMode,
    /// Outside `[0, 1]`, for u and v. A border is transparent black.
    pub address: [AddressMode; 2],
    /// Between mip levels; `None` reads the largest level only.
    pub mips: Option<MipmapFilterMode>,
}

impl Default for Sampler {
    fn default() -> Self {
        Self { filter: FilterMode::Linear, address: [AddressMode::Repeat; 2], mips: None }
    }
}

/// Change of the texture coordinates from one pixel to the next, to the right and down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// du, dv per pixel to the right.
    pub dx: [f32; 2],
    /// du, dv per pixel down.
    pub dy: [f32; 2],
}

impl Texture {
    /// The texture at `[u, v]`, `[0, 0]` being the top left corner; any float, NaN reads as 0.
    ///
    /// `footprint` selects the mip level and is not asked for without mips.
    #[must_use]
    pub fn sample(&self, uv: [f32; 2], footprint: impl FnOnce() -> Footprint) -> [f32; 4] {
        let Some(mip_filter) = self.sampler.mips else { return self.sample_level(0, uv).map(f64_to_f32) };
        let (level, fraction) = self.level(footprint());
        let texel = match mip_filter {
            MipmapFilterMode::Nearest => self.sample_level(if fraction < 0.5 { level } else { level + 1 }, uv),
            MipmapFilterMode::Linear if fraction == 0.0 => self.sample_level(level, uv),
            MipmapFilterMode::Linear => mix(self.sample_level(level, uv), self.sample_level(level + 1, uv), fraction),
        };
        texel.map(f64_to_f32)
    }

    /// Mip level and the way to the next one, from the longer side rho of the footprint in texels of level 0: the
    /// exponent of rho, and `rho / 2^exponent - 1` in place of the fraction of its logarithm. NaN reads as 0.
    fn level(&self, footprint: Footprint) -> (usize, f64) {
        let size = [f64::from(self.levels[0].width()), f64::from(self.levels[0].height())];
        let square = |x: f64| x * x;
        let length = |d: [f32; 2]| (square(f64::from(d[0]) * size[0]) + square(f64::from(d[1]) * size[1])).sqrt();
        let last = self.levels.len() - 1;
        let (mut rho, mut level) = (length(footprint.dx).max(length(footprint.dy)), 0);
        while rho >= 2.0 && level < last {
            rho /= 2.0;
            level += 1;
        }
        if rho > 1.0 && level < last { (level, rho.min(2.0) - 1.0) } else { (level, 0.0) }
    }

    fn sample_level(&self, level: usize, [u, v]: [f32; 2]) -> [f64; 4] {
        let image = &self.levels[level.min(self.levels.len() - 1)];
        let u = f64::from(u) * f64::from(image.width());
        let v = f64::from(v) * f64::from(image.height());
        match self.sampler.filter {
            FilterMode::Nearest => self.fetch(image, u.floor(), v.floor()),
            FilterMode::Linear => {
                let (u, v) = (u - 0.5, v - 0.5);
                let (x, y) = (u.floor(), v.floor());
                let row = |y| mix(self.fetch(image, x, y), self.fetch(image, x + 1.0, y), u - x);
                mix(row(y), row(y + 1.0), v - y)
            }
        }
    }

    /// One texel by integer coordinates, wherever they lie.
    fn fetch(&self, image: &Image, x: f64, y: f64) -> [f64; 4] {
        let [mode_x, mode_y] = self.sampler.address;
        match (wrap(x, image.width(), mode_x), wrap(y, image.height(), mode_y)) {
            (Some(x), Some(y)) => image.texel(x, y).map(f64::from),
            _ => [0.0; 4],
        }
    }
}

/// `a` at 0, `b` at 1; a weight that is not finite counts as 0.
fn mix(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    let t = if t.is_finite() { t } else { 0.0 };
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

/// A texel coordinate brought into `0..size`; `None` on the border.
fn wrap(coordinate: f64, size: u32, mode: AddressMode) -> Option<u32> {
    // Beyond 2^52 there are no neighbours left to tell apart.
    let limit = i64_to_f64(1 << 52);
    let i = f64_to_i64(coordinate.clamp(-limit, limit));
    let size = i64::from(size);
    let inside = match mode {
        AddressMode::ClampToEdge => i.clamp(0, size - 1),
        AddressMode::Repeat => i.rem_euclid(size),
        AddressMode::MirrorRepeat => {
            let i = i.rem_euclid(2 * size);
            i.min(2 * size - 1 - i)
        }
        AddressMode::ClampToBorder => i,
    };
    u32::try_from(inside).ok().filter(|&i| i64::from(i) < size)
}
