//! The cases: a state, its bytes, and who merges them.

use outmerge::kernel::{Colors, Isa, Kernel, Span, SpanMerger, depth};
use outmerge::merger::Merger;
use outmerge::model::registry;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use tiny_skia::BlendMode;
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, ColorWrites};
use wgpu_types::{CompareFunction, TextureFormat};

use super::measure::{Contender, measure, wrong};
use super::pixman::{Operator, Pixman};
use super::{peers, stream};

/// Widths of square targets; the least stays in the first-level cache, where only arithmetic counts.
const SIZES: [usize; 4] = [64, 256, 1024, 4096];

/// A case with peers.
struct Case {
    name: &'static str,
    format: TextureFormat,
    blend: BlendState,
    /// The models whose kernels run; the first is "ours".
    models: &'static [&'static str],
    data: Data,
}

/// What the bytes are.
#[derive(Clone, Copy, PartialEq)]
enum Data {
    /// Any bytes.
    Any,
    /// Any source over opaque destinations, so that libraries that also divide by alpha compute the same.
    OpaqueTarget,
    /// Premultiplied color.
    Premultiplied,
    /// Halves of numbers in [0, 1].
    Halves,
}

fn same(src_factor: F, dst_factor: F, operation: Op) -> BlendState {
    let both = BlendComponent { src_factor, dst_factor, operation };
    BlendState { color: both, alpha: both }
}

fn cases() -> Vec<Case> {
    let unorm = |name, blend, models, data| Case { name, format: TextureFormat::Rgba8Unorm, blend, models, data };
    let srgb = |name, blend| Case {
        name,
        format: TextureFormat::Rgba8UnormSrgb,
        blend,
        models: &["exact", "f32", "llvmpipe"],
        data: Data::Any,
    };
    let half = |name, blend| Case {
        name,
        format: TextureFormat::Rgba16Float,
        blend,
        models: &["exact", "f32", "llvmpipe"],
        data: Data::Halves,
    };
    let all: &[&str] = &["exact", "fixed:8", "llvmpipe"];
    // Everything separate, every operand computed.
    let worst = BlendState {
        color: BlendComponent {
            src_factor: F::SrcAlphaSaturated,
            dst_factor: F::OneMinusDst,
            operation: Op::ReverseSubtract,
        },
        alpha: BlendComponent { src_factor: F::DstAlpha, dst_factor: F::Constant, operation: Op::Add },
    };
    vec![
        unorm("straight over", BlendState::ALPHA_BLENDING, all, Data::OpaqueTarget),
        unorm("premultiplied over", BlendState::PREMULTIPLIED_ALPHA_BLENDING, all, Data::Premultiplied),
        unorm("plus", same(F::One, F::One, Op::Add), &["exact"], Data::Premultiplied),
        unorm("additive by alpha", same(F::SrcAlpha, F::One, Op::Add), &["exact"], Data::Any),
        unorm("xor", same(F::OneMinusDstAlpha, F::OneMinusSrcAlpha, Op::Add), all, Data::Premultiplied),
        unorm("separate, saturate and subtract", worst, all, Data::Any),
        srgb("srgb over, straight", BlendState::ALPHA_BLENDING),
        half("half over, straight", BlendState::ALPHA_BLENDING),
        half("half over, premultiplied", BlendState::PREMULTIPLIED_ALPHA_BLENDING),
    ]
}

/// Bytes of a texel.
fn texel(format: TextureFormat) -> usize {
    if format == TextureFormat::Rgba16Float { 8 } else { 4 }
}

pub fn bytes(count: usize, seed: u64) -> Vec<u8> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| random.u8(..)).collect()
}

fn image(data: Data, pixels: usize, seed: u64, is_target: bool) -> Vec<u8> {
    if data == Data::Halves {
        let mut random = fastrand::Rng::with_seed(seed);
        return (0..2 * pixels).flat_map(|_| half::f16::from_f32(random.f32()).to_le_bytes()).collect();
    }
    let mut image = bytes(4 * pixels, seed);
    for texel in image.as_chunks_mut::<4>().0 {
        match data {
            Data::Any | Data::Halves => {}
            Data::OpaqueTarget if is_target => texel[3] = 255,
            Data::OpaqueTarget => {}
            Data::Premultiplied => {
                let alpha = u16::from(texel[3]);
                for color in &mut texel[..3] {
                    *color = u8::try_from((u16::from(*color) * alpha + 127) / 255).expect("at most 255");
                }
            }
        }
    }
    image
}

