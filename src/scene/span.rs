//! Fragments in raster order, merged as spans.

use super::shade::PixelFragment;
use crate::kernel::{Colors, Span, SpanMerger};
use crate::merger::MergerError;
use crate::model::NumericModel;
use crate::state::{MAX_COLOR_TARGETS, MergerState};
use crate::target::Framebuffer;

/// The merger of one draw, and memory for its spans.
pub(super) struct Spans<'a> {
    merger: SpanMerger<'a>,
    outputs: usize,
    /// Red, green, blue and alpha by location.
    planes: [[Vec<f32>; 4]; MAX_COLOR_TARGETS],
    depth: Vec<f32>,
    keep: Vec<u8>,
}

impl<'a> Spans<'a> {
    pub(super) fn new(
        state: &'a MergerState,
        model: &'a dyn NumericModel,
        targets: &Framebuffer,
    ) -> Result<Self, MergerError> {
        Ok(Self {
            merger: SpanMerger::new(state, model, targets)?,
            outputs: state.targets.len().clamp(1, MAX_COLOR_TARGETS),
            planes: Default::default(),
            depth: Vec::new(),
            keep: Vec::new(),
        })
    }

    pub(super) fn merge(&mut self, fragments: &[PixelFragment], targets: &mut Framebuffer) {
        let neighbours = |a: &PixelFragment, b: &PixelFragment| {
            b.y == a.y && b.x == a.x + 1 && b.fragment.front_facing == a.fragment.front_facing
        };
        for run in fragments.chunk_by(neighbours) {
            self.run(run, targets);
        }
    }

    /// Fragments side by side.
    fn run(&mut self, run: &[PixelFragment], targets: &mut Framebuffer) {
        for (location, planes) in self.planes.iter_mut().enumerate().take(self.outputs) {
            for (channel, plane) in planes.iter_mut().enumerate() {
                plane.clear();
                plane.extend(run.iter().map(|pixel| pixel.fragment.outputs[location][channel]));
            }
        }
        self.depth.clear();
        self.depth.extend(run.iter().map(|pixel| pixel.fragment.depth));
        self.keep.clear();
        self.keep.extend(run.iter().map(|pixel| u8::from(!pixel.fragment.discarded)));
        let colors = self.planes.each_ref().map(|planes| Colors::Planes(planes.each_ref().map(Vec::as_slice)));
        let span = Span {
            depth: Some(&self.depth),
            keep: Some(&self.keep),
            front_facing: run[0].fragment.front_facing,
            ..Span::new(run[0].x, run[0].y, &colors[..self.outputs])
        };
        self.merger.merge(&span, targets);
    }
}
