//! Why was an object drawn, or culled, in the last frame? For windows, logs and tests.
//!
//! The driver remembers what was drawn, the policy what became of each node ([`Fate`]); an
//! explanation joins the two along the way from the object up to the root. Nothing is computed
//! before somebody asks.

use std::fmt;

use super::Culler;
use crate::geom::{Aabb, Frustum, View};
use crate::policy::{Context, Fate, Policy, Samples};
use crate::scene::{ObjectId, Scene};
use crate::tree::{NodeId, NodeInfo};

/// Why an object was drawn, or culled, in the last frame. As text it is a line for a user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Why {
    /// It has been removed from the scene.
    Gone,
    /// No longer known, or not yet: the object, or the shape of the tree, changed after the frame.
    Unknown {
        /// Whether it was drawn.
        drawn: bool,
    },
    /// Drawn always.
    Always {
        /// Because its box is bad, and not because the app wishes it.
        bad: bool,
    },
    /// Drawn: the policy asks nothing.
    Unasked,
    /// The policy was told which objects to draw.
    Given {
        /// Whether it is one of them.
        drawn: bool,
    },
    /// The policy sweeps objects.
    Swept {
        /// Drawn: it was found, or drawn first because it was visible in the last frame. Else it was in
        /// no answer: no sample of its box is in sight, or of that of a group that holds it, or nothing of it
        /// showed when it was to be drawn.
        drawn: bool,
    },
    /// Culled: its box lies outside the frustum.
    Outside,
    /// Culled: the box of a node that holds it lies between the samples of the screen.
    NoSample(Holder),
    /// Culled: the node was asked about, and none of its samples was visible.
    Hidden(Holder),
    /// Drawn: the node was asked about, and something of it was visible.
    Visible {
        /// What was asked about.
        node: Holder,
        /// How much was visible, if that was counted.
        samples: Option<Samples>,
    },
    /// Drawn without asking: the node was visible before.
    Remembered {
        /// What is taken as visible.
        node: Holder,
        /// In how many frames it is asked about again, at the latest, if there is a term; 1 is the
        /// next one.
        within: Option<u32>,
    },
    /// Drawn without asking, since the node was visible before; the answer that came afterwards
    /// says that nothing of it was visible.
    HiddenNow(Holder),
    /// Drawn without asking: the node's box crosses the near plane, or is too close to it.
    Near(Holder),
}

/// A node that holds an object, itself or below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holder {
    /// Which one.
    pub id: NodeId,
    /// The box that questions about it are about, metres, relative to the scene's origin.
    pub bounds: Aabb,
}

impl<P: Policy> Culler<P> {
    /// Why an object was drawn, or culled, in the last frame; `view` is that frame's.
    ///
    /// Ask before the scene is edited again. Of what has moved or was merged since, the answer is
    /// less certain or [`Why::Unknown`]; whether the object was drawn is always true.
    ///
    /// O(depth); with a policy that counts samples, O(questions of the frame) to find the count.
    pub fn why(&self, scene: &Scene, view: &View, object: ObjectId) -> Why {
        let Some(description) = scene.object(object) else { return Why::Gone };
        let drawn = self.scene.0 == scene.id().0 && self.drawn.has(object);
        let tree = scene.tree();
        let (bounds, leaf) = match (description.bounds, tree.node_of(object.slot() as u32)) {
            (Some(bounds), Some(leaf)) if self.knows(scene) => (bounds, leaf),
            (None, _) if drawn => return Why::Always { bad: description.bad },
            _ => return Why::Unknown { drawn },
        };
        let view = &view.coarsened(self.divisor);
        let frustum = Frustum::new(view);
        let cx = self.context(scene, view, &frustum);
        let way_up = std::iter::successors(Some(leaf), |&node| tree.parent(node));
        let mut fates = way_up.map(|id| {
            let holder = Holder { id, bounds: tree.query_box(id) };
            (holder, self.policy.fate(&cx, id))
        });
        if drawn {
            fates.find_map(reason_to_draw).unwrap_or(Why::Unknown { drawn })
        } else if !frustum.intersects(&bounds) {
            Why::Outside
        } else {
            fates.filter_map(reason_to_cull).last().unwrap_or(Why::Unknown { drawn })
        }
    }

    /// What became of each node in the last frame, parents before their children: to colour boxes
    /// by it. Empty nodes are left out; `view` is that frame's. The cost a node is that of
    /// [`Culler::why`].
    pub fn fates(&self, scene: &Scene, view: &View) -> impl Iterator<Item = (NodeInfo, Fate)> {
        let view = view.coarsened(self.divisor);
        let (frustum, knows) = (Frustum::new(&view), self.knows(scene));
        scene.tree().nodes().filter(|node| node.below > 0).map(move |node| {
            let cx = self.context(scene, &view, &frustum);
            (node, if knows { self.policy.fate(&cx, node.id) } else { Fate::Unknown })
        })
    }

