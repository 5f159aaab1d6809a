//! The reference renderer: what the demos, the tests and the benches draw with on wgpu.
//!
//! It draws entities with a [`Drawable`], many at once: the objects of a call are grouped by mesh
//! and level of detail, and each group is one instanced draw. Only what is drawn is uploaded. No
//! optional feature of the device is needed.
//!
//! ```no_run
//! use tercet::Culler;
//! use tercet::draw::{Detail, Renderer, Shading};
//! use tercet::geom::View;
//! use tercet::policy::DualQuery;
//! use tercet::query::gpu::{FrameTargets, GpuQueries, wgpu};
//! use tercet::scene::Scene;
//!
//! fn frame(
//!     (scene, world, view): (&Scene, &hecs::World, &View),
//!     (eye, queries, renderer): (&mut Culler<DualQuery>, &mut GpuQueries, &mut Renderer),
//!     (color, depth): (wgpu::TextureView, wgpu::TextureView),
//! ) -> Result<(), tercet::Error> {
//!     let sky = wgpu::LoadOp::Clear(wgpu::Color { r: 0.4, g: 0.6, b: 0.8, a: 1.0 });
//!     queries.target(&FrameTargets::new(depth).with_color(color, sky));
//!     renderer.begin(view, Detail::default(), Shading::Lit);
//!     eye.frame(scene, view, queries, |pass, objects| {
//!         renderer.draw(pass, world, objects);
//!     })?;
//!     println!("{} triangles", renderer.stats().drawn.triangles);
//!     Ok(())
//! }
//! ```
//!
//! # The same frame, whatever is left out
//!
//! An object's level of detail follows from object and view alone, and a vertex's position from
//! vertex, object and view: not from who else is drawn, nor from the order. So a culled frame has
//! the depth of the whole one, bit for bit, and its colours wherever one object alone is nearest.
//! Where several share the nearest depth the one drawn last shows, as everywhere.
//!
//! Positions are transformed in f32 twice, by `world_from_object` and by the view's matrix:
//! that is what the bounds of [`Mesh::bounds_under`] and of `geom/proxy.rs` allow for. Positions
//! relative to the eye would be steadier far from the origin, but no longer those.
//!
//! | file | |
//! |---|---|
//! | `batch` | the objects of one call, put together by mesh and level |
//! | `arena` | room on the device for what one frame draws |
//! | `by_slot` | all objects on the device, for frames that it culls by itself |
//! | `geometry`, `normals` | meshes on the device |
//! | `camera` | the view as the shaders read it |
//! | `colors` | of objects, and formats of targets |
//! | `pipelines`, `kinds`, `vertices` | made when first needed; what each draws, and reads |
//! | `look_ups` | a texture, where shading is to be dear |
//! | `overlays` | boxes and polygons over a frame |

mod arena;
mod batch;
mod by_slot;
mod camera;
mod colors;
mod geometry;
mod kinds;
mod look_ups;
mod normals;
mod overlays;
mod pipelines;
mod vertices;

use std::ops::AddAssign;

use bytemuck::{bytes_of, cast_slice};
use wgpu::{
    BindGroup, Buffer, BufferDescriptor, BufferUsages, Device, IndexFormat, Queue, RenderPass, TextureFormat,
};

pub use by_slot::BySlot;
pub use overlays::Lines;

use super::{Detail, Drawable};
use crate::Error;
use crate::geom::View;
use crate::scene::ObjectRef;
use crate::scene::mesh::Mesh;
use arena::Arena;
use batch::{Batch, Instance, Sorted};
use camera::PackedCamera;
use colors::{check, linear, takes_linear, tinted};
use geometry::Geometry;
use kinds::{Kind, Source};
use pipelines::Pipelines;

/// How surfaces look. Without a colour target there is only depth, whatever is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Shading {
    /// By a sun, the sky, the ground and a little light from the eye.
    #[default]
    Lit,
    /// In their own colours.
    Unlit,
    /// By the number of layers that are drawn, hidden ones included, over black: red, orange,
    /// yellow, white. Every surface is drawn twice.
    Overdraw,
}

/// What was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Triangles of all instances; once, although [`Shading::Overdraw`] draws them twice.
    pub triangles: u64,
    /// Objects with something to draw.
    pub instances: u64,
    /// Draw calls.
    pub draws: u64,
}

/// Counters of a [`Renderer`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RendererStats {
    /// Surfaces since the frame began.
    pub drawn: Drawn,
    /// Bytes of objects, boxes and outlines that were uploaded since the frame began.
    pub uploaded: u64,
    /// Buffers for them.
    pub frame_buffers: usize,
    /// Meshes on the device.
    pub meshes: usize,
    /// And their bytes.
    pub mesh_bytes: u64,
}

