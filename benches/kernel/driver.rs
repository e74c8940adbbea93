//! lavapipe doing the same draws, through its real output merger.

use std::ops::ControlFlow;
use std::time::Instant;

use outmerge::crosscheck::{Destination, Device, Input, Job, OpenOptions, Program, Sweep};
use outmerge::{Extent, Framebuffer, MergerState};
use wgpu_types::{BlendState, TextureFormat};

use super::cases::{bytes, kernel, target};

/// Draws over a target; the first is not timed, for it builds the pipeline.
const DRAWS: u32 = 33;

/// Prints the table, or why there is none.
pub fn run() {
    let options = OpenOptions { adapter: Some("llvmpipe".to_owned()), ..OpenOptions::default() };
    let device = match Device::open(&options) {
        Ok(device) => device,
        Err(error) => return println!("\nnot run: lavapipe: {error}"),
    };
    println!("\nThe driver: {}, nanoseconds of processor time, all threads together\n", device.report());
    println!("| case | size | lavapipe | `llvmpipe` kernel | lavapipe takes | wrong |\n|---|---|---|---|---|---|");
    for size in [256, 1024, 2048] {
        for (name, blend) in [
            ("straight over", BlendState::ALPHA_BLENDING),
            ("premultiplied over", BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        ] {
            compare(&device, name, blend, size);
        }
    }
}

/// The source of texel number n, a code in each channel.
const SOURCE: [(u32, u32); 4] = [(1, 0), (3, 1), (7, 2), (256, 3)];

fn compare(device: &Device, name: &str, blend: BlendState, size: u32) {
    let pixels = (size * size) as usize;
    let state = MergerState::single(target(TextureFormat::Rgba8Unorm, blend));
    let mut targets = Framebuffer::for_state(Extent::new(size, size).expect("a size"), &state).expect("memory");
    let before = bytes(4 * pixels, 2);
    targets.colors[0].as_mut().expect("a target").bytes_mut().copy_from_slice(&before);
    let mut sweep = Sweep::new(device, targets).expect("a sweep");
    let outputs = SOURCE.map(|(divisor, add)| Input::Unorm8 { divisor, modulus: 256, add });
    let program = Program { outputs: vec![outputs], second_source: None, depth: None };
    let fragments = sweep.program(program, &[]).expect("fragments");
    let jobs = (0..DRAWS).map(|number| Job {
        state: &state,
        fragments: &fragments,
        first: 0,
        destination: if number == 0 { Destination::Restored } else { Destination::LeftOver },
        unclipped_depth: false,
    });
    let (mut first, mut started) = (Vec::new(), None);
    sweep
        .run(jobs, |number, outcome| {
            if number == 0 {
                first = outcome.color(0).to_vec();
                started = processor_seconds();
            }
            ControlFlow::Continue(())
        })
        .expect("swept");
    let src: Vec<u8> = (0..size * size)
        .flat_map(|n| SOURCE.map(|(divisor, add)| (n / divisor % 256 + add).min(255).to_le_bytes()[0]))
        .collect();
    let merged = |model: &str| {
        let mut dst = before.clone();
        kernel(TextureFormat::Rgba8Unorm, blend, model).merge_row(&src, None, None, &mut dst);
        dst
    };
    assert!(merged("llvmpipe") == first, "the model stores what the driver does");
    let exact = merged("exact");
    let wrong = first.chunks_exact(4).zip(exact.chunks_exact(4)).filter(|(a, b)| a != b).count();
    let ours = kernel(TextureFormat::Rgba8Unorm, blend, "llvmpipe");
    let mut dst = before.clone();
    let mut kernel_time = f64::INFINITY;
    for _ in 0..20 {
        let run = Instant::now();
        ours.merge_row(&src, None, None, std::hint::black_box(&mut dst));
        kernel_time = kernel_time.min(run.elapsed().as_secs_f64() * 1e9 / pixels as f64);
    }
    let Some(driver) = started.zip(processor_seconds()).map(|(from, to)| to - from) else {
        return println!("| {name} | {size}^2 | not run: no processor times here | {kernel_time:.3} | | |");
    };
    let driver = driver * 1e9 / (f64::from(DRAWS - 1) * pixels as f64);
    println!(
        "| {name} | {size}^2 | {driver:.2} | {kernel_time:.3} | {:.0} times as long | {:.3} % |",
        driver / kernel_time,
        100.0 * wrong as f64 / pixels as f64
    );
}

/// Processor time of this process so far, user and system; `None` where there is no `/proc`.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields 14 and 15, in ticks of 10 ms; the name before them may hold spaces but ends with the last bracket.
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}
