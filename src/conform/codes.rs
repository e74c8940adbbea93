//! Every 8-bit input of states on rgba8unorm.
//!
//! Shader outputs are k / 255, which store as code k. Red, green and blue carry three source codes at a time: s, s + 86 and
//! s + 172 (255 at most) for s from 0 to 85, so a plane of 86 x 256 x 256 texels goes through every source code, every
//! destination code and one further input.

use std::ops::ControlFlow;

use wgpu_types::{BlendComponent, BlendFactor, BlendState, ColorTargetState, ColorWrites, TextureFormat};

use super::level::{component_name, equal_states};
use super::run::{Compared, Subject, Tally, compare, texel};
use crate::crosscheck::{Destination, Device, Fragments, Input, Job, Program, ReplayError, Sweep};
use crate::format::{Codes, ColorFormat};
use crate::kernel::Kernel;
use crate::model::ColorInputs;
use crate::model::llvmpipe::integer::merge_codes8;
use crate::state::{MergerState, reads_second_source};
use crate::target::{Extent, Framebuffer};

/// Source codes go in steps of this between red, green and blue.
const THIRD: u32 = 86;

/// The values k / 255; longer indices stay at the last.
fn table() -> Vec<f32> {
    (0..=255_u8).map(|k| f32::from(k) / 255.0).collect()
}

/// The code a table input stores for texel number n.
fn code(input: Input, n: u32) -> u32 {
    match input {
        Input::Table { divisor, modulus, add } => ((n / divisor) % modulus + add).min(255),
        Input::Bits(_) | Input::Number { .. } | Input::Unorm8 { .. } => 0,
    }
}

fn look_up(divisor: u32, modulus: u32, add: u32) -> Input {
    Input::Table { divisor, modulus, add }
}

/// Three sources for each number n / `divisor` mod 86, with this alpha.
fn sources(divisor: u32, alpha: Input) -> [Input; 4] {
    let third = |i| look_up(divisor, THIRD, i * THIRD);
    [third(0), third(1), third(2), alpha]
}

/// A target whose texel number n holds n mod 256 in R, G and B and (n / 256) mod 256 in A.
fn destination(extent: Extent, state: &MergerState) -> Result<Framebuffer, ReplayError> {
    let mut framebuffer = Framebuffer::for_state(extent, state)?;
    if let Some(Some(target)) = framebuffer.colors.first_mut() {
        for (n, texel) in target.bytes_mut().chunks_exact_mut(4).enumerate() {
            let [d, alpha, ..] = n.to_le_bytes();
            texel.copy_from_slice(&[d, d, d, alpha]);
        }
    }
    Ok(framebuffer)
}

/// What texel number n holds before.
fn stored(n: u32) -> Codes {
    let [d, alpha, ..] = n.to_le_bytes();
    [u32::from(d), u32::from(d), u32::from(d), u32::from(alpha)]
}

fn merger_state(blend: BlendState) -> MergerState {
    MergerState::single(ColorTargetState {
        format: TextureFormat::Rgba8Unorm,
        blend: Some(blend),
        write_mask: ColorWrites::ALL,
    })
}

/// One draw over a plane: its state, inputs as functions of the texel's number, constant, and first number.
struct Draw<'a> {
    state: &'a MergerState,
    source: [Input; 4],
    second: [Input; 4],
    constant: u32,
    first: u32,
}

impl Draw<'_> {
    fn expected(&self, subject: &Subject, format: ColorFormat, blend: &BlendState, i: usize) -> Codes {
        let n = self.first + u32::try_from(i).unwrap_or(u32::MAX);
        let codes = |inputs: [Input; 4]| inputs.map(|input| code(input, n));
        let (src, src1, dst) = (codes(self.source), codes(self.second), stored(n));
        if let Some(llvmpipe) = subject.llvmpipe {
            return merge_codes8(llvmpipe.generation, blend, src, src1, [self.constant; 4], dst);
        }
        let output = |codes: Codes| codes.map(|code| u8::try_from(code).map_or(1.0, |code| f32::from(code) / 255.0));
        subject.model.merge_color(&ColorInputs {
            format,
            blend: Some(*blend),
            constant: output([self.constant; 4]),
            src: output(src),
            src1: output(src1),
            dst,
        })
    }
}

