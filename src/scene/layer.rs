//! A scene as layers of fragments, for replay on a device, and the fragments of one pixel, for its history.

use super::description::Scene;
use super::draw::Draw;
use super::render::SceneError;
use super::shade::PixelFragment;
use crate::fragment::Fragment;
use crate::state::Rect;

/// Fragments [`Scene::layers`] keeps at most: about 0.8 GB.
pub const MAX_KEPT_FRAGMENTS: usize = 1 << 22;

/// Fragments of one draw, at most one a texel: merging layers in order merges the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Index of the draw, which holds the state.
    pub draw: usize,
    /// The fragments.
    pub fragments: Vec<PixelFragment>,
}

/// One fragment of a texel and what made it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the draw.
    pub draw: usize,
    /// Index of the triangle in [`Draw::triangles`].
    pub triangle: usize,
    /// The fragment.
    pub fragment: Fragment,
}

impl Scene {
    /// The fragments of `draws` (from [`Scene::draws`]) as layers. A draw that covers a texel several times, as a sphere
    /// without culling does, gives several layers; the order at each texel is kept.
    ///
    /// # Errors
    /// [`SceneError::TooManyFragments`] above [`MAX_KEPT_FRAGMENTS`].
    pub fn layers(&self, draws: &[Draw]) -> Result<Vec<Layer>, SceneError> {
        let (mut layers, mut kept) = (Vec::<Layer>::new(), 0);
        for (index, draw) in draws.iter().enumerate() {
            let first = layers.len();
            let mut covered = vec![0_usize; self.target.extent.sample_total()];
            self.shade(draw, None, |fragments| {
                kept += fragments.len();
                if kept > MAX_KEPT_FRAGMENTS {
                    return;
                }
                for fragment in fragments {
                    let times = &mut covered[self.target.extent.index(fragment.x, fragment.y, 0)];
                    if first + *times == layers.len() {
                        layers.push(Layer { draw: index, fragments: Vec::new() });
                    }
                    layers[first + *times].fragments.push(*fragment);
                    *times += 1;
                }
            });
            if kept > MAX_KEPT_FRAGMENTS {
                return Err(SceneError::TooManyFragments { limit: MAX_KEPT_FRAGMENTS });
            }
        }
        Ok(layers)
    }

    /// Every fragment of one texel in drawing order.
    #[must_use]
    pub fn fragments_at(&self, draws: &[Draw], x: u32, y: u32) -> Vec<Hit> {
        let window = Rect { x, y, width: 1, height: 1 };
        let mut found = Vec::new();
        for (index, draw) in draws.iter().enumerate() {
            self.shade_each(draw, Some(window), |triangle, pixel| {
                found.push(Hit { draw: index, triangle, fragment: pixel.fragment });
            });
        }
        found
    }
}
