//! Targets as pictures: any format to 8-bit RGBA and PNG.

use std::io::Cursor;

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::description::Display;
use super::number::unit_to_u8;
use super::texture::ColorSpace;
use crate::format::{ChannelKind, snorm, srgb, unorm};
use crate::target::{ColorTarget, DepthStencilTarget};

/// What becomes of alpha in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureAlpha {
    /// The picture is opaque: a screen shows color alone.
    #[default]
    Opaque,
    /// The picture has the target's alpha.
    Stored,
}

/// An 8-bit RGBA picture, rows from the top, 4 bytes a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The pixels.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// What a screen shows of a color target (sample 0): values clamped to `[0, 1]`; NaN shows as 0. sRGB formats show
    /// their codes, others their values, encoded if `display` asks for it.
    #[must_use]
    pub fn of_color(target: &ColorTarget, display: Display, alpha: PictureAlpha) -> Self {
        let channels = target.format().channels();
        Self::of(target.extent().width, target.extent().height, |x, y| {
            let codes = target.codes(x, y, 0);
            let mut pixel = [0, 0, 0, u8::MAX];
            for i in 0..3 {
                pixel[i] = match (channels[i], display) {
                    (ChannelKind::Absent, _) => 0,
                    (ChannelKind::Srgb, _) => u8::try_from(codes[i]).unwrap_or(u8::MAX),
                    (kind, Display::Stored) => unit_to_u8(value(kind, codes[i])),
                    (kind, Display::Srgb) => {
                        u8::try_from(ColorSpace::Srgb.encode(value(kind, codes[i]), 255)).unwrap_or(u8::MAX)
                    }
                };
            }
            if alpha == PictureAlpha::Stored && channels[3] != ChannelKind::Absent {
                pixel[3] = unit_to_u8(value(channels[3], codes[3]));
            }
            pixel
        })
    }

    /// Depth as grey (sample 0): the range that occurs is spread from black (nearest 0) to white. `None` without depth.
    #[must_use]
    pub fn of_depth(target: &DepthStencilTarget) -> Option<Self> {
        let kind = target.format().depth()?;
        let values = || target.depth().iter().map(|code| kind.value(*code));
        let (low, high) = values().fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
        let range = if high > low { high - low } else { 1.0 };
        let extent = target.extent();
        Some(Self::of(extent.width, extent.height, |x, y| {
            let grey = unit_to_u8((kind.value(target.depth()[extent.index(x, y, 0)]) - low) / range);
            [grey, grey, grey, u8::MAX]
        }))
    }

    fn of(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Self {
        let rgba = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y)).collect();
        Self { width, height, rgba }
    }

    /// The bytes of a PNG file: RGB if every pixel is opaque, RGBA otherwise.
    ///
    /// # Errors
    /// The encoder's, which for a picture whose size fits its pixels is lack of memory.
    pub fn to_png(&self) -> Result<Vec<u8>, image::ImageError> {
        let mut bytes = Cursor::new(Vec::new());
        let encoder = PngEncoder::new(&mut bytes);
        let pixels = self.rgba.chunks_exact(4);
        if pixels.clone().all(|pixel| pixel[3] == u8::MAX) {
            let rgb: Vec<u8> = pixels.flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
            encoder.write_image(&rgb, self.width, self.height, ExtendedColorType::Rgb8)?;
        } else {
            encoder.write_image(&self.rgba, self.width, self.height, ExtendedColorType::Rgba8)?;
        }
        Ok(bytes.into_inner())
    }
}

/// The real value a code stands for; sRGB codes linear, an absent channel 0.
#[must_use]
pub fn value(kind: ChannelKind, code: u32) -> f64 {
    match kind {
        ChannelKind::Absent => 0.0,
        ChannelKind::Unorm(bits) => f64::from(code) / f64::from(unorm::steps(bits)),
        ChannelKind::Snorm(bits) => f64::from(snorm::signed_code(code, bits)) / f64::from(snorm::steps(bits)),
        ChannelKind::Srgb => srgb::decode(code).value,
        ChannelKind::Float(layout) => layout.decode(code),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::ColorFormat;
    use crate::scene::number::f64_to_f32;
    use crate::target::Extent;

    fn picture(format: &str, codes: [u32; 4], display: Display, alpha: PictureAlpha) -> Picture {
        let extent = Extent::new(2, 1).expect("2 x 1 is legal");
        let mut target = ColorTarget::new(extent, ColorFormat::from_name(format).expect("a format")).expect("memory");
        target.fill(codes);
        Picture::of_color(&target, display, alpha)
    }

    #[test]
    fn stored_values_become_bytes_whatever_the_format() {
        let half = |x: f32| u32::from(half::f16::from_f32(x).to_bits());
        for (format, codes, expected) in [
            ("rgba8unorm", [1, 2, 3, 4], [1, 2, 3, 4]),
            ("bgra8unorm-srgb", [1, 2, 3, 4], [1, 2, 3, 4]),
            ("rgb10a2unorm", [1023, 0, 512, 1], [255, 0, 128, 85]),
            ("rgba8snorm", [0x81, 0x80, 0x7F, 0], [0, 0, 255, 0]),
            ("rgba16float", [half(0.2), half(-3.0), half(9.0), half(1.0)], [51, 0, 255, 255]),
            ("r16float", [half(f32::NAN), 0, 0, 0], [0, 0, 0, 255]),
        ] {
            let picture = picture(format, codes, Display::Stored, PictureAlpha::Stored);
            assert_eq!(picture.rgba[4..], expected, "{format}");
        }
    }

    #[test]
    fn linear_values_are_encoded_on_request_and_alpha_is_left_out_by_default() {
        let linear = ColorSpace::Srgb.decode(188.0 / 255.0);
        let codes = [f64_to_f32(linear).to_bits(), 0, 0, 0];
        let picture = picture("rgba32float", codes, Display::Srgb, PictureAlpha::Opaque);
        assert_eq!(picture.rgba[..4], [188, 0, 0, 255], "sRGB code 188, opaque");
    }

    #[test]
    fn png_files_read_back_to_the_same_pixels() {
        for alpha in [PictureAlpha::Opaque, PictureAlpha::Stored] {
            let picture = picture("rgba8unorm", [10, 20, 30, 40], Display::Stored, alpha);
            let png = picture.to_png().expect("a small picture");
            let back = image::load_from_memory(&png).expect("a PNG file").into_rgba8();
            assert_eq!(back.into_raw(), picture.rgba, "{alpha:?}");
        }
    }
}
