//! Layers of fragments over given targets, through a real output merger, and the bytes back.

use wgpu::DepthStencilState;

use super::batch::{Batch, Layer, ReplayError, check_targets};
use super::device::Device;
use super::painter::{Painter, Ready};
use super::pipeline::pass_through;
use super::readback::Readback;
use super::upload::{Attachments, seed_depth};
use crate::fragment::Fragment;
use crate::state::MergerState;
use crate::target::Framebuffer;

/// Fragments of one render pass take at most about this many bytes; further layers go into another pass.
const PASS_BUDGET: u64 = 256 << 20;

/// Draws batches on one device, keeping pipelines, textures and buffers between them.
#[derive(Debug)]
pub struct Replay<'a> {
    device: &'a Device,
    painter: Painter,
    kept: Option<(Attachments, Readback)>,
}

impl<'a> Replay<'a> {
    /// A replay without pipelines yet.
    #[must_use]
    pub fn new(device: &'a Device) -> Self {
        Self { device, painter: Painter::new(&device.device), kept: None }
    }

    /// Draws all layers of `batch` and returns the targets' bytes afterwards.
    ///
    /// All layers go into one render pass, except where their fragments exceed 256 MiB.
    ///
    /// # Errors
    /// [`ReplayError`]: a batch that contradicts itself, something the device cannot do, or a fault of the device. After
    /// one the next batch starts afresh: no refused pipeline stays behind.
    pub fn run(&mut self, batch: &Batch) -> Result<Framebuffer, ReplayError> {
        let result = self.draw(batch);
        if result.is_err() {
            // wgpu hands out objects that it refused, and their later use fails with less to say. A lost or hung device
            // must not be asked for new ones.
            if self.device.check().is_ok() {
                self.painter = Painter::new(&self.device.device);
            }
            self.kept = None;
        }
        result
    }

    fn draw(&mut self, batch: &Batch) -> Result<Framebuffer, ReplayError> {
        batch.check(self.device)?;
        let (attachments, readback) = self.targets(&batch.initial);
        attachments.upload(&self.device.queue, &batch.initial);
        self.seed_depth(&batch.initial, &attachments, &readback)?;
        self.paint(batch, &attachments)?;

        let mut encoder = self.device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        readback.record(&mut encoder, &attachments);
        let submission = self.device.queue.submit([encoder.finish()]);
        let mut result = batch.initial.clone();
        readback.fetch(self.device, submission, |bytes| readback.store(bytes, &mut result))?;
        self.kept = Some((attachments, readback));
        Ok(result)
    }

    /// Textures that hold the bytes of `framebuffer`.
    pub(super) fn put(mut self, framebuffer: &Framebuffer) -> Result<Attachments, ReplayError> {
        check_targets(self.device, framebuffer)?;
        let (attachments, readback) = self.targets(framebuffer);
        attachments.upload(&self.device.queue, framebuffer);
        self.seed_depth(framebuffer, &attachments, &readback)?;
        self.device.check()?;
        Ok(attachments)
    }

    /// The textures of the last batch, if they fit this one.
    fn targets(&mut self, initial: &Framebuffer) -> (Attachments, Readback) {
        match self.kept.take() {
            Some((attachments, readback)) if attachments.fit(initial) => (attachments, readback),
            _ => {
                let attachments = Attachments::new(&self.device.device, initial);
                let readback = Readback::new(&self.device.device, initial, &attachments);
                (attachments, readback)
            }
        }
    }

    fn paint(&mut self, batch: &Batch, attachments: &Attachments) -> Result<(), ReplayError> {
        let limit = self.device.device.limits().max_storage_buffer_binding_size;
        let mut chunk: Vec<Ready> = Vec::new();
        let mut bytes = 0;
        for (layer, given) in batch.layers.iter().enumerate() {
            let ready = Ready::new(given, &batch.initial);
            if ready.bytes() > limit {
                return Err(ReplayError::TooLarge { layer, bytes: ready.bytes(), limit });
            }
            if bytes + ready.bytes() > PASS_BUDGET && !chunk.is_empty() {
                self.painter.paint(self.device, &chunk, attachments, batch.initial.extent);
                chunk.clear();
                bytes = 0;
            }
            bytes += ready.bytes();
            chunk.push(ready);
        }
        if !chunk.is_empty() {
            self.painter.paint(self.device, &chunk, attachments, batch.initial.extent);
        }
        Ok(())
    }

    /// Draws the initial depth codes that cannot be copied, and makes sure that they arrived.
    fn seed_depth(&mut self, initial: &Framebuffer, on: &Attachments, readback: &Readback) -> Result<(), ReplayError> {
        let (Some(target), Some(texture)) = (&initial.depth_stencil, &on.depth_stencil) else { return Ok(()) };
        let (Some(depths), Some(kind)) = (seed_depth(target), target.format().depth()) else { return Ok(()) };
        let state =
            DepthStencilState { depth_write_enabled: Some(true), ..pass_through(target.format().texture_format()) };
        let state = MergerState { depth_stencil: Some(state), ..MergerState::default() };
        let fragments = depths.into_iter().map(|depth| Fragment::default().at_depth(depth)).collect();
        // A pass without color targets: even masked ones are rewritten by some drivers.
        let alone =
            Framebuffer { extent: initial.extent, colors: Vec::new(), depth_stencil: initial.depth_stencil.clone() };
        let ready = Ready::new(&Layer::new(state, fragments), &alone);
        self.painter.paint(self.device, &[ready], &on.depth_only(), initial.extent);

        let mut encoder = self.device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        readback.record_depth(&mut encoder, texture);
        let submission = self.device.queue.submit([encoder.finish()]);
        let got = readback.fetch(self.device, submission, |bytes| readback.depth_codes(bytes, kind))?;
        match got.iter().zip(target.depth()).position(|(got, wanted)| got != wanted) {
            Some(texel) => Err(ReplayError::InitialDepth { texel, wanted: target.depth()[texel], got: got[texel] }),
            None => Ok(()),
        }
    }
}
