//! The fast path for many states or many fragments: everything stays on the device, and the host compares one
//! result while the device draws the next.
//!
//! One job is one draw over all texels of the targets. Its destination is restored by a copy on the device, its
//! fragments come from records uploaded once ([`Sources`]) or are computed from the texel's number ([`Program`]).

use std::collections::VecDeque;
use std::ops::ControlFlow;

use wgpu::{Buffer, BufferUsages, SubmissionIndex};

use super::batch::{ReplayError, check_state, state_reads_second_source};
use super::device::Device;
use super::painter::{begin, set_dynamic};
use super::pipeline::{PipelineKey, Pipelines};
use super::program::Program;
use super::readback::Readback;
use super::record::whole_target;
use super::replay::Replay;
use super::shader::{HEADER_WORDS, RecordLayout, RecordShader, Shader, Written};
use super::upload::Attachments;
use crate::format::depth::DepthKind;
use crate::state::{AlphaTest, MergerState};
use crate::target::{Extent, Framebuffer};

/// Jobs under way at once: one drawn by the device, one compared by the host.
const SLOTS: usize = 2;

/// Rows of the targets are copied without padding when the width is a multiple of this.
pub const WIDTH_MULTIPLE: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// Fragments for every texel, as separate arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sources {
    /// Output colors by location; states may use fewer.
    pub outputs: Vec<Vec<[f32; 4]>>,
    /// The second source; needed by states that read it.
    pub second_source: Option<Vec<[f32; 4]>>,
    /// Depth; needed where there is a depth attachment.
    pub depth: Option<Vec<f32>>,
    /// Which fragments are discarded; `None` for none.
    pub discarded: Option<Vec<bool>>,
}

/// Fragments on the device, for jobs to draw.
#[derive(Debug)]
pub struct Fragments {
    buffer: Buffer,
    bindings: wgpu::BindGroup,
    extent: Extent,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Records { layout: RecordLayout, depth: bool, discard: bool },
    Program { program: Program, table_entries: u32 },
}

/// What a job draws over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Destination {
    /// The sweep's destination bytes.
    #[default]
    Restored,
    /// Whatever the job before left: for states that overwrite all of it.
    LeftOver,
}

/// One draw over all texels.
#[derive(Clone, Copy, Debug)]
pub struct Job<'j> {
    /// The state; its alpha test must be off (put it into [`Sources::discarded`]).
    pub state: &'j MergerState,
    /// The fragments.
    pub fragments: &'j Fragments,
    /// The number of the first texel, for programs; the others follow row by row, modulo 2^32.
    pub first: u32,
    /// What it draws over.
    pub destination: Destination,
    /// Clamp depth to the viewport's range (wgpu's `unclipped_depth`).
    pub unclipped_depth: bool,
}

/// The targets' bytes after one job, valid inside the callback.
#[derive(Clone, Copy, Debug)]
pub struct Outcome<'o> {
    readback: &'o Readback,
    bytes: &'o [u8],
    depth: Option<DepthKind>,
}

impl<'o> Outcome<'o> {
    /// All texels of a color target, rows from the top, no padding; empty where there is no such target.
    #[must_use]
    pub fn color(&self, location: usize) -> &'o [u8] {
        self.readback.color_bytes(self.bytes, location)
    }

    /// All stencil values; empty without a stencil aspect.
    #[must_use]
    pub fn stencil(&self) -> &'o [u8] {
        self.readback.stencil_bytes(self.bytes)
    }

    /// All depth codes; empty without a depth aspect.
    #[must_use]
    pub fn depth(&self) -> Vec<u32> {
        self.depth.map_or_else(Vec::new, |kind| self.readback.depth_codes(self.bytes, kind))
    }
}

/// Draws jobs over targets of one extent and set of formats.
#[derive(Debug)]
pub struct Sweep<'a> {
    device: &'a Device,
    pipelines: Pipelines,
    triangle: Buffer,
    destination: Framebuffer,
    pristine: Attachments,
    working: Attachments,
    free: Vec<Readback>,
}

