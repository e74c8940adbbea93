//! The fast path says what the plain replay says, and its programs compute what the host computes.

use std::ops::ControlFlow;

use outmerge::crosscheck::{Batch, Destination, Input, Job, Layer, Program, Replay, ReplayError, Sources, Sweep};
use outmerge::{AlphaTest, Fragment, MergerState};
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, BlendState, CompareFunction, TextureFormat as T};

use crate::harness::{bytes, device, single, targets};

const WIDTH: u32 = 256;
const HEIGHT: u32 = 16;
const TEXELS: u32 = WIDTH * HEIGHT;

fn blend(src_factor: F, dst_factor: F) -> BlendState {
    let component = BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add };
    BlendState { color: component, alpha: component }
}

/// A reproducible mess of values.
fn noise(seed: u32) -> f32 {
    let mixed = (seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995).wrapping_mul(0x85eb_ca6b) >> 8;
    f32::from(u16::try_from(mixed & 0xffff).expect("16 bits")) / 50000.0 - 0.1
}

fn mess(texel: usize) -> Vec<u8> {
    (0..16_usize).map(|i| ((texel * 31 + i * 57) % 256).to_le_bytes()[0]).collect()
}

fn job<'j>(state: &'j MergerState, fragments: &'j outmerge::crosscheck::Fragments) -> Job<'j> {
    Job { state, fragments, first: 0, destination: Destination::Restored, unclipped_depth: false }
}

#[test]
fn a_sweep_over_states_equals_the_replay_of_each() {
    let Some(device) = device() else { return };
    let mut states: Vec<MergerState> =
        [(F::SrcAlpha, F::OneMinusSrcAlpha), (F::One, F::One), (F::Constant, F::Dst), (F::Zero, F::One)]
            .map(|(src, dst)| single(T::Rgba8Unorm, Some(blend(src, dst))))
            .to_vec();
    states[2].dynamic.blend_constant = [0.25, 0.5, 0.75, 1.0];
    states.push(single(T::Rgba8Unorm, None));
    let colors: Vec<[f32; 4]> = (0..TEXELS).map(|n| [0, 1, 2, 3].map(|c| noise(4 * n + c))).collect();
    let discarded: Vec<bool> = (0..TEXELS).map(|n| n % 7 == 0).collect();
    let initial = targets(&states[0], WIDTH, HEIGHT, mess);
    let mut sweep = Sweep::new(device, initial.clone()).expect("a sweep");
    let sources = Sources {
        outputs: vec![colors.clone()],
        // More than these states read: records may hold more than is written.
        second_source: Some(colors.clone()),
        depth: None,
        discarded: Some(discarded.clone()),
    };
    let fragments = sweep.upload(&sources).expect("uploaded");
    let mut seen = Vec::new();
    sweep
        .run(states.iter().map(|state| job(state, &fragments)), |number, outcome| {
            seen.push((number, outcome.color(0).to_vec()));
            ControlFlow::Continue(())
        })
        .expect("swept");
    assert_eq!(seen.len(), states.len(), "one outcome a job");
    for (index, state) in states.into_iter().enumerate() {
        let fragment =
            |(color, discarded): (&[f32; 4], &bool)| Fragment { discarded: *discarded, ..Fragment::new(*color) };
        let layer = Layer::new(state, colors.iter().zip(&discarded).map(fragment).collect());
        let batch = Batch { initial: initial.clone(), layers: vec![layer] };
        let replayed = Replay::new(device).run(&batch).expect("replayed");
        assert_eq!(seen[index].0, index, "in order");
        assert!(seen[index].1 == bytes(&replayed), "state {index} differs from its replay");
    }
}

