//! All objects on the device, by slot: what frames are drawn from that the device culls by itself.
//!
//! Nobody on the host knows what such a frame draws. So nothing can be sent along with it: what an
//! instance needs lies on the device already, for every object, and what has changed is uploaded. Nor can
//! a level of detail be chosen by what is in view and how near: every mesh is drawn as its finest level.
//! Choosing on the host would be a look at each object in each frame, and an order by mesh *and* level
//! that changes whenever the eye moves; that order is what stays as it is here.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use hecs::{Entity, World};
use rayon::prelude::*;
use wgpu::{BufferBinding, Device, IndexFormat, Queue, RenderPass};

use super::Renderer;
use super::batch::Instance;
use super::colors::linear;
use super::kinds::{Kind, Source};
use crate::Error;
use crate::draw::Drawable;
use crate::query::gpu::{BatchMesh, IndirectBatch, Mirrored};
use crate::scene::mesh::{Mesh, MeshId};
use crate::scene::{Batch, Scene};

/// What the device needs to draw any object of a scene: its transform and colour, and which mesh each
/// [`Batch`] stands for. One for all views of a scene; [`Renderer::draw_batches`] draws from it.
///
/// ```no_run
/// use tercet::draw::{BySlot, Detail, Renderer, Shading};
/// use tercet::geom::View;
/// use tercet::query::gpu::{FrameTargets, IndirectCuller, wgpu};
/// use tercet::scene::Scene;
///
/// fn frame(
///     (device, queue): (&wgpu::Device, &wgpu::Queue),
///     (world, scene, view): (&mut hecs::World, &mut Scene, &View),
///     (eye, renderer, by_slot): (&mut IndirectCuller, &mut Renderer, &mut BySlot),
///     targets: &FrameTargets,
/// ) -> Result<(), tercet::Error> {
///     by_slot.dress(world); // after spawning, and after an entity has got another mesh
///     scene.sync(world);
///     by_slot.follow(scene, world)?;
///     renderer.begin(view, Detail::FULL, Shading::Lit);
///     let mut encoder = device.create_command_encoder(&Default::default());
///     eye.frame(scene, view, targets, by_slot.meshes(), &mut encoder, |pass, batches| {
///         renderer.draw_batches(pass, by_slot, batches);
///     })?;
///     queue.submit([encoder.finish()]);
///     Ok(())
/// }
/// ```
#[derive(Debug)]
pub struct BySlot {
    device: Device,
    queue: Queue,
    objects: Mirrored<Object>,
    /// Reused by uploads.
    scratch: Vec<Object>,
    /// By sRGB byte.
    linear: [f32; 256],
    known: HashMap<MeshId, Batch>,
    /// By number of the batch; None for one that is free.
    of: Vec<Option<Mesh>>,
    free: Vec<Batch>,
    meshes: Vec<BatchMesh>,
}

/// Objects that a thread takes at a time, at least: tens of microseconds of work.
const LEAST: usize = 1024;

/// The twin of `Object` in `shaders/by_slot.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct Object {
    /// The rows of `world_from_object`.
    rows: [[f32; 4]; 3],
    /// Linear red, green and blue, as the vertex fetch of [`Instance`] makes them.
    color: [f32; 4],
}

