//! Layers: the same bytes for any tile size and number of threads.

use outmerge::kernel::Kernel;
use outmerge::kernel::tile::{Layer, Source, merge_layers, merge_layers_parallel};
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState};

use super::{Bytes, MODELS, equation, kernel, target};

const TEXELS: usize = 5000;

fn kernels(name: &str) -> Vec<Kernel> {
    let additive = equation(F::SrcAlpha, F::One, Op::Add);
    [None, Some(BlendState::ALPHA_BLENDING), Some(BlendState { color: additive, alpha: additive })]
        .map(|blend| kernel(&target(blend), [0.0; 4], name))
        .into()
}

#[test]
fn tiles_and_threads_do_not_show() {
    for name in MODELS {
        let kernels = kernels(name);
        let mut bytes = Bytes(7);
        let textures: Vec<Vec<u8>> = (0..3).map(|_| bytes.fill(4 * TEXELS)).collect();
        let before = bytes.fill(4 * TEXELS);
        let layers: Vec<Layer<'_>> = (0..12)
            .map(|i| {
                let source = match i % 4 {
                    0..=2 => Source::Texels(&textures[i % 4]),
                    _ => Source::Color([bytes.next(), bytes.next(), bytes.next(), bytes.next()]),
                };
                // The opaque kernel first, and never again, or nothing before it would matter.
                let kernel = if i == 0 { &kernels[0] } else { &kernels[1 + i % 2] };
                Layer { kernel, source }
            })
            .collect();
        // Row by row, layer after layer.
        let mut expected = before.clone();
        for layer in &layers {
            let spread: Vec<u8>;
            let src = match layer.source {
                Source::Texels(texels) => texels,
                Source::Color(color) => {
                    spread = color.repeat(TEXELS);
                    &spread
                }
            };
            layer.kernel.merge_row(src, None, None, &mut expected);
        }
        for tile in [1, 7, 1000, 1024, 4999, TEXELS, 100_000] {
            let mut target = before.clone();
            merge_layers(&layers, tile, &mut target);
            assert!(target == expected, "{name}: tiles of {tile}");
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let mut target = before.clone();
                pool.install(|| merge_layers_parallel(&layers, tile, &mut target));
                assert!(target == expected, "{name}: tiles of {tile} on {threads} threads");
            }
        }
    }
}

#[test]
fn stacks_of_colors_are_their_layers() {
    let mut bytes = Bytes(11);
    // Every model's kernels in one stack: rules change within it, and some kernels have no short way.
    let kernels: Vec<Kernel> = MODELS.into_iter().flat_map(kernels).collect();
    for texels in [1, 3, 16, 63, 64, 65, 300] {
        let before = bytes.fill(4 * texels);
        for count in [1, 2, 31, 32, 33, 200] {
            let layers: Vec<Layer<'_>> = (0..count)
                .map(|i| {
                    // Runs of one kernel, from single layers to more than a batch.
                    let kernel = &kernels[if count < 100 { i / 7 } else { i / 50 } % kernels.len()];
                    Layer {
                        kernel,
                        source: Source::Color([bytes.next(), bytes.next(), bytes.next(), bytes.next() / 4]),
                    }
                })
                .collect();
            let mut expected = before.clone();
            for layer in &layers {
                let Source::Color(color) = layer.source else { unreachable!("all are") };
                layer.kernel.merge_row(&color.repeat(texels), None, None, &mut expected);
            }
            let mut target = before.clone();
            merge_layers(&layers, 4096, &mut target);
            assert!(target == expected, "{texels} texels, {count} layers");
        }
    }
}