#[test]
fn programs_compute_on_the_device_what_they_compute_on_the_host() {
    let Some(device) = device() else { return };
    let mut state = single(T::Rgba32Float, None);
    state.targets.push(state.targets[0].clone());
    let mut sweep = Sweep::new(device, targets(&state, WIDTH, HEIGHT, |_| vec![0; 16])).expect("a sweep");
    let table: Vec<f32> = (0..300_u16).map(|k| f32::from(k) / 255.0).collect();
    let program = Program {
        outputs: vec![
            [
                Input::Number { stride: 4, add: 0x7f80_0001 },
                Input::Table { divisor: 256, modulus: 86, add: 172 },
                Input::Table { divisor: 3, modulus: 1000, add: 0 },
                Input::Bits(0xffc0_1234),
            ],
            [
                Input::Unorm8 { divisor: 1, modulus: 256, add: 0 },
                Input::Unorm8 { divisor: 5, modulus: 86, add: 172 },
                Input::Unorm8 { divisor: 256, modulus: 256, add: 1 },
                Input::Bits(0),
            ],
        ],
        second_source: None,
        depth: None,
    };
    let fragments = sweep.program(program.clone(), &table).expect("a program");
    let firsts = [0, 4096, u32::MAX - 100];
    let jobs = firsts.map(|first| Job { first, destination: Destination::LeftOver, ..job(&state, &fragments) });
    sweep
        .run(jobs, |number, outcome| {
            for location in [0, 1] {
                for (texel, got) in (0..TEXELS).zip(outcome.color(location).chunks_exact(16)) {
                    let n = firsts[number].wrapping_add(texel);
                    let wanted = program.fragment(n, &table).outputs[location].map(f32::to_le_bytes).concat();
                    assert_eq!(got, wanted, "texel number {n}, location {location}");
                }
            }
            ControlFlow::Continue(())
        })
        .expect("swept");
}

#[test]
fn a_sweep_stops_when_told_and_can_go_on() {
    let Some(device) = device() else { return };
    let state = single(T::R8Unorm, None);
    let mut sweep = Sweep::new(device, targets(&state, WIDTH, 1, |_| vec![0])).expect("a sweep");
    let program = Program { outputs: vec![[Input::Bits(0x3f80_0000); 4]], ..Program::default() };
    let fragments = sweep.program(program, &[]).expect("a program");
    for stop_at in [0, 3, 1] {
        let mut count = 0;
        sweep
            .run(std::iter::repeat_n(job(&state, &fragments), 5), |number, outcome| {
                count += 1;
                assert_eq!(outcome.color(0)[0], 255, "drawn");
                if number == stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .expect("swept");
        assert_eq!(count, stop_at + 1, "no outcome after the break");
    }
}

#[test]
fn jobs_that_do_not_fit_are_refused() {
    let Some(device) = device() else { return };
    let state = single(T::R8Unorm, None);
    let error = Sweep::new(device, targets(&state, 100, 1, |_| vec![0])).expect_err("100 is no multiple of 256");
    assert_eq!(error, ReplayError::SweepWidth { width: 100, multiple: 256 }, "{error}");
    let mut sweep = Sweep::new(device, targets(&state, WIDTH, 1, |_| vec![0])).expect("a sweep");
    let short = Sources { outputs: vec![vec![[0.0; 4]; 3]], ..Sources::default() };
    assert_eq!(sweep.upload(&short).expect_err("3 of 256"), ReplayError::SweepSize { expected: 256, got: 3 }, "short");
    let none = sweep.program(Program::default(), &[]).expect("a program without outputs");
    let error = sweep.run([job(&state, &none)], |_, _| ControlFlow::Continue(())).expect_err("no output");
    assert_eq!(error, ReplayError::SweepInput("an output for every color target"), "{error}");
    let mut tested = state.clone();
    tested.alpha_test = AlphaTest::On { compare: CompareFunction::Less, reference: 0.5 };
    let error = sweep.run([job(&tested, &none)], |_, _| ControlFlow::Continue(())).expect_err("an alpha test");
    assert!(error.to_string().contains("alpha test"), "{error}");
}
