//! From draws to fragments: rasterise, shade, hand over in order.

use glam::Vec3;

use super::description::{Output, Scene};
use super::draw::{Draw, SceneVertex, VARYINGS};
use super::material::surface::SurfaceShader;
use super::material::{SurfaceInput, Work};
use super::raster::{Primitive, assemble};
use super::texture::Footprint;
use crate::fragment::Fragment;
use crate::state::Rect;

/// Fragments handed over at a time.
const CHUNK: usize = 1 << 13;

/// A fragment and its texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFragment {
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// The fragment.
    pub fragment: Fragment,
}

impl Scene {
    /// Shades the fragments of one draw and hands them to `take` in primitive order, in pieces. Only texels inside
    /// `window`, if given. Returns what shading took.
    pub fn shade(&self, draw: &Draw, window: Option<Rect>, mut take: impl FnMut(&[PixelFragment])) -> Work {
        let mut fragments = Vec::with_capacity(CHUNK);
        let work = self.shade_each(draw, window, |_, fragment| {
            fragments.push(fragment);
            if fragments.len() == CHUNK {
                take(&fragments);
                fragments.clear();
            }
        });
        if !fragments.is_empty() {
            take(&fragments);
        }
        work
    }

    /// As [`Scene::shade`], one by one, each with the index of its triangle in [`Draw::triangles`].
    pub(super) fn shade_each(
        &self,
        draw: &Draw,
        window: Option<Rect>,
        mut take: impl FnMut(usize, PixelFragment),
    ) -> Work {
        let mut work = Work::default();
        let stage = Stage::new(self, draw);
        for (index, triangle) in draw.triangles.iter().enumerate() {
            for primitive in assemble::<VARYINGS>(*triangle, &draw.raster) {
                for span in primitive.spans() {
                    let columns = match window {
                        None => span.start..span.end,
                        Some(window) if span.y < window.y || span.y - window.y >= window.height => continue,
                        Some(window) => span.start.max(window.x)..span.end.min(window.x.saturating_add(window.width)),
                    };
                    for x in columns {
                        let fragment = stage.run(&primitive, x, span.y, &mut work);
                        take(index, PixelFragment { x, y: span.y, fragment });
                    }
                }
            }
        }
        work
    }
}

/// The fragment stage of one draw.
struct Stage<'a> {
    surface: SurfaceShader<'a>,
    outputs: Vec<Output>,
    fine_derivatives: bool,
}

impl<'a> Stage<'a> {
    fn new(scene: &'a Scene, draw: &'a Draw) -> Self {
        let surface = SurfaceShader {
            material: &draw.material,
            texture: draw.material.texture.map(|index| &scene.textures[index]),
            keywords: draw.keywords,
            shader: draw.shader,
            lighting: &scene.lighting,
            light: draw.light,
            eye: scene.eye(),
        };
        Self {
            surface,
            outputs: scene.target.colors.iter().map(|color| color.output).collect(),
            fine_derivatives: draw.raster.rasteriser.has_fine_derivatives(),
        }
    }

    fn run(&self, primitive: &Primitive<VARYINGS>, x: u32, y: u32, work: &mut Work) -> Fragment {
        let front_facing = primitive.front_facing();
        let keywords = self.surface.keywords;
        // Without texture and light nothing reads the varyings.
        let unread = !keywords.texture && !keywords.light && !self.outputs.contains(&Output::Normal);
        let [u, v, nx, ny, nz, px, py, pz] = if unread { [0.0; VARYINGS] } else { primitive.varyings(x, y) };
        let input =
            SurfaceInput { uv: [u, v], normal: Vec3::new(nx, ny, nz), position: Vec3::new(px, py, pz), front_facing };
        let shaded = self.surface.shade(&input, || footprint(primitive, x, y, self.fine_derivatives), work);
        let mut fragment =
            Fragment { depth: primitive.depth(x, y), front_facing, discarded: shaded.discarded, ..Fragment::default() };
        for (slot, output) in fragment.outputs.iter_mut().zip(&self.outputs) {
            *slot = match output {
                Output::Color => shaded.color,
                Output::Normal => {
                    let n = input.normal.try_normalize().unwrap_or(Vec3::Z) * 0.5 + 0.5;
                    [n.x, n.y, n.z, shaded.color[3]]
                }
            };
        }
        fragment
    }
}

/// Differences of the texture coordinates within the 2 x 2 quad the pixel lies in: along its upper row and left column,
/// or (`fine`) along the pixel's own.
fn footprint(primitive: &Primitive<VARYINGS>, x: u32, y: u32, fine: bool) -> Footprint {
    let uv = |x, y| {
        let [u, v, ..] = primitive.varyings(x, y);
        [u, v]
    };
    let (x, y) = if fine { (x, y) } else { (x & !1, y & !1) };
    let here = uv(x, y);
    // To the right or down, whichever of the two is here.
    let from = |other: [f32; 2], last: bool| {
        let (a, b) = if last { (other, here) } else { (here, other) };
        [b[0] - a[0], b[1] - a[1]]
    };
    Footprint { dx: from(uv(x ^ 1, y), x % 2 == 1), dy: from(uv(x, y ^ 1), y % 2 == 1) }
}

/// The vertices of a draw as one list, for a device.
impl Draw {
    /// All vertices, three a triangle.
    pub fn vertices(&self) -> impl Iterator<Item = &SceneVertex> {
        self.triangles.iter().flatten()
    }
}
