//! The device's copy of a framebuffer: textures, and the bytes that go into them.
//!
//! Color, stencil and 16-bit depth are copied. WebGPU forbids copies into other depth formats: their initial codes are
//! drawn ([`seed_depth`]), and the replay reads them back to be sure.

use wgpu::{TextureAspect, TextureUsages};

use crate::format::depth::DepthKind;
use crate::target::{DepthStencilTarget, Extent, Framebuffer};

/// Textures of all attachments.
#[derive(Debug)]
pub struct Attachments {
    extent: Extent,
    /// Color textures by location.
    pub colors: Vec<Option<wgpu::Texture>>,
    /// The depth/stencil texture.
    pub depth_stencil: Option<wgpu::Texture>,
}

impl Attachments {
    /// Textures for every attachment of `framebuffer`, their contents undefined.
    #[must_use]
    pub fn new(device: &wgpu::Device, framebuffer: &Framebuffer) -> Self {
        let make = |format: wgpu::TextureFormat, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("attachment"),
                size: size(framebuffer.extent),
                mip_level_count: 1,
                sample_count: framebuffer.extent.samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let copied = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC | TextureUsages::COPY_DST;
        let colors = framebuffer.colors.iter();
        Self {
            extent: framebuffer.extent,
            colors: colors.map(|c| c.as_ref().map(|c| make(c.format().texture_format(), copied))).collect(),
            depth_stencil: framebuffer.depth_stencil.as_ref().map(|target| {
                let sampled = match target.format().depth() {
                    Some(_) => TextureUsages::TEXTURE_BINDING,
                    None => TextureUsages::empty(),
                };
                make(target.format().texture_format(), copied | sampled)
            }),
        }
    }

    /// Whether these textures have the extent and formats of `framebuffer`.
    #[must_use]
    pub fn fit(&self, framebuffer: &Framebuffer) -> bool {
        let ours = |texture: &Option<wgpu::Texture>| texture.as_ref().map(wgpu::Texture::format);
        self.extent == framebuffer.extent
            && self
                .colors
                .iter()
                .map(ours)
                .eq(framebuffer.colors.iter().map(|color| color.as_ref().map(|color| color.format().texture_format())))
            && ours(&self.depth_stencil)
                == framebuffer.depth_stencil.as_ref().map(|target| target.format().texture_format())
    }

    /// The depth/stencil texture without the color ones.
    #[must_use]
    pub fn depth_only(&self) -> Self {
        Self { extent: self.extent, colors: Vec::new(), depth_stencil: self.depth_stencil.clone() }
    }

    /// Records copies of all aspects of textures of the same formats and extent.
    pub fn copy_from(&self, encoder: &mut wgpu::CommandEncoder, others: &Self) {
        let ours = self.colors.iter().chain([&self.depth_stencil]).flatten();
        let theirs = others.colors.iter().chain([&others.depth_stencil]).flatten();
        for (to, from) in ours.zip(theirs) {
            encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), from.size());
        }
    }

    /// Copies all initial bytes that can be copied.
    pub fn upload(&self, queue: &wgpu::Queue, framebuffer: &Framebuffer) {
        for (texture, color) in self.colors.iter().zip(&framebuffer.colors) {
            if let (Some(texture), Some(color)) = (texture, color) {
                write(queue, texture, TextureAspect::All, color.bytes(), self.extent, color.format().bytes_per_texel());
            }
        }
        let (Some(texture), Some(target)) = (&self.depth_stencil, &framebuffer.depth_stencil) else { return };
        if target.format().has_stencil() {
            write(queue, texture, TextureAspect::StencilOnly, target.stencil(), self.extent, 1);
        }
        if target.format().depth() == Some(DepthKind::Unorm(16)) {
            let bytes: Vec<u8> =
                target.depth().iter().flat_map(|code| [code.to_le_bytes()[0], code.to_le_bytes()[1]]).collect();
            write(queue, texture, TextureAspect::DepthOnly, &bytes, self.extent, 2);
        }
    }
}

/// The depths that draw the initial depth codes; `None` when the codes are copied or there are none.
#[must_use]
pub fn seed_depth(target: &DepthStencilTarget) -> Option<Vec<f32>> {
    match target.format().depth()? {
        DepthKind::Unorm(16) => None,
        kind => Some(target.depth().iter().map(|&code| depth_as_f32(kind, code)).collect()),
    }
}

/// The binary32 depth nearest to a code's value; it quantises back to that code.
fn depth_as_f32(kind: DepthKind, code: u32) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to nearest is what is meant")]
    fn narrow(x: f64) -> f32 {
        x as f32
    }
    match kind {
        DepthKind::Float32 => f32::from_bits(code),
        DepthKind::Unorm(_) => narrow(kind.value(code)),
    }
}

/// The texture size of an extent.
#[must_use]
pub fn size(extent: Extent) -> wgpu::Extent3d {
    wgpu::Extent3d { width: extent.width, height: extent.height, depth_or_array_layers: 1 }
}

fn write(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    aspect: TextureAspect,
    bytes: &[u8],
    extent: Extent,
    each: usize,
) {
    let each = u32::try_from(each).unwrap_or(16);
    queue.write_texture(
        wgpu::TexelCopyTextureInfo { texture, mip_level: 0, origin: wgpu::Origin3d::ZERO, aspect },
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(extent.width * each),
            rows_per_image: Some(extent.height),
        },
        size(extent),
    );
}
