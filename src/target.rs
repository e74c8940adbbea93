//! Target bytes: the memory the output merger reads and writes.

use wgpu_types::TextureFormat;

use crate::format::{Codes, ColorFormat, DepthFormat, FormatError};

/// Default limit of a target's width and height in texels (WebGPU's guaranteed `maxTextureDimension2D`).
pub const MAX_DIMENSION: u32 = 8192;

/// A target that cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TargetError {
    /// Width or height is zero.
    #[error("a {width} x {height} target has no texels; width and height must be at least 1")]
    Empty {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
    },
    /// Width or height is beyond the limit.
    #[error("a {width} x {height} target is too large; width and height may be at most {limit}")]
    TooLarge {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
        /// The limit in force.
        limit: u32,
    },
    /// The sample count is neither 1 nor 4.
    #[error("{0} samples per texel are not supported; use 1 or 4")]
    Samples(u32),
    /// The memory could not be had.
    #[error("no memory for a {width} x {height} target of {bytes} bytes")]
    OutOfMemory {
        /// Asked width.
        width: u32,
        /// Asked height.
        height: u32,
        /// Bytes it would take.
        bytes: usize,
    },
    /// The format has no such role.
    #[error(transparent)]
    Format(#[from] FormatError),
}

/// Width, height and samples of all targets of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Samples per texel, 1 or 4.
    pub samples: u32,
}

impl Extent {
    /// A single-sampled extent.
    ///
    /// # Errors
    /// [`TargetError::Empty`] or [`TargetError::TooLarge`] (limit [`MAX_DIMENSION`]).
    pub fn new(width: u32, height: u32) -> Result<Self, TargetError> {
        Self::with_samples(width, height, 1)
    }

    /// An extent with `samples` samples per texel.
    ///
    /// # Errors
    /// [`TargetError::Empty`], [`TargetError::TooLarge`] (limit [`MAX_DIMENSION`]) or [`TargetError::Samples`].
    pub fn with_samples(width: u32, height: u32, samples: u32) -> Result<Self, TargetError> {
        if width == 0 || height == 0 {
            return Err(TargetError::Empty { width, height });
        }
        if width > MAX_DIMENSION || height > MAX_DIMENSION {
            return Err(TargetError::TooLarge { width, height, limit: MAX_DIMENSION });
        }
        if samples != 1 && samples != 4 {
            return Err(TargetError::Samples(samples));
        }
        Ok(Self { width, height, samples })
    }

    /// Samples in all: width x height x samples.
    #[must_use]
    pub fn sample_total(self) -> usize {
        self.width as usize * self.height as usize * self.samples as usize
    }

    /// Index of a sample: rows from the top, texels from the left, samples of a texel together.
    #[must_use]
    pub fn index(self, x: u32, y: u32, sample: u32) -> usize {
        (y as usize * self.width as usize + x as usize) * self.samples as usize + sample as usize
    }

    /// Zeroed memory of `each` bytes a sample, or an error instead of an abort.
    fn allocate(self, each: usize) -> Result<Vec<u8>, TargetError> {
        let bytes = self.sample_total() * each;
        let mut memory = Vec::new();
        memory.try_reserve_exact(bytes).map_err(|_| TargetError::OutOfMemory {
            width: self.width,
            height: self.height,
            bytes,
        })?;
        memory.resize(bytes, 0);
        Ok(memory)
    }
}

/// A color target: texels in memory order, no row padding, all bytes zero when new.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColorTarget {
    extent: Extent,
    format: ColorFormat,
    bytes: Vec<u8>,
}

impl ColorTarget {
    /// A zeroed target.
    ///
    /// # Errors
    /// [`TargetError::OutOfMemory`].
    pub fn new(extent: Extent, format: ColorFormat) -> Result<Self, TargetError> {
        Ok(Self { extent, format, bytes: extent.allocate(format.bytes_per_texel())? })
    }

    /// The extent.
    #[must_use]
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The format.
    #[must_use]
    pub fn format(&self) -> ColorFormat {
        self.format
    }

