//! A texture to look things up in: surfaces that are dearer to shade, for measurements.
//!
//! Apps shade a fragment with anything from one to dozens of texture look-ups; what culling saves
//! depends on it. This stands in for that: noise, read again and again, each time where the last
//! texel says. So no compiler can leave a look-up out, and no cache can know the next one.

use wgpu::{
    AddressMode, BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, Device, Extent3d, FilterMode, Origin3d, Queue,
    SamplerBindingType, SamplerDescriptor, ShaderStages, TexelCopyBufferLayout, TexelCopyTextureInfo,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureSampleType, TextureUsages,
    TextureViewDescriptor, TextureViewDimension,
};

/// Texels a side: 1 MiB in all, as much as a GPU's caches just hold.
const SIDE: u32 = 512;

/// The texture, as group 1 of a pipeline.
#[derive(Debug)]
pub(super) struct LookUps {
    pub(super) layout: BindGroupLayout,
    pub(super) bindings: BindGroup,
}

impl LookUps {
    pub(super) fn new(device: &Device, queue: &Queue) -> Self {
        let label = Some("tercet look-ups");
        let entry = |binding, ty| BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: true },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
        let layout = device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label,
            entries: &[entry(0, texture), entry(1, sampler)],
        });
        let sampler = device.create_sampler(&SamplerDescriptor {
            label,
            address_mode_u: AddressMode::Repeat,
            address_mode_v: AddressMode::Repeat,
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            ..Default::default()
        });
        let bindings = device.create_bind_group(&BindGroupDescriptor {
            label,
            layout: &layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: BindingResource::TextureView(&upload(device, queue)) },
                BindGroupEntry { binding: 1, resource: BindingResource::Sampler(&sampler) },
            ],
        });
        Self { layout, bindings }
    }
}

fn upload(device: &Device, queue: &Queue) -> wgpu::TextureView {
    let size = Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 };
    let texture = device.create_texture(&TextureDescriptor {
        label: Some("tercet noise"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba8Unorm,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<u8> = (0..SIDE * SIDE).flat_map(|texel| noise(texel).to_le_bytes()).collect();
    let whole = TexelCopyTextureInfo {
        texture: &texture,
        mip_level: 0,
        origin: Origin3d::ZERO,
        aspect: TextureAspect::All,
    };
    let rows = TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIDE), rows_per_image: None };
    queue.write_texture(whole, &texels, rows, size);
    texture.create_view(&TextureViewDescriptor::default())
}

/// As good as random, and the same on every device.
fn noise(texel: u32) -> u32 {
    let x = texel.wrapping_add(1).wrapping_mul(0x9E37_79B1);
    let x = (x ^ x >> 15).wrapping_mul(0x85EB_CA77);
    let x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE3D);
    x ^ x >> 16
}
