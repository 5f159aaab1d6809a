//! Random edits, votes and moves against a brute-force model of the scene; every invariant of the
//! tree is checked after each step.

use std::collections::BTreeMap;

use glam::Vec3;
use proptest::prelude::*;
use tercet::Costs;
use tercet::geom::Aabb;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{NodeId, Votes};

use super::ops::{Op, config, op};
use super::votes::Ballot;

proptest! {
    #[test]
    fn the_tree_agrees_with_a_list(config in config(), ops in prop::collection::vec(op(), 1..40)) {
        let scene = Scene::new(SceneConfig { tree: config, ..SceneConfig::default() });
        let mut tested = Tested { scene, model: BTreeMap::new() };
        for op in &ops {
            tested.apply(op);
            tested.check();
        }
    }
}

/// The scene and what it should hold.
struct Tested {
    scene: Scene,
    model: BTreeMap<ObjectId, Aabb>,
}

impl Tested {
    fn insert(&mut self, aabb: Aabb) {
        let id = self.scene.insert(aabb, Traits::default());
        assert!(self.model.insert(id, aabb).is_none(), "a handle was given out twice");
    }

    fn nth(&self, i: usize) -> Option<(ObjectId, Aabb)> {
        let n = self.model.len();
        (n > 0).then(|| self.model.iter().nth(i % n).map(|(&id, &b)| (id, b))).flatten()
    }

    fn set(&mut self, id: ObjectId, aabb: Aabb) {
        assert!(self.scene.set_bounds(id, aabb));
        self.model.insert(id, aabb);
    }

    fn remove(&mut self, id: ObjectId) {
        assert!(self.scene.remove(id));
        assert!(!self.scene.remove(id), "a removed handle is not valid");
        self.model.remove(&id);
    }

    fn nudge(&mut self, i: usize, d: Vec3) {
        if let Some((id, b)) = self.nth(i) {
            let moved = Aabb::new(b.min + d, b.max + d);
            self.set(id, if moved.is_valid() { moved } else { b });
        }
    }

    fn remove_nth(&mut self, i: usize) {
        if let Some((id, _)) = self.nth(i) {
            self.remove(id);
        }
    }

    fn apply(&mut self, op: &Op) {
        match op {
            Op::Insert(b) => self.insert(*b),
            Op::Flood(boxes) => boxes.iter().for_each(|b| self.insert(*b)),
            Op::Move(i, b) => {
                if let Some((id, _)) = self.nth(*i) {
                    self.set(id, *b);
                }
            }
            Op::Nudge(i, d) => self.nudge(*i, *d),
            Op::Remove(i) => self.remove_nth(*i),
            Op::Rush(steps) => {
                for (n, &(i, d)) in steps.iter().enumerate() {
                    self.nudge(i, d);
                    if n % 3 == 0 {
                        self.remove_nth(i / 2);
                    }
                }
            }
            Op::Purge(keep) => {
                while self.model.len() > *keep {
                    let id = *self.model.keys().next().expect("not empty");
                    self.remove(id);
                }
            }
            Op::Vote(seed) => {
                self.scene.update();
                self.vote(*seed);
            }
            Op::Rest(frames) => {
                for _ in 0..*frames {
                    self.scene.update();
                    self.vote(0);
                }
            }
        }
        self.scene.update();
    }

    /// Answers about each leaf: all visible, all hidden, or a share, by the bits of the seed.
    fn vote(&mut self, seed: u32) {
        let costs = Costs::of((seed % 11) as f32);
        let mut ballot = Ballot(Votes { forward: Vec3::new(0.3, -0.2, -0.9), costs, ..Votes::default() });
        for (i, node) in self.scene.tree().nodes().enumerate() {
            if node.is_leaf && seed != 0 {
                let share = seed.rotate_left(3 * i as u32) % 5;
                match share {
                    4 => ballot.0.near(node.id),
                    _ => ballot.0.count(node.id, 25 * share, 100),
                }
            }
        }
        self.scene.adapt([&mut ballot]);
        assert!(ballot.0.votes.is_empty(), "votes are used up");
        self.scene.tree().validate().expect("valid after adapting");
    }

    fn check(&self) {
        let tree = self.scene.tree();
        tree.validate().expect("a valid tree");
        assert_eq!(tree.len(), self.model.len());
        assert_eq!(self.scene.len(), self.model.len());
        for (&id, aabb) in &self.model {
            let object = self.scene.object(id).expect("a live object");
            assert_eq!(object.bounds, Some(*aabb));
        }
        self.check_boxes(tree.root());
    }

    /// The box that a question about a node asks holds all that is below, whatever the dials.
    fn check_boxes(&self, root: NodeId) {
        let tree = self.scene.tree();
        let mut stack = vec![(root, Vec::new())];
        while let Some((node, above)) = stack.pop() {
            let mut boxes: Vec<Aabb> = above;
            boxes.push(tree.query_box(node));
            for (_, aabb) in tree.own_objects(node) {
                assert!(boxes.iter().all(|b| b.contains(&aabb)), "an object sticks out of a question's box");
            }
            stack.extend(tree.children(node).into_iter().flatten().map(|c| (c, boxes.clone())));
        }
    }
}
