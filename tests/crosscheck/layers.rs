//! Laws of drawing that hold on every conforming device.

use outmerge::crosscheck::{Batch, Device, Layer, Replay, ReplayError};
use outmerge::state::Rect;
use outmerge::{AlphaTest, Fragment};
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState, CompareFunction, TextureFormat as T};

use crate::harness::{bytes, device, draw, options, run, single, targets};

fn blend(src_factor: BlendFactor, dst_factor: BlendFactor) -> Option<BlendState> {
    let component = BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add };
    Some(BlendState { color: component, alpha: component })
}

fn unorm8(code: usize) -> f32 {
    f32::from(u8::try_from(code % 256).expect("below 256")) / 255.0
}

fn pattern(texel: usize) -> Vec<u8> {
    let start = u8::try_from(texel % 251).expect("below 251");
    (0..16_u8).map(|i| start.wrapping_mul(7).wrapping_add(i.wrapping_mul(37))).collect()
}

#[test]
fn an_unblended_store_of_k_over_255_gives_k() {
    let Some(device) = device() else { return };
    let state = single(T::Rgba8Unorm, None);
    let fragments = (0..256).map(|k| Fragment::new([unorm8(k), unorm8(k + 1), unorm8(k + 2), unorm8(k + 3)])).collect();
    let result = draw(device, targets(&state, 16, 16, |_| vec![0x55; 4]), state, fragments);
    for (k, texel) in bytes(&result).chunks_exact(4).enumerate() {
        let wanted: Vec<u8> = (k..k + 4).map(|k| u8::try_from(k % 256).expect("below 256")).collect();
        assert_eq!(texel, wanted, "texel {k}");
    }
}

#[test]
fn one_zero_equals_blending_off() {
    let Some(device) = device() else { return };
    let fragments: Vec<_> =
        (0..256).map(|k| Fragment::new([unorm8(k), unorm8(3 * k), unorm8(7 * k), unorm8(k)])).collect();
    let results = [None, blend(BlendFactor::One, BlendFactor::Zero)].map(|blend| {
        let state = single(T::Rgba8Unorm, blend);
        draw(device, targets(&state, 16, 16, pattern), state, fragments.clone())
    });
    assert_eq!(bytes(&results[0]), bytes(&results[1]), "one/zero stores the source");
}

#[test]
fn zero_one_keeps_bytes() {
    let Some(device) = device() else { return };
    let state = single(T::Rgba8Unorm, blend(BlendFactor::Zero, BlendFactor::One));
    let initial = targets(&state, 33, 7, pattern);
    let result = draw(device, initial.clone(), state, vec![Fragment::new([0.3, 0.6, 0.9, 0.5]); 33 * 7]);
    assert_eq!(bytes(&result), bytes(&initial), "zero/one keeps the target");
}

#[test]
fn discarded_and_uncovered_fragments_leave_their_texels_alone() {
    let Some(device) = device() else { return };
    let state = single(T::Rgba8Unorm, None);
    let initial = targets(&state, 19, 11, pattern);
    let fragments = (0..19 * 11).map(|k| Fragment {
        discarded: k % 3 == 0,
        coverage: if k % 5 == 0 { 0 } else { 1 },
        ..Fragment::new([1.0; 4])
    });
    let result = draw(device, initial.clone(), state, fragments.collect());
    for (k, (after, before)) in bytes(&result).chunks_exact(4).zip(bytes(&initial).chunks_exact(4)).enumerate() {
        let wanted = if k % 3 == 0 || k % 5 == 0 { before } else { &[255; 4] };
        assert_eq!(after, wanted, "texel {k}");
    }
}

#[test]
fn the_alpha_test_drops_what_fails_it() {
    let Some(device) = device() else { return };
    let mut state = single(T::Rgba8Unorm, None);
    state.alpha_test = AlphaTest::On { compare: CompareFunction::GreaterEqual, reference: 0.5 };
    let initial = targets(&state, 16, 16, |_| vec![9; 4]);
    let alpha = |k: usize| if k == 7 { f32::NAN } else { unorm8(k) };
    let fragments = (0..256).map(|k| Fragment::new([1.0, 1.0, 1.0, alpha(k)])).collect();
    let result = draw(device, initial, state, fragments);
    for (k, texel) in bytes(&result).chunks_exact(4).enumerate() {
        assert_eq!(texel[0], if k >= 128 { 255 } else { 9 }, "alpha {k}/255");
    }
}

