//! One line of a vector file: parsed, checked and written back.

use serde::{Deserialize, Serialize};
use wgpu_types::{BlendComponent, BlendState, ColorWrites};

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
    #[error("unknown line kind `{0}`; this version reads color vectors, which have no `kind`")]
    Kind(String),
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
        let src = colors("src", &raw.src, None)?;
        if raw.dual != raw.src1.is_some() {
            return Err(LineError::Dual);
        }
        let src1 = raw.src1.map(|text| colors("src1", &text, Some(src.len()))).transpose()?;
        let constant = match raw.constant {
            None => [0.0; 4],
            Some(text) => colors("constant", &text, Some(1))?[0],
        };
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
        let component = |c: &BlendComponent| RawComponent {
            src: spelling::factor_name(c.src_factor).to_owned(),
            dst: spelling::factor_name(c.dst_factor).to_owned(),
            op: spelling::operation_name(c.operation).to_owned(),
        };
        let raw = RawLine {
            kind: None,
            format: self.format.name().to_owned(),
            blend: self.blend.map(|b| RawBlend { color: component(&b.color), alpha: component(&b.alpha) }),
            mask: self.mask.bits(),
            constant: Some(color_hex(&[self.constant])),
            dual: self.src1.is_some(),
            src: color_hex(&self.src),
            src1: self.src1.as_deref().map(color_hex),
            dst: hex::encode(&self.dst),
            out: self.out.as_deref().map(hex::encode),
        };
        serde_json::to_string(&raw).expect("plain strings and numbers serialise")
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

/// A byte string of a known length.
fn bytes(member: &'static str, text: &str, expected: usize) -> Result<Vec<u8>, LineError> {
    let bytes = hex::decode(text).map_err(|at| LineError::Hex { member, at })?;
    if bytes.len() != expected {
        return Err(LineError::Length { member, got: bytes.len(), expected });
    }
    Ok(bytes)
}

/// n x 4 binary32; `count` where the number of colors is known.
fn colors(member: &'static str, text: &str, count: Option<usize>) -> Result<Vec<[f32; 4]>, LineError> {
    let bytes = hex::decode(text).map_err(|at| LineError::Hex { member, at })?;
    let expected = count.map_or(bytes.len().next_multiple_of(16), |count| 16 * count);
    if bytes.len() != expected {
        return Err(LineError::Length { member, got: bytes.len(), expected });
    }
    let float = |c: &[u8], i: usize| f32::from_le_bytes([c[4 * i], c[4 * i + 1], c[4 * i + 2], c[4 * i + 3]]);
    Ok(bytes.chunks_exact(16).map(|c| std::array::from_fn(|i| float(c, i))).collect())
}

fn color_hex(colors: &[[f32; 4]]) -> String {
    let bytes: Vec<u8> = colors.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    hex::encode(&bytes)
}
