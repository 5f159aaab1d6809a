//! Edits of a world with every extreme in it: good ones go through, bad ones are named, and the tree
//! stays valid throughout.

use std::collections::BTreeMap;

use hecs::{Entity, World};
use proptest::prelude::*;
use tercet::geom::Aabb;
use tercet::scene::{Bounds, Scene, SceneConfig, Slack, SyncReport};
use tercet::tree::{Straddlers, TreeConfig};

use super::strategies::{bad_box, sound_box, thin_box};

#[derive(Clone, Debug)]
enum Edit {
    Spawn(Aabb),
    Copies(Aabb, usize),
    Move(usize, Aabb),
    Slack(usize, f32),
    Despawn(usize),
}

/// A third of what is said is bad.
fn any_box() -> impl Strategy<Value = Aabb> {
    prop_oneof![sound_box(), thin_box(), bad_box()]
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        3 => any_box().prop_map(Edit::Spawn),
        1 => (any_box(), 2usize..40).prop_map(|(aabb, n)| Edit::Copies(aabb, n)),
        3 => (any::<usize>(), any_box()).prop_map(|(i, aabb)| Edit::Move(i, aabb)),
        1 => (any::<usize>(), prop_oneof![Just(f32::NAN), Just(-1.0), Just(f32::MAX), 0.0f32..10.0])
            .prop_map(|(i, slack)| Edit::Slack(i, slack)),
        1 => any::<usize>().prop_map(Edit::Despawn),
    ]
}

/// A world, and what it holds of each entity: its box and its slack.
#[derive(Default)]
struct Edited {
    world: World,
    told: BTreeMap<Entity, (Aabb, f32)>,
}

impl Edited {
    fn apply(&mut self, edit: &Edit) {
        let nth = |i: usize| self.told.keys().nth(i % self.told.len().max(1)).copied();
        match *edit {
            Edit::Spawn(aabb) => self.spawn(aabb),
            Edit::Copies(aabb, n) => (0..n).for_each(|_| self.spawn(aabb)),
            Edit::Move(i, aabb) => {
                if let Some(entity) = nth(i) {
                    self.world.insert_one(entity, Bounds(aabb)).expect("it is alive");
                    self.told.get_mut(&entity).expect("it is known").0 = aabb;
                }
            }
            Edit::Slack(i, slack) => {
                if let Some(entity) = nth(i) {
                    self.world.insert_one(entity, Slack(slack)).expect("it is alive");
                    self.told.get_mut(&entity).expect("it is known").1 = slack;
                }
            }
            Edit::Despawn(i) => {
                if let Some(entity) = nth(i) {
                    self.world.despawn(entity).expect("it is alive");
                    self.told.remove(&entity);
                }
            }
        }
    }

    fn spawn(&mut self, aabb: Aabb) {
        self.told.insert(self.world.spawn((Bounds(aabb),)), (aabb, 0.0));
    }

    /// The scene has each good box, and each bad one by its entity's name.
    fn check(&self, scene: &Scene, report: &SyncReport) -> Result<(), TestCaseError> {
        prop_assert_eq!(scene.tree().validate(), Ok(()));
        prop_assert_eq!(scene.len(), self.told.len());
        let is_bad = |&(aabb, slack): &(Aabb, f32)| {
            !aabb.is_valid() || !slack.ge(&0.0) || slack > 0.0 && !aabb.inflated(slack).is_valid()
        };
        let bad = self.told.values().filter(|told| is_bad(told)).count();
        prop_assert_eq!(report.bad, bad);
        prop_assert_eq!(report.first_bad.len(), bad.min(SyncReport::NAMED));
        for named in &report.first_bad {
            let told = self.told.get(&named.entity);
            prop_assert!(told.is_some_and(is_bad), "{:?} is not bad", named);
        }
        for object in scene.objects() {
            let told = &self.told[&object.object.entity()];
            prop_assert_eq!(object.bad, is_bad(told));
            prop_assert_eq!(object.bounds.is_none(), is_bad(told));
            prop_assert!(
                object.bounds.is_none_or(|held| held.contains(&told.0) && (told.1 > 0.0 || held == told.0))
            );
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn bad_edits_are_named_and_spoil_no_good_one(
        straddlers in prop_oneof![Just(Straddlers::Leaf), Just(Straddlers::Split), Just(Straddlers::StayInParent)],
        frames in prop::collection::vec(prop::collection::vec(edit(), 1..8), 1..12),
    ) {
        let tree = TreeConfig { straddlers, bulk_leaf: 2, unasked_leaf: 2, ..TreeConfig::default() };
        let mut scene = Scene::new(SceneConfig { tree, ..SceneConfig::default() });
        let mut edited = Edited::default();
        for edits in &frames {
            edits.iter().for_each(|edit| edited.apply(edit));
            let report = scene.sync(&edited.world);
            edited.check(&scene, &report)?;
        }
    }
}