#[test]
fn layers_are_drawn_in_order_in_one_pass() {
    let Some(device) = device() else { return };
    let state = single(T::Rgba8Unorm, None);
    let over = single(T::Rgba8Unorm, blend(BlendFactor::One, BlendFactor::One));
    let layer = |state: &outmerge::MergerState, red: f32| {
        Layer::new(state.clone(), vec![Fragment::new([red / 255.0, 0.0, 0.0, 0.0]); 64])
    };
    let initial = targets(&state, 8, 8, |_| vec![200; 4]);
    let layers = vec![layer(&over, 100.0), layer(&state, 3.0), layer(&over, 40.0), layer(&over, 50.0)];
    let result = run(device, Batch { initial, layers });
    assert!(bytes(&result).chunks_exact(4).all(|texel| texel == [93, 0, 0, 0]), "3 + 40 + 50, the first layer covered");
}

#[test]
fn the_scissor_bounds_the_draw_even_when_it_leaves_the_target() {
    let Some(device) = device() else { return };
    let mut state = single(T::R8Unorm, None);
    state.dynamic.scissor = Some(Rect { x: 3, y: 2, width: 100, height: 4 });
    let result = draw(device, targets(&state, 8, 8, |_| vec![7]), state, vec![Fragment::new([1.0; 4]); 64]);
    for (k, byte) in bytes(&result).iter().enumerate() {
        let inside = k % 8 >= 3 && (2..6).contains(&(k / 8));
        assert_eq!(*byte, if inside { 255 } else { 7 }, "texel {k}");
    }
}

#[test]
fn the_second_source_reaches_the_blender() {
    let Some(device) = device() else { return };
    let state = single(T::Rgba8Unorm, blend(BlendFactor::Zero, BlendFactor::Src1));
    let batch = Batch {
        initial: targets(&state, 4, 4, |_| vec![255; 4]),
        layers: vec![Layer::new(state, vec![Fragment::new([0.5; 4]).with_src1([0.0, 0.2, 0.4, 1.0]); 16])],
    };
    match Replay::new(device).run(&batch) {
        Ok(result) => assert_eq!(bytes(&result)[..4], [0, 51, 102, 255], "destination times second source"),
        Err(ReplayError::MissingFeature { feature, .. }) => {
            assert_eq!(feature, "DUAL_SOURCE_BLENDING", "the one feature needed")
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn several_targets_are_written_each_by_its_own_state() {
    let Some(device) = device() else { return };
    let mut state = single(T::Rgba8Unorm, None);
    state.targets.push(None);
    state.targets.extend(single(T::Rgba16Float, None).targets);
    state.targets.extend(single(T::R8Unorm, blend(BlendFactor::One, BlendFactor::One)).targets);
    let mut fragment = Fragment::new([1.0, 0.0, 0.2, 0.4]);
    fragment.outputs[1] = [f32::NAN; 4];
    fragment.outputs[2] = [1.0, -2.0, 0.5, f32::INFINITY];
    fragment.outputs[3] = [10.0 / 255.0, 0.0, 0.0, 0.0];
    let result = draw(device, targets(&state, 5, 3, |_| vec![60; 16]), state, vec![fragment; 15]);
    let at = |index: usize| result.colors[index].as_ref().expect("a target").codes(4, 2, 0);
    assert_eq!(at(0), [255, 0, 51, 102], "target 0");
    assert!(result.colors[1].is_none(), "location 1 is unused");
    assert_eq!(at(2), [0x3c00, 0xc000, 0x3800, 0x7c00], "target 2");
    assert_eq!(at(3), [70, 0, 0, 0], "target 3");
}

#[test]
fn a_layer_of_the_wrong_size_is_refused() {
    let Some(device) = device() else { return };
    let state = single(T::R8Unorm, None);
    let batch = Batch { initial: targets(&state, 4, 4, |_| vec![0]), layers: vec![Layer::new(state, Vec::new())] };
    let error = Replay::new(device).run(&batch).expect_err("no fragments for 16 texels");
    assert_eq!(error, ReplayError::LayerSize { layer: 0, what: "fragments", expected: 16, got: 0 }, "{error}");
}

#[test]
fn what_wgpu_refuses_is_an_error_and_the_device_lives_on() {
    if device().is_none() {
        return;
    }
    // Its own device: faults are noted per device, and other tests run beside this one.
    let device = &Device::open(&options()).expect("a second device");
    let mut bad = single(T::Rgba8Unorm, None);
    bad.dynamic.depth_range = [0.9, 0.1];
    let good = single(T::Rgba8Unorm, None);
    let batch = |state: &outmerge::MergerState| Batch {
        initial: targets(state, 4, 4, |_| vec![0; 4]),
        layers: vec![Layer::new(state.clone(), vec![Fragment::new([1.0; 4]); 16])],
    };
    let mut replay = Replay::new(device);
    let error = replay.run(&batch(&bad)).expect_err("a reversed depth range");
    assert!(error.to_string().contains("wgpu refused"), "{error}");
    let result = replay.run(&batch(&good)).expect("the next batch");
    assert_eq!(bytes(&result)[0], 255, "drawn");
}
