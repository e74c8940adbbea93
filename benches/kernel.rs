//! Row kernels against a streaming kernel of the same process: `cargo bench --all-features --bench kernel`.
//!
//! The streaming kernel adds bytes with saturation: it reads source and target and writes the target, 12 bytes a pixel, and
//! computes next to nothing, so it is as fast as memory. A ratio of 1 means that merging is free beside moving the bytes.
//! Every figure is the best of several runs on one thread; a ratio compares two best runs of the same size.
//!
//! "Wrong" is the share of pixels whose bytes are not the correctly rounded ones, counted against the `exact` kernel on the
//! same data: how a model departs from exact arithmetic, not an error of the kernel.
//!
//! Not measured here: other libraries (pixman, tiny-skia, `image`). lavapipe's own speed is in the bench `device`.

use std::hint::black_box;
use std::time::Instant;

use outmerge::kernel::tile::{Layer, Source, TILE_TEXELS, merge_layers_parallel};
use outmerge::kernel::{Isa, Kernel};
use outmerge::merger::Merger;
use outmerge::model::registry;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites};

/// Widths of square targets.
const SIZES: [usize; 3] = [256, 1024, 4096];

/// The least time a measurement takes.
const SECONDS: f64 = 0.4;

fn same(src_factor: F, dst_factor: F, operation: Op) -> BlendState {
    let both = BlendComponent { src_factor, dst_factor, operation };
    BlendState { color: both, alpha: both }
}

fn target(blend: Option<BlendState>) -> ColorTargetState {
    ColorTargetState { format: wgpu_types::TextureFormat::Rgba8Unorm, blend, write_mask: ColorWrites::ALL }
}

/// States from the simple to the worst: everything separate, every operand computed.
fn states() -> Vec<(&'static str, BlendState)> {
    let worst = BlendState {
        color: BlendComponent {
            src_factor: F::SrcAlphaSaturated,
            dst_factor: F::OneMinusDst,
            operation: Op::ReverseSubtract,
        },
        alpha: BlendComponent { src_factor: F::DstAlpha, dst_factor: F::Constant, operation: Op::Add },
    };
    vec![
        ("over, straight", BlendState::ALPHA_BLENDING),
        ("over, premultiplied", BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        ("additive by alpha", same(F::SrcAlpha, F::One, Op::Add)),
        ("xor", same(F::OneMinusDstAlpha, F::OneMinusSrcAlpha, Op::Add)),
        ("separate, saturate and subtract", worst),
    ]
}

/// Nanoseconds of the best run of `work`, which is repeated for [`SECONDS`].
fn best(mut work: impl FnMut()) -> f64 {
    work();
    let (start, mut best) = (Instant::now(), f64::INFINITY);
    while start.elapsed().as_secs_f64() < SECONDS {
        let run = Instant::now();
        work();
        best = best.min(run.elapsed().as_secs_f64() * 1e9);
    }
    best
}

fn bytes(count: usize, seed: u64) -> Vec<u8> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| random.u8(..)).collect()
}