pub fn target(format: TextureFormat, blend: BlendState) -> ColorTargetState {
    ColorTargetState { format, blend: Some(blend), write_mask: ColorWrites::ALL }
}

pub fn kernel(format: TextureFormat, blend: BlendState, model: &str) -> Kernel {
    let model = registry::by_name(model).expect("a model");
    Kernel::new(&target(format, blend), [0.2; 4], &*model).expect("a kernel")
}

/// All cases that are wanted, at every size.
pub fn run(pixman: Option<&Pixman>, wanted: &dyn Fn(&str) -> bool) {
    println!("\n| case | size | contender | ns/pixel | of stream | ours | wrong |\n|---|---|---|---|---|---|---|");
    for case in cases().iter().filter(|case| wanted(case.name)) {
        for size in SIZES {
            run_case(case, size, pixman);
        }
    }
    if wanted("depth-tested over") {
        SIZES.into_iter().for_each(depth_tested);
    }
}

fn run_case(case: &Case, size: usize, pixman: Option<&Pixman>) {
    let pixels = size * size;
    let wide = texel(case.format) / 4;
    let (src, before) = (image(case.data, wide * pixels, 1, false), image(case.data, wide * pixels, 2, true));
    let mut contenders = vec![Contender::new("streaming", stream::add)];
    for model in case.models {
        let kernel = kernel(case.format, case.blend, model);
        contenders.push(Contender::new(format!("{model}, {:?}", Isa::best()), move |src: &[u8], dst: &mut [u8]| {
            kernel.merge_row(src, None, None, dst);
        }));
    }
    for isa in Isa::ALL.into_iter().filter(|isa| isa.available() && *isa != Isa::best()) {
        let kernel = kernel(case.format, case.blend, "exact");
        contenders.push(Contender::new(format!("exact, {isa:?}"), move |src: &[u8], dst: &mut [u8]| {
            kernel.merge_row_on(isa, src, None, None, dst);
        }));
    }
    contenders.extend(peers_of(case.name, size, pixman));
    let times = measure(&mut contenders, &src, &before);
    let mut exact = before.clone();
    kernel(case.format, case.blend, "exact").merge_row(&src, None, None, &mut exact);
    for (i, (contender, time)) in contenders.iter_mut().zip(&times).enumerate() {
        let each = time / pixels as f64;
        let (of_stream, ours) = (times[0] / time, time / times[1]);
        let wrong = if i == 0 {
            String::new()
        } else {
            format!("{:.3} %", wrong(contender, &src, &before, &exact, texel(case.format)))
        };
        println!(
            "| {} | {size}^2 | {} | {each:.3} | {of_stream:.2} | {ours:.2} | {wrong} |",
            case.name, contender.name
        );
    }
}

/// Other libraries that can do a case.
fn peers_of<'a>(name: &str, size: usize, pixman: Option<&'a Pixman>) -> Vec<Contender<'a>> {
    let skia = |mode| {
        Contender::new("tiny-skia 0.12", move |src: &[u8], dst: &mut [u8]| peers::tiny_skia(mode, src, dst, size))
    };
    let of_pixman = |operator| {
        pixman.map(|pixman| {
            let run = move |src: &[u8], dst: &mut [u8]| pixman.composite(operator, src, dst, size);
            Contender::new("pixman", run)
        })
    };
    let both = |operator, mode| of_pixman(operator).into_iter().chain([skia(mode)]).collect();
    match name {
        "straight over" => {
            vec![Contender::new("image 0.25 overlay", move |src: &[u8], dst: &mut [u8]| peers::image(src, dst, size))]
        }
        "premultiplied over" => both(Operator::Over, BlendMode::SourceOver),
        "plus" => both(Operator::Add, BlendMode::Plus),
        "xor" => both(Operator::Xor, BlendMode::Xor),
        "srgb over, straight" => vec![Contender::new("fast-srgb8 1.0", peers::fast_srgb8)],
        _ => Vec::new(),
    }
}

