//! Depth and stencil: exact codes in and out, and the tests' effect on them.

use std::ops::ControlFlow;

use outmerge::crosscheck::{Batch, DepthSource, Destination, Input, Job, Layer, Program, Replay, Sweep};
use outmerge::target::{Extent, Framebuffer};
use outmerge::{Fragment, MergerState};
use wgpu_types::{
    BlendComponent, BlendState, CompareFunction, DepthBiasState, DepthStencilState, StencilFaceState, StencilOperation,
    StencilState, TextureFormat as T,
};

use crate::harness::{bytes, device, draw, run, single, targets};

fn depth_state(format: T, depth_compare: CompareFunction) -> DepthStencilState {
    DepthStencilState {
        format,
        depth_write_enabled: Some(true),
        depth_compare: Some(depth_compare),
        stencil: StencilState::default(),
        bias: DepthBiasState::default(),
    }
}

fn with_depth(format: T, depth_compare: CompareFunction) -> MergerState {
    MergerState { depth_stencil: Some(depth_state(format, depth_compare)), ..single(T::R8Unorm, None) }
}

fn set_depth(framebuffer: &mut Framebuffer, code: impl Fn(u32) -> u32) {
    let target = framebuffer.depth_stencil.as_mut().expect("a depth target");
    for (texel, depth) in (0..).zip(target.depth_mut()) {
        *depth = code(texel);
    }
}

fn depth(framebuffer: &Framebuffer) -> &[u32] {
    framebuffer.depth_stencil.as_ref().expect("a depth target").depth()
}

fn stencil(framebuffer: &Framebuffer) -> &[u8] {
    framebuffer.depth_stencil.as_ref().expect("a stencil target").stencil()
}

/// What a comparison says of the fragment's code and the stored one.
type Compare = fn(u32, u32) -> bool;

#[test]
fn depth_and_stencil_bytes_round_trip() {
    let Some(device) = device() else { return };
    let kinds = [
        (T::Depth16Unorm, 16),
        (T::Depth24Plus, 24),
        (T::Depth24PlusStencil8, 24),
        (T::Depth32Float, 32),
        (T::Depth32FloatStencil8, 32),
        (T::Stencil8, 0),
    ];
    for (format, bits) in kinds {
        if !device.renders(format) {
            println!("not run: the adapter does not render {format:?}");
            continue;
        }
        let state =
            MergerState { depth_stencil: Some(depth_state(format, CompareFunction::Always)), ..MergerState::default() };
        let mut initial = Framebuffer::for_state(Extent::new(67, 61).expect("legal"), &state).expect("targets");
        set_depth(&mut initial, |texel| match bits {
            32 => (f32::from(u16::try_from(texel).expect("small")) / 5000.0).to_bits(),
            bits => texel.wrapping_mul(2_654_435_761) >> (32 - bits),
        });
        let target = initial.depth_stencil.as_mut().expect("there");
        for (texel, value) in (0_usize..).zip(target.stencil_mut()) {
            *value = (texel * 7).to_le_bytes()[0];
        }
        let result = run(device, Batch { initial: initial.clone(), layers: Vec::new() });
        assert!(depth(&result) == depth(&initial), "{format:?}: depth");
        assert!(stencil(&result) == stencil(&initial), "{format:?}: stencil");
    }
}

/// With 2^24 codes in all, a chain of 2^24 strictly growing stored depths can only be 0, 1, 2, ...: so code k / (2^24 -
/// 1) is stored as k, and what the read-back tells is k too. The last two codes load alike and stay out.
#[test]
fn all_24_bit_depth_codes_but_the_last_are_stored_told_apart_and_read_back() {
    let Some(device) = device() else { return };
    let state = with_depth(T::Depth24Plus, CompareFunction::Greater);
    let (side, last) = (1024, 0x00ff_fffd);
    for block in 0..16 {
        let code = |texel: u32| (block * side * side + texel).min(last);
        let mut initial = targets(&state, side, side, |_| vec![0]);
        set_depth(&mut initial, code);
        // `run` reads the initial codes back and compares them; the draw then tells neighbours apart.
        let next = |texel: u32| Fragment::new([1.0; 4]).at_depth(unorm24((code(texel) + 1).min(last)));
        let result = draw(device, initial, state.clone(), (0..side * side).map(next).collect());
        for (texel, (passed, stored)) in (0..).zip(bytes(&result).iter().zip(depth(&result))) {
            let code = code(texel);
            assert_eq!(*passed, if code == last { 0 } else { 255 }, "code {code:#x} is below its successor");
            assert_eq!(*stored, if code == last { code } else { code + 1 }, "stored over {code:#x}");
        }
    }
}