fn stream(src: &[u8], dst: &mut [u8]) {
    for (d, s) in dst.iter_mut().zip(src) {
        *d = d.saturating_add(*s);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn stream_avx2(src: &[u8], dst: &mut [u8]) {
    stream(src, dst);
}

/// The streaming kernel on the vectors the merging kernels get.
fn stream_best(src: &[u8], dst: &mut [u8]) {
    #[cfg(target_arch = "x86_64")]
    if Isa::Avx2.available() {
        #[expect(unsafe_code, reason = "the processor has AVX2: asked just before")]
        return unsafe { stream_avx2(src, dst) };
    }
    stream(src, dst);
}

fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole as f64
}

/// Every kernel at every size.
fn rows() {
    println!(
        "{:<32} {:<9} {:<9} {:>7} {:>9} {:>8}",
        "state, rgba8unorm, packed source", "model", "isa", "size", "ns/pixel", "stream"
    );
    for size in SIZES {
        let pixels = size * size;
        let (src, before) = (bytes(4 * pixels, 1), bytes(4 * pixels, 2));
        let mut dst = before.clone();
        let streaming = best(|| stream_best(black_box(&src), black_box(&mut dst)));
        println!(
            "{:<32} {:<9} {:<9} {size:>7} {:>9.3} {:>8}",
            "saturating add (streaming)",
            "",
            "",
            streaming / pixels as f64,
            "1.00"
        );
        for (name, blend) in states() {
            for model in ["exact", "fixed:8", "llvmpipe"] {
                let model = registry::by_name(model).expect("a model");
                let kernel = Kernel::new(&target(Some(blend)), [0.2; 4], &*model).expect("a kernel");
                for isa in Isa::ALL.into_iter().filter(|isa| isa.available()) {
                    if isa != Isa::best() && (size != 1024 || model.name() != "exact") {
                        continue;
                    }
                    let time = best(|| kernel.merge_row_on(isa, black_box(&src), None, None, black_box(&mut dst)));
                    let isa = format!("{isa:?}");
                    let ratio = streaming / time;
                    println!(
                        "{name:<32} {:<9} {isa:<9} {size:>7} {:>9.3} {ratio:>8.2}",
                        model.name(),
                        time / pixels as f64
                    );
                }
            }
        }
    }
    let lacking: Vec<_> = Isa::ALL.into_iter().filter(|isa| !isa.available()).collect();
    println!("not run, for want of the instructions: {lacking:?}\n");
}

/// How often a model's bytes are not the exact ones.
fn wrong() {
    println!("{:<32} {:<9} {:>10}", "state", "model", "wrong");
    let pixels = 1 << 20;
    let (src, before) = (bytes(4 * pixels, 1), bytes(4 * pixels, 2));
    for (name, blend) in states() {
        let merged = |model: &str| {
            let model = registry::by_name(model).expect("a model");
            let mut dst = before.clone();
            let kernel = Kernel::new(&target(Some(blend)), [0.2; 4], &*model).expect("a kernel");
            kernel.merge_row(&src, None, None, &mut dst);
            dst
        };
        let exact = merged("exact");
        for model in ["f32", "fixed:8", "llvmpipe"] {
            let got = merged(model);
            let differing = got.chunks_exact(4).zip(exact.chunks_exact(4)).filter(|(a, b)| a != b).count();
            println!("{name:<32} {model:<9} {:>8.3} %", percent(differing, pixels));
        }
    }
    println!();
}

/// The reference on the same texels, for the gain.
fn reference() {
    let size: u32 = 256;
    let pixels = (size * size) as usize;
    let src = bytes(4 * pixels, 1);
    let state = MergerState::single(target(Some(BlendState::ALPHA_BLENDING)));
    let mut targets = Framebuffer::for_state(Extent::new(size, size).expect("a size"), &state).expect("memory");
    let color = |at: usize| std::array::from_fn(|i| f32::from(src[4 * at + i]) / 255.0);
    let fragments: Vec<Fragment> = (0..pixels).map(|at| Fragment::new(color(at))).collect();
    println!("{:<32} {:<9} {:>9} {:>9} {:>8}", "over, straight, 256^2", "model", "reference", "kernel", "gain");
    for name in ["exact", "f32", "fixed:8", "llvmpipe"] {
        let model = registry::by_name(name).expect("a model");
        let merger = Merger::new(&state, &*model, &targets).expect("a merger");
        let slow = best(|| {
            for (at, fragment) in (0_u32..).zip(&fragments) {
                merger.merge(fragment, at % size, at / size, &mut targets);
            }
        });
        let kernel = Kernel::new(&target(Some(BlendState::ALPHA_BLENDING)), [0.0; 4], &*model).expect("a kernel");
        let mut dst = bytes(4 * pixels, 2);
        let fast = best(|| kernel.merge_row(black_box(&src), None, None, black_box(&mut dst)));
        let each = pixels as f64;
        println!("{:<32} {name:<9} {:>9.1} {:>9.3} {:>7.0}x", "", slow / each, fast / each, slow / fast);
    }
    println!();
}

/// Many layers on one target, tile by tile on two threads, against one layer at a time over the whole target.
fn layers() {
    let (size, count) = (4096, 200);
    let pixels = size * size;
    let model = registry::by_name("exact").expect("a model");
    let kernel = Kernel::new(&target(Some(BlendState::ALPHA_BLENDING)), [0.0; 4], &*model).expect("a kernel");
    let texture = bytes(4 * pixels, 3);
    let mut dst = bytes(4 * pixels, 4);
    let single = best(|| kernel.merge_row(black_box(&texture), None, None, black_box(&mut dst)));
    let colors = bytes(4 * count, 5);
    let stack: Vec<Layer<'_>> = colors
        .chunks_exact(4)
        .map(|c| Layer { kernel: &kernel, source: Source::Color([c[0], c[1], c[2], c[3]]) })
        .collect();
    println!("{count} layers of one color each, over, exact, {size}^2: ns a pixel and layer");
    println!("  one layer of texels, one thread      {:.4}", single / pixels as f64);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let time = pool.install(|| best(|| merge_layers_parallel(black_box(&stack), TILE_TEXELS, black_box(&mut dst))));
        let each = time / (pixels * count) as f64;
        println!(
            "  tiles, {threads} thread(s)                  {each:.4}, {:.1} x the single layer's rate",
            single / pixels as f64 / each
        );
    }
}

fn main() {
    reference();
    wrong();
    rows();
    layers();
}
