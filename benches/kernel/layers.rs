//! Many layers on one target, tile by tile, against one layer over the whole target.

use std::hint::black_box;
use std::time::Instant;

use outmerge::kernel::tile::{Layer, Source, TILE_TEXELS, merge_layers_parallel};
use wgpu_types::{BlendState, TextureFormat};

use super::cases::{bytes, kernel};

/// Nanoseconds of the best of some runs.
fn best(runs: usize, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..runs {
        let run = Instant::now();
        work();
        best = best.min(run.elapsed().as_secs_f64() * 1e9);
    }
    best
}

pub fn run() {
    let size = 4096;
    let pixels = size * size;
    let kernel = kernel(TextureFormat::Rgba8Unorm, BlendState::ALPHA_BLENDING, "exact");
    let texture = bytes(4 * pixels, 3);
    let mut dst = bytes(4 * pixels, 4);
    let single = best(10, || kernel.merge_row(black_box(&texture), None, None, black_box(&mut dst))) / pixels as f64;
    println!(
        "\n| layers, straight over, exact, {size}^2 | threads | ns/pixel and layer | of the single layer's rate |"
    );
    println!("|---|---|---|---|\n| 1, texels | 1 | {single:.4} | 1.0 |");
    for (count, threads) in [(10, 1), (100, 1), (1000, 1), (10, 2), (100, 2), (1000, 2)] {
        let colors = bytes(4 * count, 5);
        let stack: Vec<Layer<'_>> = colors
            .chunks_exact(4)
            .map(|c| Layer { kernel: &kernel, source: Source::Color([c[0], c[1], c[2], c[3]]) })
            .collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let runs = (1000 / count).clamp(2, 20);
        let work = || merge_layers_parallel(black_box(&stack), TILE_TEXELS, black_box(&mut dst));
        let each = pool.install(|| best(runs, work)) / (pixels * count) as f64;
        println!("| {count}, one color each | {threads} | {each:.4} | {:.1} |", single / each);
    }
}
