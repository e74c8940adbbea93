//! Filtering: what a bilinear fetch between four texels, which is also the first mip level, makes of each storage.
//!
//! All colors are stored values, not linear light, and compared as they contribute over black (color times alpha).

use serde::Serialize;

use super::Errors;
use super::pipeline::to_code;
use super::source::Source;

/// Errors at the middle of every 2 x 2 block of texels, in codes of 8 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Filtering {
    /// Straight colors filtered, then multiplied by the filtered alpha: the color of transparent texels bleeds in.
    pub straight: Fringe,
    /// Premultiplied to 8 bits, then filtered: the storage's roundings average out.
    pub premultiplied: Fringe,
    /// Filtered, then premultiplied to 8 bits, as a mip chain made before storing.
    pub filtered_first: Fringe,
}

/// How far one way of filtering is from filtering colors times alpha without rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Fringe {
    /// The largest error of a channel.
    pub worst: f64,
    /// The mean error of a channel.
    pub mean: f64,
}

/// Share of a mip level's texels that a cutout keeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// The mip level, 0 the image itself.
    pub level: u32,
    /// Its width in texels.
    pub width: u32,
    /// Its height in texels.
    pub height: u32,
    /// Share of texels with alpha at or above the cutoff, 0 to 1.
    pub kept: f64,
}

/// Filters every 2 x 2 block; an image of one row or column has none.
pub(super) fn filtering(source: &Source) -> Filtering {
    let mut errors = [Errors::default(), Errors::default(), Errors::default()];
    let top = f64::from(source.top());
    for y in 1..source.height {
        for x in 1..source.width {
            let block =
                [source.texel(x - 1, y - 1), source.texel(x, y - 1), source.texel(x - 1, y), source.texel(x, y)];
            if block.iter().all(|texel| *texel == block[0]) && u32::from(block[0][3]) == source.top() {
                // Equal opaque texels filter to themselves in every storage.
                errors.iter_mut().for_each(|errors| errors.channels += 3);
                continue;
            }
            let values = block.map(|texel| texel.map(|code| f64::from(code) / top));
            let mean = |of: &dyn Fn(&[f64; 4]) -> f64| values.iter().map(of).sum::<f64>() / 4.0;
            let alpha = mean(&|texel| texel[3]);
            for i in 0..3 {
                let truth = mean(&|texel| texel[i] * texel[3]);
                let straight = mean(&|texel| texel[i]) * alpha;
                let eight = |x: f64| f64::from(to_code(x, 255)) / 255.0;
                let premultiplied = mean(&|texel| eight(texel[i] * texel[3]));
                for (errors, value) in errors.iter_mut().zip([straight, premultiplied, eight(truth)]) {
                    errors.add((value - truth).abs() * 255.0);
                }
            }
        }
    }
    let fringe = |errors: &Errors| Fringe { worst: errors.worst, mean: errors.mean() };
    let [straight, premultiplied, filtered_first] = &errors;
    Filtering {
        straight: fringe(straight),
        premultiplied: fringe(premultiplied),
        filtered_first: fringe(filtered_first),
    }
}

/// The cutout's coverage of every mip level, each made of the one above by 2 x 2 averages (odd last rows and columns are
/// left out, as a plain box generator does).
pub(super) fn coverage(source: &Source, cutoff: f64) -> Vec<Coverage> {
    let (mut width, mut height) = (source.width as usize, source.height as usize);
    let mut alphas: Vec<f64> = source.texels.iter().map(|texel| source.value(texel[3])).collect();
    let mut levels = Vec::new();
    for level in 0.. {
        let kept = alphas.iter().filter(|alpha| **alpha >= cutoff).count() as u64;
        let side = |n: usize| u32::try_from(n).expect("mips are smaller than the image");
        let kept = super::count(kept) / super::count(alphas.len() as u64);
        levels.push(Coverage { level, width: side(width), height: side(height), kept });
        if width == 1 && height == 1 {
            break;
        }
        let (next_width, next_height) = ((width / 2).max(1), (height / 2).max(1));
        let (dx, dy) = (usize::from(width > 1), usize::from(height > 1));
        let average = |x: usize, y: usize| {
            let (x, y) = (x * (1 + dx), y * (1 + dy));
            let at = |x: usize, y: usize| alphas[y * width + x];
            (at(x, y) + at(x + dx, y) + at(x, y + dy) + at(x + dx, y + dy)) / 4.0
        };
        let next = (0..next_height).flat_map(|y| (0..next_width).map(move |x| (x, y)));
        alphas = next.map(|(x, y)| average(x, y)).collect();
        (width, height) = (next_width, next_height);
    }
    levels
}
