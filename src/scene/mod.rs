//! What is where: a mirror of the app's world, in the tree.
//!
//! Edits come from a hecs world ([`Scene::sync`]) or directly ([`Scene::insert`],
//! [`Scene::set_bounds`], [`Scene::remove`], then [`Scene::update`]). A bad edit (NaN, infinite,
//! inverted) spoils nothing: its object is drawn always until it is mended, and the report names
//! it. Positions are f32, relative to a movable f64 origin.

#[cfg(any(feature = "gltf", feature = "lod"))]
mod compact;
mod components;
mod edit;
#[cfg(feature = "gltf")]
pub mod gltf;
#[cfg(feature = "gltf")]
pub mod import;
#[cfg(feature = "lod")]
pub mod lod;
pub mod mesh;
pub(crate) mod meshlets;
#[cfg(feature = "lod")]
mod nearest;
mod object;
mod objects;
mod rebase;
mod sync;
mod tape;

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use glam::DVec3;

pub use components::{
    Batch, Bounds, BoundsF64, Mobility, NeverCull, NotOccluder, OccluderMesh, Slack, Traits,
};
pub use object::{ObjectId, ObjectRef, ObjectSet};
pub use sync::{BadEdit, SyncReport};
pub use tape::SceneEdit;

use crate::Error;
use crate::culler::Voter;
use crate::geom::Aabb;
use crate::tree::{Tree, TreeConfig, Votes};
use objects::{Objects, Place};
use sync::Mirror;

/// How a scene is set up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneConfig {
    /// The dials of the tree.
    pub tree: TreeConfig,
    /// What positions are relative to, metres.
    pub origin: DVec3,
}

/// One object, as the scene knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneObject {
    /// Its handle and entity.
    pub object: ObjectRef,
    /// Its box with its slack, relative to the origin; None for one that is drawn always.
    pub bounds: Option<Aabb>,
    /// Its optional components.
    pub traits: Traits,
    /// Whether its last edit was bad.
    pub bad: bool,
}

/// Where things are: one per world, shared by all views.
#[derive(Debug)]
pub struct Scene {
    /// Tells cullers which scene their history is about, and which making of its tree.
    id: (u64, u64),
    origin: DVec3,
    objects: Objects,
    tree: Tree,
    mirror: Mirror,
    /// The votes of one adaptation, kept for their memory.
    ballots: Vec<Votes>,
    /// Edits since the last update.
    pending: usize,
    /// What was done, if somebody wants to know.
    tape: Option<Vec<SceneEdit>>,
    /// Whether anything was ever done.
    touched: bool,
}

impl Scene {
    /// An empty scene.
    pub fn new(config: SceneConfig) -> Self {
        Self {
            id: (next_id(), 0),
            origin: config.origin,
            objects: Objects::default(),
            tree: Tree::new(config.tree),
            mirror: Mirror::default(),
            ballots: Vec::new(),
            pending: 0,
            tape: None,
            touched: false,
        }
    }

    /// What positions are relative to, metres.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The tree, to read.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Objects in the scene.
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// Whether there is no object.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// An object by its handle; None once it has been removed.
    pub fn object(&self, id: ObjectId) -> Option<SceneObject> {
        self.objects.slot(id).map(|slot| self.describe(slot))
    }

    /// Every object, by slot.
    pub fn objects(&self) -> impl Iterator<Item = SceneObject> {
        self.objects.slots().map(|slot| self.describe(slot))
    }

    /// Slots are below this: the size of a side table by [`ObjectId::slot`].
    pub fn slot_bound(&self) -> usize {
        self.objects.slot_bound()
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        self.objects.bytes() + self.tree.bytes() + self.mirror.bytes()
    }

    /// Brings the tree up to date after direct edits, and returns the time that it took. Nothing
    /// is done for a scene without edits but to count the frame. O(edits · depth).
    pub fn update(&mut self) -> Duration {
        let start = Instant::now();
        self.note(|| SceneEdit::Update);
        self.tree.update();
        self.pending = 0;
        start.elapsed()
    }

    /// Lets the votes of all views split and merge leaves; once a frame, after all views. Returns
    /// the time that it took. O(votes); the first view whose policy asks about nodes makes the
    /// leaves fine, once, in O(n log n).
    pub fn adapt<'a, V: Voter + ?Sized + 'a>(
        &mut self,
        views: impl IntoIterator<Item = &'a mut V>,
    ) -> Duration {
        let start = Instant::now();
        let mut count = 0;
        for view in views {
            if count == self.ballots.len() {
                self.ballots.push(Votes::default());
            }
            // The view gets an old list to fill, the memory of which is kept.
            self.ballots[count].clear();
            std::mem::swap(&mut self.ballots[count], view.votes_mut());
            count += 1;
        }
        self.note_votes(count);
        self.tree.adapt(self.ballots[..count].iter());
        start.elapsed()
    }

    pub(crate) fn id(&self) -> (u64, u64) {
        self.id
    }

    /// # Errors
    /// [`Error::PendingEdits`] between an edit and the next update.
    pub(crate) fn check_updated(&self) -> Result<(), Error> {
        if self.pending == 0 { Ok(()) } else { Err(Error::PendingEdits(self.pending)) }
    }

    pub(crate) fn objects_store(&self) -> &Objects {
        &self.objects
    }

    fn describe(&self, slot: u32) -> SceneObject {
        SceneObject {
            object: self.objects.object(slot),
            bounds: self.tree.aabb_of(slot),
            traits: self.objects.traits(slot),
            bad: self.objects.place(slot) == Place::Bad,
        }
    }
}

/// A number that no scene has had.
fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
