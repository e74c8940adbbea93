//! Texels a second through a real output merger, by kind of sweep; needs a Vulkan adapter.
//!
//! Run with `cargo bench --all-features --bench device -- [ADAPTER]`. "Wait" counts only the read-back's arrival, so
//! it is the driver's speed; "sum" also adds up the bytes on the host. In brackets, where the system tells: per second
//! of processor time, all threads together, which for a software driver does not depend on what else runs.

use std::ops::ControlFlow;
use std::time::Instant;

use outmerge::crosscheck::{Destination, Device, Input, Job, OpenOptions, Program, Sources, Sweep};
use outmerge::{Extent, Framebuffer, MergerState};
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation, BlendState, ColorTargetState, ColorWrites};
use wgpu_types::{CompareFunction, DepthStencilState, TextureFormat as T};

const JOBS: u32 = 48;

fn color(format: T, blended: bool) -> MergerState {
    let component =
        BlendComponent { src_factor: F::SrcAlpha, dst_factor: F::OneMinusSrcAlpha, operation: BlendOperation::Add };
    let blend = blended.then_some(BlendState { color: component, alpha: component });
    MergerState::single(ColorTargetState { format, blend, write_mask: ColorWrites::ALL })
}

fn depth(format: T) -> MergerState {
    MergerState {
        depth_stencil: Some(DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Always),
            stencil: wgpu_types::StencilState::default(),
            bias: wgpu_types::DepthBiasState::default(),
        }),
        ..MergerState::default()
    }
}

/// Every (s, d, sa, da): s and sa from the texel's number, d and da from the destination's bytes.
fn codes() -> Program {
    let s = Input::Unorm8 { divisor: 1 << 16, modulus: 256, add: 0 };
    let sa = Input::Unorm8 { divisor: 1 << 24, modulus: 256, add: 0 };
    Program { outputs: vec![[s, s, s, sa]], second_source: None, depth: Some(s) }
}

fn raw() -> Program {
    let input = |add| Input::Number { stride: 4, add };
    Program {
        outputs: vec![[input(0), input(1), input(2), input(3)]],
        second_source: None,
        depth: Some(Input::Number { stride: 1, add: 0 }),
    }
}

fn main() {
    let adapter = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let device = Device::open(&OpenOptions { adapter, ..OpenOptions::default() });
    let device = match device {
        Ok(device) => device,
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(2);
        }
    };
    println!("{}", device.report());
    for side in [256, 1024, 2048] {
        for (name, state, program, destination) in [
            ("rgba8unorm over, codes", color(T::Rgba8Unorm, true), Some(codes()), Destination::Restored),
            ("rgba8unorm over, uploaded", color(T::Rgba8Unorm, true), None, Destination::Restored),
            ("rgba8unorm store, raw bits", color(T::Rgba8Unorm, false), Some(raw()), Destination::LeftOver),
            ("rgba8unorm-srgb over, uploaded", color(T::Rgba8UnormSrgb, true), None, Destination::Restored),
            ("rgba16float over, uploaded", color(T::Rgba16Float, true), None, Destination::Restored),
            ("depth16unorm, raw bits", depth(T::Depth16Unorm), Some(raw()), Destination::LeftOver),
            ("depth24plus, raw bits", depth(T::Depth24Plus), Some(raw()), Destination::LeftOver),
            ("depth32float, raw bits", depth(T::Depth32Float), Some(raw()), Destination::LeftOver),
        ] {
            measure(&device, side, name, &state, program, destination);
        }
    }
}

fn measure(
    device: &Device,
    side: u32,
    name: &str,
    state: &MergerState,
    program: Option<Program>,
    destination: Destination,
) {
    let extent = Extent::new(side, side).expect("a legal extent");
    let targets = Framebuffer::for_state(extent, state).expect("targets");
    let mut sweep = Sweep::new(device, targets).expect("a sweep");
    let fragments = match program {
        Some(program) => sweep.program(program, &[]),
        None => sweep.upload(&Sources {
            outputs: vec![vec![[0.3, 0.6, 0.9, 0.4]; extent.sample_total()]],
            ..Sources::default()
        }),
    }
    .expect("fragments");
    let mut line = format!("{side:>5}^2  {name:<32}");
    for sum in [false, true] {
        let jobs = (0..JOBS).map(|number| Job {
            state,
            fragments: &fragments,
            first: number.wrapping_mul(side * side),
            destination,
            unclipped_depth: false,
        });
        let mut started: Option<(Instant, Option<f64>)> = None;
        let mut total = 0_u64;
        sweep
            .run(jobs, |_, outcome| {
                // The first job pays for the pipeline.
                started.get_or_insert_with(|| (Instant::now(), processor_seconds()));
                if sum {
                    total += outcome.color(0).iter().map(|byte| u64::from(*byte)).sum::<u64>();
                    total += outcome.depth().iter().map(|code| u64::from(*code)).sum::<u64>();
                }
                ControlFlow::Continue(())
            })
            .expect("swept");
        let (wall, processor) = started.expect("some job");
        let texels = f64::from(JOBS - 1) * f64::from(side) * f64::from(side) / 1e6;
        let spent = processor.zip(processor_seconds()).map(|(from, to)| texels / (to - from).max(0.01));
        let spent = spent.map_or(String::new(), |rate| format!(" [{rate:6.1}]"));
        let rate = texels / wall.elapsed().as_secs_f64();
        line += &format!("  {}: {rate:6.1}{spent} Mtexel/s", if sum { "sum" } else { "wait" });
        std::hint::black_box(total);
    }
    println!("{line}");
}

/// Processor time of this process so far, user and system; `None` where there is no `/proc`.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields 14 and 15, in ticks of 10 ms; the name before them may hold spaces but ends with the last bracket.
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}