impl<'a> Sweep<'a> {
    /// A sweep over targets that hold `destination` before every job.
    ///
    /// # Errors
    /// [`ReplayError`]: targets the device cannot draw to, a width that is no multiple of [`WIDTH_MULTIPLE`], initial
    /// depth codes that cannot be drawn, or a fault of the device.
    pub fn new(device: &'a Device, destination: Framebuffer) -> Result<Self, ReplayError> {
        if !destination.extent.width.is_multiple_of(WIDTH_MULTIPLE) {
            return Err(ReplayError::SweepWidth { width: destination.extent.width, multiple: WIDTH_MULTIPLE });
        }
        let gpu = &device.device;
        let pristine = Replay::new(device).put(&destination)?;
        let working = Attachments::new(gpu, &destination);
        let free = (0..SLOTS).map(|_| Readback::new(gpu, &destination, &working)).collect();
        let triangle = gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("triangle"),
            size: 48,
            usage: BufferUsages::VERTEX | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        device.queue.write_buffer(&triangle, 0, bytemuck::cast_slice(&whole_target(true)));
        Ok(Self { device, pipelines: Pipelines::new(gpu), triangle, destination, pristine, working, free })
    }

    /// The bytes every job draws over.
    #[must_use]
    pub fn destination(&self) -> &Framebuffer {
        &self.destination
    }

    /// Fragments from arrays, one element a texel.
    ///
    /// # Errors
    /// [`ReplayError::SweepSize`] for an array of another length, [`ReplayError::TooLarge`].
    pub fn upload(&self, sources: &Sources) -> Result<Fragments, ReplayError> {
        let texels = self.destination.extent.sample_total();
        let lengths = sources
            .outputs
            .iter()
            .map(Vec::len)
            .chain(sources.second_source.iter().map(Vec::len))
            .chain(sources.depth.iter().map(Vec::len))
            .chain(sources.discarded.iter().map(Vec::len));
        if let Some(got) = lengths.into_iter().find(|length| *length != texels) {
            return Err(ReplayError::SweepSize { expected: texels, got });
        }
        let (depth, discard) = (sources.depth.is_some(), sources.discarded.is_some());
        let layout = RecordLayout {
            outputs: (0..sources.outputs.len().min(8)).fold(0, |mask, location| mask | 1 << location),
            second_source: sources.second_source.is_some(),
            tail: depth || discard,
        };
        let mut words = Vec::with_capacity(HEADER_WORDS + texels * layout.quads() * 4);
        words.extend([self.destination.extent.width, 0, 0, 0]);
        for texel in 0..texels {
            let before = words.len();
            for output in sources.outputs.iter().take(8).chain(sources.second_source.as_ref()) {
                words.extend(output[texel].map(f32::to_bits));
            }
            if layout.tail {
                let depth = sources.depth.as_ref().map_or(0, |depth| depth[texel].to_bits());
                words.extend([depth, u32::from(sources.discarded.as_ref().is_some_and(|all| all[texel])), 0, 0]);
            }
            words.resize(before + layout.quads() * 4, 0);
        }
        self.fragments(&words, Kind::Records { layout, depth, discard })
    }

    /// Fragments computed on the device; `table` is what [`super::program::Input::Table`] looks up.
    ///
    /// # Errors
    /// [`ReplayError::TooLarge`] for a table beyond the device's limit.
    pub fn program(&self, program: Program, table: &[f32]) -> Result<Fragments, ReplayError> {
        let table_entries = u32::try_from(table.len()).unwrap_or(u32::MAX);
        let mut words = vec![self.destination.extent.width, 0, 0, table_entries.saturating_sub(1)];
        words.extend(table.iter().map(|value| value.to_bits()));
        if table.is_empty() {
            words.push(0);
        }
        self.fragments(&words, Kind::Program { program, table_entries })
    }

