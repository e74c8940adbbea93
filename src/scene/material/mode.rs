//! The four rendering modes, as data: all that sets one apart from another stands in [`MODES`].

use serde::Deserialize;
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use crate::scene::queue::RenderQueue;

/// How a material treats alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RenderingMode {
    /// Alpha means nothing.
    #[default]
    Opaque,
    /// Alpha below the cutoff is a hole.
    Cutout,
    /// Alpha fades everything, highlights included.
    Fade,
    /// Alpha lets light through, highlights stay: glass.
    Transparent,
}

/// One row of the table of modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeSettings {
    /// The mode.
    pub mode: RenderingMode,
    /// Its render queue.
    pub queue: RenderQueue,
    /// Its render type tag, for replacement shading.
    pub render_type: &'static str,
    /// Source blend factor, color and alpha. Additive light passes use it too.
    pub src_blend: BlendFactor,
    /// Destination blend factor, color and alpha.
    pub dst_blend: BlendFactor,
    /// Whether depth is written.
    pub depth_write: bool,
    /// Whether fragments with an alpha below the cutoff are clipped.
    pub clips: bool,
    /// Whether the shader multiplies the diffuse color by alpha and adds reflectivity to alpha.
    pub premultiplies: bool,
    /// Whether the shader's alpha output is the material's alpha; 1 otherwise.
    pub outputs_alpha: bool,
}

/// The table of modes.
pub const MODES: [ModeSettings; 4] = [
    ModeSettings {
        mode: RenderingMode::Opaque,
        queue: RenderQueue::GEOMETRY,
        render_type: "Opaque",
        src_blend: BlendFactor::One,
        dst_blend: BlendFactor::Zero,
        depth_write: true,
        clips: false,
        premultiplies: false,
        outputs_alpha: false,
    },
    ModeSettings {
        mode: RenderingMode::Cutout,
        queue: RenderQueue::ALPHA_TEST,
        render_type: "TransparentCutout",
        src_blend: BlendFactor::One,
        dst_blend: BlendFactor::Zero,
        depth_write: true,
        clips: true,
        premultiplies: false,
        outputs_alpha: false,
    },
    ModeSettings {
        mode: RenderingMode::Fade,
        queue: RenderQueue::TRANSPARENT,
        render_type: "Transparent",
        src_blend: BlendFactor::SrcAlpha,
        dst_blend: BlendFactor::OneMinusSrcAlpha,
        depth_write: false,
        clips: false,
        premultiplies: false,
        outputs_alpha: true,
    },
    ModeSettings {
        mode: RenderingMode::Transparent,
        queue: RenderQueue::TRANSPARENT,
        render_type: "Transparent",
        src_blend: BlendFactor::One,
        dst_blend: BlendFactor::OneMinusSrcAlpha,
        depth_write: false,
        clips: false,
        premultiplies: true,
        outputs_alpha: true,
    },
];

impl RenderingMode {
    /// The mode's row.
    #[must_use]
    pub fn settings(self) -> &'static ModeSettings {
        match self {
            Self::Opaque => &MODES[0],
            Self::Cutout => &MODES[1],
            Self::Fade => &MODES[2],
            Self::Transparent => &MODES[3],
        }
    }
}

impl ModeSettings {
    /// The blend state of the base pass; `None` where it would be one/zero.
    #[must_use]
    pub fn blend(&self) -> Option<BlendState> {
        let off = (self.src_blend, self.dst_blend) == (BlendFactor::One, BlendFactor::Zero);
        (!off).then(|| both(self.src_blend, self.dst_blend))
    }

    /// The blend state of passes that add a light: the mode's source factor, one.
    #[must_use]
    pub fn additive_blend(&self) -> BlendState {
        both(self.src_blend, BlendFactor::One)
    }
}

/// The same factors for color and alpha, added.
fn both(src_factor: BlendFactor, dst_factor: BlendFactor) -> BlendState {
    let component = BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add };
    BlendState { color: component, alpha: component }
}
