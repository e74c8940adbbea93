//! One line of a vector file: parsed, checked and written back.

use serde::{Deserialize, Serialize};
use wgpu_types::{BlendComponent, BlendState, ColorWrites};

use super::bytes::{bytes, color_hex, colors};
use super::hex;
use crate::format::{Codes, ColorFormat, FormatError};
use crate::model::ColorInputs;
use crate::state::spelling::{self, SpellingError};

/// A parsed line: one state, n texels.
#[derive(Clone, Debug, PartialEq)]
pub struct VectorLine {
    /// The target's format.
    pub format: ColorFormat,
    /// The blend state; `None` is blending off.
    pub blend: Option<BlendState>,
    /// The write mask.
    pub mask: ColorWrites,
    /// The blend constant.
    pub constant: [f32; 4],
    /// Fragment output 0 of each texel.
    pub src: Vec<[f32; 4]>,
    /// The second source of each texel; `None` without dual-source blending.
    pub src1: Option<Vec<[f32; 4]>>,
    /// Raw texels before, `n * format.bytes_per_texel()` bytes.
    pub dst: Vec<u8>,
    /// Raw texels after, likewise; `None` when the line does not say.
    pub out: Option<Vec<u8>>,
}

/// A line that is not a vector.
#[derive(Debug, thiserror::Error)]
pub enum LineError {
    /// Not the JSON object it should be.
    #[error("not a vector object: {0}")]
    Json(#[from] serde_json::Error),
    /// Longer than the limit.
    #[error("the line has more than {0} bytes, the limit `line-bytes`")]
    TooLong(u64),
    /// Not text.
    #[error("byte {0} of the line is not UTF-8 text")]
    Utf8(usize),
    /// An unknown kind of line.
    #[error(
        "unknown line kind `{0}`; it must be `color` (or left out), `depth`, `layers`, or `driver` in a file that was recorded"
    )]
    Kind(String),
    /// A line of one kind where another is wanted.
    #[error("a line of kind `{0}` where one of another kind is wanted")]
    OtherKind(&'static str),
    /// The depth/stencil state of a depth line.
    #[error("`state`: {0}")]
    State(#[from] crate::state::webgpu::WebGpuError),
    /// Depth bias acts on rasterised depth only.
    #[error("`state`: depth bias acts on rasterised depth, and a line's fragments bring their own; leave it out")]
    Bias,
    /// A range that is no part of [0, 1].
    #[error("`range`: [{0}, {1}] is no range of depth; it must be two numbers with 0 <= min <= max <= 1")]
    Range(f32, f32),
    /// A byte that is neither 0 nor 1.
    #[error("`{member}`: texel {texel} is neither 00 nor 01")]
    Flag {
        /// The member.
        member: &'static str,
        /// Index of the texel.
        texel: usize,
    },
    /// A depth code wider than the format's.
    #[error("`{member}`: texel {texel} has depth code {code:#x}, the format has 24 bits")]
    DepthCode {
        /// The member.
        member: &'static str,
        /// Index of the texel.
        texel: usize,
        /// The code.
        code: u32,
    },
    /// A scene without layers.
    #[error("`layers` is empty; there must be at least one")]
    NoLayers,
    /// Something is wrong with one layer.
    #[error("layer {layer}: {source}")]
    Layer {
        /// Index of the layer, from 0.
        layer: usize,
        /// What.
        source: Box<LineError>,
    },
    /// Unknown format.
    #[error("`format`: {0}")]
    Format(#[from] FormatError),
    /// Unknown factor or operation.
    #[error("`blend`: {0}")]
    Spelling(#[from] SpellingError),
    /// The mask has bits beyond the four channels.
    #[error("`mask`: {0} is not a mask of four channels; it must be 0 to 15")]
    Mask(u32),
    /// A byte string is not hex.
    #[error("`{member}`: character {at} is not part of a lower-case hex byte string")]
    Hex {
        /// The member.
        member: &'static str,
        /// Position of the character.
        at: usize,
    },
    /// A byte string has the wrong length.
    #[error("`{member}`: {got} bytes, expected {expected}")]
    Length {
        /// The member.
        member: &'static str,
        /// Its length.
        got: usize,
        /// The length it should have.
        expected: usize,
    },
    /// `dual` and `src1` contradict each other.
    #[error("`src1` must be given if and only if `dual` is true")]
    Dual,
    /// There is no result to compare with.
    #[error("`out` is missing; fill it in with `outmerge vectors apply`")]
    NoOut,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLine {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    format: String,
    #[serde(default)]
    blend: Option<RawBlend>,
    #[serde(default = "all_channels")]
    mask: u32,
    #[serde(default)]
    constant: Option<String>,
    #[serde(default)]
    dual: bool,
    src: String,
    #[serde(default)]
    src1: Option<String>,
    dst: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    out: Option<String>,
}

/// One draw of a line of kind `layers`; a color line has the same members.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawDraw {
    #[serde(default)]
    blend: Option<RawBlend>,
    #[serde(default = "all_channels")]
    mask: u32,
    #[serde(default)]
    constant: Option<String>,
    #[serde(default)]
    dual: bool,
    src: String,
    #[serde(default)]
    src1: Option<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBlend {
    color: RawComponent,
    alpha: RawComponent,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawComponent {
    src: String,
    dst: String,
    op: String,
}

fn all_channels() -> u32 {
    ColorWrites::ALL.bits()
}

/// The state of one draw and the fragments of every texel.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorDraw {
    /// The blend state; `None` is blending off.
    pub blend: Option<BlendState>,
    /// The write mask.
    pub mask: ColorWrites,
    /// The blend constant.
    pub constant: [f32; 4],
    /// Fragment output 0 of each texel.
    pub src: Vec<[f32; 4]>,
    /// The second source of each texel; `None` without dual-source blending.
    pub src1: Option<Vec<[f32; 4]>>,
}

impl ColorDraw {
    /// `count` is the number of texels where it is known.
    pub(super) fn read(raw: RawDraw, count: Option<usize>) -> Result<Self, LineError> {
        let component = |c: RawComponent| -> Result<BlendComponent, SpellingError> {
            Ok(BlendComponent {
                src_factor: spelling::blend_factor(&c.src)?,
                dst_factor: spelling::blend_factor(&c.dst)?,
                operation: spelling::blend_operation(&c.op)?,
            })
        };
        let blend = match raw.blend {
            None => None,
            Some(blend) => Some(BlendState { color: component(blend.color)?, alpha: component(blend.alpha)? }),
        };
        let mask = ColorWrites::from_bits(raw.mask).ok_or(LineError::Mask(raw.mask))?;
        let src = colors("src", &raw.src, count)?;
        if raw.dual != raw.src1.is_some() {
            return Err(LineError::Dual);
        }
        let src1 = raw.src1.map(|text| colors("src1", &text, Some(src.len()))).transpose()?;
        let constant = match raw.constant {
            None => [0.0; 4],
            Some(text) => colors("constant", &text, Some(1))?[0],
        };
        Ok(Self { blend, mask, constant, src, src1 })
    }

    pub(super) fn write(&self) -> RawDraw {
        let component = |c: &BlendComponent| RawComponent {
            src: spelling::factor_name(c.src_factor).to_owned(),
            dst: spelling::factor_name(c.dst_factor).to_owned(),
            op: spelling::operation_name(c.operation).to_owned(),
        };
        RawDraw {
            blend: self.blend.map(|b| RawBlend { color: component(&b.color), alpha: component(&b.alpha) }),
            mask: self.mask.bits(),
            constant: Some(color_hex(&[self.constant])),
            dual: self.src1.is_some(),
            src: color_hex(&self.src),
            src1: self.src1.as_deref().map(color_hex),
        }
    }

    /// What the blender sees of texel `i` over these codes.
    ///
    /// # Panics
    /// When there is no such texel.
    #[must_use]
    pub fn inputs(&self, format: ColorFormat, i: usize, dst: Codes) -> ColorInputs {
        ColorInputs {
            format,
            blend: self.blend,
            constant: self.constant,
            src: self.src[i],
            src1: self.src1.as_ref().map_or([0.0; 4], |src1| src1[i]),
            dst,
        }
    }
}

impl VectorLine {
    /// Parses one line.
    ///
    /// # Errors
    /// [`LineError`], naming the member.
    pub fn parse(text: &str) -> Result<Self, LineError> {
        let raw: RawLine = serde_json::from_str(text)?;
        if let Some(kind) = raw.kind.filter(|kind| kind != "color") {
            return Err(LineError::Kind(kind));
        }
        let format = ColorFormat::from_name(&raw.format)?;
        let RawLine { blend, mask, constant, dual, src, src1, .. } = raw;
        let ColorDraw { blend, mask, constant, src, src1 } =
            ColorDraw::read(RawDraw { blend, mask, constant, dual, src, src1 }, None)?;
        let expected = src.len() * format.bytes_per_texel();
        let dst = bytes("dst", &raw.dst, expected)?;
        let out = raw.out.map(|text| bytes("out", &text, expected)).transpose()?;
        Ok(Self { format, blend, mask, constant, src, src1, dst, out })
    }

    /// The line as JSON, without a line break.
    ///
    /// # Panics
    /// Never: the object has string keys only.
    #[must_use]
    pub fn to_json(&self) -> String {
        let RawDraw { blend, mask, constant, dual, src, src1 } = self.draw().write();
        let raw = RawLine {
            kind: None,
            format: self.format.name().to_owned(),
            blend,
            mask,
            constant,
            dual,
            src,
            src1,
            dst: hex::encode(&self.dst),
            out: self.out.as_deref().map(hex::encode),
        };
        serde_json::to_string(&raw).expect("plain strings and numbers serialise")
    }

    /// State and fragments alone.
    #[must_use]
    pub fn draw(&self) -> ColorDraw {
        ColorDraw {
            blend: self.blend,
            mask: self.mask,
            constant: self.constant,
            src: self.src.clone(),
            src1: self.src1.clone(),
        }
    }

    /// Number of texels.
    #[must_use]
    pub fn len(&self) -> usize {
        self.src.len()
    }

    /// Whether the line has no texels.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.src.is_empty()
    }

    /// What the blender sees of texel `i`.
    ///
    /// # Panics
    /// When `i` is not below [`Self::len`].
    #[must_use]
    pub fn inputs(&self, i: usize) -> ColorInputs {
        ColorInputs {
            format: self.format,
            blend: self.blend,
            constant: self.constant,
            src: self.src[i],
            src1: self.src1.as_ref().map_or([0.0; 4], |src1| src1[i]),
            dst: self.codes(&self.dst, i),
        }
    }

    /// The codes of texel `i` of `texels`, one of this line's byte strings.
    #[must_use]
    pub(super) fn codes(&self, texels: &[u8], i: usize) -> Codes {
        let each = self.format.bytes_per_texel();
        self.format.unpack(&texels[i * each..(i + 1) * each])
    }
}
