//! What the device has drawn of a frame that it culled by itself: read back when the frame is over, for
//! figures and pictures. An app has no need of it.

use std::collections::HashMap;

use anyhow::{Context, bail};
use tercet::query::gpu::{IndirectBatch, wgpu};
use tercet::scene::Batch;
use wgpu::Buffer;

use super::Gpu;

/// The draws of a frame.
#[derive(Default)]
pub struct Lists {
    draws: Vec<Draw>,
}

struct Draw {
    batch: Batch,
    instances: Buffer,
    instances_offset: u64,
    arguments: Buffer,
    arguments_offset: u64,
}

impl Lists {
    /// Notes draws that are being recorded.
    pub fn note(&mut self, batches: &[IndirectBatch<'_>]) {
        self.draws.extend(batches.iter().map(|draw| Draw {
            batch: draw.batch,
            instances: draw.instances.clone(),
            instances_offset: draw.instances_offset,
            arguments: draw.arguments.clone(),
            arguments_offset: draw.arguments_offset,
        }));
    }

    /// The slots that each draw has drawn; after the frame was submitted, and before the next one is.
    ///
    /// # Errors
    /// What the device reports.
    pub fn read(&self, gpu: &Gpu) -> anyhow::Result<Vec<(Batch, Vec<u32>)>> {
        let words = read_all(gpu, self.draws.iter().flat_map(|draw| [&draw.instances, &draw.arguments]))?;
        let slots = |draw: &Draw| {
            let count = words[&draw.arguments][draw.arguments_offset as usize / 4 + 1] as usize;
            let first = draw.instances_offset as usize / 4;
            let slots = words[&draw.instances].get(first..first + count);
            slots.map(|slots| (draw.batch, slots.to_vec())).context("the device draws more than there is")
        };
        self.draws.iter().map(slots).collect()
    }
}

/// The words of buffers, each read once.
fn read_all<'a>(
    gpu: &Gpu,
    buffers: impl Iterator<Item = &'a Buffer>,
) -> anyhow::Result<HashMap<&'a Buffer, Vec<u32>>> {
    let mut copies: HashMap<&Buffer, Buffer> = HashMap::new();
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for buffer in buffers {
        copies.entry(buffer).or_insert_with(|| {
            let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("read back"),
                size: buffer.size(),
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
            copy
        });
    }
    gpu.queue.submit([encoder.finish()]);
    copies.values().for_each(|copy| copy.map_async(wgpu::MapMode::Read, .., |_| ()));
    gpu.wait()?;
    let read = |(buffer, copy): (&'a Buffer, Buffer)| {
        let Ok(bytes) = copy.get_mapped_range(..) else { bail!("{} gives nothing back", gpu.adapter()) };
        let words = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
        Ok((buffer, words.collect()))
    };
    copies.into_iter().map(read).collect()
}
