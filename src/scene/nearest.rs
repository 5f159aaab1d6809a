//! How far points lie from a set of triangles (feature `lod`): a bounding-volume hierarchy.

use glam::Vec3;

use crate::geom::Aabb;

/// Triangles, sorted into a hierarchy of boxes. Building takes O(n log n).
pub(super) struct Triangles {
    /// In the order of the leaves.
    triangles: Vec<Triangle>,
    nodes: Vec<Node>,
}

/// The first child of an inner node is the next node.
struct Node {
    bounds: Aabb,
    /// The second child; 0 for a leaf.
    second: usize,
    /// The leaf's triangles.
    first: usize,
    end: usize,
}

const LEAF: usize = 4;

impl Triangles {
    /// `indices` has three a triangle, each with a point.
    pub(super) fn new(points: &[Vec3], indices: &[u32]) -> Self {
        let corner = |i: u32| points[i as usize];
        let triangles = indices.chunks_exact(3).map(|t| Triangle([corner(t[0]), corner(t[1]), corner(t[2])]));
        let mut all = Self { triangles: triangles.collect(), nodes: Vec::new() };
        if !all.triangles.is_empty() {
            all.build(0, all.triangles.len());
        }
        all
    }

    /// From a point to the nearest triangle, in metres; `f32::MAX` without triangles. O(log n) as
    /// a rule, O(n) when the point is far from all of them compared to their distances.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        let mut best = f32::MAX;
        let mut stack: Vec<usize> = self.nodes.first().map(|_| 0).into_iter().collect();
        while let Some(n) = stack.pop() {
            let node = &self.nodes[n];
            if node.bounds.distance_squared(p).sqrt() >= best {
                continue;
            }
            if node.second == 0 {
                let leaf = self.triangles[node.first..node.end].iter();
                best = leaf.fold(best, |best, triangle| best.min(triangle.distance(p)));
                continue;
            }
            let distance = |n: usize| self.nodes[n].bounds.distance_squared(p);
            let (first, second) = (n + 1, node.second);
            // The nearer one is looked at first.
            stack.extend(if distance(first) < distance(second) { [second, first] } else { [first, second] });
        }
        best
    }

    /// Adds the node of a range of triangles, and all below it.
    fn build(&mut self, first: usize, end: usize) {
        let range = &mut self.triangles[first..end];
        let bounds = range.iter().fold(Aabb::EMPTY, |all, t| all.union(&Aabb::from_points(t.0)));
        let number = self.nodes.len();
        self.nodes.push(Node { bounds, second: 0, first, end });
        if range.len() <= LEAF {
            return;
        }
        let axis = bounds.size().max_position();
        let middle = range.len() / 2;
        let place = |t: &Triangle| t.0[0][axis] + t.0[1][axis] + t.0[2][axis];
        range.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
        self.build(first, first + middle);
        self.nodes[number].second = self.nodes.len();
        self.build(first + middle, end);
    }
}

/// A triangle by its corners.
pub(super) struct Triangle(pub(super) [Vec3; 3]);

impl Triangle {
    /// To the plane where the point lies above the triangle, else to the nearest edge.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        let [a, b, c] = self.0;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let above = |a: Vec3, b: Vec3| (b - a).cross(p - a).dot(normal) >= 0.0;
        if normal != Vec3::ZERO && above(a, b) && above(b, c) && above(c, a) {
            return (p - a).dot(normal).abs();
        }
        let edge = |a: Vec3, b: Vec3| {
            let along = b - a;
            let t = ((p - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            p.distance(a + along * t)
        };
        edge(a, b).min(edge(b, c)).min(edge(c, a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn the_hierarchy_finds_what_looking_at_each_triangle_finds() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut point =
            |scale: f32| Vec3::from_array(std::array::from_fn(|_| scale * random.random::<f32>()));
        for count in [0, 1, 4, 5, 300] {
            let points: Vec<Vec3> =
                (0..3 * count).map(|i| 0.2 * point(1.0) + point(1.0) * (i / 3 % 2) as f32).collect();
            let indices: Vec<u32> = (0..3 * count).collect();
            let triangles = Triangles::new(&points, &indices);
            for _ in 0..100 {
                let p = point(3.0) - Vec3::ONE;
                let each = points.chunks_exact(3).map(|t| Triangle([t[0], t[1], t[2]]).distance(p));
                assert_eq!(triangles.distance(p), each.fold(f32::MAX, f32::min));
            }
        }
    }

    #[test]
    fn a_point_is_measured_to_face_edge_and_corner() {
        let triangle = Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let cases = [
            (Vec3::new(0.2, 0.2, 3.0), 3.0),
            (Vec3::new(-3.0, -4.0, 0.0), 5.0),
            (Vec3::new(0.5, -2.0, 0.0), 2.0),
            (Vec3::new(1.0, 1.0, 0.0), 0.5f32.sqrt()),
        ];
        for (p, expected) in cases {
            assert!((triangle.distance(p) - expected).abs() < 1e-6, "{p}");
        }
        let sliver = Triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
        assert_eq!(sliver.distance(Vec3::new(1.0, 2.0, 0.0)), 2.0);
    }
}
