//! Textures: images in memory as linear values, and what a sampler reads from them.
//!
//! - [`png`] and [`pattern`] make images of encoded values; [`color_space`] linearises them;
//! - [`storage`] keeps them straight or premultiplied, as exact values or quantised as a file would store them;
//! - [`mips`] halves them; [`sample`] reads them.

pub mod color_space;
pub mod mips;
pub mod pattern;
pub mod png;
pub mod sample;
pub mod storage;
#[cfg(test)]
mod tests;

pub use color_space::ColorSpace;
pub use pattern::Pattern;
pub use sample::{Footprint, Sampler};
pub use storage::Storage;

/// Largest width and height of a texture in texels.
pub const MAX_TEXTURE_SIZE: u32 = 4096;

/// A rectangle of RGBA values, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

impl Image {
    /// An image of `width * height` texels.
    ///
    /// # Errors
    /// [`TextureError::Size`] unless both are in `1..=`[`MAX_TEXTURE_SIZE`].
    pub fn new(width: u32, height: u32, mut texel: impl FnMut(u32, u32) -> [f32; 4]) -> Result<Self, TextureError> {
        let limits = 1..=MAX_TEXTURE_SIZE;
        if !limits.contains(&width) || !limits.contains(&height) {
            return Err(TextureError::Size { width, height });
        }
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
        Ok(Self { width, height, texels })
    }

    /// Width in texels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All texels, rows from the top.
    #[must_use]
    pub fn texels(&self) -> &[[f32; 4]] {
        &self.texels
    }

    /// One texel.
    ///
    /// # Panics
    /// When it lies outside.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        assert!(x < self.width, "column {x} of an image {} wide", self.width);
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// The image with every texel replaced.
    #[must_use]
    pub fn map(mut self, change: impl Fn([f32; 4]) -> [f32; 4]) -> Self {
        self.texels.iter_mut().for_each(|texel| *texel = change(*texel));
        self
    }
}

/// An image with its mip chain and sampler.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    levels: Vec<Image>,
    sampler: Sampler,
}

impl Texture {
    /// A texture of linear values; its mip chain is made only if the sampler uses one.
    #[must_use]
    pub fn new(image: Image, sampler: Sampler) -> Self {
        let levels = if sampler.mips.is_some() { mips::chain(image) } else { vec![image] };
        Self { levels, sampler }
    }

    /// The mip levels, largest first; at least one.
    #[must_use]
    pub fn levels(&self) -> &[Image] {
        &self.levels
    }

    /// Bytes in memory: 16 a texel, all levels.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| size_of_val(level.texels()) as u64).sum()
    }

    /// The sampler.
    #[must_use]
    pub fn sampler(&self) -> Sampler {
        self.sampler
    }
}

/// A texture that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    /// No texels, or too many.
    #[error("a {width} x {height} texture is not possible; width and height must be 1 to {MAX_TEXTURE_SIZE}")]
    Size {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
    },
    /// The file could not be read.
    #[error("cannot read `{path}`: {source}")]
    Read {
        /// The file.
        path: std::path::PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The file is too large.
    #[error("`{path}` has more than {limit} bytes, the limit `image-bytes`")]
    FileSize {
        /// The file.
        path: std::path::PathBuf,
        /// The limit in bytes.
        limit: u64,
    },
    /// The file is not a PNG image, or a damaged one.
    #[error("`{path}` is not a complete PNG image: {source}")]
    Decode {
        /// The file.
        path: std::path::PathBuf,
        /// The reason.
        source: image::ImageError,
    },
}
