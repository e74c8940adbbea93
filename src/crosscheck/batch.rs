//! What a replay is given: initial target bytes and layers of fragments, and the checks on them.

use wgpu::{Features, TextureFormat};

use super::device::{Device, DeviceError, feature_names};
use crate::format::DepthFormat;
use crate::fragment::Fragment;
use crate::state::{MAX_COLOR_TARGETS, MergerState, reads_second_source};
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
    /// A sweep over targets whose rows would be padded.
    #[error("a sweep's targets must be a multiple of {multiple} texels wide, not {width}")]
    SweepWidth {
        /// Asked width.
        width: u32,
        /// Smallest width.
        multiple: u32,
    },
    /// A sweep's array is too long or too short.
    #[error("a sweep's arrays must have one element for each of the {expected} texels, not {got}")]
    SweepSize {
        /// Texels of the targets.
        expected: usize,
        /// Elements given.
        got: usize,
    },
    /// A sweep's job needs what its fragments do not offer.
    #[error("the sweep's state needs {0}")]
    SweepInput(&'static str),
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
        check_targets(device, &self.initial)?;
        self.layers.iter().enumerate().try_for_each(|(index, layer)| layer.check(index, device, &self.initial))
    }
}

/// Whether the device draws to these targets.
pub(super) fn check_targets(device: &Device, targets: &Framebuffer) -> Result<(), ReplayError> {
    if targets.extent.samples != 1 {
        return Err(ReplayError::Samples(targets.extent.samples));
    }
    let colors = targets.colors.iter().flatten().map(|color| color.format().texture_format());
    let depth_stencil = targets.depth_stencil.iter().map(|target| target.format().texture_format());
    match colors.chain(depth_stencil).find(|format| !device.renders(*format)) {
        Some(format) => Err(ReplayError::NotRendered { adapter: device.report().name.clone(), format }),
        None => Ok(()),
    }
}

/// Whether a state fits targets and device; `layer` is named in errors.
pub(super) fn check_state(
    device: &Device,
    layer: usize,
    state: &MergerState,
    unclipped_depth: bool,
    targets: &Framebuffer,
) -> Result<(), ReplayError> {
    check_attachments(layer, state, targets)?;
    let needs = |feature: Features, what: &str| match device.features().contains(feature) {
        true => Ok(()),
        false => Err(ReplayError::MissingFeature {
            adapter: device.report().name.clone(),
            feature: feature_names(feature),
            what: what.to_owned(),
        }),
    };
    if unclipped_depth {
        needs(Features::DEPTH_CLIP_CONTROL, "unclipped depth")?;
    }
    if state_reads_second_source(state) {
        needs(Features::DUAL_SOURCE_BLENDING, "a second source")?;
        if state.targets.iter().flatten().count() != 1 || state.targets[0].is_none() {
            return Err(ReplayError::DualSourceTargets(layer));
        }
    }
    Ok(())
}

fn check_attachments(layer: usize, state: &MergerState, targets: &Framebuffer) -> Result<(), ReplayError> {
    let wrong = |attachment: String| Err(ReplayError::Attachment { layer, attachment });
    if state.targets.len() > MAX_COLOR_TARGETS {
        return wrong(format!("the number of color targets ({})", state.targets.len()));
    }
    for (location, target) in state.targets.iter().enumerate() {
        let Some(target) = target else { continue };
        let attached = targets.colors.get(location).and_then(Option::as_ref);
        if attached.map(|color| color.format().texture_format()) != Some(target.format) {
            return wrong(format!("color target {location}"));
        }
    }
    if let Some(depth_stencil) = &state.depth_stencil {
        let attached = targets.depth_stencil.as_ref().map(|target| target.format());
        if attached.map(DepthFormat::texture_format) != Some(depth_stencil.format) {
            return wrong("the depth/stencil target".to_owned());
        }
    }
    if state.multisample.count != targets.extent.samples {
        return wrong("the sample count".to_owned());
    }
    Ok(())
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
        check_state(device, index, &self.state, self.unclipped_depth, targets)
    }
}

/// Whether some target's blending reads the second source.
#[must_use]
pub fn state_reads_second_source(state: &MergerState) -> bool {
    state.targets.iter().flatten().filter_map(|target| target.blend.as_ref()).any(reads_second_source)
}
