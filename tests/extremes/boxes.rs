//! Boxes that are made of other numbers, against exact arithmetic: each holds what it was made of.

use glam::{Affine3A, DVec3, Mat3A, Vec3, Vec3A};
use proptest::prelude::*;
use tercet::geom::Aabb;
use tercet::scene::{Scene, SceneConfig, Traits};

use super::exact::Dyadic;
use super::strategies::{coordinate, sound_box};

/// Absolute places to 1e12 m, with all the digits of f64.
fn place() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => coordinate().prop_map(f64::from),
        2 => -1e7f64..1e7,
        1 => -1e12f64..1e12,
        1 => -1e-3f64..1e-3,
    ]
}

fn places() -> impl Strategy<Value = DVec3> {
    [place(), place(), place()].prop_map(DVec3::from)
}

/// `low ≤ exact ≤ high`, and no wider than by some steps of f32.
fn is_held(low: f32, high: f32, exact: &Dyadic) -> bool {
    !(exact - &Dyadic::from(low)).is_negative() && !(exact - &Dyadic::from(high)).is_positive()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, ..ProptestConfig::default() })]

    #[test]
    fn from_f64_holds_what_it_was_made_of(corner in places(), size in places(), origin in places()) {
        let (min, max) = (corner, corner + size.abs());
        let aabb = Aabb::from_f64(min, max, origin);
        prop_assert!(aabb.is_valid());
        for axis in 0..3 {
            for end in [min[axis], max[axis]] {
                let exact = &Dyadic::new(end) - &Dyadic::new(origin[axis]);
                prop_assert!(is_held(aabb.min[axis], aabb.max[axis], &exact), "{end} is not in {aabb:?}");
            }
        }
    }

    #[test]
    fn a_rebased_box_holds_what_it_held(aabb in sound_box(), from in places(), to in places()) {
        let mut scene = Scene::new(SceneConfig { origin: from, ..SceneConfig::default() });
        let id = scene.insert(aabb, Traits::default());
        scene.update();
        scene.rebase(to);
        prop_assert_eq!(scene.tree().validate(), Ok(()));
        let held = scene.object(id).and_then(|o| o.bounds).expect("these are within the range of f32");
        for axis in 0..3 {
            for (end, now) in [(aabb.min[axis], held.min[axis]), (aabb.max[axis], held.max[axis])] {
                let shift = &Dyadic::new(from[axis]) - &Dyadic::new(to[axis]);
                let exact = &Dyadic::from(end) + &shift;
                prop_assert!(is_held(held.min[axis], held.max[axis], &exact), "{end} is not in {held:?}");
                // No farther than two steps of f32.
                prop_assert!(!is_held(now.next_up().next_up(), f32::MAX, &exact) || now == held.max[axis], "{now} is too low");
                prop_assert!(!is_held(f32::MIN, now.next_down().next_down(), &exact) || now == held.min[axis], "{now} is too high");
            }
        }
    }

    #[test]
    fn a_transformed_box_holds_its_transformed_corners(
        aabb in sound_box(),
        columns in [coordinate(), coordinate(), coordinate(), coordinate(), coordinate(), coordinate(), coordinate(), coordinate(), coordinate()],
        shift in [coordinate(), coordinate(), coordinate()],
    ) {
        let m = Affine3A { matrix3: Mat3A::from_cols_array(&columns), translation: Vec3A::from(shift) };
        let around = aabb.transformed(&m);
        prop_assert!(around.is_valid());
        for corner in aabb.corners() {
            for (axis, &shift) in shift.iter().enumerate() {
                let row = m.matrix3.row(axis);
                let terms = [0, 1, 2].map(|k| &Dyadic::from(row[k]) * &Dyadic::from(corner[k]));
                let sum = terms.iter().fold(Dyadic::from(shift), |sum, term| &sum + term);
                prop_assert!(is_held(around.min[axis], around.max[axis], &sum), "{corner} in {around:?}");
            }
        }
    }

    #[test]
    fn an_inflated_box_is_larger_by_all_of_it(aabb in sound_box(), metres in 0.0f32..1e7) {
        let grown = aabb.inflated(metres);
        for axis in 0..3 {
            let low = &Dyadic::from(aabb.min[axis]) - &Dyadic::from(metres);
            let high = &Dyadic::from(aabb.max[axis]) + &Dyadic::from(metres);
            prop_assert!(is_held(grown.min[axis], grown.max[axis], &low));
            prop_assert!(is_held(grown.min[axis], grown.max[axis], &high));
        }
    }
}

/// The difference of these two origins is no f64. Rounded to nearest, it would put the point 1e-7 m
/// from where it is.
#[test]
fn rebasing_by_a_difference_that_rounds_loses_nothing() {
    let (from, to) = (DVec3::splat(1e10), DVec3::splat(1e-7));
    let mut scene = Scene::new(SceneConfig { origin: from, ..SceneConfig::default() });
    let at = Vec3::splat(-1e10);
    let id = scene.insert(Aabb::new(at, at), Traits::default());
    scene.update();
    scene.rebase(to);
    let held = scene.object(id).and_then(|o| o.bounds).expect("a box");
    let exact = &(&Dyadic::from(at.x) + &Dyadic::new(from.x)) - &Dyadic::new(to.x);
    assert!(is_held(held.min.x, held.max.x, &exact), "{} is not in {held:?}", exact.about());
}
