//! A scene through the planned merger, by spans, in one or several numeric models at once; or through the reference.

use std::time::{Duration, Instant};

use super::description::{DepthSpec, Scene};
use super::draw::Draw;
use super::material::Work;
use super::shade::PixelFragment;
use super::span::Spans;
use crate::merger::{Merger, MergerError};
use crate::model::NumericModel;
use crate::model::exact::Exact;
use crate::plan::{Access, Plan};
use crate::state::MergerState;
use crate::state::block::StateBlock;
use crate::target::{Framebuffer, TargetError};

/// A scene that cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The targets cannot be made.
    #[error("the scene's targets: {0}")]
    Target(#[from] TargetError),
    /// The model or the state do not fit.
    #[error("draw {index} ({draw}): {source}")]
    Merger {
        /// Index of the draw.
        index: usize,
        /// Its object and pass.
        draw: String,
        /// Why.
        source: MergerError,
    },
    /// Too many fragments to keep.
    #[error("the scene makes more than {limit} fragments, too many to keep at once; draw it smaller")]
    TooManyFragments {
        /// The limit.
        limit: usize,
    },
}

/// What one draw was and made.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct DrawReport {
    /// Name of the object.
    pub object: String,
    /// Name of the pass.
    pub pass: String,
    /// Render queue.
    pub queue: u16,
    /// Sort key within the queue.
    pub distance: f64,
    /// The parts of the shader it needed.
    pub keywords: Vec<&'static str>,
    /// What shading took.
    pub work: Work,
}

/// A rendered scene.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Name of the numeric model.
    pub model: String,
    /// The targets after the last draw.
    pub framebuffer: Framebuffer,
    /// The draws, in order.
    pub draws: Vec<DrawReport>,
    /// Fragments merged, discarded ones included.
    pub fragments: u64,
    /// Time spent merging; rasterising and shading are not in it.
    pub merge_time: Duration,
}

