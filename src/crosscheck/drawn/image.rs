//! A scene's textures on the device: linear values in binary32, every mip level, read texel by texel.

use wgpu::{TextureFormat, TextureUsages};

use crate::crosscheck::device::Device;
use crate::scene::texture::Texture;

/// Uploads a texture's levels.
#[must_use]
pub fn upload(device: &Device, texture: &Texture) -> wgpu::TextureView {
    let levels: Vec<_> = texture.levels().iter().map(|level| (level.width(), level.height(), level.texels())).collect();
    make(device, &levels)
}

/// One white texel, for draws without a texture.
#[must_use]
pub fn white(device: &Device) -> wgpu::TextureView {
    make(device, &[(1, 1, &[[1.0; 4]])])
}

fn make(device: &Device, levels: &[(u32, u32, &[[f32; 4]])]) -> wgpu::TextureView {
    let size = |width, height| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("scene texture"),
        size: size(levels[0].0, levels[0].1),
        mip_level_count: u32::try_from(levels.len()).unwrap_or(1),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba32Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, &(width, height, texels)) in (0..).zip(levels) {
        device.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * width), rows_per_image: Some(height) },
            size(width, height),
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
