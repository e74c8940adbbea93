//! Mip chains: every level is a box filter of the one above, each channel on its own as GPU mip generators have it.

use super::Image;
use crate::scene::number::f64_to_f32;

/// The image and its halvings down to 1 x 1.
pub(super) fn chain(image: Image) -> Vec<Image> {
    let mut levels = vec![image];
    while let Some(last) = levels.last().filter(|image| image.width > 1 || image.height > 1) {
        levels.push(halve(last));
    }
    levels
}

/// Half the size, rounded down but at least 1; each texel averages the area it covers of the larger image, partial
/// texels by the part covered.
fn halve(image: &Image) -> Image {
    let (width, height) = ((image.width / 2).max(1), (image.height / 2).max(1));
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0.0; 4];
            for (row, row_part) in shares(y, image.height, height) {
                for (column, column_part) in shares(x, image.width, width) {
                    let texel = image.texel(column, row);
                    for (sum, value) in sum.iter_mut().zip(texel) {
                        *sum += row_part * column_part * f64::from(value);
                    }
                }
            }
            texels.push(sum.map(f64_to_f32));
        }
    }
    Image { width, height, texels }
}

/// The texels of a side of `from` that texel `i` of a side of `to` covers, with their weights, which sum to 1.
fn shares(i: u32, from: u32, to: u32) -> impl Iterator<Item = (u32, f64)> {
    // In units of 1 / to texels of the larger side everything is an integer.
    let (start, end) = (i * from, (i + 1) * from);
    (start / to..end.div_ceil(to)).map(move |texel| {
        let covered = end.min((texel + 1) * to) - start.max(texel * to);
        (texel, f64::from(covered) / f64::from(from))
    })
}
