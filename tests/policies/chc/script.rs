//! Drives a policy by hand. Who is visible is written down; what the policy does is read off.

use std::fmt::Write;

use glam::Vec3;
use tercet::geom::{Aabb, Frustum, Proxy, Question, View, Viewport};
use tercet::policy::{Action, Context, Policy};
use tercet::query::{Answer, Ticket, Wait, Want};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};
use tercet::tree::{NodeId, SplitAxis, SplitPlane, Straddlers, TreeConfig};
use tercet::{Costs, Tradeoff};

/// A scene whose nodes are called after the objects in and below them: `01` holds objects 0 and 1.
pub struct Script {
    pub scene: Scene,
    pub view: View,
    pub tradeoff: Tradeoff,
    /// When answers arrive.
    pub arrival: Arrival,
    /// Questions whose answers are lost: those about these, alone or among others.
    pub lost: &'static [&'static str],
    objects: Vec<ObjectId>,
    frame: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrival {
    /// As soon as somebody looks: the software backend.
    AtOnce,
    /// When they are waited for: a device.
    WhenAwaited,
    /// The same, the last one first.
    Backwards,
}

/// Leaves of one object, cut halfway along the longest side.
pub fn fine() -> TreeConfig {
    TreeConfig {
        bulk_leaf: 1,
        unasked_leaf: 1,
        axis: SplitAxis::Longest,
        plane: SplitPlane::Middle,
        straddlers: Straddlers::Leaf,
        ..TreeConfig::stable()
    }
}

/// An object of 2 m at a distance from the eye.
pub fn cube(distance: f32) -> Aabb {
    Aabb::from_center(Vec3::X * distance, Vec3::ONE)
}

impl Script {
    /// Objects in front of an eye at the origin that looks along x.
    pub fn new(tree: TreeConfig, boxes: &[Aabb]) -> Self {
        let mut script = Self {
            scene: Scene::new(SceneConfig { tree, ..SceneConfig::default() }),
            view: looking(Vec3::X),
            tradeoff: Tradeoff::EXACT,
            arrival: Arrival::WhenAwaited,
            lost: &[],
            objects: Vec::new(),
            frame: 0,
        };
        boxes.iter().for_each(|&aabb| script.add(aabb));
        script.scene.update();
        script
    }

    /// Objects in a row, 10 m apart: halved, and halved again. The nearest is number 0.
    pub fn row(count: usize) -> Self {
        let boxes: Vec<Aabb> = (0..count).map(|i| cube(10.0 + 10.0 * i as f32)).collect();
        Self::new(fine(), &boxes)
    }

    pub fn add(&mut self, aabb: Aabb) {
        self.objects.push(self.scene.insert(aabb, Traits::default()));
    }

    pub fn put(&mut self, object: usize, aabb: Aabb) {
        self.scene.set_bounds(self.objects[object], aabb);
        self.scene.update();
    }

    /// The actions of one frame in which something can be seen of the boxes called `visible`.
    ///
    /// `ask A` is a question about a box, `ask A+B` about several, `count A` one that counts;
    /// `draw A` draws a node's own objects, `draw A whole` those below as well.
    pub fn frame(&mut self, policy: &mut dyn Policy, visible: &[&str]) -> String {
        self.frame += 1;
        let frustum = Frustum::new(&self.view);
        let cx = Context {
            scene: &self.scene,
            tree: self.scene.tree(),
            view: &self.view,
            frustum: &frustum,
            frame: self.frame,
            tradeoff: &self.tradeoff,
            costs: Costs::default(),
            past: None,
        };
        let (mut told, mut open, mut steps) = (String::new(), Vec::new(), 0);
        let mut tell = |what: &str| write!(told, "{}{what}", if told.is_empty() { "" } else { ", " });
        policy.begin(&cx);
        loop {
            let mut arrived = Vec::new();
            let line = match policy.next(&cx) {
                Action::Draw(node, extent) => {
                    let whole = if extent == tercet::policy::Extent::Own { "" } else { " whole" };
                    format!("draw {}{whole}", self.name(node))
                }
                Action::Ask { ticket, boxes, want } => {
                    let names: Vec<String> = boxes.iter().map(|proxy| self.name_of(proxy)).collect();
                    let verb = if want == Want::Dual { "count" } else { "ask" };
                    let line = format!("{verb} {}", names.join("+"));
                    open.push((ticket, names, want));
                    line
                }
                Action::Wait(Wait::Poll) => {
                    if self.arrival == Arrival::AtOnce {
                        arrived.append(&mut open);
                    }
                    "look".to_owned()
                }
                Action::Wait(Wait::Block) => {
                    arrived.append(&mut open);
                    "wait".to_owned()
                }
                Action::Done => break,
                Action::DrawObjects(_) | Action::DrawIfSeen { .. } | Action::Sweep { .. } => {
                    panic!("these policies draw nodes")
                }
            };
            tell(&line).expect("a string takes everything");
            steps += 1;
            assert!(steps < 1000, "a frame comes to its end");
            if self.arrival == Arrival::Backwards {
                arrived.reverse();
            }
            for (ticket, names, want) in arrived {
                policy.answer(&cx, ticket, self.answer(&names, want, visible));
            }
        }
        // To questions that nobody asked.
        policy.answer(&cx, Ticket(0), Answer::Any(false));
        policy.answer(&cx, Ticket(u32::MAX), Answer::Any(false));
        told
    }

    fn answer(&self, names: &[String], want: Want, visible: &[&str]) -> Answer<'static> {
        let is_in = |list: &[&str]| names.iter().any(|name| list.contains(&name.as_str()));
        match want {
            _ if is_in(self.lost) => Answer::Unknown,
            Want::Any => Answer::Any(is_in(visible)),
            // A small part of it.
            Want::Dual => Answer::Dual { visible: 3 * u32::from(is_in(visible)), total: 100 },
        }
    }

    /// The numbers of the objects in a node and below.
    fn name(&self, node: NodeId) -> String {
        let tree = self.scene.tree();
        let mut inside = |&object: &usize| {
            let leaf = tree.node_of(self.objects[object].slot() as u32);
            std::iter::successors(leaf, |&up| tree.parent(up)).any(|up| up == node)
        };
        (0..self.objects.len()).filter(&mut inside).map(|object| object.to_string()).collect()
    }

    /// The node, or else the object, that a proxy stands for: a parent's box differs from its
    /// children's here.
    fn name_of(&self, proxy: &Proxy) -> String {
        let tree = self.scene.tree();
        let is_it = |aabb: &Aabb| Question::new(aabb, &self.view) == Question::Ask(*proxy);
        let node = tree.nodes().filter(|n| n.below > 0).find(|n| is_it(&tree.query_box(n.id)));
        let object = || {
            let boxes = self.objects.iter().map(|&id| self.scene.object(id).and_then(|o| o.bounds));
            boxes.enumerate().find(|(_, aabb)| aabb.is_some_and(|aabb| is_it(&aabb)))
        };
        let name = node.map(|n| self.name(n.id)).or_else(|| object().map(|(i, _)| format!("#{i}")));
        name.expect("a question is about a node or an object")
    }
}

/// From the origin.
pub fn looking(to: Vec3) -> View {
    View::look_at(Vec3::ZERO, to, 60.0, 0.1, Viewport::new(200, 100)).expect("a view")
}
