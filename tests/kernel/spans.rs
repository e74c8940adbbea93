//! Spans are their fragments, one by one through the reference.

use outmerge::kernel::{Colors, Isa, Span, SpanMerger};
use outmerge::merger::Merger;
use outmerge::model::{NumericModel, registry};
use outmerge::proptest::{fragment, state, target};
use outmerge::state::{MAX_COLOR_TARGETS, Rect};
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use proptest::collection::vec;
use proptest::prelude::*;
use wgpu_types::{BlendState, ColorTargetState, ColorWrites, CompareFunction, TextureFormat};
use wgpu_types::{DepthBiasState, DepthStencilState, StencilFaceState, StencilState};

use super::{Bytes, instruction_sets};

const WIDTH: u32 = 37;

/// Fragments of a row: any numbers, or codes and halves as textures have them.
#[derive(Clone, Debug)]
struct Case {
    state: MergerState,
    before: Framebuffer,
    fragments: Vec<Fragment>,
    x: u32,
}

fn from_codes(mut fragment: Fragment, codes: [u8; 4]) -> Fragment {
    let numbers = codes.map(|code| f32::from(code) / 255.0);
    fragment.outputs = [numbers; MAX_COLOR_TARGETS];
    fragment.src1 = [numbers[3], numbers[0], numbers[1], numbers[2]];
    fragment
}

/// States whose targets have kernels more often than not.
fn states() -> impl Strategy<Value = MergerState> {
    let formats = prop::sample::select(vec![
        TextureFormat::Rgba8Unorm,
        TextureFormat::Bgra8Unorm,
        TextureFormat::Rgba8UnormSrgb,
        TextureFormat::Bgra8UnormSrgb,
        TextureFormat::Rgba16Float,
        TextureFormat::R8Unorm,
    ]);
    let blends = prop_oneof![
        Just(Some(BlendState::ALPHA_BLENDING)),
        Just(Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING)),
        state::blend(),
    ];
    let color = (formats, blends, state::write_mask())
        .prop_map(|(format, blend, write_mask)| Some(ColorTargetState { format, blend, write_mask }));
    let scissor = prop::option::of((0..WIDTH, 0..2_u32, 1..WIDTH, 1..3_u32));
    (state::valid_state(), vec(color, 1..3), scissor, 0..3_u8).prop_map(|(mut state, targets, scissor, plain)| {
        state.targets = targets;
        state.dynamic.scissor = scissor.map(|(x, y, width, height)| Rect { x, y, width, height });
        if plain != 0 {
            // Mostly what rows can do.
            state.multisample = wgpu_types::MultisampleState::default();
            if let Some(depth_stencil) = &mut state.depth_stencil {
                depth_stencil.stencil = StencilState::default();
            }
        }
        state
    })
}

fn cases() -> impl Strategy<Value = Case> {
    (states(), 0..4_u32).prop_flat_map(|(state, x)| {
        let extent = Extent::with_samples(WIDTH, 2, state.multisample.count).expect("a few texels");
        let count = (WIDTH - x) as usize;
        let codes = vec(any::<Option<[u8; 4]>>(), count);
        let fragments = (fragment::stack(&state, count), codes).prop_map(|(mut fragments, codes)| {
            for (fragment, codes) in fragments.iter_mut().zip(codes) {
                if let Some(codes) = codes {
                    *fragment = from_codes(*fragment, codes);
                }
                fragment.front_facing = true;
                fragment.coverage = !0;
            }
            fragments
        });
        (target::framebuffer(&state, extent), fragments).prop_map(move |(before, fragments)| Case {
            state: state.clone(),
            before,
            fragments,
            x,
        })
    })
}

/// The fragments as arrays: one plane a channel.
struct Arrays {
    outputs: Vec<[Vec<f32>; 4]>,
    src1: [Vec<f32>; 4],
    depth: Vec<f32>,
    keep: Vec<u8>,
}

impl Arrays {
    fn new(fragments: &[Fragment]) -> Self {
        let planes = |pick: &dyn Fn(&Fragment) -> [f32; 4]| {
            std::array::from_fn(|channel| fragments.iter().map(|f| pick(f)[channel]).collect())
        };
        Self {
            outputs: (0..MAX_COLOR_TARGETS).map(|i| planes(&|f: &Fragment| f.outputs[i])).collect(),
            src1: planes(&|f: &Fragment| f.src1),
            depth: fragments.iter().map(|f| f.depth).collect(),
            keep: fragments.iter().map(|f| if f.discarded { 0 } else { 7 }).collect(),
        }
    }
}

fn slices(planes: &[Vec<f32>; 4]) -> Colors<'_> {
    Colors::Planes([&planes[0], &planes[1], &planes[2], &planes[3]])
}

fn one_by_one(case: &Case, model: &dyn NumericModel) -> Option<Framebuffer> {
    let mut targets = case.before.clone();
    let merger = Merger::new(&case.state, model, &targets).ok()?;
    for (i, fragment) in (0..).zip(&case.fragments) {
        merger.merge(fragment, case.x + i, 1, &mut targets);
    }
    Some(targets)
}

