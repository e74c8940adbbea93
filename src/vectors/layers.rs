//! Lines of kind `layers`: several draws over the same texels, one after the other.

use serde::{Deserialize, Serialize};

use super::bytes::bytes;
use super::hex;
use super::line::{ColorDraw, LineError, RawDraw};
use crate::format::{Codes, ColorFormat};
use crate::merger::write_mask;
use crate::model::NumericModel;

/// A parsed line: n texels, each drawn over by every layer in order.
#[derive(Clone, Debug, PartialEq)]
pub struct LayersLine {
    /// The target's format.
    pub format: ColorFormat,
    /// The draws in order, at least one.
    pub layers: Vec<ColorDraw>,
    /// Raw texels before, `n * format.bytes_per_texel()` bytes.
    pub dst: Vec<u8>,
    /// Raw texels after all layers, likewise; `None` when the line does not say.
    pub out: Option<Vec<u8>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLayers {
    kind: String,
    format: String,
    layers: Vec<RawDraw>,
    dst: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    out: Option<String>,
}

impl LayersLine {
    /// Parses one line.
    ///
    /// # Errors
    /// [`LineError`], naming the layer and the member.
    pub fn parse(text: &str) -> Result<Self, LineError> {
        let raw: RawLayers = serde_json::from_str(text)?;
        if raw.kind != "layers" {
            return Err(LineError::Kind(raw.kind));
        }
        let format = ColorFormat::from_name(&raw.format)?;
        let mut layers: Vec<ColorDraw> = Vec::new();
        for (layer, draw) in raw.layers.into_iter().enumerate() {
            let count = layers.first().map(|first| first.src.len());
            let read = ColorDraw::read(draw, count);
            layers.push(read.map_err(|source| LineError::Layer { layer, source: Box::new(source) })?);
        }
        let first = layers.first().ok_or(LineError::NoLayers)?;
        let expected = first.src.len() * format.bytes_per_texel();
        let dst = bytes("dst", &raw.dst, expected)?;
        let out = raw.out.map(|text| bytes("out", &text, expected)).transpose()?;
        Ok(Self { format, layers, dst, out })
    }

    /// The line as JSON, without a line break.
    ///
    /// # Panics
    /// Never: the object has string keys only.
    #[must_use]
    pub fn to_json(&self) -> String {
        let raw = RawLayers {
            kind: "layers".to_owned(),
            format: self.format.name().to_owned(),
            layers: self.layers.iter().map(ColorDraw::write).collect(),
            dst: hex::encode(&self.dst),
            out: self.out.as_deref().map(hex::encode),
        };
        serde_json::to_string(&raw).expect("plain strings and numbers serialise")
    }

    /// Number of texels.
    #[must_use]
    pub fn len(&self) -> usize {
        self.dst.len() / self.format.bytes_per_texel()
    }

    /// Whether the line has no texels.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.dst.is_empty()
    }

    /// The codes of texel `i` of one of this line's byte strings.
    pub(super) fn codes(&self, texels: &[u8], i: usize) -> Codes {
        let each = self.format.bytes_per_texel();
        self.format.unpack(&texels[i * each..(i + 1) * each])
    }

    /// The model's codes of texel `i` after all layers.
    pub(super) fn run(&self, model: &dyn NumericModel, i: usize) -> Codes {
        self.layers.iter().fold(self.codes(&self.dst, i), |codes, layer| {
            write_mask::select(layer.mask, codes, model.merge_color(&layer.inputs(self.format, i, codes)))
        })
    }

    /// Fills in `out` by the model.
    pub(super) fn fill(&mut self, model: &dyn NumericModel) {
        let each = self.format.bytes_per_texel();
        let mut out = vec![0; self.dst.len()];
        for i in 0..self.len() {
            self.format.pack(self.run(model, i), &mut out[i * each..]);
        }
        self.out = Some(out);
    }
}
