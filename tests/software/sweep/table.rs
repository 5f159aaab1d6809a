//! A scene with some of it drawn: what sweeps are put to.

use std::collections::BTreeSet;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Frustum, Question, View, Viewport};
use tercet::query::software::SoftwareQueries;
use tercet::query::{Answer, QueryBackend, Sweep, SweepTest, Ticket, Wait};
use tercet::scene::{ObjectId, ObjectRef, Scene, SceneConfig};
use tercet::tree::{NodeId, TreeConfig};
use tercet::worlds::Model;

use crate::painter::draw;
use crate::stage::Stage;

pub struct Table {
    pub scene: Scene,
    pub view: View,
    pub frustum: Frustum,
    pub queries: SoftwareQueries,
    pub objects: Vec<ObjectRef>,
    pub stage: Stage,
    pub dice: ChaCha8Rng,
}

impl Table {
    /// A model on a tree, everything changing.
    pub fn new(model: Model, tree: TreeConfig, seed: u64, viewport: Viewport) -> Self {
        let mut stage = Stage::new(model, seed, viewport, true);
        let view = stage.next(0);
        let scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        Self {
            scene,
            frustum: Frustum::new(&view),
            view,
            queries: SoftwareQueries::new(),
            objects: Vec::new(),
            stage,
            dice: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// The next frame, of which a share of the objects is drawn.
    pub fn next(&mut self, frame: u32, share: f64) {
        self.view = self.stage.next(frame);
        self.frustum = Frustum::new(&self.view);
        self.scene.sync(&self.stage.world);
        self.queries.begin(&self.view).expect("a frame");
        self.objects = self.scene.objects().map(|object| object.object).collect();
        let drawn: Vec<ObjectRef> =
            self.objects.iter().copied().filter(|_| self.dice.random_bool(share)).collect();
        let (world, view, detail) = (&self.stage.world, &self.view, self.stage.detail);
        self.queries
            .draw_objects(&drawn, |pass, objects| draw(world, view, detail, pass, objects))
            .expect("draws");
    }

    /// Some nodes, none below another, and some objects.
    pub fn targets(&mut self) -> (Vec<NodeId>, Vec<ObjectId>) {
        let tree = self.scene.tree();
        let (mut groups, mut stack) = (Vec::new(), vec![tree.root()]);
        while let Some(node) = stack.pop() {
            match (tree.children(node), self.dice.random_range(0..4)) {
                (Some(children), 0 | 1) => stack.extend(children),
                (_, 2) => {}
                _ => groups.push(node),
            }
        }
        let loose = self.objects.iter().map(|object| object.id).filter(|_| self.dice.random_bool(0.1));
        (groups, loose.collect())
    }

    /// What a sweep answers: slots.
    pub fn sweep(&mut self, groups: &[NodeId], loose: &[ObjectId], test: SweepTest) -> BTreeSet<usize> {
        let sweep =
            Sweep { scene: &self.scene, view: &self.view, frustum: &self.frustum, groups, loose, test };
        self.queries.sweep(Ticket(7), &sweep).expect("a sweep");
        let mut found = None;
        let deliver = |ticket, answer: Answer<'_>| match answer {
            Answer::Swept(set) if ticket == Ticket(7) => found = Some(set.slots().collect()),
            other => panic!("{other:?} to {ticket:?}"),
        };
        self.queries.answers(Wait::Block, deliver).expect("answers");
        found.expect("one answer")
    }

    /// What it should: object by object, sample by sample.
    pub fn naive(&self, groups: &[NodeId], loose: &[ObjectId]) -> BTreeSet<usize> {
        let tree = self.scene.tree();
        let is_below = |slot: usize| {
            let node = tree.node_of(slot as u32);
            std::iter::successors(node, |&node| tree.parent(node)).any(|node| groups.contains(&node))
        };
        let depth = self.queries.depth();
        let passes = |slot: usize| {
            let Some(bounds) = tree.aabb_of(slot as u32) else { return false };
            self.frustum.intersects(&bounds)
                && match Question::new(&bounds, &self.view) {
                    Question::Outside => false,
                    Question::Visible => true,
                    Question::Ask(p) => (p.rect.y0..p.rect.y1).any(|y| {
                        (p.rect.x0..p.rect.x1).any(|x| p.covers(x, y) && p.nearness(x, y) >= depth.at(x, y))
                    }),
                }
        };
        let meant = |id: &ObjectId| loose.contains(id) || is_below(id.slot());
        let all = self.objects.iter().map(|object| object.id).filter(meant).map(ObjectId::slot);
        all.filter(|&slot| passes(slot)).collect()
    }
}
