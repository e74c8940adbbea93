//! PNG files in: 8 and 16 bits, grey and RGB, with and without alpha. Ancillary color chunks are ignored: the scene
//! declares the color space.

use std::io::Cursor;
use std::path::Path;

use image::{ColorType, ImageFormat, ImageReader};

use super::{ColorSpace, Image, MAX_TEXTURE_SIZE, TextureError};
use crate::limit;
use crate::scene::number::f64_to_f32;

/// Memory the decoder may use, in bytes: a 16-bit RGBA image of the largest size, twice.
const MAX_DECODE_BYTES: u64 = 2 * 8 * MAX_TEXTURE_SIZE as u64 * MAX_TEXTURE_SIZE as u64;

/// Reads a file into linear values, within the default [`Limits`](limit::Limits).
///
/// # Errors
/// [`TextureError::Read`], [`TextureError::FileSize`], [`TextureError::Decode`] (damaged, truncated, too large) or
/// [`TextureError::Size`].
pub fn load(path: &Path, space: ColorSpace) -> Result<Image, TextureError> {
    load_within(path, space, &limit::Limits::default())
}

/// Reads a file into linear values.
///
/// # Errors
/// As [`load`].
pub fn load_within(path: &Path, space: ColorSpace, limits: &limit::Limits) -> Result<Image, TextureError> {
    let bytes = limit::read_file(path, limits.image_bytes)
        .map_err(|source| TextureError::Read { path: path.into(), source })?
        .ok_or_else(|| TextureError::FileSize { path: path.into(), limit: limits.image_bytes })?;
    decode(&bytes, path, space)
}

/// Reads the bytes of a PNG file into linear values; `path` serves messages only.
///
/// # Errors
/// As [`load`], but for reading.
pub fn decode(bytes: &[u8], path: &Path, space: ColorSpace) -> Result<Image, TextureError> {
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_TEXTURE_SIZE);
    limits.max_image_height = Some(MAX_TEXTURE_SIZE);
    limits.max_alloc = Some(MAX_DECODE_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    reader.limits(limits);
    let decoded = reader.decode().map_err(|source| TextureError::Decode { path: path.into(), source })?;
    let (width, height) = (decoded.width(), decoded.height());
    match decoded.color() {
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let values = table(space, u16::MAX);
            let texels = decoded.into_rgba16();
            Image::new(width, height, |x, y| linear(&values, texels.get_pixel(x, y).0))
        }
        _ => {
            let values = table(space, u16::from(u8::MAX));
            let texels = decoded.into_rgba8();
            Image::new(width, height, |x, y| linear(&values, texels.get_pixel(x, y).0.map(u16::from)))
        }
    }
}

/// Linear color values and alpha values of every code.
fn table(space: ColorSpace, top: u16) -> [Vec<f32>; 2] {
    let values =
        |space: ColorSpace| (0..=top).map(|code| f64_to_f32(space.decode(f64::from(code) / f64::from(top)))).collect();
    [values(space), values(ColorSpace::Linear)]
}

fn linear([color, alpha]: &[Vec<f32>; 2], [r, g, b, a]: [u16; 4]) -> [f32; 4] {
    let look_up = |table: &[f32], code: u16| table[usize::from(code)];
    [look_up(color, r), look_up(color, g), look_up(color, b), look_up(alpha, a)]
}
