//! What the device has drawn of a frame that it culled by itself: read back when the frame is over, for
//! figures and pictures. An app has no need of it.

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
        let known = read_all(gpu, self.draws.iter().flat_map(|draw| [&draw.instances, &draw.arguments]))?;
        let words =
            |buffer: &Buffer| known.iter().find(|(known, _)| **known == *buffer).map(|(_, words)| words);
        let slots = |draw: &Draw| {
            let (first, at) = (draw.instances_offset as usize / 4, draw.arguments_offset as usize / 4);
            let count = *words(&draw.arguments)?.get(at + 1)? as usize;
            Some((draw.batch, words(&draw.instances)?.get(first..first + count)?.to_vec()))
        };
        let all: Option<_> = self.draws.iter().map(slots).collect();
        all.context("the device draws more than there is")
    }
}

/// The words of buffers, each read once. There are few: draws share them.
fn read_all<'a>(
    gpu: &Gpu,
    buffers: impl Iterator<Item = &'a Buffer>,
) -> anyhow::Result<Vec<(&'a Buffer, Vec<u32>)>> {
    let mut copies: Vec<(&Buffer, Buffer)> = Vec::new();
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for buffer in buffers {
        if copies.iter().all(|(known, _)| *known != buffer) {
            let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("read back"),
                size: buffer.size(),
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
            copies.push((buffer, copy));
        }
    }
    gpu.queue.submit([encoder.finish()]);
    copies.iter().for_each(|(_, copy)| copy.map_async(wgpu::MapMode::Read, .., |_| ()));
    gpu.wait()?;
    let read = |(buffer, copy): (&'a Buffer, Buffer)| {
        let Ok(bytes) = copy.get_mapped_range(..) else { bail!("{} gives nothing back", gpu.adapter()) };
        let words = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word));
        Ok((buffer, words.collect()))
    };
    copies.into_iter().map(read).collect()
}
