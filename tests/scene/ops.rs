//! Random steps of a scene's life, on trees of every kind.

use glam::Vec3;
use proptest::prelude::*;
use tercet::geom::Aabb;
use tercet::tree::{SplitAxis, SplitPlane, Straddlers, TightBoxes, TreeConfig};

/// One step of a test. Indices are taken modulo what there is.
#[derive(Clone, Debug)]
pub(super) enum Op {
    Insert(Aabb),
    /// Many at once: what the bulk build is for.
    Flood(Vec<Aabb>),
    Move(usize, Aabb),
    /// A small step: mostly stays in its cell.
    Nudge(usize, Vec3),
    Remove(usize),
    /// Objects move, and every third time another one goes, all between two updates.
    Rush(Vec<(usize, Vec3)>),
    /// All but a few objects go: nodes thin out, the root may shrink.
    Purge(usize),
    /// Dual answers for every leaf, from a seed; then the tree adapts.
    Vote(u32),
    /// Frames in which nothing happens.
    Rest(u8),
}

pub(super) fn op() -> impl Strategy<Value = Op> {
    prop_oneof![
        4 => aabb().prop_map(Op::Insert),
        1 => prop::collection::vec(aabb(), 1..120).prop_map(Op::Flood),
        1 => (aabb(), 2usize..80).prop_map(|(b, n)| Op::Flood(vec![b; n])),
        4 => (any::<usize>(), aabb()).prop_map(|(i, b)| Op::Move(i, b)),
        4 => (any::<usize>(), step()).prop_map(|(i, d)| Op::Nudge(i, d)),
        2 => any::<usize>().prop_map(Op::Remove),
        2 => prop::collection::vec((any::<usize>(), step()), 1..60).prop_map(Op::Rush),
        1 => (0usize..6).prop_map(Op::Purge),
        3 => any::<u32>().prop_map(Op::Vote),
        1 => (1u8..20).prop_map(Op::Rest),
    ]
}

pub(super) fn config() -> impl Strategy<Value = TreeConfig> {
    let dials = (
        prop_oneof![Just(SplitAxis::Longest), Just(SplitAxis::ViewAligned)],
        prop_oneof![Just(SplitPlane::Middle), Just(SplitPlane::SurfaceArea)],
        prop_oneof![Just(Straddlers::Leaf), Just(Straddlers::Split), Just(Straddlers::StayInParent)],
        prop_oneof![Just(TightBoxes::Never), Just(TightBoxes::Settled), Just(TightBoxes::Always)],
        1u32..12,
        prop_oneof![Just(1u32), 1u32..64],
        any::<bool>(),
    );
    dials.prop_map(|(axis, plane, straddlers, tight_boxes, bulk_leaf, unasked_leaf, published)| TreeConfig {
        axis,
        plane,
        straddlers,
        tight_boxes,
        bulk_leaf,
        unasked_leaf,
        idle_frames: 10,
        ..if published { TreeConfig::paper() } else { TreeConfig::stable() }
    })
}

fn aabb() -> impl Strategy<Value = Aabb> {
    let v3 = || [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from);
    (v3(), [extent(), extent(), extent()].prop_map(Vec3::from))
        .prop_map(|(min, size)| Aabb::new(min, (min + size).min(Vec3::MAX)))
}

/// Coordinates that lie close together, far out, on round numbers (planes) and at random.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => -50.0f32..50.0,
        3 => (-8i32..=8).prop_map(|i| i as f32),
        1 => prop_oneof![Just(0.0f32), Just(1e7), Just(-1e7), Just(1e-6), Just(3e30), Just(f32::MAX)],
    ]
}

fn extent() -> impl Strategy<Value = f32> {
    prop_oneof![
        5 => 0.0f32..4.0,
        2 => Just(0.0f32),
        1 => 10.0f32..200.0,
        1 => Just(1e-6f32),
    ]
}

fn step() -> impl Strategy<Value = Vec3> {
    [-0.5f32..0.5, -0.5f32..0.5, -0.5f32..0.5].prop_map(Vec3::from)
}
