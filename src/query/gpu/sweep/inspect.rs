//! What the device has made, read back to look at: for tests, and for pictures of how a frame is
//! culled. Everything here waits for the device.

use bytemuck::{Pod, pod_collect_to_vec, try_cast_slice};
use wgpu::{Buffer, BufferDescriptor, BufferUsages, MapMode};

use super::asked::{OUTSIDE, SEEN};
use super::enclose::PackedNode;
use super::looks::Looks;
use crate::Error;
use crate::geom::{PixelRect, Question};
use crate::query::gpu::pack::PackedProxy;
use crate::query::gpu::{GpuQueries, frame, guard};
use crate::query::{Sweep, SweepTest};
use crate::scene::ObjectId;
use crate::tree::NodeId;

/// A level of the pyramid of farthest depths.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Texels in a row; each stands for 2 pixels along each side on the first level, for twice as many
    /// on each further one.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The least nearness of a texel's samples, row by row.
    pub nearness: Vec<f32>,
}

impl GpuQueries {
    /// What the device asks about the objects of a sweep that meet its frustum. Blocks.
    ///
    /// # Errors
    /// [`Error::Target`] outside a frame; what the device reports.
    pub fn inspect_proxies(&mut self, sweep: &Sweep<'_>) -> Result<Vec<(ObjectId, Question)>, Error> {
        let index = self.record_looks(sweep, None)?;
        let swept = &self.sweeps.as_ref().expect("it was recorded").sweeps[index];
        let (ids, asked) =
            (swept.targets.ids.clone(), &swept.looked.as_ref().expect("it was recorded").asked);
        let [proxies, verdicts] = [asked.proxies(), asked.verdicts()].map(|binding| binding.buffer.clone());
        let proxies: Vec<PackedProxy> = self.read_now(&proxies, ids.len())?;
        let verdicts: Vec<u32> = self.read_now(&verdicts, ids.len())?;
        let question = |(proxy, verdict): (PackedProxy, u32)| match verdict {
            OUTSIDE => Question::Outside,
            SEEN => Question::Visible,
            _ => Question::Ask(proxy.unpacked()),
        };
        Ok(ids.into_iter().zip(proxies.into_iter().zip(verdicts).map(question)).collect())
    }

    /// Into which groups a sweep by rays casts them, and over which pixels of the viewport: those of the sweep,
    /// and what stands for such as are opened. None for the pixels of a group that the device cannot place:
    /// its rays would go everywhere; no pixels where all of it is known to be hidden. Rays go over the part of these
    /// where something is open, if they are less work than its objects one by one. Blocks.
    ///
    /// # Errors
    /// [`Error::Target`] outside a frame; what the device reports.
    pub fn inspect_groups(&mut self, sweep: &Sweep<'_>) -> Result<Vec<(NodeId, Option<PixelRect>)>, Error> {
        let index = self.record_looks(sweep, Some(SweepTest::Rays))?;
        let sweeps = self.sweeps.as_ref().expect("it was recorded");
        let groups = sweeps.sweeps[index].targets.groups.clone();
        let Some(nodes) = sweeps.looks.as_ref().and_then(Looks::nodes) else { return Ok(Vec::new()) };
        let (buffer, count) = (nodes.buffer().clone(), nodes.count() as usize);
        let nodes: Vec<PackedNode> = self.read_now(&buffer, count)?;
        Ok(groups.into_iter().map(|group| (group, nodes[group.index()].pixels())).collect())
    }

    /// The pyramid of what has been drawn so far, from half the viewport's size down to one texel.
    /// Blocks.
    ///
    /// # Errors
    /// [`Error::Target`] outside a frame; [`Error::Device`] for a viewport whose pyramid the device
    /// cannot bind, and what it reports.
    pub fn inspect_pyramid(&mut self) -> Result<Vec<Level>, Error> {
        self.bind_looks()?;
        let frame = self.frame.as_mut().ok_or_else(frame::not_begun)?;
        let sweeps = self.sweeps.as_mut().expect("they are bound");
        let looks = sweeps.looks.as_mut().expect("they are bound");
        let passes = looks.passes[usize::from(frame.view.samples() > 1)].as_mut().expect("made when bound");
        let bound = looks.bound.as_ref().expect("they are bound");
        let pyramid = &mut passes.pyramid;
        guard::guarded(&self.device, || {
            let fits = pyramid.resize(&self.device, frame.view.viewport());
            pyramid.record(&mut frame::tape(&mut frame.encoder, &self.device, &mut self.clock), &bound.frame);
            fits.then_some(())
                .ok_or_else(|| guard::failed("it cannot bind the pyramid of so large a viewport"))
        })??;
        let (sizes, buffer) = pyramid.levels().expect("it was recorded");
        let (sizes, buffer) = (sizes.to_vec(), buffer.clone());
        let texels: Vec<f32> = self.read_now(&buffer, buffer.size() as usize / size_of::<f32>())?;
        let mut rest = texels.as_slice();
        let level = |[width, height]: [u32; 2]| {
            let (nearness, after) = rest.split_at((width * height) as usize);
            rest = after;
            Level { width, height, nearness: nearness.to_vec() }
        };
        Ok(sizes.into_iter().map(level).collect())
    }

    /// Submits what was recorded, and reads elements of a buffer.
    fn read_now<T: Pod>(&mut self, buffer: &Buffer, count: usize) -> Result<Vec<T>, Error> {
        let bytes = (count * size_of::<T>()) as u64;
        if bytes == 0 {
            return Ok(Vec::new());
        }
        let frame = self.frame.as_mut().ok_or_else(frame::not_begun)?;
        let back = guard::guarded(&self.device, || {
            let back = self.device.create_buffer(&BufferDescriptor {
                label: Some("tercet inspected"),
                size: bytes,
                usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let tape = frame::tape(&mut frame.encoder, &self.device, &mut self.clock);
            tape.encoder.copy_buffer_to_buffer(buffer, 0, &back, 0, bytes);
            back
        })?;
        self.submit()?;
        back.map_async(MapMode::Read, .., |_| ());
        let index = self.frame.as_ref().and_then(|frame| frame.last_submission.clone());
        guard::wait(&self.device, index.ok_or_else(frame::not_begun)?, self.config.timeout)?;
        let view = back.get_mapped_range(..).map_err(guard::failed)?;
        Ok(try_cast_slice(&view).map_or_else(|_| pod_collect_to_vec(&view), <[T]>::to_vec))
    }
}
