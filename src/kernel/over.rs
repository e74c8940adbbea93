//! What half-float and sRGB kernels share: the states they do, the rules, and the way back to the reference.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, BlendState, TextureFormat};

use crate::format::{Codes, ColorFormat};
use crate::model::binary32::Binary32;
use crate::model::exact::Exact;
use crate::model::llvmpipe::Llvmpipe;
use crate::model::{ColorInputs, NumericModel};

/// How a model blends float and sRGB targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FloatRule {
    /// One rounding, at the store: `exact`.
    Exact,
    /// Each operation rounded to binary32: `f32`.
    Binary32,
    /// The same, with the driver's own curve for sRGB, and halves stored toward zero: a `llvmpipe`.
    Llvmpipe(Llvmpipe),
}

/// An added blend whose source factor is source alpha or 1, and whose destination factor is one minus source alpha or 1:
/// straight and premultiplied over, and additive blending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Over {
    /// Whether the source is multiplied by its alpha: color, alpha.
    pub(super) src_by_alpha: [bool; 2],
    /// Whether the destination is multiplied by one minus source alpha.
    pub(super) dst_by_rest: [bool; 2],
}

impl Over {
    /// `None` for other states.
    pub(super) fn new(state: &BlendState) -> Option<Self> {
        let component = |c: &BlendComponent| {
            let src = match c.src_factor {
                F::SrcAlpha => true,
                F::One => false,
                _ => return None,
            };
            let dst = match c.dst_factor {
                F::OneMinusSrcAlpha => true,
                F::One => false,
                _ => return None,
            };
            (c.operation == BlendOperation::Add).then_some((src, dst))
        };
        let (color, alpha) = (component(&state.color)?, component(&state.alpha)?);
        // Where source and destination factor are the same, a driver adds before it multiplies; both are 1 here.
        Some(Self { src_by_alpha: [color.0, alpha.0], dst_by_rest: [color.1, alpha.1] })
    }
}

/// The reference for one texel, for what a vector cannot prove.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    rule: FloatRule,
    format: ColorFormat,
    blend: BlendState,
}

impl Reference {
    pub(super) fn new(rule: FloatRule, format: TextureFormat, blend: BlendState) -> Option<Self> {
        Some(Self { rule, format: ColorFormat::new(format).ok()?, blend })
    }

    /// The codes of one texel, from the shader's output and the codes before.
    pub(super) fn merge(&self, src: [f32; 4], dst: Codes) -> Codes {
        let zeros = [0.0; 4];
        let inputs =
            ColorInputs { format: self.format, blend: Some(self.blend), constant: zeros, src, src1: zeros, dst };
        match self.rule {
            FloatRule::Exact => Exact::default().merge_color(&inputs),
            FloatRule::Binary32 => Binary32.merge_color(&inputs),
            FloatRule::Llvmpipe(model) => model.merge_color(&inputs),
        }
    }

    /// The same on the target's bytes.
    pub(super) fn merge_bytes(&self, src: [f32; 4], dst: &[u8], out: &mut [u8]) {
        self.format.pack(self.merge(src, self.format.unpack(dst)), out);
    }
}