fn as_span(case: &Case, model: &dyn NumericModel, isa: Isa) -> Framebuffer {
    let mut targets = case.before.clone();
    let arrays = Arrays::new(&case.fragments);
    let colors: Vec<Colors<'_>> = arrays.outputs.iter().map(slices).collect();
    let span = Span {
        src1: Some(slices(&arrays.src1)),
        depth: Some(&arrays.depth),
        keep: Some(&arrays.keep),
        ..Span::new(case.x, 1, &colors)
    };
    SpanMerger::new(&case.state, model, &targets).expect("as the merger").merge_on(isa, &span, &mut targets);
    targets
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn any_span_under_any_state_is_its_fragments_one_by_one(case in cases()) {
        for name in ["exact", "f32", "f16", "fixed:8", "llvmpipe:mesa=22.3", "llvmpipe", "llvmpipe:128", "swiftshader"] {
            let model = registry::by_name(name).expect("a model");
            let Some(expected) = one_by_one(&case, &*model) else { continue };
            for isa in instruction_sets() {
                prop_assert!(as_span(&case, &*model, isa) == expected, "{name} on {isa:?}");
            }
        }
    }
}

#[test]
fn packed_codes_are_their_numbers_and_go_to_kernels() {
    let mut bytes = Bytes(13);
    for format in
        [TextureFormat::Rgba8Unorm, TextureFormat::Bgra8Unorm, TextureFormat::Rgba8UnormSrgb, TextureFormat::R8Unorm]
    {
        for blend in [None, Some(BlendState::ALPHA_BLENDING)] {
            let target = ColorTargetState { format, blend, write_mask: ColorWrites::ALL };
            let state = MergerState { targets: vec![Some(target)], ..MergerState::default() };
            let extent = Extent::new(WIDTH, 1).expect("a size");
            let mut packed = Framebuffer::for_state(extent, &state).expect("memory");
            for byte in packed.colors[0].as_mut().expect("a target").bytes_mut() {
                *byte = bytes.next();
            }
            let mut single = packed.clone();
            let codes = bytes.fill(4 * WIDTH as usize);
            let model = registry::by_name("exact").expect("a model");
            let mut merger = SpanMerger::new(&state, &*model, &packed).expect("a merger");
            let has_kernel = format != TextureFormat::R8Unorm && !(blend.is_none() && format.is_srgb());
            assert_eq!(merger.kernels().collect::<Vec<_>>(), [has_kernel], "{format:?}, {blend:?}");
            merger.merge(&Span::new(0, 0, &[Colors::Unorm8(&codes)]), &mut packed);
            let reference = Merger::new(&state, &*model, &single).expect("a merger");
            for (x, codes) in (0..).zip(codes.chunks_exact(4)) {
                let color = std::array::from_fn(|i| f32::from(codes[i]) / 255.0);
                reference.merge(&Fragment::new(color), x, 0, &mut single);
            }
            assert!(packed == single, "{format:?}, {blend:?}");
        }
    }
}

#[test]
fn a_stencil_test_without_masks_still_compares() {
    let face = StencilFaceState { compare: CompareFunction::Greater, ..StencilFaceState::IGNORE };
    let depth_stencil = DepthStencilState {
        format: TextureFormat::Depth24PlusStencil8,
        depth_write_enabled: Some(true),
        depth_compare: Some(CompareFunction::Always),
        stencil: StencilState { front: face, back: face, read_mask: 0, write_mask: 0 },
        bias: DepthBiasState::default(),
    };
    let target = ColorTargetState { format: TextureFormat::Rgba8Unorm, blend: None, write_mask: ColorWrites::ALL };
    let state =
        MergerState { targets: vec![Some(target)], depth_stencil: Some(depth_stencil), ..MergerState::default() };
    let mut targets = Framebuffer::for_state(Extent::new(2, 1).expect("a size"), &state).expect("memory");
    let before = targets.clone();
    let model = registry::by_name("exact").expect("a model");
    let mut merger = SpanMerger::new(&state, &*model, &targets).expect("a merger");
    merger.merge(&Span { depth: Some(&[0.5; 2]), ..Span::new(0, 0, &[Colors::Unorm8(&[9; 8])]) }, &mut targets);
    assert!(targets == before, "0 > 0 fails");
}

#[test]
#[should_panic(expected = "inside the target")]
fn a_span_that_leaves_the_target_is_refused() {
    let target = ColorTargetState { format: TextureFormat::Rgba8Unorm, blend: None, write_mask: ColorWrites::ALL };
    let state = MergerState { targets: vec![Some(target)], ..MergerState::default() };
    let mut targets = Framebuffer::for_state(Extent::new(4, 1).expect("a size"), &state).expect("memory");
    let model = registry::by_name("exact").expect("a model");
    let mut merger = SpanMerger::new(&state, &*model, &targets).expect("a merger");
    merger.merge(&Span::new(1, 0, &[Colors::Unorm8(&[0; 16])]), &mut targets);
}
