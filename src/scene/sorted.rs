//! The yardstick for drawing orders: every pixel's fragments sorted by depth, farthest first.
//!
//! This is what order-independent transparency aims at. It needs all fragments of a pixel at once, which is why GPUs
//! draw sorted objects instead.

use wgpu_types::{CompareFunction, StencilState};

use super::description::Scene;
use super::render::SceneError;
use crate::merger::Merger;
use crate::model::NumericModel;
use crate::state::MergerState;
use crate::target::Framebuffer;

impl Scene {
    /// The scene with each pixel's fragments merged from the farthest to the nearest, equal depths in drawing order,
    /// without depth and stencil tests. Meant for scenes whose materials have one pass each.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn render_sorted_per_pixel(&self, model: &dyn NumericModel) -> Result<Framebuffer, SceneError> {
        let draws = self.draws();
        let mut fragments: Vec<_> = self
            .layers(&draws)?
            .into_iter()
            .flat_map(|layer| layer.fragments.into_iter().map(move |pixel| (layer.draw, pixel)))
            .collect();
        // Far is 1, unless depth is reversed; a stable sort keeps the drawing order of equals.
        let nearness = |depth: f32| if self.camera.reversed { depth } else { -depth };
        fragments.sort_by(|(_, a), (_, b)| nearness(a.fragment.depth).total_cmp(&nearness(b.fragment.depth)));
        let states: Vec<MergerState> = draws.iter().map(|draw| untested(&draw.state)).collect();
        let mut framebuffer = self.cleared()?;
        let blank = framebuffer.clone();
        let mergers = states.iter().enumerate().map(|(index, state)| {
            Merger::new(state, model, &blank).map_err(|source| SceneError::Merger {
                index,
                draw: draws[index].label(),
                source,
            })
        });
        let mergers: Vec<_> = mergers.collect::<Result<_, _>>()?;
        for (draw, pixel) in &fragments {
            mergers[*draw].merge(&pixel.fragment, pixel.x, pixel.y, &mut framebuffer);
        }
        Ok(framebuffer)
    }
}

/// The state without depth and stencil tests and writes.
fn untested(state: &MergerState) -> MergerState {
    let mut state = state.clone();
    if let Some(depth_stencil) = &mut state.depth_stencil {
        depth_stencil.stencil = StencilState::default();
        if depth_stencil.depth_compare.is_some() {
            depth_stencil.depth_compare = Some(CompareFunction::Always);
            depth_stencil.depth_write_enabled = Some(false);
        }
    }
    state
}
