//! Many layers at once: each tile of the target takes all layers before the next, so that it stays in the cache.

use super::unorm8::flat::{self, Flat};
use super::{Isa, Kernel, TEXEL};

/// Texels of a tile by default: with a source row and scratch it stays within a second-level cache of 256 KiB.
pub const TILE_TEXELS: usize = 16 * 1024;

/// One layer over the whole target.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// One color everywhere, in the target's byte order.
    Color([u8; TEXEL]),
    /// A color a texel, as many bytes as the target has.
    Texels(&'a [u8]),
}

/// A layer: what it draws and how it is merged.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// The kernel of its state; states that read a second source cannot be layers.
    pub kernel: &'a Kernel,
    /// Its colors.
    pub source: Source<'a>,
}

/// Merges all layers in order, tile by tile. The result does not depend on `tile_texels`.
///
/// # Panics
/// When a layer's texels are not as many as the target's, its state reads a second source, its kernel
/// is one for halves, or `tile_texels` is 0.
pub fn merge_layers(layers: &[Layer<'_>], tile_texels: usize, target: &mut [u8]) {
    check(layers, target.len());
    let steps = steps(layers);
    for (index, tile) in target.chunks_mut(tile_texels * TEXEL).enumerate() {
        merge_tile(&steps, index * tile_texels * TEXEL, tile);
    }
}

/// The same on all threads of the current rayon pool; the result does not depend on their number.
///
/// # Panics
/// As [`merge_layers`].
#[cfg(feature = "parallel")]
pub fn merge_layers_parallel(layers: &[Layer<'_>], tile_texels: usize, target: &mut [u8]) {
    use rayon::prelude::*;
    check(layers, target.len());
    let steps = steps(layers);
    let tiles = target.par_chunks_mut(tile_texels * TEXEL).enumerate();
    tiles.for_each(|(index, tile)| merge_tile(&steps, index * tile_texels * TEXEL, tile));
}

fn check(layers: &[Layer<'_>], bytes: usize) {
    for layer in layers {
        assert!(!layer.kernel.reads_second_source(), "layers have no second source");
        assert_eq!(layer.kernel.texel(), TEXEL, "layers have texels of four bytes");
        if let Source::Texels(texels) = layer.source {
            assert_eq!(texels.len(), bytes, "a layer has as many texels as the target");
        }
    }
}

/// What a tile goes through.
enum Step<'a> {
    /// A layer with a color a texel.
    Texels(&'a Kernel, &'a [u8]),
    /// A layer of one color that has no shorter way than a row of it.
    Color(&'a Kernel, [u8; TEXEL]),
    /// Layers of one color each, merged together.
    Stack(Vec<Flat>),
}

fn steps<'a>(layers: &[Layer<'a>]) -> Vec<Step<'a>> {
    let mut steps = Vec::new();
    for layer in layers {
        let color = match layer.source {
            Source::Texels(texels) => {
                steps.push(Step::Texels(layer.kernel, texels));
                continue;
            }
            Source::Color(color) => color,
        };
        match (layer.kernel.flat(color), steps.last_mut()) {
            (Some(flat), Some(Step::Stack(stack))) => stack.push(flat),
            (Some(flat), _) => steps.push(Step::Stack(vec![flat])),
            (None, _) => steps.push(Step::Color(layer.kernel, color)),
        }
    }
    steps
}

/// All steps on one tile that starts at byte `start`.
fn merge_tile(steps: &[Step<'_>], start: usize, tile: &mut [u8]) {
    let isa = Isa::best();
    for step in steps {
        match step {
            Step::Texels(kernel, texels) => {
                kernel.merge_row_on(isa, &texels[start..start + tile.len()], None, None, tile);
            }
            Step::Color(kernel, color) => kernel.merge_color_on(isa, *color, tile),
            Step::Stack(stack) => flat::merge(isa, stack, tile),
        }
    }
}
