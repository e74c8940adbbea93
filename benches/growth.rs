//! How cost grows: `cargo bench --bench growth`.
//!
//! Time per fragment of the reference merger with the number of layers, the size of the target and what the state asks for;
//! time and peak heap memory per texel of whole scenes with their size; and the cold start of the program. Times are the
//! least of their runs. A growth is linear where time per fragment, or bytes per texel, stay the same down the table.

use std::hint::black_box;
use std::process::{Command, Stdio};
use std::time::Instant;

use outmerge::merger::Merger;
use outmerge::model::registry;
use outmerge::plan::Planned;
use outmerge::scene::Scene;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use peak_alloc::PeakAlloc;
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites};
use wgpu_types::{
    CompareFunction, DepthBiasState, DepthStencilState, StencilFaceState, StencilOperation, StencilState,
};
use wgpu_types::{MultisampleState, TextureFormat as T};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

const MODELS: [&str; 4] = ["exact", "f32", "fixed:8", "llvmpipe"];

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

/// Fragments that differ from each other.
fn fragments(count: u32) -> Vec<Fragment> {
    let number = |i: u32, step: u32| ((i * step) % 251) as f32 / 250.0;
    let color = |i| [number(i, 7), number(i, 11), number(i, 13), number(i, 17)];
    (0..count)
        .map(|i| {
            let mut fragment = Fragment::new(color(i)).at_depth(number(i, 19)).with_src1(color(i + 1));
            fragment.outputs = [color(i); 8];
            fragment
        })
        .collect()
}

fn over(format: T) -> ColorTargetState {
    ColorTargetState { format, blend: Some(BlendState::ALPHA_BLENDING), write_mask: ColorWrites::ALL }
}

/// Nanoseconds a fragment of `layers` draws over a square target; `None` where the model does not define them.
fn merge(state: &MergerState, model: &str, size: u32, layers: u32, planned: bool) -> Option<f64> {
    let model = registry::by_name(model).expect("a model");
    let extent = Extent::with_samples(size, size, state.multisample.count).expect("a size");
    let mut targets = Framebuffer::for_state(extent, state).expect("memory");
    if let Some(target) = &mut targets.depth_stencil {
        // At the far end, so that the first draw passes, and the same again after it.
        target.depth_mut().fill(0xff_ffff);
    }
    let source = fragments(251);
    let reference = Merger::new(state, &*model, &targets).ok()?;
    let plan = Planned::new(state, &*model, &targets).ok()?;
    let total = f64::from(size) * f64::from(size) * f64::from(layers);
    let each = best(5, || {
        for layer in 0..layers {
            for y in 0..size {
                for x in 0..size {
                    let fragment = &source[((x + 3 * y + 5 * layer) % 251) as usize];
                    if planned {
                        plan.merge(fragment, x, y, black_box(&mut targets));
                    } else {
                        reference.merge(fragment, x, y, black_box(&mut targets));
                    }
                }
            }
        }
    });
    Some(each / total)
}

fn row(name: &str, state: &MergerState, size: u32, layers: u32) {
    let times = MODELS.map(|model| {
        merge(state, model, size, layers, false).map_or_else(|| "-".to_owned(), |each| format!("{each:.0}"))
    });
    println!("| {name} | {} |", times.join(" | "));
}

fn header(what: &str, unit: &str) {
    println!("\n{unit}\n\n| {what} | {} |", MODELS.join(" | "));
    println!("|---|{}", "---|".repeat(MODELS.len()));
}

fn layers_and_sizes() {
    let state = MergerState::single(over(T::Rgba8Unorm));
    header("layers of 64^2", "Reference, straight over on rgba8unorm, ns a fragment:");
    for layers in [1, 10, 100, 1000] {
        row(&layers.to_string(), &state, 64, layers);
    }
    header("one layer of", "Reference, straight over on rgba8unorm, ns a fragment:");
    for size in [64, 256, 1024, 2048] {
        row(&format!("{size}^2"), &state, size, 1);
    }
}