/// Texels of a run: destination codes 0 to 255, over which no source changes.
const RUN: usize = 256;

/// A draw's rows by a model's kernel, which is proven to be the model (`tests/kernel`) and a hundred times as fast.
struct Rows<'a> {
    kernel: Kernel,
    draw: &'a Draw<'a>,
}

impl<'a> Rows<'a> {
    /// `None` without a kernel.
    fn new(draw: &'a Draw<'a>, subject: &Subject) -> Option<Self> {
        let changes_in_runs = |input: &Input| match input {
            Input::Table { divisor, modulus, .. } => *modulus > 1 && divisor % 256 != 0,
            Input::Bits(_) | Input::Number { .. } | Input::Unorm8 { .. } => true,
        };
        if draw.source.iter().chain(&draw.second).any(changes_in_runs) {
            return None;
        }
        let target = draw.state.targets.first()?.as_ref()?;
        let kernel = Kernel::new(target, draw.state.dynamic.blend_constant, &*subject.model)?;
        Some(Self { kernel, draw })
    }

    /// Whether the device's run of texels that starts at texel `start` holds the kernel's bytes.
    fn are(&self, start: usize, got: &[u8]) -> bool {
        let n = self.draw.first + u32::try_from(start).unwrap_or(u32::MAX);
        let byte = |input: Input| u8::try_from(code(input, n)).unwrap_or(u8::MAX);
        let spread = |inputs: [Input; 4]| {
            let texel = inputs.map(byte);
            let mut row = [0; 4 * RUN];
            row.chunks_exact_mut(4).for_each(|bytes| bytes.copy_from_slice(&texel));
            row
        };
        let mut row = [0; 4 * RUN];
        for (n, texel) in (n..).zip(row.chunks_exact_mut(4)) {
            let [d, alpha, ..] = n.to_le_bytes();
            texel.copy_from_slice(&[d, d, d, alpha]);
        }
        let second = self.kernel.reads_second_source().then(|| spread(self.draw.second));
        self.kernel.merge_row(
            &spread(self.draw.source),
            second.as_ref().map(<[u8; 4 * RUN]>::as_slice),
            None,
            &mut row,
        );
        row == got
    }

    /// Whether all of the device's texels do.
    fn are_all(&self, got: &[u8]) -> bool {
        let run = |i: usize| &got[4 * RUN * i..4 * RUN * (i + 1)];
        got.len().is_multiple_of(4 * RUN)
            && compare(got.len() / (4 * RUN), |i| self.are(RUN * i, run(i))).mismatches == 0
    }
}

/// Models that are too slow are not compared.
fn leave_out(subjects: &[Subject], tally: &mut Tally<'_>) {
    let reason = "too slow for every 8-bit input; judged at the other levels";
    tally.benches.iter_mut().for_each(|bench| bench.leave_out(reason));
    for (subject, outcome) in subjects.iter().zip(&mut tally.models) {
        if !subject.exhaustive {
            let reason = "too slow for every 8-bit input; compared at the other levels";
            outcome.not_run = Some(reason.to_owned());
        }
    }
}

