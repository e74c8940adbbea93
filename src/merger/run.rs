//! The stages in sequence.

use wgpu_types::{ColorTargetState, ColorWrites};

use super::depth_stencil::{self, DepthStencil};
use super::{coverage, discard, write_mask};
use crate::format::{Codes, ColorFormat, DepthFormat, FormatError};
use crate::fragment::Fragment;
use crate::model::{ColorInputs, NumericModel, Unsupported};
use crate::state::MergerState;
use crate::target::Framebuffer;

/// State, model and targets that do not fit together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergerError {
    /// A format has no such role.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The model defines no result for a target.
    #[error("target {index}: {source}")]
    Unsupported {
        /// The target's index.
        index: usize,
        /// Why.
        source: Unsupported,
    },
    /// The framebuffer's attachments are not those of the state.
    #[error("{0}: the framebuffer's attachment does not match the state; make it with `Framebuffer::for_state`")]
    Attachment(String),
}

/// What became of one sample of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fate {
    /// Outside scissor, primitive or sample mask.
    NotCovered,
    /// The shader discarded the fragment.
    Discarded,
    /// The fixed-function alpha test failed.
    AlphaTestFailed,
    /// Alpha to coverage dropped the sample.
    AlphaToCoverage,
    /// The stencil test failed.
    StencilFailed,
    /// The depth test failed.
    DepthFailed,
    /// It reached the color targets.
    Merged,
}

/// What one sample went through.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleTrace {
    /// The sample's index.
    pub sample: u32,
    /// How it ended.
    pub fate: Fate,
    /// Depth and stencil before and after, with the fragment's depth code; `None` when not reached or not attached.
    pub depth_stencil: Option<(u32, DepthStencil, DepthStencil)>,
    /// Per color target: what the blender saw, and the codes stored after the write mask.
    pub colors: Vec<Option<(ColorInputs, Codes)>>,
}

/// What one fragment went through, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// One entry a sample of the target.
    pub samples: Vec<SampleTrace>,
}

/// The reference output merger for one state, model and set of formats.
#[derive(Debug)]
pub struct Merger<'a> {
    pub(crate) state: &'a MergerState,
    pub(crate) model: &'a dyn NumericModel,
    pub(crate) colors: Vec<Option<(&'a ColorTargetState, ColorFormat)>>,
    pub(crate) depth: Option<DepthFormat>,
}

impl<'a> Merger<'a> {
    /// Fits state, model and targets together.
    ///
    /// # Errors
    /// [`MergerError`] when a format is not of its role, the model does not cover a target, or `targets` lacks an
    /// attachment that `state` names or has it in another format.
    pub fn new(
        state: &'a MergerState,
        model: &'a dyn NumericModel,
        targets: &Framebuffer,
    ) -> Result<Self, MergerError> {
        let mut colors = Vec::new();
        for (index, target) in state.targets.iter().enumerate() {
            let Some(target) = target else {
                colors.push(None);
                continue;
            };
            let format = ColorFormat::new(target.format)?;
            model
                .supports(format, target.blend.as_ref())
                .map_err(|source| MergerError::Unsupported { index, source })?;
            let attached = targets.colors.get(index).and_then(Option::as_ref);
            if attached.is_none_or(|color| color.format() != format || color.extent() != targets.extent) {
                return Err(MergerError::Attachment(format!("color target {index}")));
            }
            colors.push(Some((target, format)));
        }
        let depth = match &state.depth_stencil {
            None => None,
            Some(depth_stencil) => {
                let format = DepthFormat::new(depth_stencil.format)?;
                let attached = targets.depth_stencil.as_ref();
                if attached.is_none_or(|target| target.format() != format || target.extent() != targets.extent) {
                    return Err(MergerError::Attachment("depth/stencil target".to_owned()));
                }
                Some(format)
            }
        };
        if state.multisample.count != targets.extent.samples {
            return Err(MergerError::Attachment("sample count".to_owned()));
        }
        Ok(Self { state, model, colors, depth })
    }

    /// Merges one fragment into texel (x, y).
    ///
    /// # Panics
    /// When the texel lies outside `targets`, or `targets` are not those given to [`Merger::new`].
    pub fn merge(&self, fragment: &Fragment, x: u32, y: u32, targets: &mut Framebuffer) {
        self.run(fragment, x, y, targets, &mut |_| ());
    }