/// Draws entities with a [`Drawable`] into wgpu passes; see the module's example.
///
/// Its depth is Depth32Float or Depth24Plus without stencil, as the view says, and so are sample
/// count and direction of depth. Passes need one colour attachment of the format that it was made
/// for, or none; with ids, a second one.
#[derive(Debug)]
pub struct Renderer {
    device: Device,
    queue: Queue,
    color: Option<TextureFormat>,
    has_ids: bool,
    pipelines: Pipelines,
    uniforms: Buffer,
    bindings: BindGroup,
    geometry: Geometry,
    batch: Batch,
    arena: Arena,
    /// By sRGB byte: the linear fraction of 65535.
    linear: [u16; 256],
    look_ups: u32,
    frame: Option<Frame>,
    drawn: Drawn,
    uploaded: u64,
}

/// What a frame is drawn with.
#[derive(Clone, Debug)]
struct Frame {
    view: View,
    detail: Detail,
    shading: Shading,
}

/// The most objects of one draw: what they need fits the buffers of every device.
const MOST: usize = 1 << 20;

impl Renderer {
    /// The format of item buffers: see [`Renderer::with_ids`].
    pub const IDS: TextureFormat = TextureFormat::Rg16Uint;

    /// A renderer on the app's device, whose handles it clones. Without a colour format it draws
    /// depth alone: shadow maps.
    ///
    /// # Errors
    /// [`Error::Target`] for a format that is no colour with at least three channels, or that
    /// cannot be drawn to and blended.
    pub fn new(device: &Device, queue: &Queue, color: Option<TextureFormat>) -> Result<Self, Error> {
        Self::made(device, queue, color, false)
    }