/// Every source and destination code of the states with this source factor, with one further input: source alpha,
/// destination alpha, second source, its alpha, or constant; and every pair of source and destination alpha.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    src_factor: BlendFactor,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    leave_out(subjects, tally);
    let mut states = equal_states(src_factor);
    let total = states.len();
    let has_second = device.has_second_source();
    states.retain(|state| has_second || !reads_second_source(state));
    if states.len() < total {
        tally.left_out = Some(format!("{} states with a second source, which the adapter lacks", total - states.len()));
    }
    if states.is_empty() {
        return Ok(());
    }
    let merger_states: Vec<MergerState> = states.iter().map(|state| merger_state(*state)).collect();
    let plane = Extent::new(4096, 1376)?;
    let mut sweep = Sweep::new(device, destination(plane, &merger_states[0])?)?;
    let page = Extent::new(256, THIRD)?;
    let mut pages = Sweep::new(device, destination(page, &merger_states[0])?)?;

    // Source alpha, or second source and its alpha, as the further input; destination alpha follows it.
    let by_alpha = sources(65_536, look_up(256, 256, 0));
    // Source alpha follows the sources, in three parts, so that it meets every destination alpha.
    let by_source = |i: u32| sources(65_536, look_up(65_536, THIRD, i * THIRD));
    let further = [look_up(256, 256, 0); 4];
    let plans = [(by_alpha, further), (by_source(0), further), (by_source(1), further), (by_source(2), further)];
    for (source, second) in plans {
        let program = Program { outputs: vec![source], second_source: has_second.then_some(second), depth: None };
        let fragments = sweep.program(program, &table())?;
        let draws: Vec<Draw<'_>> =
            merger_states.iter().map(|state| Draw { state, source, second, constant: 0, first: 0 }).collect();
        draw(&mut sweep, &fragments, subjects, &states, &draws, tally)?;
    }

    // The constant is no function of the texel: a page for each of its 256 codes.
    let source = sources(256, look_up(256, THIRD, 0));
    let program = Program { outputs: vec![source], second_source: has_second.then_some(source), depth: None };
    let fragments = pages.program(program, &table())?;
    let with_constant: Vec<BlendState> = states.iter().filter(|state| state.color.uses_constant()).copied().collect();
    for state in &with_constant {
        let each_constant: Vec<MergerState> = (0..=255_u8)
            .map(|k| {
                let mut merger = merger_state(*state);
                merger.dynamic.blend_constant = [f32::from(k) / 255.0; 4];
                merger
            })
            .collect();
        let draws: Vec<Draw<'_>> = (0..)
            .zip(&each_constant)
            .map(|(constant, state)| Draw { state, source, second: source, constant, first: 0 })
            .collect();
        draw(&mut pages, &fragments, subjects, &vec![*state; draws.len()], &draws, tally)?;
    }
    tally.states = states.len() as u64;
    for outcome in tally.models.iter_mut().filter(|outcome| outcome.not_run.is_none()) {
        // Draws were tallied; states are what the reader counts.
        let failed = u64::from(outcome.mismatches > 0);
        (outcome.states, outcome.states_matched) = (states.len() as u64, (states.len() as u64).saturating_sub(failed));
    }
    Ok(())
}

/// Every source, destination, source alpha and destination alpha of one state.
pub(super) fn run_both_alphas(
    device: &Device,
    subjects: &[Subject],
    component: BlendComponent,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    leave_out(subjects, tally);
    let blend = BlendState { color: component, alpha: component };
    let state = merger_state(blend);
    let plane = Extent::new(4096, 1376)?;
    let mut sweep = Sweep::new(device, destination(plane, &state)?)?;
    let source = sources(65_536, look_up(65_536 * THIRD, 256, 0));
    let second = [look_up(1, 1, 0); 4];
    let program = Program { outputs: vec![source], second_source: None, depth: None };
    let fragments = sweep.program(program, &table())?;
    // One plane for each source alpha.
    let draws: Vec<Draw<'_>> = (0..256)
        .map(|alpha| Draw { state: &state, source, second, constant: 0, first: alpha * 65_536 * THIRD })
        .collect();
    draw(&mut sweep, &fragments, subjects, &vec![blend; draws.len()], &draws, tally)?;
    tally.states = 1;
    for outcome in tally.models.iter_mut().filter(|outcome| outcome.not_run.is_none()) {
        (outcome.states, outcome.states_matched) = (1, u64::from(outcome.mismatches == 0));
    }
    Ok(())
}

