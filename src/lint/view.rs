//! A scene as the rules see it: drawn once as it is, and again with each repair.

use super::{Example, Finding};
use crate::format::Codes;
use crate::merger::Merger;
use crate::model::exact::Exact;
use crate::scene::{Draw, Scene, SceneError};
use crate::state::MAX_COLOR_TARGETS;
use crate::target::Framebuffer;

/// A scene, its draws and its picture.
pub(crate) struct View<'a> {
    pub(super) scene: &'a Scene,
    pub(super) draws: Vec<Draw>,
    drawn: Framebuffer,
}

/// A pixel that a repair changes.
pub(super) struct Changed {
    pub(super) pixel: (u32, u32),
    pub(super) target: usize,
    pub(super) stored: Codes,
    pub(super) repaired: Codes,
}

impl<'a> View<'a> {
    pub(super) fn new(scene: &'a Scene) -> Result<Self, SceneError> {
        let draws = scene.draws();
        let drawn = render(scene, &draws)?;
        Ok(Self { scene, draws, drawn })
    }

    /// Draws the scene with changed draws; the first pixel that comes out otherwise, in `channels` of any target.
    pub(super) fn changed_by(&self, repaired: &[Draw], channels: [bool; 4]) -> Result<Option<Changed>, SceneError> {
        Ok(self.difference(&render(self.scene, repaired)?, channels))
    }

    /// The same with one draw changed.
    pub(super) fn changed_by_one(
        &self,
        draw: usize,
        channels: [bool; 4],
        repair: impl FnOnce(&mut Draw),
    ) -> Result<Option<Changed>, SceneError> {
        let mut draws = self.draws.clone();
        repair(&mut draws[draw]);
        self.changed_by(&draws, channels)
    }

    fn difference(&self, repaired: &Framebuffer, channels: [bool; 4]) -> Option<Changed> {
        let extent = self.drawn.extent;
        let places = (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| (x, y)));
        places
            .flat_map(|pixel| (0..MAX_COLOR_TARGETS.min(self.drawn.colors.len())).map(move |target| (pixel, target)))
            .find_map(|(pixel, target)| {
                let codes = |targets: &Framebuffer| Some(targets.colors[target].as_ref()?.codes(pixel.0, pixel.1, 0));
                let (stored, repaired) = (codes(&self.drawn)?, codes(repaired)?);
                let differs = (0..4).any(|i| channels[i] && stored[i] != repaired[i]);
                differs.then_some(Changed { pixel, target, stored, repaired })
            })
    }

    /// A finding at a draw.
    pub(super) fn finding(
        &self,
        rule: &'static str,
        draw: usize,
        (problem, fix): (String, &str),
        changed: &Changed,
    ) -> Finding {
        let (x, y) = changed.pixel;
        Finding {
            rule,
            place: self.place(draw),
            problem,
            fix: fix.to_owned(),
            example: Example {
                pixel: Some(changed.pixel),
                given: format!("pixel {x},{y}, color target {}", changed.target),
                target: changed.target,
                format: self.scene.target.colors[changed.target].format,
                stored: changed.stored,
                repaired: changed.repaired,
            },
        }
    }

    /// A draw in words.
    pub(super) fn place(&self, draw: usize) -> String {
        format!("draw {} ({})", draw + 1, self.draws[draw].label())
    }
}

fn render(scene: &Scene, draws: &[Draw]) -> Result<Framebuffer, SceneError> {
    let mut targets = scene.cleared()?;
    let exact = Exact::default();
    for (index, draw) in draws.iter().enumerate() {
        let failed = |source| SceneError::Merger { index, draw: draw.label(), source };
        let merger = Merger::new(&draw.state, &exact, &targets).map_err(failed)?;
        scene.shade(draw, None, |fragments| {
            for pixel in fragments {
                merger.merge(&pixel.fragment, pixel.x, pixel.y, &mut targets);
            }
        });
    }
    Ok(targets)
}