    /// Whether the last frame was of this scene and of this making of its tree.
    fn knows(&self, scene: &Scene) -> bool {
        self.frame != 0 && self.scene == scene.id()
    }

    /// The last frame's context.
    fn context<'a>(&'a self, scene: &'a Scene, view: &'a View, frustum: &'a Frustum) -> Context<'a> {
        let (frame, costs) = (self.frame, self.costs);
        let (tree, tradeoff, past) = (scene.tree(), &self.applied, self.past.as_ref());
        Context { scene, tree, view, frustum, frame, tradeoff, costs, past }
    }
}

impl Why {
    /// Whether the object was drawn in the last frame.
    pub const fn is_drawn(&self) -> bool {
        match *self {
            Self::Unknown { drawn } | Self::Given { drawn } | Self::Swept { drawn } => drawn,
            Self::Gone | Self::Outside | Self::NoSample(_) | Self::Hidden(_) => false,
            Self::Always { .. }
            | Self::Unasked
            | Self::Visible { .. }
            | Self::Remembered { .. }
            | Self::HiddenNow(_)
            | Self::Near(_) => true,
        }
    }

    /// The node that decided, if one did: to draw its box.
    pub const fn node(&self) -> Option<Holder> {
        match *self {
            Self::NoSample(node)
            | Self::Hidden(node)
            | Self::HiddenNow(node)
            | Self::Near(node)
            | Self::Visible { node, .. }
            | Self::Remembered { node, .. } => Some(node),
            _ => None,
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gone => write!(f, "gone: it has been removed from the scene"),
            Self::Unknown { drawn: true } => {
                write!(f, "drawn; the tree has changed since, so why is not known")
            }
            Self::Unknown { drawn: false } => {
                write!(f, "not drawn: it is new, or the tree has changed since, so why is not known")
            }
            Self::Always { bad: true } => write!(f, "drawn always, until its box is a good one"),
            Self::Always { bad: false } => write!(f, "drawn always, as the app wishes"),
            Self::Unasked => write!(f, "drawn: this policy asks nothing"),
            Self::Given { drawn: true } => write!(f, "drawn: it is in the set that the policy was given"),
            Self::Given { drawn: false } => {
                write!(f, "culled: it is not in the set that the policy was given")
            }
            Self::Swept { drawn: true } => {
                write!(f, "drawn: a sweep found it, or it was visible in the last frame")
            }
            Self::Swept { drawn: false } => write!(f, "culled: no sweep found it, or nothing of it showed"),
            Self::Outside => write!(f, "culled: it is outside the view"),
            Self::NoSample(node) => write!(f, "culled: {node} is too small to cover a pixel's sample"),
            Self::Hidden(node) => write!(f, "culled: nothing of {node} was visible"),
            Self::Visible { node, samples: None } => write!(f, "drawn: something of {node} was visible"),
            Self::Visible { node, samples: Some(samples) } => write!(f, "drawn: of {node}, {samples}"),
            Self::Remembered { node, within: None } => write!(f, "drawn unasked: {node} was visible before"),
            Self::Remembered { node, within: Some(1) } => {
                write!(f, "drawn unasked: {node} was visible before; asked again in the next frame")
            }
            Self::Remembered { node, within: Some(frames) } => {
                write!(f, "drawn unasked: {node} was visible before; asked again within {frames} frames")
            }
            Self::HiddenNow(node) => {
                write!(f, "drawn unasked: {node} was visible before; it has become hidden")
            }
            Self::Near(node) => write!(f, "drawn unasked: {node} reaches the near plane"),
        }
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.bounds.size();
        write!(f, "its node {} ({:.2} × {:.2} × {:.2} m)", self.id.index(), size.x, size.y, size.z)
    }
}

/// Of the nodes that hold a drawn object, the first that says why.
fn reason_to_draw((node, fate): (Holder, Fate)) -> Option<Why> {
    match fate {
        Fate::Unasked => Some(Why::Unasked),
        Fate::Given => Some(Why::Given { drawn: true }),
        Fate::Swept => Some(Why::Swept { drawn: true }),
        Fate::Visible { samples } => Some(Why::Visible { node, samples }),
        Fate::Remembered { within } => Some(Why::Remembered { node, within }),
        Fate::Near => Some(Why::Near(node)),
        Fate::Hidden => Some(Why::HiddenNow(node)),
        Fate::Unknown | Fate::Outside | Fate::NotReached => None,
    }
}

/// What a node says of an object in the frustum that was not drawn: the highest one that says
/// something kept those below it from being looked at.
fn reason_to_cull((node, fate): (Holder, Fate)) -> Option<Why> {
    match fate {
        Fate::Hidden => Some(Why::Hidden(node)),
        Fate::Outside => Some(Why::NoSample(node)),
        Fate::Given => Some(Why::Given { drawn: false }),
        Fate::Swept => Some(Why::Swept { drawn: false }),
        _ => None,
    }
}
