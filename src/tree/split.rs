//! Choosing the plane that a leaf is split by.

use glam::Vec3;

use super::config::{SplitAxis, SplitPlane, Straddlers, TreeConfig};
use super::node::{Role, side};
use crate::geom::Aabb;

/// An object while its leaf is taken apart.
pub(crate) type Item = (u32, Aabb);

/// What a leaf is, for choosing its plane.
pub(crate) struct Site<'a> {
    pub(crate) items: &'a [Item],
    pub(crate) cell: Aabb,
    pub(crate) straddled: Vec3,
    pub(crate) role: Role,
    /// Direction of the view that asked for the split, if one did.
    pub(crate) forward: Option<Vec3>,
}

/// Positions tried an axis by the surface-area heuristic.
const BINS: usize = 16;

/// A plane that separates the objects of a leaf, or None if there is none: then at least two of
/// the three children would be empty whatever plane were taken.
pub(crate) fn choose(site: &Site<'_>, config: &TreeConfig) -> Option<(usize, f32)> {
    if site.role == Role::Straddle && config.straddlers == Straddlers::Leaf || site.items.len() < 2 {
        return None;
    }
    let bounds = site.items.iter().fold(Aabb::EMPTY, |all, (_, b)| all.union(b));
    if config.plane == SplitPlane::SurfaceArea {
        return surface_area(site, &bounds).or_else(|| middle(site, &bounds, &bounds, config));
    }
    middle(site, &site.cell, &bounds, config).or_else(|| middle(site, &bounds, &bounds, config))
}

/// The middle of `within`, on the preferred axis or else the next.
fn middle(site: &Site<'_>, within: &Aabb, bounds: &Aabb, config: &TreeConfig) -> Option<(usize, f32)> {
    let size = within.size();
    let preference = match (config.axis, site.forward) {
        (SplitAxis::ViewAligned, Some(v)) => v.abs(),
        _ => size,
    };
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| preference[b].total_cmp(&preference[a]));
    axes.into_iter()
        .map(|axis| (axis, within.center()[axis]))
        .find(|&(axis, plane)| separates(site, bounds, axis, plane))
}

/// Whether a plane leaves at least two of the three children with objects.
fn separates(site: &Site<'_>, bounds: &Aabb, axis: usize, plane: f32) -> bool {
    // A straddled axis cannot separate: every object is across it already, and a plane strictly
    // inside the cell is what keeps the halves of the cell proper boxes.
    let inside = site.cell.min[axis] < plane && plane < site.cell.max[axis];
    if !site.straddled[axis].is_nan() || !inside {
        return false;
    }
    if bounds.max[axis] <= plane || bounds.min[axis] >= plane {
        return false;
    }
    let first = side(&site.items[0].1, axis, plane);
    site.items[1..].iter().any(|(_, b)| side(b, axis, plane) != first)
}

/// The plane of least surface-area cost, over [`BINS`] positions an axis. The boxes of the halves
/// are the objects' own; straddlers are charged with the parent's whole box, which is what makes
/// planes that cut few of them win. O(items).
fn surface_area(site: &Site<'_>, bounds: &Aabb) -> Option<(usize, f32)> {
    let whole = bounds.surface_area();
    let mut best: Option<(f32, usize, f32)> = None;
    for axis in 0..3 {
        let (low, size) = (bounds.min[axis], bounds.size()[axis]);
        let usable = site.straddled[axis].is_nan() && size > 0.0 && size.is_finite();
        if !usable {
            continue;
        }
        let position = |k: usize| low + size * (k as f32 / BINS as f32);
        // The first plane at or above x, and the last at or below it.
        let at_or_above = |x: f32| (((x - low) / size * BINS as f32).ceil() as usize).min(BINS);
        let at_or_below = |x: f32| (((x - low) / size * BINS as f32).floor() as usize).min(BINS);
        let mut ends = [(0u32, Aabb::EMPTY); BINS + 1];
        let mut starts = [(0u32, Aabb::EMPTY); BINS + 1];
        for (_, b) in site.items {
            let e = &mut ends[at_or_above(b.max[axis])];
            *e = (e.0 + 1, e.1.union(b));
            let s = &mut starts[at_or_below(b.min[axis])];
            *s = (s.0 + 1, s.1.union(b));
        }
        // Accumulated from above: what starts at plane k or later.
        let mut above = [(0u32, Aabb::EMPTY); BINS + 1];
        let mut sum = (0, Aabb::EMPTY);
        for k in (1..=BINS).rev() {
            sum = (sum.0 + starts[k].0, sum.1.union(&starts[k].1));
            above[k] = sum;
        }
        let mut below = ends[0];
        for k in 1..BINS {
            below = (below.0 + ends[k].0, below.1.union(&ends[k].1));
            let n = site.items.len() as u32;
            // A flat object on the plane is counted on both sides.
            let cut = n.saturating_sub(below.0 + above[k].0);
            let cost = below.0 as f32 * below.1.surface_area()
                + above[k].0 as f32 * above[k].1.surface_area()
                + cut as f32 * whole;
            let plane = position(k);
            if best.is_none_or(|(least, ..)| cost < least) && separates(site, bounds, axis, plane) {
                best = Some((cost, axis, plane));
            }
        }
    }
    best.map(|(_, axis, plane)| (axis, plane))
}
