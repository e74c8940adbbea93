//! The same blend by other crates.

use image::{ImageBuffer, Rgba};
use tiny_skia::{BlendMode, PixmapMut, PixmapPaint, PixmapRef, Transform};

fn side(width: usize) -> u32 {
    u32::try_from(width).expect("a small image")
}

/// tiny-skia on premultiplied color.
pub fn tiny_skia(mode: BlendMode, src: &[u8], dst: &mut [u8], width: usize) {
    let (width, paint) = (side(width), PixmapPaint { blend_mode: mode, ..PixmapPaint::default() });
    let src = PixmapRef::from_bytes(src, width, width).expect("a square image");
    let mut dst = PixmapMut::from_bytes(dst, width, width).expect("a square image");
    dst.draw_pixmap(0, 0, src, &paint, Transform::identity(), None);
}

/// `image::imageops::overlay` on straight color.
pub fn image(src: &[u8], dst: &mut [u8], width: usize) {
    let width = side(width);
    let src = ImageBuffer::<Rgba<u8>, _>::from_raw(width, width, src).expect("a square image");
    let mut dst = ImageBuffer::<Rgba<u8>, _>::from_raw(width, width, dst).expect("a square image");
    image::imageops::overlay(&mut dst, &src, 0, 0);
}

/// Straight over on sRGB targets by fast-srgb8: decode by its table, blend in binary32, encode. The source is linear.
pub fn fast_srgb8(src: &[u8], dst: &mut [u8]) {
    for (s, d) in src.as_chunks::<4>().0.iter().zip(dst.as_chunks_mut::<4>().0) {
        let a = f32::from(s[3]) / 255.0;
        let mut blended = [0.0; 4];
        for i in 0..3 {
            blended[i] = f32::from(s[i]) / 255.0 * a + fast_srgb8::srgb8_to_f32(d[i]) * (1.0 - a);
        }
        let alpha = 255.0 * a + f32::from(d[3]) * (1.0 - a);
        let [r, g, b, _] = fast_srgb8::f32x4_to_srgb8(blended);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
        let alpha = (alpha + 0.5) as u8;
        *d = [r, g, b, alpha];
    }
}
