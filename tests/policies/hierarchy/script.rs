//! A policy at work on a small tree, with scripted answers: what it does, in words.

use glam::Vec3;
use tercet::geom::{Aabb, Frustum, Question, View, Viewport};
use tercet::policy::{Action, Context, Extent, Hierarchy, Policy};
use tercet::query::Answer;
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{NodeId, Tree, TreeConfig};
use tercet::{Costs, Tradeoff};

/// A row of boxes along x, seen from its lower end: each hides all that is behind it.
///
/// ```text
///            root −1…31
///        L −1…15      H 15…31
///      LL     LH     HL     HH      one box each: at 0, 10, 20 and 30
/// ```
pub(crate) struct Row {
    pub(crate) scene: Scene,
    pub(crate) policy: Hierarchy,
    pub(crate) tradeoff: Tradeoff,
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    pub(crate) objects: Vec<ObjectId>,
    frame: u32,
}

impl Row {
    pub(crate) fn new(policy: Hierarchy, tree: TreeConfig) -> Self {
        Self::of(policy, tree, &[0.0, 10.0, 20.0, 30.0].map(Self::at))
    }

    pub(crate) fn of(policy: Hierarchy, tree: TreeConfig, boxes: &[Aabb]) -> Self {
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let objects = boxes.iter().map(|&b| scene.insert(b, Traits::default())).collect();
        scene.update();
        let (eye, target) = (Vec3::new(-20.0, 0.0, 0.0), Vec3::ZERO);
        Self { scene, policy, tradeoff: Tradeoff::EXACT, eye, target, objects, frame: 0 }
    }

    /// The box of an object.
    pub(crate) fn at(x: f32) -> Aabb {
        Aabb::from_center(Vec3::X * x, Vec3::ONE)
    }

    /// Runs a frame and tells what was asked and drawn, in order. `answers` says what becomes of
    /// questions: `LL=v` all visible, `=p` in part, `=h` hidden, `=u` the answer is lost; those
    /// that are not named are visible in part.
    pub(crate) fn frame(&mut self, answers: &str) -> String {
        self.frame += 1;
        let view = View::look_at(self.eye, self.target, 60.0, 0.1, Viewport::new(640, 360)).expect("a view");
        let frustum = Frustum::new(&view);
        let tree = self.scene.tree();
        let cx = Context {
            scene: &self.scene,
            tree,
            view: &view,
            frustum: &frustum,
            frame: self.frame,
            tradeoff: &self.tradeoff,
            costs: Costs::default(),
            past: None,
        };
        let (mut told, mut open) = (Vec::new(), Vec::new());
        self.policy.begin(&cx);
        loop {
            match self.policy.next(&cx) {
                Action::Ask { ticket, boxes, .. } => {
                    // Nodes that begin at the same face may have the same proxy: parents come first.
                    let is_asked =
                        |node| Question::new(&tree.query_box(node), &view) == Question::Ask(boxes[0]);
                    let asked = tree.nodes().filter(|n| is_asked(n.id)).map(|n| name(tree, n.id));
                    let name = asked.into_iter().find(|name| !told.contains(name)).expect("a node's box");
                    open.push((ticket, name.clone()));
                    told.push(name);
                }
                Action::Draw(node, extent) => {
                    let what = if extent == Extent::Own { "own" } else { "all" };
                    told.push(format!("{what}:{}", name(tree, node)));
                }
                Action::Wait(_) => {
                    for (ticket, name) in open.drain(..) {
                        self.policy.answer(&cx, ticket, answer(answers, &name));
                    }
                }
                Action::Done => break,
                Action::DrawObjects(_) | Action::DrawIfSeen { .. } | Action::Sweep { .. } => {
                    unreachable!("nodes are drawn, not objects")
                }
            }
        }
        told.join(" ")
    }

    /// What a counter of the last frame came to.
    pub(crate) fn counter(&self, key: &str) -> u32 {
        self.policy.counters().into_iter().find(|c| c.key == key).expect("a counter of that name").count
    }
}

fn answer(answers: &str, name: &str) -> Answer<'static> {
    let said = answers.split_whitespace().find_map(|a| a.strip_prefix(name)?.strip_prefix('='));
    match said.unwrap_or("p") {
        "v" => Answer::Dual { visible: 10, total: 10 },
        "p" => Answer::Dual { visible: 5, total: 10 },
        "h" => Answer::Dual { visible: 0, total: 10 },
        "u" => Answer::Unknown,
        other => unreachable!("no such answer: {other}"),
    }
}

/// The way from the root: low, high, straddle.
fn name(tree: &Tree, node: NodeId) -> String {
    let Some(parent) = tree.parent(node) else { return "root".to_owned() };
    let letter = tree.children(parent).into_iter().flatten().zip(["L", "H", "S"]).find(|(c, _)| *c == node);
    let above = Some(name(tree, parent)).filter(|above| above != "root").unwrap_or_default();
    above + letter.expect("a child of its parent").1
}
