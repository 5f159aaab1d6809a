//! Another origin: near the camera of a large world, f32 is precise again.

use glam::DVec3;

use super::Scene;
use super::tape::SceneEdit;
use crate::geom::Aabb;

impl Scene {
    /// Makes positions relative to another origin, metres. Every box is translated, rounded outward
    /// where it must be, and the tree built anew; cullers start their histories anew with it. The
    /// app gives its own f32 positions relative to the new origin from now on; a
    /// [`BoundsF64`](super::BoundsF64) is precise again from the next sync on. O(n log n).
    ///
    /// A box that leaves the range of f32 by it makes its object drawn always until it is given
    /// another. So does an origin that is not finite, for every object.
    pub fn rebase(&mut self, origin: DVec3) {
        self.note(|| SceneEdit::Rebase(origin));
        // The update is part of it.
        let tape = self.tape.take();
        let from = self.origin;
        let boxes: Vec<(u32, Aabb)> =
            self.objects.slots().filter_map(|slot| Some((slot, self.tree.aabb_of(slot)?))).collect();
        self.origin = origin;
        self.tree = self.tree.emptied();
        // Histories are about nodes that are gone: cullers begin anew.
        self.id.1 += 1;
        for (slot, aabb) in boxes {
            self.put(slot, translated(&aabb, from, origin));
        }
        self.update();
        self.tape = tape;
    }
}

/// The box around the same place, relative to another origin.
fn translated(aabb: &Aabb, from: DVec3, to: DVec3) -> Aabb {
    let ends = |axis: usize, x: f32| translated_coordinate(x, from[axis], to[axis]);
    let low = [0, 1, 2].map(|axis| ends(axis, aabb.min[axis])[0]);
    let high = [0, 1, 2].map(|axis| ends(axis, aabb.max[axis])[1]);
    // Bounds already: relative to nothing.
    Aabb::from_bounds(DVec3::from(low), DVec3::from(high))
}

/// Bounds of `x + from − to` in f64.
///
/// The sums round, and the difference of two origins does so by the size of the origins, not of what
/// is left: so both errors are found (Knuth's two-sum; Ogita, Rump and Oishi, *Accurate Sum and Dot
/// Product*, 2005, algorithm 3.1), and the result is `sum + rest` exactly before the last addition.
///
/// If x + shift is exact, `rest` is the shift's own error, exactly, and the addition rounds once: one
/// step of f64. If it is not, x and the shift do not cancel (Sterbenz), so that |sum| is at least half
/// of |shift| and `rest` at most 2⁻⁵¹ of it: the roundings of `rest` and of the addition are below two
/// steps together. What is exact is not widened, so that going to and fro does not grow a box.
fn translated_coordinate(x: f32, from: f64, to: f64) -> [f64; 2] {
    let (shift, shift_error) = two_sum(from, -to);
    let (sum, sum_error) = two_sum(f64::from(x), shift);
    let rest = shift_error + sum_error;
    if shift_error == 0.0 && sum_error == 0.0 {
        return [sum, sum];
    }
    let near = sum + rest;
    [near.next_down().next_down(), near.next_up().next_up()]
}

/// The rounded sum, and what it lacks: exact if nothing overflows, and then NaN or infinite, which
/// makes a box that is refused.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn what_is_exact_stays_as_it_is() {
        let aabb = Aabb::new(Vec3::new(0.1, -3.0, 7e-3), Vec3::new(0.2, 5.0, 8e-3));
        assert_eq!(translated(&aabb, DVec3::splat(0.1), DVec3::splat(0.1)), aabb);
        let whole = Aabb::new(Vec3::splat(-2.0), Vec3::splat(3.0));
        let moved = translated(&whole, DVec3::splat(1e7), DVec3::splat(1e7 - 4.0));
        assert_eq!(moved, Aabb::new(Vec3::splat(2.0), Vec3::splat(7.0)));
    }

    /// The difference of these origins is no f64: rounded, it would be 1, and the box would be said
    /// to lie where the object is not.
    #[test]
    fn a_difference_of_origins_that_rounds_is_bounded() {
        let (from, to) = (1.0, -1e-17);
        let [low, high] = translated_coordinate(-1.0, from, to);
        assert!(low <= 1e-17 && (1e-17..1e-16).contains(&high), "{low:e} to {high:e}");
        let aabb = translated(
            &Aabb::new(Vec3::splat(-1.0), Vec3::splat(-1.0)),
            DVec3::splat(from),
            DVec3::splat(to),
        );
        assert!(
            aabb.is_valid() && f64::from(aabb.max.x) >= 1e-17 && f64::from(aabb.min.x) <= 1e-17,
            "{aabb:?}"
        );
    }

    #[test]
    fn what_leaves_the_range_is_no_box() {
        let aabb = Aabb::new(Vec3::ZERO, Vec3::ONE);
        for to in [1e39, f64::MAX, f64::INFINITY, f64::NAN] {
            assert!(!translated(&aabb, DVec3::ZERO, DVec3::splat(to)).is_valid(), "{to}");
        }
    }
}