    /// Merges one fragment and tells what each sample went through.
    ///
    /// # Panics
    /// As [`Merger::merge`].
    pub fn trace(&self, fragment: &Fragment, x: u32, y: u32, targets: &mut Framebuffer) -> Trace {
        let mut samples = Vec::new();
        self.run(fragment, x, y, targets, &mut |sample| samples.push(sample));
        Trace { samples }
    }

    /// The numeric model in use.
    #[must_use]
    pub fn model(&self) -> &'a dyn NumericModel {
        self.model
    }

    /// The stages, in order, for every sample.
    fn run(&self, fragment: &Fragment, x: u32, y: u32, targets: &mut Framebuffer, record: &mut dyn FnMut(SampleTrace)) {
        let state = self.state;
        let mask = self.model.sample_mask(&state.multisample);
        let covered = coverage::covered_samples(state.multisample.count, mask, &state.dynamic, fragment, (x, y));
        let alpha = fragment.outputs[0][3];
        let kept = covered & discard::alpha_to_coverage(&state.multisample, alpha);
        for sample in 0..targets.extent.samples {
            let mut trace = SampleTrace { sample, fate: Fate::Merged, depth_stencil: None, colors: Vec::new() };
            trace.fate = if covered >> sample & 1 == 0 {
                Fate::NotCovered
            } else if fragment.discarded {
                Fate::Discarded
            } else if !state.alpha_test.passes(alpha) {
                Fate::AlphaTestFailed
            } else if kept >> sample & 1 == 0 {
                Fate::AlphaToCoverage
            } else {
                self.test_depth_stencil(fragment, x, y, targets, &mut trace)
            };
            self.write_colors(fragment, x, y, targets, &mut trace);
            record(trace);
        }
    }

    /// Stage 3 on one sample.
    fn test_depth_stencil(
        &self,
        fragment: &Fragment,
        x: u32,
        y: u32,
        targets: &mut Framebuffer,
        trace: &mut SampleTrace,
    ) -> Fate {
        let (Some(state), Some(format), Some(target)) =
            (&self.state.depth_stencil, self.depth, targets.depth_stencil.as_mut())
        else {
            return Fate::Merged;
        };
        let at = target.extent().index(x, y, trace.sample);
        let stored = DepthStencil {
            depth: target.depth().get(at).copied().unwrap_or(0),
            stencil: target.stencil().get(at).copied().unwrap_or(0),
        };
        let dynamic = &self.state.dynamic;
        let code = format.depth().map_or(0, |kind| self.model.depth_code(kind, fragment.depth, dynamic.depth_range));
        let tested = depth_stencil::test(state, format, fragment.front_facing, dynamic.stencil_reference, code, stored);
        if let Some(depth) = target.depth_mut().get_mut(at) {
            *depth = tested.stored.depth;
        }
        if let Some(stencil) = target.stencil_mut().get_mut(at) {
            *stencil = tested.stored.stencil;
        }
        trace.depth_stencil = Some((code, stored, tested.stored));
        match (tested.stencil_passed, tested.depth_passed) {
            (false, _) => Fate::StencilFailed,
            (true, false) => Fate::DepthFailed,
            (true, true) => Fate::Merged,
        }
    }

    /// Stages 4 to 7 on one sample, for every target.
    fn write_colors(&self, fragment: &Fragment, x: u32, y: u32, targets: &mut Framebuffer, trace: &mut SampleTrace) {
        for (index, color) in self.colors.iter().enumerate() {
            let (Some((state, format)), Some(Some(target))) = (color, targets.colors.get_mut(index)) else {
                trace.colors.push(None);
                continue;
            };
            let old = target.codes(x, y, trace.sample);
            if trace.fate != Fate::Merged {
                if trace.fate != Fate::NotCovered {
                    target.set_codes(x, y, trace.sample, self.model.rewrite_untouched(*format, old));
                }
                trace.colors.push(None);
                continue;
            }
            let inputs = ColorInputs {
                format: *format,
                blend: state.blend,
                constant: self.state.dynamic.blend_constant,
                src: fragment.outputs[index],
                src1: fragment.src1,
                dst: old,
            };
            let mut codes = old;
            if state.write_mask != ColorWrites::empty() {
                codes = write_mask::select(state.write_mask, old, self.model.merge_color(&inputs));
            }
            let untouched = self.model.rewrite_untouched(*format, codes);
            codes = write_mask::select(state.write_mask, untouched, codes);
            target.set_codes(x, y, trace.sample, codes);
            trace.colors.push(Some((inputs, codes)));
        }
    }
}
