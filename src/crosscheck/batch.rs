//! What a replay is given: initial target bytes and layers of fragments, and the checks on them.

use wgpu::{BlendState, Features, TextureFormat};

use super::device::{Device, DeviceError, feature_names};
use crate::format::DepthFormat;
use crate::fragment::Fragment;
use crate::state::{MAX_COLOR_TARGETS, MergerState};
use crate::target::{Framebuffer, TargetError};

/// Where a layer's depth comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DepthSource {
    /// The fragment shader writes it (`frag_depth`): any bits, no depth bias.
    #[default]
    Shader,
    /// The rasteriser: one triangle a fragment at that constant depth, so depth bias applies with slope 0. Fragments
    /// outside [0, 1] are clipped away unless [`Layer::unclipped_depth`] is set.
    Rasteriser,
}

/// One fragment for every texel, drawn with one state.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The state of the draw.
    pub state: MergerState,
    /// One a texel, rows from the top. A fragment whose coverage lacks sample 0 is not drawn.
    pub fragments: Vec<Fragment>,
    /// One stencil reference a texel; `None` uses the state's for all.
    pub stencil_references: Option<Vec<u8>>,
    /// Clamp depth to the viewport's range where the pipeline would otherwise clip (wgpu's `unclipped_depth`).
    pub unclipped_depth: bool,
    /// Where depth comes from.
    pub depth_source: DepthSource,
}

impl Layer {
    /// A layer with nothing out of the ordinary.
    #[must_use]
    pub fn new(state: MergerState, fragments: Vec<Fragment>) -> Self {
        Self { state, fragments, stencil_references: None, unclipped_depth: false, depth_source: DepthSource::Shader }
    }
}

/// Layers over given target bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The targets and their bytes before the first layer.
    pub initial: Framebuffer,
    /// The layers, drawn in order.
    pub layers: Vec<Layer>,
}

/// A batch that cannot be replayed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplayError {
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A target could not be made.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// More than one sample a texel.
    #[error("targets with {0} samples per texel cannot be replayed; only single-sampled ones can")]
    Samples(u32),
    /// Attachments of state and framebuffer differ.
    #[error("layer {layer}: {attachment} of the state is not the framebuffer's; make it with `Framebuffer::for_state`")]
    Attachment {
        /// The layer's index.
        layer: usize,
        /// Which attachment.
        attachment: String,
    },
    /// A layer has too few or too many fragments or stencil references.
    #[error("layer {layer} has {got} {what}; the targets have {expected} texels")]
    LayerSize {
        /// The layer's index.
        layer: usize,
        /// What was counted.
        what: &'static str,
        /// Texels of the targets.
        expected: usize,
        /// Elements given.
        got: usize,
    },
    /// The adapter does not draw to this format.
    #[error("adapter `{adapter}` does not draw to {format:?}; leave this format out")]
    NotRendered {
        /// The adapter's name.
        adapter: String,
        /// The format.
        format: TextureFormat,
    },
    /// The device lacks a feature.
    #[error("adapter `{adapter}` lacks {feature}, which {what} needs")]
    MissingFeature {
        /// The adapter's name.
        adapter: String,
        /// The feature, as wgpu names it.
        feature: String,
        /// What needs it.
        what: String,
    },
    /// Dual-source blending with several targets.
    #[error("layer {0}: dual-source blending works with exactly one color target, at location 0")]
    DualSourceTargets(usize),
    /// A layer does not fit the device.
    #[error("layer {layer} needs {bytes} bytes of fragments, the device binds at most {limit}; use smaller targets")]
    TooLarge {
        /// The layer's index.
        layer: usize,
        /// Bytes needed.
        bytes: u64,
        /// Bytes the device binds.
        limit: u64,
    },
    /// An initial depth code that drawing does not produce.
    #[error(
        "texel {texel}: the device holds depth code {got:#x} where {wanted:#x} was to be put; such a code cannot come from a draw"
    )]
    InitialDepth {
        /// Index of the texel.
        texel: usize,
        /// The code asked for.
        wanted: u32,
        /// The code found.
        got: u32,
    },
}

impl Batch {
    /// Whether the device can replay this batch.
    pub(super) fn check(&self, device: &Device) -> Result<(), ReplayError> {
        let targets = &self.initial;
        if targets.extent.samples != 1 {
            return Err(ReplayError::Samples(targets.extent.samples));
        }
        let colors = targets.colors.iter().flatten().map(|color| color.format().texture_format());
        for format in colors.chain(targets.depth_stencil.iter().map(|target| target.format().texture_format())) {
            if !device.renders(format) {
                return Err(ReplayError::NotRendered { adapter: device.report().name.clone(), format });
            }
        }
        self.layers.iter().enumerate().try_for_each(|(index, layer)| layer.check(index, device, targets))
    }
}

impl Layer {
    fn check(&self, index: usize, device: &Device, targets: &Framebuffer) -> Result<(), ReplayError> {
        let expected = targets.extent.sample_total();
        let size = |what, got| match got == expected {
            true => Ok(()),
            false => Err(ReplayError::LayerSize { layer: index, what, expected, got }),
        };
        size("fragments", self.fragments.len())?;
        if let Some(references) = &self.stencil_references {
            size("stencil references", references.len())?;
        }
        self.check_attachments(index, targets)?;
        let needs = |feature: Features, what: &str| match device.features().contains(feature) {
            true => Ok(()),
            false => Err(ReplayError::MissingFeature {
                adapter: device.report().name.clone(),
                feature: feature_names(feature),
                what: what.to_owned(),
            }),
        };
        if self.unclipped_depth {
            needs(Features::DEPTH_CLIP_CONTROL, "unclipped depth")?;
        }
        if self.uses_second_source() {
            needs(Features::DUAL_SOURCE_BLENDING, "a second source")?;
            if self.state.targets.iter().flatten().count() != 1 || self.state.targets[0].is_none() {
                return Err(ReplayError::DualSourceTargets(index));
            }
        }
        Ok(())
    }

    fn check_attachments(&self, index: usize, targets: &Framebuffer) -> Result<(), ReplayError> {
        let wrong = |attachment: String| Err(ReplayError::Attachment { layer: index, attachment });
        if self.state.targets.len() > MAX_COLOR_TARGETS {
            return wrong(format!("the number of color targets ({})", self.state.targets.len()));
        }
        for (location, target) in self.state.targets.iter().enumerate() {
            let Some(target) = target else { continue };
            let attached = targets.colors.get(location).and_then(Option::as_ref);
            if attached.map(|color| color.format().texture_format()) != Some(target.format) {
                return wrong(format!("color target {location}"));
            }
        }
        if let Some(state) = &self.state.depth_stencil {
            let attached = targets.depth_stencil.as_ref().map(|target| target.format());
            if attached.map(DepthFormat::texture_format) != Some(state.format) {
                return wrong("the depth/stencil target".to_owned());
            }
        }
        if self.state.multisample.count != targets.extent.samples {
            return wrong("the sample count".to_owned());
        }
        Ok(())
    }

    /// Whether some factor reads the second source.
    pub(super) fn uses_second_source(&self) -> bool {
        self.state.targets.iter().flatten().filter_map(|target| target.blend.as_ref()).any(reads_second_source)
    }
}

/// Whether a factor of `blend` reads the second source.
#[must_use]
pub fn reads_second_source(blend: &BlendState) -> bool {
    [blend.color, blend.alpha]
        .iter()
        .any(|part| part.src_factor.ref_second_blend_source() || part.dst_factor.ref_second_blend_source())
}
