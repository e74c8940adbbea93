//! The image under test: bytes as they were read back.

use wgpu_types::TextureFormat;

use crate::format::{ColorFormat, FormatError};
use crate::target::{ColorTarget, Extent, TargetError};

/// A read-back image: texels in the memory layout of their WebGPU format, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Actual {
    pub(super) target: ColorTarget,
}

/// Bytes that are no image of the given format and size.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ActualError {
    /// The format is no color format outmerge models.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// Width or height is out of range.
    #[error(transparent)]
    Extent(#[from] TargetError),
    /// Rows overlap.
    #[error("{pitch} bytes from row to row are too few; a row has {row} bytes")]
    Pitch {
        /// Bytes from row to row.
        pitch: usize,
        /// Bytes of a row.
        row: usize,
    },
    /// Too few or too many bytes.
    #[error("{got} bytes were read back; {expected} are expected")]
    Length {
        /// Bytes given.
        got: usize,
        /// Bytes the format and size take.
        expected: usize,
    },
}

impl Actual {
    /// An image without padding between rows.
    ///
    /// # Errors
    /// [`ActualError`].
    pub fn new(format: TextureFormat, width: u32, height: u32, bytes: &[u8]) -> Result<Self, ActualError> {
        let format = ColorFormat::new(format)?;
        let expected = width as usize * height as usize * format.bytes_per_texel();
        if bytes.len() != expected {
            return Err(ActualError::Length { got: bytes.len(), expected });
        }
        Self::with_pitch(format.texture_format(), width, height, bytes, width as usize * format.bytes_per_texel())
    }

    /// An image with `pitch` bytes from the start of a row to that of the next, as `copy_texture_to_buffer` pads them to
    /// multiples of 256. The last row may end without padding.
    ///
    /// # Errors
    /// [`ActualError`].
    pub fn with_pitch(
        format: TextureFormat,
        width: u32,
        height: u32,
        bytes: &[u8],
        pitch: usize,
    ) -> Result<Self, ActualError> {
        let format = ColorFormat::new(format)?;
        let mut target = ColorTarget::new(Extent::new(width, height)?, format)?;
        let row = width as usize * format.bytes_per_texel();
        if pitch < row {
            return Err(ActualError::Pitch { pitch, row });
        }
        let expected = pitch.saturating_mul(height as usize - 1).saturating_add(row);
        if bytes.len() < expected {
            return Err(ActualError::Length { got: bytes.len(), expected });
        }
        for (to, from) in target.bytes_mut().chunks_exact_mut(row).zip(bytes.chunks(pitch)) {
            to.copy_from_slice(&from[..row]);
        }
        Ok(Self { target })
    }

    /// The image as a target.
    #[must_use]
    pub fn target(&self) -> &ColorTarget {
        &self.target
    }
}

impl From<ColorTarget> for Actual {
    /// A target that another model or merger wrote; of several samples the first is compared.
    fn from(target: ColorTarget) -> Self {
        Self { target }
    }
}

/// `rgba8unorm 16 x 16`, and the samples where there are several.
pub(super) fn shape(target: &ColorTarget) -> String {
    let Extent { width, height, samples } = target.extent();
    let samples = if samples == 1 { String::new() } else { format!(" with {samples} samples") };
    format!("{} {width} x {height}{samples}", target.format().name())
}