    /// All texels, `extent.sample_total() * format.bytes_per_texel()` bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// All texels, writable: the way to upload.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// The codes of one sample.
    ///
    /// # Panics
    /// When the sample lies outside the target.
    #[must_use]
    pub fn codes(&self, x: u32, y: u32, sample: u32) -> Codes {
        let each = self.format.bytes_per_texel();
        let at = self.extent.index(x, y, sample) * each;
        self.format.unpack(&self.bytes[at..at + each])
    }

    /// Stores the codes of one sample.
    ///
    /// # Panics
    /// When the sample lies outside the target.
    pub fn set_codes(&mut self, x: u32, y: u32, sample: u32, codes: Codes) {
        let each = self.format.bytes_per_texel();
        let at = self.extent.index(x, y, sample) * each;
        self.format.pack(codes, &mut self.bytes[at..at + each]);
    }

    /// Stores the same codes in every sample.
    pub fn fill(&mut self, codes: Codes) {
        for texel in self.bytes.chunks_exact_mut(self.format.bytes_per_texel()) {
            self.format.pack(codes, texel);
        }
    }
}

/// A depth/stencil target: depth codes and stencil values, kept apart as WebGPU's aspects are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DepthStencilTarget {
    extent: Extent,
    format: DepthFormat,
    depth: Vec<u32>,
    stencil: Vec<u8>,
}

impl DepthStencilTarget {
    /// A target with depth code and stencil value 0 everywhere.
    ///
    /// # Errors
    /// [`TargetError::Format`] for a color format, [`TargetError::OutOfMemory`].
    pub fn new(extent: Extent, texture_format: TextureFormat) -> Result<Self, TargetError> {
        let format = DepthFormat::new(texture_format)?;
        let stencil = if format.has_stencil() { extent.allocate(1)? } else { Vec::new() };
        let mut depth = Vec::new();
        if format.depth().is_some() {
            let total = extent.sample_total();
            depth.try_reserve_exact(total).map_err(|_| TargetError::OutOfMemory {
                width: extent.width,
                height: extent.height,
                bytes: 4 * total,
            })?;
            depth.resize(total, 0);
        }
        Ok(Self { extent, format, depth, stencil })
    }

    /// The extent.
    #[must_use]
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The format.
    #[must_use]
    pub fn format(&self) -> DepthFormat {
        self.format
    }

    /// Depth codes, one a sample; empty without a depth aspect.
    #[must_use]
    pub fn depth(&self) -> &[u32] {
        &self.depth
    }

    /// Depth codes, writable.
    pub fn depth_mut(&mut self) -> &mut [u32] {
        &mut self.depth
    }

    /// Stencil values, one a sample; empty without a stencil aspect.
    #[must_use]
    pub fn stencil(&self) -> &[u8] {
        &self.stencil
    }

    /// Stencil values, writable.
    pub fn stencil_mut(&mut self) -> &mut [u8] {
        &mut self.stencil
    }
}

/// All targets of a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Framebuffer {
    /// Width, height and samples, the same for all targets.
    pub extent: Extent,
    /// Color targets by output location.
    pub colors: Vec<Option<ColorTarget>>,
    /// The depth/stencil target, if any.
    pub depth_stencil: Option<DepthStencilTarget>,
}

impl Framebuffer {
    /// Zeroed targets for every attachment `state` names.
    ///
    /// # Errors
    /// [`TargetError`] for formats without that role and for lack of memory.
    pub fn for_state(extent: Extent, state: &crate::state::MergerState) -> Result<Self, TargetError> {
        let color = |target: &Option<wgpu_types::ColorTargetState>| match target {
            Some(target) => ColorTarget::new(extent, ColorFormat::new(target.format)?).map(Some),
            None => Ok(None),
        };
        Ok(Self {
            extent,
            colors: state.targets.iter().map(color).collect::<Result<_, _>>()?,
            depth_stencil: match &state.depth_stencil {
                Some(depth_stencil) => Some(DepthStencilTarget::new(extent, depth_stencil.format)?),
                None => None,
            },
        })
    }
}
