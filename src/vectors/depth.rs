//! Lines of kind `depth`: fragments' depths against stored depth and stencil.

use serde::{Deserialize, Serialize};
use wgpu_types::DepthStencilState;

use super::bytes::{bytes, flag_hex, flags, float_hex, floats};
use super::hex;
use super::line::LineError;
use crate::format::DepthFormat;
use crate::format::depth::DepthKind;
use crate::merger::depth_stencil::{DepthStencil, test};
use crate::model::NumericModel;
use crate::state::webgpu::{depth_stencil_from_value, depth_stencil_to_value};

/// The smallest and largest depth there is.
const WHOLE: [f32; 2] = [0.0, 1.0];

/// A parsed line: one depth/stencil state, n texels.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthLine {
    /// The target's format.
    pub format: DepthFormat,
    /// The state; its format is the same, its depth bias zero.
    pub state: DepthStencilState,
    /// The stencil reference.
    pub reference: u8,
    /// The viewport's depth range, `0 <= min <= max <= 1`.
    pub range: [f32; 2],
    /// Each fragment's depth, as a shader writes it.
    pub z: Vec<f32>,
    /// Whether each fragment is front-facing; `None` if all are.
    pub front: Option<Vec<bool>>,
    /// What is stored before.
    pub dst: Vec<DepthStencil>,
    /// What is stored after; `None` when the line does not say.
    pub out: Option<Vec<DepthStencil>>,
    /// Whether each fragment passed both tests; `None` when the line does not say.
    pub passed: Option<Vec<bool>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDepth {
    kind: String,
    state: serde_json::Value,
    #[serde(default)]
    reference: u8,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    range: Option<String>,
    z: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    front: Option<String>,
    dst: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    out: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    passed: Option<String>,
}

impl DepthLine {
    /// Parses one line.
    ///
    /// # Errors
    /// [`LineError`], naming the member.
    pub fn parse(text: &str) -> Result<Self, LineError> {
        let raw: RawDepth = serde_json::from_str(text)?;
        if raw.kind != "depth" {
            return Err(LineError::Kind(raw.kind));
        }
        let state = depth_stencil_from_value(raw.state)?;
        let format = DepthFormat::new(state.format)?;
        if state.bias != wgpu_types::DepthBiasState::default() {
            return Err(LineError::Bias);
        }
        let range = match raw.range {
            None => WHOLE,
            Some(text) => {
                let ends = floats("range", &text, 2, Some(1))?;
                if !(0.0 <= ends[0] && ends[0] <= ends[1] && ends[1] <= 1.0) {
                    return Err(LineError::Range(ends[0], ends[1]));
                }
                [ends[0], ends[1]]
            }
        };
        let z = floats("z", &raw.z, 1, None)?;
        let each = bytes_per_texel(format);
        let texels = |member, text: &str| -> Result<Vec<DepthStencil>, LineError> {
            let bytes = bytes(member, text, z.len() * each)?;
            bytes.chunks_exact(each).enumerate().map(|(texel, bytes)| unpack(format, member, texel, bytes)).collect()
        };
        Ok(Self {
            format,
            reference: raw.reference,
            range,
            front: raw.front.map(|text| flags("front", &text, z.len())).transpose()?,
            dst: texels("dst", &raw.dst)?,
            out: raw.out.map(|text| texels("out", &text)).transpose()?,
            passed: raw.passed.map(|text| flags("passed", &text, z.len())).transpose()?,
            state,
            z,
        })
    }

    /// The line as JSON, without a line break.
    ///
    /// # Panics
    /// Never: the object has string keys only.
    #[must_use]
    pub fn to_json(&self) -> String {
        let texels = |texels: &[DepthStencil]| {
            hex::encode(&texels.iter().flat_map(|texel| pack(self.format, *texel)).collect::<Vec<_>>())
        };
        let raw = RawDepth {
            kind: "depth".to_owned(),
            state: depth_stencil_to_value(&self.state),
            reference: self.reference,
            range: (self.range != WHOLE).then(|| float_hex(&self.range)),
            z: float_hex(&self.z),
            front: self.front.as_deref().map(flag_hex),
            dst: texels(&self.dst),
            out: self.out.as_deref().map(texels),
            passed: self.passed.as_deref().map(flag_hex),
        };
        serde_json::to_string(&raw).expect("plain strings and numbers serialise")
    }

    /// Number of texels.
    #[must_use]
    pub fn len(&self) -> usize {
        self.z.len()
    }

    /// Whether the line has no texels.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.z.is_empty()
    }

    /// Whether fragment `i` is front-facing.
    #[must_use]
    pub fn front(&self, i: usize) -> bool {
        self.front.as_ref().is_none_or(|front| front[i])
    }

    /// What the model stores at texel `i`, and whether the fragment passes.
    pub(super) fn run(&self, model: &dyn NumericModel, i: usize) -> (DepthStencil, bool) {
        let code = self.format.depth().map_or(0, |kind| model.depth_code(kind, self.z[i], self.range));
        let reference = u32::from(self.reference);
        let tested = test(&self.state, self.format, self.front(i), reference, code, self.dst[i]);
        (tested.stored, tested.passed())
    }

    /// Fills in `out` and `passed` by the model.
    pub(super) fn fill(&mut self, model: &dyn NumericModel) {
        let (out, passed) = (0..self.len()).map(|i| self.run(model, i)).unzip();
        (self.out, self.passed) = (Some(out), Some(passed));
    }
}

/// Bytes of a texel in `dst` and `out`: the depth code, then the stencil value.
fn bytes_per_texel(format: DepthFormat) -> usize {
    depth_bytes(format) + usize::from(format.has_stencil())
}

fn depth_bytes(format: DepthFormat) -> usize {
    match format.depth() {
        None => 0,
        Some(DepthKind::Unorm(16)) => 2,
        Some(_) => 4,
    }
}

fn unpack(format: DepthFormat, member: &'static str, texel: usize, bytes: &[u8]) -> Result<DepthStencil, LineError> {
    let (depth, stencil) = bytes.split_at(depth_bytes(format));
    let mut word = [0; 4];
    word[..depth.len()].copy_from_slice(depth);
    let code = u32::from_le_bytes(word);
    if format.depth() == Some(DepthKind::Unorm(24)) && code > 0x00ff_ffff {
        return Err(LineError::DepthCode { member, texel, code });
    }
    Ok(DepthStencil { depth: code, stencil: stencil.first().copied().unwrap_or(0) })
}

fn pack(format: DepthFormat, texel: DepthStencil) -> Vec<u8> {
    let mut bytes = texel.depth.to_le_bytes()[..depth_bytes(format)].to_vec();
    if format.has_stencil() {
        bytes.push(texel.stencil);
    }
    bytes
}
