//! Checking every invariant of the tree. For tests: O(objects + nodes).

use super::Tree;
use super::blocks::NONE;
use super::config::Straddlers;
use super::node::{NodeId, Role};
use crate::geom::Aabb;

impl Tree {
    /// Checks the whole tree, between an update and the next edit.
    ///
    /// # Errors
    /// The first invariant found broken, in words: each object in exactly one node, inside its
    /// cell, on its side of every plane above; cells nest and fill space; straddlers straddle;
    /// counts and boxes hold their contents; nothing left dirty.
    pub fn validate(&self) -> Result<(), String> {
        let mut seen = Vec::new();
        let mut alive = 0;
        for node in self.nodes() {
            alive += 1;
            let fail = |what: &str| Err(format!("node {} ({:?}): {what}", node.id.index, node.role));
            let n = node.id.index();
            if self.nodes.dirty[n] != 0 {
                return fail("left dirty");
            }
            let (mut bounds, mut below) = (Aabb::EMPTY, 0);
            for (slot, aabb) in self.blocks.items(self.nodes.run[n]) {
                bounds = bounds.union(&aabb);
                below += 1;
                seen.push(slot);
                if self.blocks.owner_of(slot) != Some(node.id.index) || self.aabb_of(slot) != Some(aabb) {
                    return fail(&format!("object {slot} is not where it is said to be"));
                }
                if !self.nodes.holds(node.id.index, &aabb) {
                    return fail(&format!("object {slot} is not in its cell, or not across its planes"));
                }
                if !node.is_leaf && self.nodes.side(node.id.index, &aabb) != Role::Straddle {
                    return fail(&format!("object {slot} belongs into a child"));
                }
            }
            if !node.is_leaf && node.own > 0 && self.config.straddlers != Straddlers::StayInParent {
                return fail("an inner node has objects of its own");
            }
            if self.blocks.around(self.nodes.run[n]) != bounds {
                return fail("the boxes around its blocks are not around its objects");
            }
            if self.nodes.run[n].active as usize > node.own {
                return fail("more movers than objects");
            }
            if below != node.own {
                return fail(&format!("{below} objects in its blocks, {} by its length", node.own));
            }
            if let Some(children) = self.children(node.id) {
                self.validate_children(node.id, children)?;
                for child in children {
                    bounds = bounds.union(&self.bounds(child));
                    below += self.count(child);
                }
            }
            if below != node.below {
                return fail(&format!("{below} objects below, {} by its count", node.below));
            }
            if bounds != node.bounds {
                return fail(&format!("bounds {:?} instead of {bounds:?}", node.bounds));
            }
        }
        if alive != self.nodes.len() {
            return Err(format!("{alive} nodes reached, {} by the count", self.nodes.len()));
        }
        seen.sort_unstable();
        if seen.windows(2).any(|w| w[0] == w[1]) {
            return Err("an object is in two nodes".into());
        }
        Ok(())
    }

    fn validate_children(&self, parent: NodeId, children: [NodeId; 3]) -> Result<(), String> {
        let (p, axis) = (parent.index(), self.nodes.axis[parent.index()] as usize);
        let (cell, plane) = (self.nodes.cell[p], self.nodes.plane[p]);
        let (mut low, mut high, mut across) = (cell, cell, self.nodes.straddled[p]);
        low.max[axis] = plane;
        high.min[axis] = plane;
        across[axis] = plane;
        let expected = [low, high, cell];
        for (i, child) in children.into_iter().enumerate() {
            let c = child.index();
            let straddled = if i == 2 { across } else { self.nodes.straddled[p] };
            let same_planes = (0..3).all(|a| {
                straddled[a] == self.nodes.straddled[c][a]
                    || straddled[a].is_nan() && self.nodes.straddled[c][a].is_nan()
            });
            let sound = self.nodes.cell[c] == expected[i]
                && same_planes
                && self.nodes.parent[c] == parent.index
                && self.nodes.parent[c] != NONE
                && self.nodes.role[c] == Role::CHILDREN[i]
                && self.nodes.depth[c] == self.nodes.depth[p] + 1;
            if !sound {
                return Err(format!("child {c} of node {p} does not fit its parent's plane"));
            }
        }
        Ok(())
    }
}