/// Draws and compares; `blends` are the draws' states.
fn draw(
    sweep: &mut Sweep<'_>,
    fragments: &Fragments,
    subjects: &[Subject],
    blends: &[BlendState],
    draws: &[Draw<'_>],
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let format = ColorFormat::new(TextureFormat::Rgba8Unorm).expect("a color format");
    let jobs = draws.iter().map(|draw| Job {
        state: draw.state,
        fragments,
        first: draw.first,
        destination: Destination::Restored,
        unclipped_depth: false,
    });
    sweep.run(jobs, |number, outcome| {
        let (draw, blend) = (&draws[number], &blends[number]);
        let got = outcome.color(0);
        let count = got.len() / 4;
        tally.texels += count as u64;
        for (s, subject) in subjects.iter().enumerate() {
            if subject.exhaustive {
                let expected = |i| draw.expected(subject, format, blend, i);
                // The kernel only says that nothing differs; what does is found by the model itself.
                let compared = match Rows::new(draw, subject) {
                    Some(rows) if rows.are_all(got) => Compared::default(),
                    _ => compare(count, |i| texel(format, got, i) == expected(i)),
                };
                tally.add(s, compared, |i| {
                    let n = draw.first + u32::try_from(i).unwrap_or(u32::MAX);
                    let codes = |inputs: [Input; 4]| inputs.map(|input| code(input, n));
                    format!(
                        "{}, constant {}: source {:?}, second source {:?}, stored {:?}: expected {:?}, got {:?}",
                        component_name(&blend.color),
                        draw.constant,
                        codes(draw.source),
                        codes(draw.second),
                        stored(n),
                        expected(i),
                        texel(format, got, i)
                    )
                });
            }
        }
        ControlFlow::Continue(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::llvmpipe::Generation;
    use crate::model::registry::Drivers;

    #[test]
    fn a_plane_has_every_source_destination_and_alpha() {
        let source = sources(65_536, look_up(256, 256, 0));
        let mut seen = vec![false; 1 << 16];
        // The (source, alpha) pairs of one destination code.
        for n in (0..THIRD << 16).step_by(256) {
            let [r, g, b, a] = source.map(|input| code(input, n));
            for s in [r, g, b] {
                seen[(s << 8 | a) as usize] = true;
            }
        }
        assert!(seen.iter().all(|seen| *seen), "every pair");
        assert_eq!(stored(0x0003_ab12), [0x12, 0x12, 0x12, 0xab], "destination by number");
    }

    #[test]
    fn rows_by_the_kernel_are_the_models_texels_and_notice_one_wrong_code() {
        let both = |src_factor, dst_factor| {
            let component = BlendComponent { src_factor, dst_factor, operation: wgpu_types::BlendOperation::Add };
            BlendState { color: component, alpha: component }
        };
        let format = ColorFormat::new(TextureFormat::Rgba8Unorm).expect("a color format");
        for (name, blend) in [
            ("llvmpipe", both(BlendFactor::SrcAlpha, BlendFactor::OneMinusDstAlpha)),
            ("llvmpipe", both(BlendFactor::Src1, BlendFactor::OneMinusSrc1Alpha)),
            ("f32", both(BlendFactor::Constant, BlendFactor::SrcAlphaSaturated)),
        ] {
            let subject = Subject::new(name, Drivers::default()).expect("a model");
            let mut state = merger_state(blend);
            state.dynamic.blend_constant = [f32::from(77_u8) / 255.0; 4];
            let draw = Draw {
                state: &state,
                source: sources(65_536, look_up(256, 256, 0)),
                second: [look_up(256, 256, 0); 4],
                constant: 77,
                first: 65_536 * 5,
            };
            let rows = Rows::new(&draw, &subject).expect("a kernel");
            let expected =
                |i| draw.expected(&subject, format, &blend, i).map(|code| u8::try_from(code).expect("8 bits"));
            let mut texels: Vec<u8> = (0..3 * 65_536).flat_map(expected).collect();
            assert!(rows.are_all(&texels), "{name}");
            let at = 4 * 70_000 + 2;
            texels[at] = texels[at].wrapping_add(1);
            assert!(!rows.are_all(&texels), "{name}: one code off");
        }
        let state = merger_state(both(BlendFactor::One, BlendFactor::Zero));
        let fine = [look_up(1, 256, 0); 4];
        let draw = Draw { state: &state, source: fine, second: fine, constant: 0, first: 0 };
        assert!(
            Rows::new(&draw, &Subject::new("llvmpipe", Drivers::default()).expect("a model")).is_none(),
            "sources change in a run"
        );
    }

    #[test]
    fn min_and_max_need_no_factors() {
        let state = BlendComponent {
            src_factor: BlendFactor::One,
            dst_factor: BlendFactor::One,
            operation: wgpu_types::BlendOperation::Min,
        };
        let blend = BlendState { color: state, alpha: state };
        assert_eq!(
            merge_codes8(Generation::default(), &blend, [9; 4], [0; 4], [0; 4], [7; 4]),
            [7; 4],
            "the smaller code"
        );
    }
}