fn states() {
    let one = |target| MergerState::single(target);
    let blended = |blend| one(ColorTargetState { blend, ..over(T::Rgba8Unorm) });
    let component = |src_factor, dst_factor, operation| BlendComponent { src_factor, dst_factor, operation };
    let separate = BlendState {
        color: component(F::SrcAlphaSaturated, F::OneMinusDst, Op::ReverseSubtract),
        alpha: component(F::DstAlpha, F::Constant, Op::Add),
    };
    let dual = BlendState {
        color: component(F::Src1Alpha, F::OneMinusSrc1, Op::Add),
        alpha: component(F::Src1Alpha, F::OneMinusSrc1Alpha, Op::Add),
    };
    let face = StencilFaceState {
        compare: CompareFunction::GreaterEqual,
        fail_op: StencilOperation::Keep,
        depth_fail_op: StencilOperation::IncrementWrap,
        pass_op: StencilOperation::Zero,
    };
    let depth_stencil = |stencil| DepthStencilState {
        format: T::Depth24PlusStencil8,
        depth_write_enabled: Some(true),
        depth_compare: Some(CompareFunction::LessEqual),
        stencil,
        bias: DepthBiasState::default(),
    };
    let stencil = StencilState { front: face, back: face, read_mask: 255, write_mask: 255 };
    let with_depth = |stencil| MergerState { depth_stencil: Some(depth_stencil(stencil)), ..one(over(T::Rgba8Unorm)) };
    let many = |count| MergerState { targets: vec![Some(over(T::Rgba8Unorm)); count], ..MergerState::default() };
    let samples = MultisampleState { count: 4, mask: !0, alpha_to_coverage_enabled: true };
    header("state", "Reference, one layer of 256^2, ns a fragment:");
    for (name, state) in [
        ("no color target", MergerState::default()),
        ("no blending", blended(None)),
        ("straight over", blended(Some(BlendState::ALPHA_BLENDING))),
        ("separate, constant, saturate", blended(Some(separate))),
        ("dual source", blended(Some(dual))),
        ("over, sRGB", one(over(T::Rgba8UnormSrgb))),
        ("over, half float", one(over(T::Rgba16Float))),
        ("over, depth test and write", with_depth(StencilState::default())),
        ("over, depth and stencil", with_depth(stencil.clone())),
        ("over, 4 samples, alpha to coverage", MergerState { multisample: samples, ..one(over(T::Rgba8Unorm)) }),
        ("over, 2 targets", many(2)),
        ("over, 4 targets", many(4)),
        ("over, 8 targets", many(8)),
    ] {
        row(name, &state, 256, 1);
    }
    println!("\nWhat a plan leaves out, `f32`, one layer of 256^2, ns a fragment:\n");
    println!("| state | all stages | planned |\n|---|---|---|");
    for (name, state) in [
        ("no blending", blended(None)),
        ("straight over", blended(Some(BlendState::ALPHA_BLENDING))),
        ("write mask 0", one(ColorTargetState { write_mask: ColorWrites::empty(), ..over(T::Rgba8Unorm) })),
        ("over, depth and stencil", with_depth(stencil)),
    ] {
        let times = [false, true].map(|planned| merge(&state, "f32", 256, 1, planned).expect("f32 covers it"));
        println!("| {name} | {:.0} | {:.0} |", times[0], times[1]);
    }
}

fn scenes() {
    println!("\nWhole scenes, model `f32`: rasterised, shaded and merged\n");
    println!("| scene | size | fragments a texel | ns a fragment | peak heap bytes a texel | of them targets |");
    println!("|---|---|---|---|---|---|");
    for name in ["order-near-first", "four-modes", "vegetation-three-trees", "several-targets"] {
        for size in [128, 256, 512, 1024] {
            let mut scene = Scene::bundled_by_name(name).expect("a bundled scene").expect("it reads");
            scene.target.extent = Extent::new(size, size).expect("a size");
            let model = registry::by_name("f32").expect("a model");
            HEAP.reset_peak_usage();
            let before = HEAP.current_usage();
            let rendered = scene.render(&*model).expect("it renders");
            let peak = HEAP.peak_usage() - before;
            let fragments = rendered.fragments as f64;
            let colors = rendered.framebuffer.colors.iter().flatten().map(|color| color.bytes().len()).sum::<usize>();
            let depth = rendered.framebuffer.depth_stencil.as_ref();
            let depth = depth.map_or(0, |depth| 4 * depth.depth().len() + depth.stencil().len());
            let time = best(3, || drop(black_box(scene.render(&*model))));
            let texels = f64::from(size) * f64::from(size);
            println!(
                "| {name} | {size}^2 | {:.2} | {:.0} | {:.0} | {:.0} |",
                fragments / texels,
                time / fragments,
                peak as f64 / texels,
                (colors + depth) as f64 / texels
            );
        }
    }
}

fn cold_start() {
    println!(
        "\nCold start of the program, from spawn to exit\n\n| arguments | ms, least of 20 | median |\n|---|---|---|"
    );
    for arguments in [
        &["--version"] as &[&str],
        &["models"],
        &["explain", "--state", "alpha-blending", "--src", "1,0,0,0.5", "--dst", "0,0,1,1"],
        &["plan", "order-near-first"],
    ] {
        let mut times: Vec<f64> = (0..20)
            .map(|_| {
                let run = Instant::now();
                let status = Command::new(env!("CARGO_BIN_EXE_outmerge"))
                    .args(arguments)
                    .stdout(Stdio::null())
                    .stderr(Stdio::null())
                    .status()
                    .expect("the program runs");
                assert!(status.success(), "{arguments:?}");
                run.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        times.sort_by(f64::total_cmp);
        println!("| `{}` | {:.1} | {:.1} |", arguments.join(" "), times[0], times[10]);
    }
}

fn main() {
    layers_and_sizes();
    states();
    scenes();
    cold_start();
}
