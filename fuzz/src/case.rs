//! Arbitrary states, targets and fragments from bytes.

use outmerge::format::depth::DepthKind;
use outmerge::format::layout::FORMATS;
use outmerge::model::{NumericModel, registry};
use outmerge::state::spelling::{blend_factors, blend_operations, compare_functions, stencil_operations};
use outmerge::state::{DynamicState, Rect};
use outmerge::{AlphaTest, Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{
    BlendComponent, BlendState, ColorTargetState, ColorWrites, CompareFunction, DepthBiasState, DepthStencilState,
    MultisampleState, StencilFaceState, StencilState, TextureFormat,
};

use super::input::Input;

/// A state, its filled targets, and fragments with the texels they are for.
pub struct Case {
    pub state: MergerState,
    pub before: Framebuffer,
    pub fragments: Vec<(Fragment, u32, u32)>,
}

/// Width and height of the targets.
const SIDE: u32 = 2;
/// Fragments of a case.
const MAX_FRAGMENTS: usize = 6;

impl Case {
    pub fn read(input: &mut Input) -> Self {
        let state = state(input);
        let extent = Extent::with_samples(SIDE, SIDE, state.multisample.count).expect("small");
        let mut before = Framebuffer::for_state(extent, &state).expect("formats of their roles");
        fill(&mut before, input);
        let mut fragments = Vec::new();
        while fragments.len() < MAX_FRAGMENTS && (fragments.is_empty() || !input.is_empty()) {
            fragments.push((fragment(input), input.u32() % SIDE, input.u32() % SIDE));
        }
        Self { state, before, fragments }
    }
}

/// One model of each kind, and variants that could be treated alike by mistake.
pub fn models() -> Vec<Box<dyn NumericModel>> {
    let mut models = registry::all();
    for name in ["exact:ties-away", "exact:toward-zero", "llvmpipe:128", "fixed:12,fused", "fixed:8,rounding=truncate"]
    {
        models.push(registry::by_name(name).expect("a model"));
    }
    models
}

fn component(input: &mut Input) -> BlendComponent {
    let factors: Vec<_> = blend_factors().collect();
    let operations: Vec<_> = blend_operations().collect();
    BlendComponent {
        src_factor: input.pick(&factors),
        dst_factor: input.pick(&factors),
        operation: input.pick(&operations),
    }
}

fn color_target(input: &mut Input) -> Option<ColorTargetState> {
    let blend = match input.byte() % 8 {
        0 => return None,
        1 => None,
        2..=4 => {
            let both = component(input);
            Some(BlendState { color: both, alpha: both })
        }
        _ => Some(BlendState { color: component(input), alpha: component(input) }),
    };
    let (_, format) = input.pick(&FORMATS);
    let mask = input.byte();
    let write_mask = if mask < 128 { ColorWrites::ALL } else { ColorWrites::from_bits_truncate(u32::from(mask)) };
    Some(ColorTargetState { format, blend, write_mask })
}

fn comparison(input: &mut Input) -> CompareFunction {
    input.pick(&compare_functions().collect::<Vec<_>>())
}

fn face(input: &mut Input) -> StencilFaceState {
    let operations: Vec<_> = stencil_operations().collect();
    StencilFaceState {
        compare: comparison(input),
        fail_op: input.pick(&operations),
        depth_fail_op: input.pick(&operations),
        pass_op: input.pick(&operations),
    }
}

fn depth_stencil(input: &mut Input) -> Option<DepthStencilState> {
    use TextureFormat as T;
    if !input.bool() {
        return None;
    }
    Some(DepthStencilState {
        format: input.pick(&[
            T::Depth16Unorm,
            T::Depth24Plus,
            T::Depth24PlusStencil8,
            T::Depth32Float,
            T::Depth32FloatStencil8,
            T::Stencil8,
        ]),
        depth_write_enabled: input.pick(&[None, Some(true), Some(false), Some(true)]),
        depth_compare: if input.byte() < 32 { None } else { Some(comparison(input)) },
        stencil: if input.bool() {
            StencilState { front: face(input), back: face(input), read_mask: input.u32(), write_mask: input.u32() }
        } else {
            StencilState::default()
        },
        bias: DepthBiasState::default(),
    })
}

fn state(input: &mut Input) -> MergerState {
    let targets = (0..input.byte() % 4).map(|_| color_target(input)).collect();
    let mask = input.byte();
    MergerState {
        targets,
        depth_stencil: depth_stencil(input),
        multisample: MultisampleState {
            count: input.pick(&[1, 4]),
            mask: if mask < 192 { !0 } else { u64::from(mask) },
            alpha_to_coverage_enabled: input.byte() % 4 == 1,
        },
        alpha_test: if input.byte() % 4 == 1 {
            AlphaTest::On { compare: comparison(input), reference: input.number() }
        } else {
            AlphaTest::Off
        },
        dynamic: DynamicState {
            blend_constant: input.color(),
            stencil_reference: input.u32(),
            depth_range: input.pick(&[[0.0, 1.0], [0.25, 0.75], [0.5, 0.5], [0.0, 0.0]]),
            scissor: (input.byte() % 8 == 1).then(|| Rect {
                x: u32::from(input.byte()),
                y: u32::from(input.byte()),
                width: input.u32(),
                height: input.u32(),
            }),
        },
    }
}

/// Any bytes in the color targets, any valid codes in depth and stencil.
fn fill(framebuffer: &mut Framebuffer, input: &mut Input) {
    let pattern: [u8; 16] = match input.byte() % 4 {
        0 => input.array(),
        1 => [input.pick(&[0x00, 0x7c, 0x7e, 0x7f, 0x80, 0xfc, 0xff]); 16],
        _ => {
            let mut bytes = [0; 16];
            for part in bytes.chunks_exact_mut(4) {
                part.copy_from_slice(&input.number().to_le_bytes());
            }
            bytes
        }
    };
    for color in framebuffer.colors.iter_mut().flatten() {
        for (byte, value) in color.bytes_mut().iter_mut().zip(pattern.iter().cycle()) {
            *byte = *value;
        }
    }
    if let Some(target) = &mut framebuffer.depth_stencil {
        let depth = input.u32();
        let code = match target.format().depth() {
            Some(DepthKind::Unorm(bits)) => depth & (u32::MAX >> (32 - bits)),
            Some(DepthKind::Float32) | None => depth,
        };
        target.depth_mut().fill(code);
        target.stencil_mut().fill(input.byte());
    }
}

fn fragment(input: &mut Input) -> Fragment {
    let mut fragment = Fragment {
        src1: input.color(),
        depth: input.number(),
        coverage: if input.byte() < 192 { !0 } else { input.u32() },
        front_facing: input.bool(),
        discarded: input.byte() % 8 == 1,
        ..Fragment::default()
    };
    for output in &mut fragment.outputs[..3] {
        *output = input.color();
    }
    fragment
}
