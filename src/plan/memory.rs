//! Target memory as the output merger touches it: one access a method, so that accesses can be counted.

use crate::format::depth::DepthKind;
use crate::format::{Codes, DepthFormat};
use crate::target::{DepthStencilTarget, Framebuffer};

/// One sample of one texel: column, row, sample.
pub type Place = (u32, u32, u32);

/// Target memory.
pub trait Memory {
    /// Reads the codes of one sample of a color target; zeros if there is no such target.
    fn read_color(&mut self, target: usize, at: Place) -> Codes;

    /// Stores the codes of one sample of a color target.
    fn write_color(&mut self, target: usize, at: Place, codes: Codes);

    /// Reads a depth code; 0 without a depth aspect.
    fn read_depth(&mut self, at: Place) -> u32;

    /// Stores a depth code.
    fn write_depth(&mut self, at: Place, code: u32);

    /// Reads a stencil value; 0 without a stencil aspect.
    fn read_stencil(&mut self, at: Place) -> u8;

    /// Stores a stencil value.
    fn write_stencil(&mut self, at: Place, value: u8);
}

fn index(target: &DepthStencilTarget, (x, y, sample): Place) -> usize {
    target.extent().index(x, y, sample)
}

impl Memory for Framebuffer {
    fn read_color(&mut self, target: usize, (x, y, sample): Place) -> Codes {
        self.colors.get(target).and_then(Option::as_ref).map_or([0; 4], |color| color.codes(x, y, sample))
    }

    fn write_color(&mut self, target: usize, (x, y, sample): Place, codes: Codes) {
        if let Some(Some(color)) = self.colors.get_mut(target) {
            color.set_codes(x, y, sample, codes);
        }
    }

    fn read_depth(&mut self, at: Place) -> u32 {
        let target = self.depth_stencil.as_ref();
        target.and_then(|target| target.depth().get(index(target, at))).copied().unwrap_or(0)
    }

    fn write_depth(&mut self, at: Place, code: u32) {
        if let Some(target) = &mut self.depth_stencil {
            let at = index(target, at);
            if let Some(stored) = target.depth_mut().get_mut(at) {
                *stored = code;
            }
        }
    }

    fn read_stencil(&mut self, at: Place) -> u8 {
        let target = self.depth_stencil.as_ref();
        target.and_then(|target| target.stencil().get(index(target, at))).copied().unwrap_or(0)
    }

    fn write_stencil(&mut self, at: Place, value: u8) {
        if let Some(target) = &mut self.depth_stencil {
            let at = index(target, at);
            if let Some(stored) = target.stencil_mut().get_mut(at) {
                *stored = value;
            }
        }
    }
}

/// Bytes moved, by kind of access.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Traffic {
    /// Bytes of color targets read.
    pub color_read: u64,
    /// Bytes of color targets written.
    pub color_written: u64,
    /// Bytes of depth read.
    pub depth_read: u64,
    /// Bytes of depth written.
    pub depth_written: u64,
    /// Bytes of stencil read.
    pub stencil_read: u64,
    /// Bytes of stencil written.
    pub stencil_written: u64,
}

impl Traffic {
    /// All bytes, whatever the access.
    #[must_use]
    pub fn total(self) -> u64 {
        let reads = self.color_read + self.depth_read + self.stencil_read;
        reads + self.color_written + self.depth_written + self.stencil_written
    }
}

impl std::ops::AddAssign for Traffic {
    fn add_assign(&mut self, other: Self) {
        self.color_read += other.color_read;
        self.color_written += other.color_written;
        self.depth_read += other.depth_read;
        self.depth_written += other.depth_written;
        self.stencil_read += other.stencil_read;
        self.stencil_written += other.stencil_written;
    }
}

/// A framebuffer that counts the bytes that pass.
#[derive(Debug)]
pub struct Counted<'a> {
    /// The memory.
    pub framebuffer: &'a mut Framebuffer,
    /// What passed so far.
    pub traffic: Traffic,
}

impl<'a> Counted<'a> {
    /// Counts from zero.
    pub fn new(framebuffer: &'a mut Framebuffer) -> Self {
        Self { framebuffer, traffic: Traffic::default() }
    }

    /// Bytes of a texel of a color target.
    fn color_bytes(&self, target: usize) -> u64 {
        let target = self.framebuffer.colors.get(target).and_then(Option::as_ref);
        target.map_or(0, |target| target.format().bytes_per_texel() as u64)
    }

    /// Bytes of a depth code: 2 with 16 bits, 4 otherwise.
    fn depth_bytes(&self) -> u64 {
        match self.format().and_then(DepthFormat::depth) {
            None => 0,
            Some(DepthKind::Unorm(16)) => 2,
            Some(DepthKind::Unorm(_) | DepthKind::Float32) => 4,
        }
    }

    fn stencil_bytes(&self) -> u64 {
        u64::from(self.format().is_some_and(DepthFormat::has_stencil))
    }

    fn format(&self) -> Option<DepthFormat> {
        self.framebuffer.depth_stencil.as_ref().map(DepthStencilTarget::format)
    }
}

impl Memory for Counted<'_> {
    fn read_color(&mut self, target: usize, at: Place) -> Codes {
        self.traffic.color_read += self.color_bytes(target);
        self.framebuffer.read_color(target, at)
    }

    fn write_color(&mut self, target: usize, at: Place, codes: Codes) {
        self.traffic.color_written += self.color_bytes(target);
        self.framebuffer.write_color(target, at, codes);
    }

    fn read_depth(&mut self, at: Place) -> u32 {
        self.traffic.depth_read += self.depth_bytes();
        self.framebuffer.read_depth(at)
    }

    fn write_depth(&mut self, at: Place, code: u32) {
        self.traffic.depth_written += self.depth_bytes();
        self.framebuffer.write_depth(at, code);
    }

    fn read_stencil(&mut self, at: Place) -> u8 {
        self.traffic.stencil_read += self.stencil_bytes();
        self.framebuffer.read_stencil(at)
    }

    fn write_stencil(&mut self, at: Place, value: u8) {
        self.traffic.stencil_written += self.stencil_bytes();
        self.framebuffer.write_stencil(at, value);
    }
}