/// The last two codes load alike, so nothing read back tells them apart; the depth test does. Four depths, each strictly
/// greater than the one before, of which the first is code 2^24 - 4 and the last 2^24 - 1, leave one code for each.
#[test]
fn the_two_last_24_bit_depth_codes_are_stored_apart() {
    let Some(device) = device() else { return };
    let one = BlendComponent { dst_factor: wgpu_types::BlendFactor::One, ..BlendComponent::REPLACE };
    let state = MergerState {
        depth_stencil: Some(depth_state(T::Depth24Plus, CompareFunction::Greater)),
        ..single(T::R8Unorm, Some(BlendState { color: one, alpha: one }))
    };
    let initial = targets(&state, 1, 1, |_| vec![0]);
    let depths = [unorm24(0x00ff_fffc), unorm24(0x00ff_fffd), f32::from_bits(0x3f7f_ffff), 1.0];
    assert_eq!(unorm24(0x00ff_fffe).to_bits(), 0x3f7f_ffff, "the float below 1");
    let layer = |z: f32| Layer::new(state.clone(), vec![Fragment::new([1.0 / 255.0; 4]).at_depth(z)]);
    let result = run(device, Batch { initial: initial.clone(), layers: depths.map(layer).to_vec() });
    assert_eq!(bytes(&result), [4], "each of the four passes `Greater` after the one before");
    let first = run(device, Batch { initial, layers: vec![layer(depths[0])] });
    assert_eq!(depth(&first), [0x00ff_fffc], "where the chain starts");
}

/// The binary32 number nearest to k / (2^24 - 1).
fn unorm24(k: u32) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to nearest is meant")]
    fn narrow(x: f64) -> f32 {
        x as f32
    }
    narrow(f64::from(k) / f64::from(0x00ff_ffff_u32))
}

#[test]
fn every_16_bit_depth_code_is_stored_by_its_value() {
    let Some(device) = device() else { return };
    let state = MergerState {
        depth_stencil: Some(depth_state(T::Depth16Unorm, CompareFunction::Always)),
        ..MergerState::default()
    };
    let extent = Extent::new(256, 256).expect("legal");
    let mut sweep = Sweep::new(device, Framebuffer::for_state(extent, &state).expect("targets")).expect("a sweep");
    let table: Vec<f32> = (0..=u16::MAX).map(|k| f32::from(k) / 65535.0).collect();
    let depth = Some(Input::Table { divisor: 1, modulus: 65536, add: 0 });
    let fragments = sweep.program(Program { depth, ..Program::default() }, &table).expect("a program");
    let job = Job {
        state: &state,
        fragments: &fragments,
        first: 0,
        destination: Destination::LeftOver,
        unclipped_depth: false,
    };
    let mut codes = Vec::new();
    sweep
        .run([job], |_, outcome| {
            codes = outcome.depth();
            ControlFlow::Continue(())
        })
        .expect("swept");
    assert!(codes.into_iter().eq(0..65536), "k / 65535 stores k");
}

