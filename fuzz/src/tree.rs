//! Bytes as edits of a scene: after each the tree is valid and holds what it was given.

use std::collections::BTreeMap;

use arbitrary::Unstructured;
use glam::DVec3;
use tercet::geom::Aabb;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{SplitAxis, SplitPlane, Straddlers, TightBoxes, TreeConfig, Votes};
use tercet::{Costs, Voter};

use super::numbers::{any_box, below, float, vector};

/// More edits than this only take time.
const MOST_EDITS: usize = 400;
/// Objects at once.
const MOST_OBJECTS: usize = 4000;

/// Decodes the bytes to edits and carries them out.
pub fn run(bytes: &[u8]) {
    let mut u = Unstructured::new(bytes);
    let config = SceneConfig { tree: config(&mut u), ..SceneConfig::default() };
    let mut edited = Edited { scene: Scene::new(config), held: BTreeMap::new() };
    for _ in 0..MOST_EDITS {
        if u.is_empty() {
            break;
        }
        edited.edit(&mut u);
        edited.check();
    }
}

fn config(u: &mut Unstructured<'_>) -> TreeConfig {
    TreeConfig {
        axis: [SplitAxis::Longest, SplitAxis::ViewAligned][below(u, 2)],
        plane: [SplitPlane::Middle, SplitPlane::SurfaceArea][below(u, 2)],
        straddlers: [Straddlers::Leaf, Straddlers::Split, Straddlers::StayInParent][below(u, 3)],
        tight_boxes: [TightBoxes::Never, TightBoxes::Settled, TightBoxes::Always][below(u, 3)],
        bulk_leaf: 1 + below(u, 16) as u32,
        unasked_leaf: 1 + below(u, 64) as u32,
        idle_frames: 10,
        ..if below(u, 2) == 0 { TreeConfig::stable() } else { TreeConfig::paper() }
    }
}

/// A scene, and what it should hold: the box of each object that is in the tree.
struct Edited {
    scene: Scene,
    held: BTreeMap<ObjectId, Option<Aabb>>,
}

struct Ballot(Votes);

impl Voter for Ballot {
    fn votes(&self) -> &Votes {
        &self.0
    }

    fn votes_mut(&mut self) -> &mut Votes {
        &mut self.0
    }
}

impl Edited {
    fn edit(&mut self, u: &mut Unstructured<'_>) {
        match below(u, 12) {
            0 | 1 => self.insert(any_box(u), traits(u)),
            2 => {
                let (aabb, count) = (any_box(u), 1 + below(u, 120));
                (0..count).for_each(|_| self.insert(aabb, Traits::default()));
            }
            3 => {
                let step = vector(u, float);
                let mut aabb = any_box(u);
                for _ in 0..1 + below(u, 60) {
                    self.insert(aabb, Traits::default());
                    aabb = Aabb::new(aabb.min + step, aabb.max + step);
                }
            }
            4 | 5 => {
                let Some(id) = self.any(u) else { return };
                let aabb = any_box(u);
                let traits = self.scene.object(id).expect("it is there").traits;
                assert!(self.scene.set_bounds(id, aabb));
                self.held.insert(id, expected(aabb, traits));
            }
            6 => {
                let Some(id) = self.any(u) else { return };
                let (aabb, traits) = (any_box(u), traits(u));
                assert!(self.scene.set_traits(id, aabb, traits));
                self.held.insert(id, expected(aabb, traits));
            }
            7 => {
                let Some(id) = self.any(u) else { return };
                assert!(self.scene.remove(id) && !self.scene.remove(id));
                self.held.remove(&id);
            }
            8 => {
                let step = vector(u, float);
                let moved: Vec<(ObjectId, Aabb)> = self
                    .held
                    .iter()
                    .filter_map(|(&id, b)| {
                        Some((id, Aabb::new(b.as_ref()?.min + step, b.as_ref()?.max + step)))
                    })
                    .collect();
                assert_eq!(self.scene.sync_moved(moved.iter().copied()), 0);
                for (id, aabb) in moved {
                    let traits = self.scene.object(id).expect("it is there").traits;
                    self.held.insert(id, expected(aabb, traits));
                }
            }
            9 => self.rebase(vector(u, float).as_dvec3() * f64::from(float(u))),
            10 => self.vote(u),
            _ => {
                let keep = below(u, 8);
                while self.held.len() > keep {
                    let (id, _) = self.held.pop_first().expect("not empty");
                    assert!(self.scene.remove(id));
                }
            }
        }
        self.scene.update();
    }

    fn insert(&mut self, aabb: Aabb, traits: Traits) {
        if self.held.len() < MOST_OBJECTS {
            let id = self.scene.insert(aabb, traits);
            assert!(self.held.insert(id, expected(aabb, traits)).is_none(), "a handle was given out twice");
        }
    }

    fn any(&self, u: &mut Unstructured<'_>) -> Option<ObjectId> {
        let count = self.held.len();
        (count > 0).then(|| self.held.keys().nth(below(u, count)).copied()).flatten()
    }

    /// No box gets smaller by it; one that leaves the range of f32 is drawn always.
    fn rebase(&mut self, origin: DVec3) {
        self.scene.update();
        let before = self.scene.origin();
        self.scene.rebase(origin);
        for (&id, held) in &mut self.held {
            let now = self.scene.object(id).expect("it is there").bounds;
            if let (Some(was), Some(is)) = (&held, &now) {
                // In f64: a side may be longer than f32 can say.
                let size = |b: &Aabb| b.max.as_dvec3() - b.min.as_dvec3();
                let apart = (size(is) - size(was)).min_element();
                let rounding = 1e-6 * (before - origin).abs().max_element().max(size(was).max_element());
                assert!(apart >= -rounding, "{was:?} shrank to {is:?}");
            }
            assert!(held.is_some() || now.is_none(), "a bad box was mended by nothing");
            *held = now;
        }
    }

    fn vote(&mut self, u: &mut Unstructured<'_>) {
        self.scene.update();
        let costs = Costs::of(below(u, 20) as f32);
        let mut ballot = Ballot(Votes { forward: vector(u, float), costs, asks: true, ..Votes::default() });
        for node in self.scene.tree().nodes().filter(|node| node.is_leaf) {
            match below(u, 6) {
                5 => ballot.0.near(node.id),
                share => ballot.0.count(node.id, 25 * share as u32, 100),
            }
        }
        self.scene.adapt([&mut ballot]);
    }

    fn check(&self) {
        let tree = self.scene.tree();
        if let Err(why) = tree.validate() {
            panic!("{why}");
        }
        assert_eq!(self.scene.len(), self.held.len());
        assert_eq!(tree.len(), self.held.values().flatten().count());
        for (&id, held) in &self.held {
            let object = self.scene.object(id).expect("it is there");
            assert_eq!(object.bounds, *held);
            assert!(held.is_some() || object.bad || object.traits.never_cull);
        }
    }
}

fn traits(u: &mut Unstructured<'_>) -> Traits {
    let slack = if below(u, 4) == 0 { float(u) } else { 0.0 };
    Traits { never_cull: below(u, 8) == 0, not_occluder: below(u, 8) == 0, slack, ..Traits::default() }
}

/// The box that the tree should hold: none for what is drawn always.
fn expected(aabb: Aabb, traits: Traits) -> Option<Aabb> {
    let grown = match traits.slack {
        0.0 => aabb,
        slack if slack > 0.0 && aabb.is_valid() => aabb.inflated(slack),
        _ => Aabb::EMPTY,
    };
    (grown.is_valid() && !traits.never_cull).then_some(grown)
}
