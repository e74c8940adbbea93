//! What the model says the same draws write.

use crate::fragment::Fragment;
use crate::merger::{Merger, MergerError};
use crate::model::{NumericModel, registry};
use crate::scene::{PixelFragment, Scene, SceneError};
use crate::state::MergerState;
use crate::target::{ColorTarget, Extent, Framebuffer};

/// One draw: a state and the fragments it makes, in primitive order.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// What reports call it.
    pub name: String,
    /// State of the output merger.
    pub state: MergerState,
    /// The fragments, inside the target.
    pub fragments: Vec<PixelFragment>,
}

impl Draw {
    /// A draw that makes the same fragment at every texel.
    #[must_use]
    pub fn covering(name: &str, state: MergerState, extent: Extent, fragment: Fragment) -> Self {
        let texels = (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| (x, y)));
        let fragments = texels.map(|(x, y)| PixelFragment { x, y, fragment }).collect();
        Self { name: name.to_owned(), state, fragments }
    }
}

/// Draws that cannot be predicted.
#[derive(Debug, thiserror::Error)]
pub enum PredictionError {
    /// State, model and targets do not fit together.
    #[error("draw {index} ({name}): {source}")]
    Merger {
        /// Index of the draw.
        index: usize,
        /// Its name.
        name: String,
        /// Why.
        source: MergerError,
    },
    /// A fragment lies outside the target.
    #[error("draw {index} ({name}) has a fragment at ({x}, {y}), outside the {width} x {height} target")]
    Outside {
        /// Index of the draw.
        index: usize,
        /// Its name.
        name: String,
        /// The fragment's column.
        x: u32,
        /// The fragment's row.
        y: u32,
        /// The target's width.
        width: u32,
        /// The target's height.
        height: u32,
    },
    /// The scene cannot be rendered.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There is no such color target.
    #[error("there is no color target {0}")]
    Target(usize),
}

/// The targets that conforming draws leave: those of one model, or of any of several.
#[derive(Debug)]
pub struct Prediction {
    pub(super) before: Framebuffer,
    pub(super) draws: Vec<Draw>,
    /// Results by model name; the first is the one whose history is told.
    pub(super) accepted: Vec<(String, Framebuffer)>,
    pub(super) index: usize,
}

impl Prediction {
    /// What a model writes for draws over targets that hold `before`; the first color target is compared.
    ///
    /// # Errors
    /// [`PredictionError`].
    pub fn of_draws(before: &Framebuffer, draws: Vec<Draw>, model: &dyn NumericModel) -> Result<Self, PredictionError> {
        let Extent { width, height, .. } = before.extent;
        for (index, draw) in draws.iter().enumerate() {
            if let Some(PixelFragment { x, y, .. }) = draw.fragments.iter().find(|f| f.x >= width || f.y >= height) {
                let (name, x, y) = (draw.name.clone(), *x, *y);
                return Err(PredictionError::Outside { index, name, x, y, width, height });
            }
        }
        let mut prediction = Self { before: before.clone(), draws, accepted: Vec::new(), index: 0 };
        let result = prediction.run(model)?;
        prediction.accepted.push((model.name(), result));
        prediction.of_target(0)
    }

    /// What a model writes for a scene.
    ///
    /// # Errors
    /// [`PredictionError`], also for scenes of too many fragments to keep.
    pub fn of_scene(scene: &Scene, model: &dyn NumericModel) -> Result<Self, PredictionError> {
        let draws = scene.draws();
        let layers = scene.layers(&draws)?;
        let cleared = scene.cleared().map_err(SceneError::from)?;
        let layers = layers.into_iter().map(|layer| Draw {
            name: draws[layer.draw].label(),
            state: draws[layer.draw].state.clone(),
            fragments: layer.fragments,
        });
        Self::of_draws(&cleared, layers.collect(), model)
    }

    /// Compares another color target than the first.
    ///
    /// # Errors
    /// [`PredictionError::Target`] if there is none of this index.
    pub fn of_target(self, index: usize) -> Result<Self, PredictionError> {
        if !matches!(self.before.colors.get(index), Some(Some(_))) {
            return Err(PredictionError::Target(index));
        }
        Ok(Self { index, ..self })
    }

    /// Accepts, pixel by pixel, what a further model writes.
    ///
    /// # Errors
    /// [`PredictionError`] where the model does not cover the draws.
    pub fn or(mut self, model: &dyn NumericModel) -> Result<Self, PredictionError> {
        let result = self.run(model)?;
        self.accepted.push((model.name(), result));
        Ok(self)
    }

    /// Accepts what any named model of the registry that covers the draws writes.
    ///
    /// # Errors
    /// [`PredictionError`] other than a model's lack of support.
    pub fn or_any_model(mut self) -> Result<Self, PredictionError> {
        for model in registry::all() {
            match self.run(model.as_ref()) {
                Ok(result) => self.accepted.push((model.name(), result)),
                Err(PredictionError::Merger { source: MergerError::Unsupported { .. }, .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(self)
    }

    /// The first model's color target.
    ///
    /// # Panics
    /// Never: a prediction is made with its target.
    #[must_use]
    pub fn target(&self) -> &ColorTarget {
        self.color(&self.accepted[0].1)
    }

    pub(super) fn color<'a>(&self, framebuffer: &'a Framebuffer) -> &'a ColorTarget {
        framebuffer.colors[self.index].as_ref().expect("checked when the target was chosen")
    }

    /// All draws in one model.
    pub(super) fn run(&self, model: &dyn NumericModel) -> Result<Framebuffer, PredictionError> {
        let mut framebuffer = self.before.clone();
        for (index, draw) in self.draws.iter().enumerate() {
            let merger = Merger::new(&draw.state, model, &self.before).map_err(|source| PredictionError::Merger {
                index,
                name: draw.name.clone(),
                source,
            })?;
            for pixel in &draw.fragments {
                merger.merge(&pixel.fragment, pixel.x, pixel.y, &mut framebuffer);
            }
        }
        Ok(framebuffer)
    }
}