    /// The same with an item buffer, which says who owns each sample: a second colour attachment, of the
    /// format [`Renderer::IDS`], as
    /// [`GpuQueries::target_ids`](crate::query::gpu::GpuQueries::target_ids) wants it. The draws that write
    /// the depth write it too, whatever the shading.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_ids(device: &Device, queue: &Queue, color: Option<TextureFormat>) -> Result<Self, Error> {
        Self::made(device, queue, color, true)
    }

    fn made(
        device: &Device,
        queue: &Queue,
        color: Option<TextureFormat>,
        has_ids: bool,
    ) -> Result<Self, Error> {
        if let Some(format) = color {
            check(format, device)?;
        }
        let pipelines = Pipelines::new(device, color, has_ids);
        let uniforms = device.create_buffer(&BufferDescriptor {
            label: Some("tercet camera"),
            size: size_of::<PackedCamera>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            color,
            has_ids,
            bindings: pipelines.bind(device, &uniforms),
            pipelines,
            uniforms,
            geometry: Geometry::default(),
            batch: Batch::default(),
            arena: Arena::default(),
            linear: std::array::from_fn(linear),
            look_ups: 0,
            frame: None,
            drawn: Drawn::default(),
            uploaded: 0,
        })
    }

    /// Starts a frame of a view.
    ///
    /// What was recorded before must have been submitted: its uniforms and objects are overwritten.
    /// ([`Culler::frame`](crate::Culler::frame) on the GPU backend submits all of its own.) Views
    /// that are submitted together need a renderer each.
    pub fn begin(&mut self, view: &View, detail: Detail, shading: Shading) {
        let encodes = self.color.is_some_and(|format| !takes_linear(format));
        self.queue.write_buffer(&self.uniforms, 0, bytes_of(&PackedCamera::new(view, encodes)));
        self.arena.clear();
        (self.drawn, self.uploaded) = (Drawn::default(), 0);
        self.frame = Some(Frame { view: view.clone(), detail, shading });
    }

    /// How often [`Shading::Lit`] looks into a texture for each fragment, each time where the last texel
    /// says: a measure of how dear an app's own shading is. Surfaces look mottled then. With 0, as at
    /// first, there is no texture.
    pub fn set_look_ups(&mut self, count: u32) {
        self.look_ups = count;
    }

    /// Draws objects. Whoever has no [`Drawable`] is left out; before the first
    /// [`Renderer::begin`], everybody is.
    ///
    /// Meshes that are new are uploaded. O(objects); no memory is allocated once a frame like this
    /// one has been drawn. Sets pipeline, bind group 0 (and 1 for look-ups), vertex buffers 0 and 1 (and 2 for
    /// ids) and the index buffer.
    pub fn draw(
        &mut self,
        pass: &mut RenderPass<'static>,
        world: &hecs::World,
        objects: &[ObjectRef],
    ) -> Drawn {
        self.draw_all(pass, world, objects.iter().map(|&object| (object, [0; 4])))
    }

    /// The same, with a colour laid over each object's own: alpha 255 replaces it, alpha 0 leaves
    /// it as it is. Surfaces stay opaque.
    pub fn draw_tinted(
        &mut self,
        pass: &mut RenderPass<'static>,
        world: &hecs::World,
        objects: impl IntoIterator<Item = (ObjectRef, [u8; 4])>,
    ) -> Drawn {
        self.draw_all(pass, world, objects.into_iter())
    }

    /// Uploads a mesh before it is first drawn, so that drawing it takes no longer than usual.
    pub fn upload(&mut self, mesh: &Mesh) {
        self.geometry.first_group(&self.device, mesh);
    }

    /// Frees the device's memory of a mesh that is not drawn any more. O(meshes).
    pub fn forget(&mut self, mesh: &Mesh) {
        self.geometry.forget(mesh);
    }

    /// What the frame has come to so far, and what is kept.
    pub fn stats(&self) -> RendererStats {
        let (meshes, mesh_bytes) = self.geometry.size();
        let (drawn, uploaded) = (self.drawn, self.uploaded);
        RendererStats { drawn, uploaded, frame_buffers: self.arena.buffers(), meshes, mesh_bytes }
    }

    fn draw_all(
        &mut self,
        pass: &mut RenderPass<'static>,
        world: &hecs::World,
        objects: impl Iterator<Item = (ObjectRef, [u8; 4])>,
    ) -> Drawn {
        let mut drawn = Drawn::default();
        let Some(frame) = self.frame.take() else { return drawn };
        let drawables = world.view::<&Drawable>();
        for (object, tint) in objects {
            let Some(drawable) = drawables.get(object.entity()) else { continue };
            let Drawable { mesh, world_from_object, color } = drawable;
            let level = frame.detail.level(mesh, world_from_object, &frame.view);
            let group = self.geometry.first_group(&self.device, mesh) + level as u32;
            if self.geometry.group(group).index_count == 0 {
                continue;
            }
            let color = tinted(*color, tint).map(|c| self.linear[usize::from(c)]);
            self.batch.push(group, Instance::new(world_from_object, color), object.id.slot() as u32 + 1);
            if self.batch.len() == MOST {
                drawn += self.draw_batch(pass, &frame);
            }
        }
        drawn += self.draw_batch(pass, &frame);
        self.frame = Some(frame);
        self.drawn += drawn;
        drawn
    }

    fn draw_batch(&mut self, pass: &mut RenderPass<'static>, frame: &Frame) -> Drawn {
        let mut drawn = Drawn::default();
        let Sorted { instances, ids, runs } = self.batch.sort();
        if instances.is_empty() {
            return drawn;
        }
        let bytes = cast_slice(instances);
        let (buffer, offset) = self.arena.write(&self.device, &self.queue, bytes);
        self.uploaded += bytes.len() as u64;
        let ids = self.has_ids.then(|| {
            self.uploaded += size_of_val(ids) as u64;
            self.arena.write(&self.device, &self.queue, cast_slice(ids))
        });
        drawn.instances = instances.len() as u64;
        for run in runs {
            let triangles = u64::from(self.geometry.group(run.group).index_count / 3);
            drawn.triangles += triangles * run.instances.len() as u64;
        }
        pass.set_bind_group(0, &self.bindings, &[]);
        let source = if self.has_ids { Source::Identified } else { Source::Instances };
        for kind in Kind::of(frame.shading, self.color.is_some(), self.look_ups) {
            self.pipelines.set(pass, (&self.device, &self.queue), kind, source, &frame.view);
            for run in runs {
                let group = self.geometry.group(run.group);
                // The instances' buffer is moved to the first one, since a first instance other
                // than 0 is not to be had everywhere.
                let first = offset + u64::from(run.instances.start) * size_of::<Instance>() as u64;
                pass.set_vertex_buffer(0, group.vertices.slice(..));
                pass.set_vertex_buffer(1, buffer.slice(first..));
                if let Some((ids, offset)) = &ids {
                    let first = offset + u64::from(run.instances.start) * size_of::<u32>() as u64;
                    pass.set_vertex_buffer(2, ids.slice(first..));
                }
                pass.set_index_buffer(group.indices.slice(..), IndexFormat::Uint32);
                pass.draw_indexed(0..group.index_count, 0, 0..run.instances.len() as u32);
                drawn.draws += 1;
            }
        }
        drawn
    }
}

impl AddAssign for Drawn {
    fn add_assign(&mut self, other: Self) {
        self.triangles += other.triangles;
        self.instances += other.instances;
        self.draws += other.draws;
    }
}