#[test]
fn the_depth_test_compares_and_writes() {
    let Some(device) = device() else { return };
    use CompareFunction as C;
    let compares: [(C, Compare); 8] = [
        (C::Never, |_, _| false),
        (C::Less, |new, old| new < old),
        (C::Equal, |new, old| new == old),
        (C::LessEqual, |new, old| new <= old),
        (C::Greater, |new, old| new > old),
        (C::NotEqual, |new, old| new != old),
        (C::GreaterEqual, |new, old| new >= old),
        (C::Always, |_, _| true),
    ];
    let (new, old) = (|texel: u32| 100 * (texel % 16), |texel: u32| 100 * (texel / 16));
    for (compare, holds) in compares {
        let state = with_depth(T::Depth16Unorm, compare);
        let mut initial = targets(&state, 16, 16, |_| vec![0]);
        set_depth(&mut initial, old);
        let z = |texel: u32| f32::from(u16::try_from(new(texel)).expect("small")) / 65535.0;
        let fragments = (0..256).map(|texel| Fragment::new([1.0; 4]).at_depth(z(texel))).collect();
        let result = draw(device, initial, state, fragments);
        for texel in 0..256_u32 {
            let passes = holds(new(texel), old(texel));
            let index = texel as usize;
            assert_eq!(bytes(&result)[index], if passes { 255 } else { 0 }, "{compare:?}, texel {texel}: color");
            let wanted = if passes { new(texel) } else { old(texel) };
            assert_eq!(depth(&result)[index], wanted, "{compare:?}, texel {texel}: depth");
        }
    }
}

#[test]
fn stencil_references_and_faces_apply_texel_by_texel() {
    let Some(device) = device() else { return };
    let face = |pass_op| StencilFaceState { compare: CompareFunction::Always, pass_op, ..StencilFaceState::IGNORE };
    let mut state = with_depth(T::Depth24PlusStencil8, CompareFunction::Always);
    if let Some(depth_stencil) = &mut state.depth_stencil {
        depth_stencil.stencil = StencilState {
            front: face(StencilOperation::Replace),
            back: face(StencilOperation::IncrementWrap),
            read_mask: 0xff,
            write_mask: 0xff,
        };
    }
    let mut initial = targets(&state, 16, 16, |_| vec![0]);
    initial.depth_stencil.as_mut().expect("there").stencil_mut().fill(255);
    let fragments = (0..256).map(|texel| Fragment { front_facing: texel % 3 != 0, ..Fragment::new([1.0; 4]) });
    let references: Vec<u8> = (0..=255).map(|texel: u8| texel / 64 * 10).collect();
    let mut layer = Layer::new(state, fragments.collect());
    layer.stencil_references = Some(references.clone());
    let result = run(device, Batch { initial, layers: vec![layer] });
    for (texel, got) in stencil(&result).iter().enumerate() {
        let wanted = if texel % 3 == 0 { 0 } else { references[texel] };
        assert_eq!(*got, wanted, "texel {texel}: back faces wrap 255 to 0, front faces store the reference");
    }
    assert!(bytes(&result).iter().all(|byte| *byte == 255), "every texel drawn exactly where it is");
}

#[test]
fn depth_bias_applies_to_rasterised_depth_alone() {
    let Some(device) = device() else { return };
    let mut state = with_depth(T::Depth16Unorm, CompareFunction::Always);
    if let Some(depth_stencil) = &mut state.depth_stencil {
        depth_stencil.bias.constant = 5;
    }
    let fragments: Vec<_> = (0..64).map(|_| Fragment::new([1.0; 4]).at_depth(1000.0 / 65535.0)).collect();
    let drawn = [DepthSource::Shader, DepthSource::Rasteriser].map(|depth_source| {
        let layer = Layer { depth_source, ..Layer::new(state.clone(), fragments.clone()) };
        let initial = targets(&state, 8, 8, |_| vec![0]);
        Replay::new(device).run(&Batch { initial, layers: vec![layer] }).expect("replayed")
    });
    assert!(depth(&drawn[0]).iter().all(|code| *code == 1000), "shader depth: {:?}", depth(&drawn[0]));
    // The unit of the constant is at most 2 * 2^-16 (Vulkan, Depth Bias: minimum resolvable difference); lavapipe takes
    // just that.
    let biased = depth(&drawn[1])[0];
    assert!((1005..=1010).contains(&biased), "rasterised depth: {biased}");
    assert!(depth(&drawn[1]).iter().all(|code| *code == biased), "the same at every texel: {:?}", depth(&drawn[1]));
}