    fn fragments(&self, words: &[u32], kind: Kind) -> Result<Fragments, ReplayError> {
        let gpu = &self.device.device;
        let bytes = 4 * words.len().next_multiple_of(4) as u64;
        let limit = gpu.limits().max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(ReplayError::TooLarge { layer: 0, bytes, limit });
        }
        let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("fragments"),
            size: bytes,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.device.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
        let bindings = self.pipelines.bind(&buffer, bytes);
        self.device.check()?;
        Ok(Fragments { buffer, bindings, extent: self.destination.extent, kind })
    }

    /// Draws `jobs` in order and hands each outcome, with the job's number, to `consume`, which may stop the sweep.
    ///
    /// # Errors
    /// [`ReplayError`]: a job that does not fit targets or device, or a fault of the device.
    pub fn run<'j>(
        &mut self,
        jobs: impl IntoIterator<Item = Job<'j>>,
        mut consume: impl FnMut(usize, Outcome<'_>) -> ControlFlow<()>,
    ) -> Result<(), ReplayError> {
        let mut under_way: VecDeque<(usize, Readback, SubmissionIndex)> = VecDeque::new();
        let mut jobs = jobs.into_iter().enumerate();
        let mut stopped = false;
        let mut failed = None;
        loop {
            while let Some(readback) = if stopped { None } else { self.free.pop() } {
                let Some((number, job)) = jobs.next() else {
                    self.free.push(readback);
                    break;
                };
                match self.submit(&job, &readback) {
                    Ok(submission) => under_way.push_back((number, readback, submission)),
                    Err(error) => {
                        self.free.push(readback);
                        failed.get_or_insert(error);
                        stopped = true;
                    }
                }
            }
            let Some((number, readback, submission)) = under_way.pop_front() else { break };
            let depth = self.destination.depth_stencil.as_ref().and_then(|target| target.format().depth());
            let fetched = readback.fetch(self.device, submission, |bytes| {
                if !stopped {
                    stopped = consume(number, Outcome { readback: &readback, bytes, depth }).is_break();
                }
            });
            // A read-back whose fetch failed may still be mapped: make another.
            match fetched {
                Ok(()) => self.free.push(readback),
                Err(error) => {
                    self.free.push(Readback::new(&self.device.device, &self.destination, &self.working));
                    failed.get_or_insert(error.into());
                    stopped = true;
                }
            }
        }
        failed.map_or(Ok(()), Err)
    }

    /// Records and submits one job.
    fn submit(&mut self, job: &Job<'_>, readback: &Readback) -> Result<SubmissionIndex, ReplayError> {
        let shader = self.shader(job)?;
        let key = PipelineKey::new(job.state, job.unclipped_depth, shader, &self.destination);
        if let Kind::Program { table_entries, .. } = job.fragments.kind {
            let header = [self.destination.extent.width, job.first, 0, table_entries.saturating_sub(1)];
            self.device.queue.write_buffer(&job.fragments.buffer, 0, bytemuck::cast_slice(&header));
        }
        let mut encoder = self.device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if job.destination == Destination::Restored {
            self.working.copy_from(&mut encoder, &self.pristine);
        }
        {
            let mut pass = begin(&mut encoder, &self.working);
            pass.set_pipeline(self.pipelines.get(&key));
            pass.set_bind_group(0, &job.fragments.bindings, &[0]);
            pass.set_vertex_buffer(0, self.triangle.slice(..));
            set_dynamic(&mut pass, &job.state.dynamic, self.destination.extent);
            pass.set_stencil_reference(job.state.dynamic.stencil_reference & 0xff);
            pass.draw(0..3, 0..1);
        }
        readback.record(&mut encoder, &self.working);
        let submission = self.device.queue.submit([encoder.finish()]);
        self.device.check()?;
        Ok(submission)
    }

    /// The shader of a job, whose fragments must offer all that its state needs.
    fn shader(&self, job: &Job<'_>) -> Result<Shader, ReplayError> {
        let state = job.state;
        check_state(self.device, 0, state, job.unclipped_depth, &self.destination)?;
        if state.alpha_test != AlphaTest::Off {
            return Err(ReplayError::SweepInput("an alpha test; put it into the discarded fragments"));
        }
        if job.fragments.extent != self.destination.extent {
            return Err(ReplayError::SweepInput("fragments made for targets of this extent"));
        }
        let locations = state.targets.iter().enumerate().filter(|(_, target)| target.is_some());
        let has_depth = self.destination.depth_stencil.as_ref().is_some_and(|target| target.format().depth().is_some());
        let mut written = Written {
            outputs: locations.fold(0, |mask, (location, _)| mask | 1 << location),
            dual_source: state_reads_second_source(state),
            depth: has_depth,
            discard: false,
        };
        let (outputs, second_source, depth) = match &job.fragments.kind {
            Kind::Records { layout, depth, discard } => {
                written.discard = *discard;
                (layout.outputs.count_ones() as usize, layout.second_source, *depth)
            }
            Kind::Program { program, .. } => {
                (program.outputs.len(), program.second_source.is_some(), program.depth.is_some())
            }
        };
        if written.locations().any(|location| location >= outputs) {
            return Err(ReplayError::SweepInput("an output for every color target"));
        }
        if written.dual_source && !second_source {
            return Err(ReplayError::SweepInput("a second source"));
        }
        if written.depth && !depth {
            return Err(ReplayError::SweepInput("a depth"));
        }
        Ok(match &job.fragments.kind {
            Kind::Records { layout, .. } => Shader::Records(RecordShader { written, layout: *layout }),
            Kind::Program { program, .. } => Shader::Program(written, program.clone()),
        })
    }
}