impl BySlot {
    /// Nothing yet, on the app's device, whose handles it clones.
    pub fn new(device: &Device, queue: &Queue) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            objects: Mirrored::new(device, "tercet objects by slot"),
            scratch: Vec::new(),
            linear: std::array::from_fn(|byte| f32::from(linear(byte)) / f32::from(u16::MAX)),
            known: HashMap::new(),
            of: Vec::new(),
            free: Vec::new(),
            meshes: Vec::new(),
        }
    }

    /// Gives every entity with a [`Drawable`] the [`Batch`] of its mesh, before [`Scene::sync`] reads it.
    /// Returns how many had none, or another one. To be called when something was spawned, or has another
    /// mesh. O(entities).
    pub fn dress(&mut self, world: &mut World) -> usize {
        let mut changed = Vec::new();
        for (entity, drawable, batch) in world.query_mut::<(Entity, &Drawable, Option<&Batch>)>() {
            if !batch.is_some_and(|&batch| self.is_of(batch, &drawable.mesh)) {
                changed.push((entity, self.batch_of(&drawable.mesh)));
            }
        }
        for &(entity, batch) in &changed {
            world.insert_one(entity, batch).expect("it was there a moment ago");
        }
        changed.len()
    }

    /// Uploads the transforms and colours that have changed; after [`Scene::sync`], in each frame in which
    /// something has. Returns the bytes. What has no [`Drawable`] draws nothing. O(slots), on all
    /// cores, and a comparison with what the device has.
    ///
    /// # Errors
    /// [`Error::Device`] for more objects than the device's buffers hold.
    pub fn follow(&mut self, scene: &Scene, world: &World) -> Result<u64, Error> {
        let Self { device, queue, objects, scratch, linear, .. } = self;
        let (store, drawables) = (scene.objects_store(), world.view::<&Drawable>());
        scratch.resize(scene.slot_bound(), Object::zeroed());
        scratch.par_iter_mut().with_min_len(LEAST).enumerate().for_each(|(slot, object)| {
            // A free slot stands for no entity.
            let drawable = drawables.get(store.entity(slot as u32));
            *object = drawable.map_or(Object::zeroed(), |drawable| Object::new(drawable, linear));
        });
        objects.follow(device, queue, scratch)
    }

    /// What the objects of each batch draw, by its number: for
    /// [`IndirectCuller::frame`](crate::query::gpu::IndirectCuller::frame).
    pub fn meshes(&self) -> &[BatchMesh] {
        &self.meshes
    }

    /// Forgets a mesh that no entity has any more; its number is given to the next one that is new. If some
    /// entity has it after all, nothing is drawn of it until [`BySlot::dress`] has given it another.
    pub fn forget(&mut self, mesh: &Mesh) {
        if let Some(batch) = self.known.remove(&mesh.id()) {
            self.of[batch.0 as usize] = None;
            self.meshes[batch.0 as usize] = BatchMesh::default();
            self.free.push(batch);
        }
    }

    fn is_of(&self, batch: Batch, mesh: &Mesh) -> bool {
        self.mesh(batch).is_some_and(|own| own.id() == mesh.id())
    }

    fn mesh(&self, batch: Batch) -> Option<&Mesh> {
        self.of.get(batch.0 as usize)?.as_ref()
    }

    fn batch_of(&mut self, mesh: &Mesh) -> Batch {
        let Self { known, of, free, meshes, .. } = self;
        *known.entry(mesh.id()).or_insert_with(|| {
            let batch = free.pop().unwrap_or_else(|| {
                of.push(None);
                meshes.push(BatchMesh::default());
                Batch(of.len() as u32 - 1)
            });
            of[batch.0 as usize] = Some(mesh.clone());
            // Each mesh has buffers of its own, in which it begins at 0.
            meshes[batch.0 as usize].index_count = mesh.levels()[0].indices.len() as u32;
            batch
        })
    }

    fn binding(&self) -> BufferBinding<'_> {
        self.objects.binding()
    }
}

impl Object {
    fn new(drawable: &Drawable, linear: &[f32; 256]) -> Self {
        let Instance { rows, .. } = Instance::new(&drawable.world_from_object, [0; 3]);
        let [r, g, b] = drawable.color.map(|byte| linear[usize::from(byte)]);
        Self { rows, color: [r, g, b, 1.0] }
    }
}

impl Renderer {
    /// Draws batches of a frame that the device culls by itself, with the very positions of
    /// [`Renderer::draw`] at [`Detail::FULL`](super::Detail::FULL), whatever detail the frame began with. Meshes that
    /// are new are uploaded. An item buffer is left as it is.
    ///
    /// [`RendererStats::drawn`](super::RendererStats::drawn) counts draws alone: what they draw, the
    /// device knows. Sets pipeline, bind group 0 (and 1 for look-ups), vertex buffers 0 and 1 and the index
    /// buffer. The device must have storage buffers in vertex shaders, as WebGPU has.
    pub fn draw_batches(
        &mut self,
        pass: &mut RenderPass<'static>,
        by_slot: &BySlot,
        batches: &[IndirectBatch<'_>],
    ) {
        let Self { device, queue, pipelines, geometry, uniforms, frame, .. } = self;
        let Some(frame) = frame else { return };
        pass.set_bind_group(0, &pipelines.bind_by_slot(device, uniforms, by_slot.binding()), &[]);
        for kind in Kind::of(frame.shading, self.color.is_some(), self.look_ups) {
            pipelines.set(pass, (device, queue), kind, Source::Slots, &frame.view);
            for batch in batches {
                let Some(mesh) = by_slot.mesh(batch.batch) else { continue };
                let finest = geometry.first_group(device, mesh);
                let group = geometry.group(finest);
                pass.set_vertex_buffer(0, group.vertices.slice(..));
                pass.set_index_buffer(group.indices.slice(..), IndexFormat::Uint32);
                batch.draw(pass, 1);
                self.drawn.draws += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use wgpu::naga::TypeInner;
    use wgpu::naga::front::wgsl;

    use super::super::pipelines::SOURCES;
    use super::*;

    #[test]
    fn objects_lie_in_memory_as_the_shader_thinks() {
        let module = wgsl::parse_str(SOURCES[0]).expect("it parses");
        let object = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Object"));
        let Some(TypeInner::Struct { members, span }) = object.map(|(_, t)| &t.inner) else {
            panic!("Object is {object:?}");
        };
        let have: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset)).collect();
        let rows = offset_of!(Object, rows) as u32;
        let color = offset_of!(Object, color) as u32;
        assert_eq!(have, [("row_x", rows), ("row_y", rows + 16), ("row_z", rows + 32), ("color", color)]);
        assert_eq!(*span as usize, size_of::<Object>());
    }
}