/// The merger of one draw: by spans and its plan, or the reference.
enum Way<'a> {
    Planned(Box<Spans<'a>>),
    Reference(Merger<'a>),
}

/// Which merger to use.
#[derive(Clone, Copy)]
enum Path {
    Planned,
    Reference,
}

impl<'a> Way<'a> {
    fn new(
        path: Path,
        state: &'a MergerState,
        model: &'a dyn NumericModel,
        targets: &Framebuffer,
    ) -> Result<Self, MergerError> {
        match path {
            Path::Planned => Spans::new(state, model, targets).map(|spans| Self::Planned(Box::new(spans))),
            Path::Reference => Merger::new(state, model, targets).map(Self::Reference),
        }
    }

    fn merge(&mut self, fragments: &[PixelFragment], framebuffer: &mut Framebuffer) {
        match self {
            Self::Planned(spans) => spans.merge(fragments, framebuffer),
            Self::Reference(merger) => {
                fragments.iter().for_each(|pixel| merger.merge(&pixel.fragment, pixel.x, pixel.y, framebuffer));
            }
        }
    }
}

impl Scene {
    /// The scene's targets, cleared. Clear values are stored with one correct rounding, whatever the model.
    ///
    /// # Errors
    /// [`TargetError`].
    pub fn cleared(&self) -> Result<Framebuffer, TargetError> {
        self.cleared_with(self.target.depth)
    }

    fn cleared_with(&self, depth: Option<DepthSpec>) -> Result<Framebuffer, TargetError> {
        let formats: Vec<_> = self.target.colors.iter().map(|color| color.format.texture_format()).collect();
        let depth_format = depth.map(|depth| depth.format);
        let state = StateBlock::default().to_merger_state(&formats, depth_format);
        let mut framebuffer = Framebuffer::for_state(self.target.extent, &state)?;
        let exact = Exact::default();
        for (target, spec) in framebuffer.colors.iter_mut().zip(&self.target.colors) {
            if let Some(target) = target {
                target.fill(exact.clear_color(spec.format, spec.clear));
            }
        }
        if let (Some(target), Some(spec)) = (&mut framebuffer.depth_stencil, depth) {
            if let Some(kind) = target.format().depth() {
                target.depth_mut().fill(exact.depth_code(kind, spec.clear, [0.0, 1.0]));
            }
            target.stencil_mut().fill(spec.clear_stencil);
        }
        Ok(framebuffer)
    }

    /// Renders the scene in one model.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn render(&self, model: &dyn NumericModel) -> Result<Rendered, SceneError> {
        Ok(self.render_models(&[model])?.swap_remove(0))
    }

    /// Renders the scene in several models; fragments are made once, and merged by spans, in kernels where there are any
    /// ([`crate::kernel::SpanMerger`]). Each draw leaves out what its plan does not need, and
    /// where no draw reads or writes depth or stencil, there is no such target: [`Rendered::framebuffer`] has none.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn render_models(&self, models: &[&dyn NumericModel]) -> Result<Vec<Rendered>, SceneError> {
        self.render_by(models, Path::Planned)
    }

    /// Renders the scene through the reference merger, which leaves nothing out; the bytes are the same, and the depth
    /// target of the scene is always there.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn render_reference(&self, model: &dyn NumericModel) -> Result<Rendered, SceneError> {
        Ok(self.render_by(&[model], Path::Reference)?.swap_remove(0))
    }

    /// Whether some draw reads or writes depth or stencil in some model.
    pub(super) fn touches_depth(&self, draws: &[Draw], models: &[&dyn NumericModel]) -> Result<bool, SceneError> {
        for (index, draw) in draws.iter().enumerate() {
            for model in models {
                let plan = Plan::for_model(&draw.state, *model).map_err(|source| SceneError::Merger {
                    index,
                    draw: draw.label(),
                    source: source.into(),
                })?;
                if plan.depth_stencil != Access::default() {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Renders with a merger that is made anew for each draw and model.
    fn render_by(&self, models: &[&dyn NumericModel], path: Path) -> Result<Vec<Rendered>, SceneError> {
        let mut draws = self.draws();
        let depth = match path {
            Path::Planned if !self.touches_depth(&draws, models)? => None,
            Path::Planned | Path::Reference => self.target.depth,
        };
        if depth.is_none() {
            draws.iter_mut().for_each(|draw| draw.state.depth_stencil = None);
        }
        // The last model takes the cleared targets themselves, so one model needs no second copy.
        let cleared = vec![self.cleared_with(depth)?; models.len()];
        let start = |(model, framebuffer): (&&dyn NumericModel, Framebuffer)| Rendered {
            model: model.name(),
            framebuffer,
            draws: Vec::new(),
            fragments: 0,
            merge_time: Duration::ZERO,
        };
        let mut rendered: Vec<Rendered> = models.iter().zip(cleared).map(start).collect();
        for (index, draw) in draws.iter().enumerate() {
            let mut ways: Vec<Way<'_>> = models
                .iter()
                .zip(&rendered)
                .map(|(model, rendered)| Way::new(path, &draw.state, *model, &rendered.framebuffer))
                .collect::<Result<_, _>>()
                .map_err(|source| SceneError::Merger { index, draw: draw.label(), source })?;
            let work = self.shade(draw, None, |fragments| {
                for (way, rendered) in ways.iter_mut().zip(&mut rendered) {
                    let started = Instant::now();
                    way.merge(fragments, &mut rendered.framebuffer);
                    rendered.merge_time += started.elapsed();
                }
            });
            for rendered in &mut rendered {
                rendered.draws.push(draw.report(work));
                rendered.fragments += work.fragments;
            }
        }
        Ok(rendered)
    }
}

impl Draw {
    /// Object and pass, for messages.
    #[must_use]
    pub fn label(&self) -> String {
        format!("{}, {}", self.object, self.pass)
    }

    fn report(&self, work: Work) -> DrawReport {
        DrawReport {
            object: self.object.clone(),
            pass: self.pass.clone(),
            queue: self.key.queue.number(),
            distance: self.key.distance,
            keywords: self.keywords.names().collect(),
            work,
        }
    }
}
