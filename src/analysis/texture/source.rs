//! Images in: PNG files as codes, with the color space they declare.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{ColorType, ImageFormat, ImageReader};
use serde::Serialize;

use crate::limit::{self, Limits};
use crate::scene::texture::ColorSpace;

/// Memory the decoder may use for a texel, in bytes.
const DECODE_BYTES: u64 = 16;

/// Longest side of an image.
pub const MAX_SIDE: u32 = 1 << 16;

/// What the stored colors of an image mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Space {
    /// Stored colors are proportional to light.
    Linear,
    /// Stored colors are sRGB-encoded.
    Srgb,
}

impl Space {
    /// The curve.
    #[must_use]
    pub fn color_space(self) -> ColorSpace {
        match self {
            Self::Linear => ColorSpace::Linear,
            Self::Srgb => ColorSpace::Srgb,
        }
    }
}

/// An image as it is stored: straight colors, RGBA codes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file, for tables.
    pub name: String,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Bits of a channel: 8 or 16.
    pub bits: u32,
    /// What the colors mean.
    pub space: Space,
    /// The texels, rows from the top; at least one.
    pub texels: Vec<[u16; 4]>,
}

/// An image that cannot be analysed.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// The file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// Not a PNG image, damaged, or too large for the decoder's limits.
    #[error("{} is not a complete PNG image within the limits: {source}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: image::ImageError,
    },
    /// The file is too large.
    #[error("{} has more than {limit} bytes, the limit `image-bytes`", path.display())]
    FileSize {
        /// The file.
        path: PathBuf,
        /// The limit in bytes.
        limit: u64,
    },
    /// Too many texels.
    #[error(
        "{}: {width} x {height} is more than {limit} texels, the limit `image-texels`; raise it, cut the image into \
         tiles or measure a smaller version", path.display()
    )]
    Size {
        /// The file.
        path: PathBuf,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// The limit in texels.
        limit: u64,
    },
}

impl Source {
    /// Reads a file within the default [`Limits`]; `space` overrides what the file declares.
    ///
    /// # Errors
    /// [`SourceError`], naming the file.
    pub fn load(path: &Path, space: Option<Space>) -> Result<Self, SourceError> {
        Self::load_within(path, space, &Limits::default())
    }

    /// Reads a file; `space` overrides what the file declares.
    ///
    /// # Errors
    /// [`SourceError`], naming the file.
    pub fn load_within(path: &Path, space: Option<Space>, limits: &Limits) -> Result<Self, SourceError> {
        let bytes = limit::read_file(path, limits.image_bytes)
            .map_err(|source| SourceError::Read { path: path.into(), source })?
            .ok_or_else(|| SourceError::FileSize { path: path.into(), limit: limits.image_bytes })?;
        Self::decode_within(&bytes, path, space, limits)
    }

    /// Reads the bytes of a PNG file within the default [`Limits`]; `path` names it.
    ///
    /// # Errors
    /// As [`load`](Self::load), but for reading.
    pub fn decode(bytes: &[u8], path: &Path, space: Option<Space>) -> Result<Self, SourceError> {
        Self::decode_within(bytes, path, space, &Limits::default())
    }

    /// Reads the bytes of a PNG file; `path` names it.
    ///
    /// # Errors
    /// As [`load`](Self::load), but for reading.
    pub fn decode_within(
        bytes: &[u8],
        path: &Path,
        space: Option<Space>,
        limits: &Limits,
    ) -> Result<Self, SourceError> {
        let limit = limits.image_texels;
        let failed = |source| SourceError::Decode { path: path.into(), source };
        let reader = || {
            let mut limits = image::Limits::default();
            limits.max_image_width = Some(MAX_SIDE);
            limits.max_image_height = Some(MAX_SIDE);
            limits.max_alloc = Some(limit.saturating_mul(DECODE_BYTES));
            let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
            reader.limits(limits);
            reader
        };
        // The header alone tells the size, before any texel is unpacked.
        let (width, height) = reader().into_dimensions().map_err(failed)?;
        if u64::from(width) * u64::from(height) > limit {
            return Err(SourceError::Size { path: path.into(), width, height, limit });
        }
        let decoded = reader().decode().map_err(failed)?;
        let (bits, texels) = match decoded.color() {
            ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
                (16, decoded.into_rgba16().pixels().map(|pixel| pixel.0).collect())
            }
            _ => (8, decoded.into_rgba8().pixels().map(|pixel| pixel.0.map(u16::from)).collect()),
        };
        let space = space.unwrap_or_else(|| declared_space(bytes));
        Ok(Self { name: path.display().to_string(), width, height, bits, space, texels })
    }

    /// The largest code of a channel.
    #[must_use]
    pub fn top(&self) -> u32 {
        if self.bits == 16 { 65535 } else { 255 }
    }

    /// The value of a code.
    #[must_use]
    pub fn value(&self, code: u16) -> f64 {
        f64::from(code) / f64::from(self.top())
    }

    /// The texel in column x, row y.
    #[must_use]
    pub(super) fn texel(&self, x: u32, y: u32) -> [u16; 4] {
        self.texels[y as usize * self.width as usize + x as usize]
    }
}

/// The space a PNG file declares: linear if its `gAMA` chunk says 1.0 and it has no `sRGB` chunk; sRGB otherwise.
///
/// Source: PNG (third edition), 11.3.2 *Color space information*.
fn declared_space(bytes: &[u8]) -> Space {
    const SIGNATURE: usize = 8;
    const LINEAR: u32 = 100_000;
    let mut rest = bytes.get(SIGNATURE..).unwrap_or_default();
    let mut space = Space::Srgb;
    while let Some((header, after)) = rest.split_first_chunk::<8>() {
        let [l0, l1, l2, l3, kind @ ..] = *header;
        let length = u32::from_be_bytes([l0, l1, l2, l3]) as usize;
        match &kind {
            b"sRGB" => return Space::Srgb,
            b"gAMA" if after.first_chunk::<4>().is_some_and(|gamma| u32::from_be_bytes(*gamma) == LINEAR) => {
                space = Space::Linear;
            }
            b"IDAT" => break,
            _ => {}
        }
        // Data, then four bytes of checksum.
        rest = after.get(length.saturating_add(4)..).unwrap_or_default();
    }
    space
}
