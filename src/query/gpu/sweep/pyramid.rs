//! The pyramid of farthest depths (Rákos 2010), rebuilt from the depth of a frame.
//!
//! All levels lie in one storage buffer, with sizes rounded up: as the mip levels of a texture they
//! go wrong silently on some drivers. The published code has two faults that are not here. Each level
//! folds what is there of the 2 × 2 texels below, whatever the size; and the test takes the level on
//! which a rectangle spans two texels at most, instead of computing it from the rectangle's size alone.

use wgpu::{
    BindGroup, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline, Device, ShaderModule,
};

use super::stage::{STAGES, compute, tiles};
use crate::geom::Viewport;
use crate::query::gpu::bind::{self, DepthAs, Layouts};
use crate::query::gpu::clock::Tape;

/// The binding of the pyramid, here and where it is read.
pub(super) const BINDING: u32 = 3;

/// The passes, and the pyramid.
#[derive(Debug)]
pub(in crate::query::gpu) struct Pyramid {
    layouts: Layouts,
    first: ComputePipeline,
    next: ComputePipeline,
    levels: Option<Levels>,
}

/// A pyramid's levels: each one's width and height.
#[derive(Debug)]
struct Levels {
    sizes: Vec<[u32; 2]>,
    buffer: Buffer,
    bindings: BindGroup,
}

impl Pyramid {
    pub(in crate::query::gpu) fn new(device: &Device, module: &ShaderModule, depth: DepthAs) -> Self {
        let layouts = Layouts::new(device, STAGES, &[(BINDING, true)], depth);
        let stage = |entry| compute(device, &layouts, module, entry);
        Self { first: stage("first"), next: stage("next"), layouts, levels: None }
    }

    /// Makes room for a viewport's pyramid; whether the device can bind it.
    pub(in crate::query::gpu) fn resize(&mut self, device: &Device, viewport: Viewport) -> bool {
        let sizes = sizes(viewport);
        if self.levels.as_ref().is_some_and(|levels| levels.sizes == sizes) {
            return true;
        }
        let texels: u64 = sizes.iter().map(|&[width, height]| u64::from(width) * u64::from(height)).sum();
        if 4 * texels > device.limits().max_storage_buffer_binding_size {
            return false;
        }
        let buffer = device.create_buffer(&BufferDescriptor {
            label: Some("tercet pyramid"),
            size: 4 * texels,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let whole = [(BINDING, buffer.as_entire_buffer_binding())];
        let bindings = bind::storage(device, &self.layouts.batch, &whole);
        self.levels = Some(Levels { sizes, buffer, bindings });
        true
    }

    /// The levels' sizes, and the buffer that holds them one after the other.
    pub(in crate::query::gpu) fn levels(&self) -> Option<(&[[u32; 2]], &Buffer)> {
        self.levels.as_ref().map(|levels| (&levels.sizes[..], &levels.buffer))
    }

    /// What the test binds.
    pub(super) fn binding(&self) -> Option<BufferBinding<'_>> {
        self.levels.as_ref().map(|levels| levels.buffer.as_entire_buffer_binding())
    }

    /// Records the building from the depth of a frame.
    pub(in crate::query::gpu) fn record(&self, tape: &mut Tape<'_>, frame: &BindGroup) {
        let Some(Levels { sizes, bindings, .. }) = &self.levels else { return };
        let mut pass = tape.compute_pass("tercet pyramid");
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, bindings, &[]);
        for (level, &size) in (0..).zip(sizes) {
            let [columns, rows] = tiles(size);
            pass.set_pipeline(if level == 0 { &self.first } else { &self.next });
            // The grid's depth says which level it is; only its first layer works.
            pass.dispatch_workgroups(columns, rows, level.max(1));
        }
    }
}

/// The widths and heights of all levels, from half the viewport's down to a single texel.
fn sizes(viewport: Viewport) -> Vec<[u32; 2]> {
    let mut all = vec![[viewport.width.div_ceil(2), viewport.height.div_ceil(2)]];
    while all[all.len() - 1] != [1, 1] {
        let [width, height] = all[all.len() - 1];
        all.push([width.div_ceil(2), height.div_ceil(2)]);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_hold_all_pixels_down_to_one_texel() {
        let of = |width, height| sizes(Viewport::new(width, height));
        assert_eq!(of(1, 1), [[1, 1]]);
        assert_eq!(of(2, 2), [[1, 1]]);
        assert_eq!(of(5, 1), [[3, 1], [2, 1], [1, 1]]);
        assert_eq!(of(1023, 767).len(), 10);
        assert_eq!(of(16_384, 3).len(), 14);
        for (level, [width, height]) in of(333, 1000).into_iter().enumerate() {
            // As the shader takes them, in one step.
            assert_eq!([width, height], [333u32, 1000].map(|side| side.div_ceil(2 << level)));
        }
    }
}
