//! What was done to a scene, step by step: taken down on one machine, it makes the same scene, with
//! the same tree, on any other.

use glam::DVec3;

use super::Scene;
use super::components::Traits;
use super::object::ObjectId;
use crate::Costs;
use crate::culler::Voter;
use crate::geom::Aabb;

/// One step in the life of a scene.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum SceneEdit {
    /// An object was added.
    Insert {
        /// Its box, as it was given: good or bad.
        bounds: Aabb,
        /// Its optional components.
        traits: Traits,
    },
    /// An object was given another box.
    SetBounds {
        /// Whose.
        id: ObjectId,
        /// The box, as it was given: good or bad.
        bounds: Aabb,
    },
    /// An object was given other components, and a box.
    SetTraits {
        /// Whose.
        id: ObjectId,
        /// The box, as it was given: good or bad.
        bounds: Aabb,
        /// Its optional components.
        traits: Traits,
    },
    /// An object was removed.
    Remove(ObjectId),
    /// Positions became relative to another origin.
    Rebase(DVec3),
    /// The tree was brought up to date.
    Update,
    /// Votes were counted.
    Adapt {
        /// What each view that voted had seen of costs: they are part of its vote.
        costs: Vec<Costs>,
    },
}

impl Scene {
    /// Takes down every edit from now on, until [`Scene::stop_tape`]. An edit then costs a few
    /// nanoseconds more, and its memory until the tape is taken.
    pub fn start_tape(&mut self) {
        self.tape.get_or_insert_default();
    }

    /// Hands over the edits since the last time, in their order; none if no tape runs.
    pub fn take_tape(&mut self) -> Vec<SceneEdit> {
        self.tape.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Takes nothing down any more, and forgets what was not taken.
    pub fn stop_tape(&mut self) {
        self.tape = None;
    }

    /// Whether nothing was ever done to the scene: a tape from here on tells all of its life.
    pub fn is_pristine(&self) -> bool {
        !self.touched
    }

    /// Does again what was done to another scene that began like this one. An edit about an object that
    /// is not there changes nothing. `views` are those that voted; an [`SceneEdit::Adapt`] counts their
    /// votes, with the costs that were taken down.
    pub fn redo<V: Voter + ?Sized>(&mut self, edit: &SceneEdit, views: &mut [&mut V]) {
        match edit {
            SceneEdit::Insert { bounds, traits } => {
                self.insert(*bounds, *traits);
            }
            SceneEdit::SetBounds { id, bounds } => {
                self.set_bounds(*id, *bounds);
            }
            SceneEdit::SetTraits { id, bounds, traits } => {
                self.set_traits(*id, *bounds, *traits);
            }
            SceneEdit::Remove(id) => {
                self.remove(*id);
            }
            SceneEdit::Rebase(origin) => self.rebase(*origin),
            SceneEdit::Update => {
                self.update();
            }
            SceneEdit::Adapt { costs } => {
                for (view, costs) in views.iter_mut().zip(costs) {
                    view.votes_mut().costs = *costs;
                }
                self.adapt(views.iter_mut().map(|view| &mut **view));
            }
        }
    }

    /// Takes down that votes were counted, if a tape runs.
    pub(super) fn note_votes(&mut self, views: usize) {
        self.touched = true;
        if let Some(tape) = &mut self.tape {
            let costs = self.ballots[..views].iter().map(|votes| votes.costs).collect();
            tape.push(SceneEdit::Adapt { costs });
        }
    }

    /// Takes an edit down, if a tape runs.
    #[inline]
    pub(super) fn note(&mut self, edit: impl FnOnce() -> SceneEdit) {
        self.touched = true;
        if let Some(tape) = &mut self.tape {
            tape.push(edit());
        }
    }
}