/// Over behind a depth test that half of the fragments pass, row by row, against a stream over both planes.
fn depth_tested(size: usize) {
    let pixels = size * size;
    let (src, before) = (bytes(4 * pixels, 1), bytes(4 * pixels, 2));
    let mut random = fastrand::Rng::with_seed(3);
    let codes: Vec<u32> = (0..pixels).map(|_| random.f32().to_bits()).collect();
    let mut stored: Vec<u32> = (0..pixels).map(|_| random.f32().to_bits()).collect();
    let (plane, mut other) = (bytes(4 * pixels, 4), bytes(4 * pixels, 5));
    let kernel = kernel(TextureFormat::Rgba8Unorm, BlendState::ALPHA_BLENDING, "exact");
    let mut keep = vec![0; size];
    let tested = |src: &[u8], dst: &mut [u8]| {
        for (at, row) in dst.chunks_exact_mut(4 * size).enumerate() {
            let span = at * size..(at + 1) * size;
            keep.fill(255);
            depth::test_row(CompareFunction::Less, true, &codes[span.clone()], &mut stored[span.clone()], &mut keep);
            kernel.merge_row(&src[4 * span.start..4 * span.end], None, Some(&keep), row);
        }
    };
    let both_planes = |src: &[u8], dst: &mut [u8]| {
        stream::add(src, dst);
        stream::add(&plane, &mut other);
    };
    let mut contenders = [Contender::new("streaming, both planes", both_planes), Contender::new("exact", tested)];
    let times = measure(&mut contenders, &src, &before);
    for (contender, time) in contenders.iter().zip(&times) {
        let (each, of_stream, ours) = (time / pixels as f64, times[0] / time, time / times[1]);
        println!("| depth-tested over | {size}^2 | {} | {each:.3} | {of_stream:.2} | {ours:.2} | |", contender.name);
    }
}

/// The reference on the same texels, for the gain.
pub fn reference() {
    let size: u32 = 256;
    let pixels = (size * size) as usize;
    let src = bytes(4 * pixels, 1);
    let state = MergerState::single(target(TextureFormat::Rgba8Unorm, BlendState::ALPHA_BLENDING));
    let mut targets = Framebuffer::for_state(Extent::new(size, size).expect("a size"), &state).expect("memory");
    let color = |at: usize| std::array::from_fn(|i| f32::from(src[4 * at + i]) / 255.0);
    let fragments: Vec<Fragment> = (0..pixels).map(|at| Fragment::new(color(at))).collect();
    // Numbers between codes.
    let between = |x: f32| x * 0.998 + 0.001;
    let planes: [Vec<f32>; 4] = std::array::from_fn(|i| fragments.iter().map(|f| between(f.outputs[0][i])).collect());
    let mut span_targets = [targets.clone(), targets.clone()];
    println!(
        "\n| straight over, 256^2, ns/pixel | reference | span of numbers | span of codes | kernel | gain |\n\
         |---|---|---|---|---|---|"
    );
    for name in ["exact", "f32", "fixed:8", "llvmpipe"] {
        let model = registry::by_name(name).expect("a model");
        let merger = Merger::new(&state, &*model, &targets).expect("a merger");
        let kernel = kernel(TextureFormat::Rgba8Unorm, BlendState::ALPHA_BLENDING, name);
        let [mut by_planes, mut by_codes] =
            [(); 2].map(|()| SpanMerger::new(&state, &*model, &targets).expect("a merger"));
        let [plane_targets, code_targets] = &mut span_targets;
        let row = |y: u32| (y * size) as usize..((y + 1) * size) as usize;
        let slow = |_: &[u8], _: &mut [u8]| {
            for (at, fragment) in (0_u32..).zip(&fragments) {
                merger.merge(fragment, at % size, at / size, &mut targets);
            }
        };
        let spans_of_numbers = |_: &[u8], _: &mut [u8]| {
            for y in 0..size {
                let colors = [Colors::Planes(std::array::from_fn(|i| &planes[i][row(y)]))];
                by_planes.merge(&Span::new(0, y, &colors), plane_targets);
            }
        };
        let spans_of_codes = |src: &[u8], _: &mut [u8]| {
            for y in 0..size {
                let colors = [Colors::Unorm8(&src[4 * row(y).start..4 * row(y).end])];
                by_codes.merge(&Span::new(0, y, &colors), code_targets);
            }
        };
        let fast = |src: &[u8], dst: &mut [u8]| kernel.merge_row(src, None, None, dst);
        let times = measure(
            &mut [
                Contender::new("reference", slow),
                Contender::new("span of numbers", spans_of_numbers),
                Contender::new("span of codes", spans_of_codes),
                Contender::new("kernel", fast),
            ],
            &src,
            &bytes(4 * pixels, 2),
        );
        let each: Vec<f64> = times.iter().map(|time| time / pixels as f64).collect();
        let gain = times[0] / times[3];
        println!("| {name} | {:.1} | {:.2} | {:.3} | {:.3} | {gain:.0} |", each[0], each[1], each[2], each[3]);
    }
}
