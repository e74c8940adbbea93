//! Whole scenes as batches: the fragments of the mini fragment pipeline, drawn by a device (feature `scene`).

use super::batch::{Batch, Layer};
use crate::fragment::Fragment;
use crate::scene::{Scene, SceneError};

impl Batch {
    /// A scene's cleared targets and its layers of fragments, in drawing order.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn of_scene(scene: &Scene) -> Result<Self, SceneError> {
        let draws = scene.draws();
        let extent = scene.target.extent;
        let absent = Fragment { coverage: 0, ..Fragment::default() };
        let layer = |layer: crate::scene::Layer| {
            let mut fragments = vec![absent; extent.sample_total()];
            for pixel in layer.fragments {
                fragments[extent.index(pixel.x, pixel.y, 0)] = pixel.fragment;
            }
            // The rasteriser of the scene has clipped and biased depth already.
            Layer::new(draws[layer.draw].state.clone(), fragments)
        };
        let layers = scene.layers(&draws)?.into_iter().map(layer).collect();
        Ok(Self { initial: scene.cleared()?, layers })
    }
}
