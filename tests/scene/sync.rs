//! Mirroring a hecs world: every way in which an entity can appear, change and disappear.

use glam::{DVec3, Vec3};
use hecs::World;
use tercet::geom::Aabb;
use tercet::scene::{
    Bounds, BoundsF64, NeverCull, NotOccluder, Scene, SceneConfig, Slack, SyncReport, Traits,
};

fn unit_at(x: f32) -> Bounds {
    Bounds(Aabb::from_center(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5)))
}

fn counts(report: &SyncReport) -> [usize; 4] {
    [report.spawned, report.moved, report.removed, report.bad]
}

/// Syncs, and checks that the scene holds exactly the entities with valid bounds, where they are.
fn sync(scene: &mut Scene, world: &World) -> SyncReport {
    let report = scene.sync(world);
    scene.tree().validate().expect("a valid tree");
    let expected = world.query::<(hecs::Entity, &Bounds)>().iter().count();
    assert_eq!(scene.len(), expected);
    for object in scene.objects() {
        let entity = object.object.entity();
        let bounds = world.get::<&Bounds>(entity).expect("an object's entity is alive");
        if object.traits == Traits::default() && !object.bad {
            assert_eq!(object.bounds, Some(bounds.0));
        }
    }
    report
}

#[test]
fn spawned_moved_and_despawned_entities_are_found() {
    let (mut scene, mut world) = (Scene::new(SceneConfig::default()), World::new());
    assert_eq!(counts(&sync(&mut scene, &world)), [0, 0, 0, 0]);
    let entities: Vec<_> = (0..100).map(|i| world.spawn((unit_at(i as f32 * 3.0),))).collect();
    assert_eq!(counts(&sync(&mut scene, &world)), [100, 0, 0, 0]);
    assert_eq!(counts(&sync(&mut scene, &world)), [0, 0, 0, 0]);
    *world.get::<&mut Bounds>(entities[7]).unwrap() = unit_at(-50.0);
    assert_eq!(counts(&sync(&mut scene, &world)), [0, 1, 0, 0]);
    world.despawn(entities[3]).unwrap();
    world.remove_one::<Bounds>(entities[4]).unwrap();
    assert_eq!(counts(&sync(&mut scene, &world)), [0, 0, 2, 0]);
    world.insert_one(entities[4], unit_at(1.0)).unwrap();
    assert_eq!(counts(&sync(&mut scene, &world)), [1, 0, 0, 0]);
}

#[test]
fn a_reused_entity_id_is_another_object() {
    let (mut scene, mut world) = (Scene::new(SceneConfig::default()), World::new());
    let first = world.spawn((unit_at(0.0),));
    sync(&mut scene, &world);
    let old = scene.objects().next().unwrap().object.id;
    world.despawn(first).unwrap();
    let second = world.spawn((unit_at(9.0),));
    assert_eq!(first.id(), second.id(), "hecs hands the id out again");
    assert_eq!(counts(&sync(&mut scene, &world)), [1, 0, 1, 0]);
    assert!(scene.object(old).is_none(), "the old handle names nothing");
    assert_eq!(scene.objects().next().unwrap().object.entity(), second);
}

#[test]
fn bad_bounds_are_named_and_drawn_always_until_mended() {
    let (mut scene, mut world) = (Scene::new(SceneConfig::default()), World::new());
    let good = world.spawn((unit_at(0.0),));
    let nan = world.spawn((Bounds(Aabb::new(Vec3::NAN, Vec3::ONE)),));
    let infinite = world.spawn((Bounds(Aabb::new(Vec3::ZERO, Vec3::INFINITY)),));
    let inverted = world.spawn((Bounds(Aabb::new(Vec3::ONE, Vec3::ZERO)),));
    let slack = world.spawn((unit_at(5.0), Slack(f32::NAN)));
    let report = sync(&mut scene, &world);
    assert_eq!(counts(&report), [5, 0, 0, 4]);
    let named: Vec<_> = report.first_bad.iter().map(|b| b.entity).collect();
    for entity in [nan, infinite, inverted, slack] {
        assert!(named.contains(&entity));
    }
    let bad: Vec<_> = scene.objects().filter(|o| o.bad).map(|o| o.object.entity()).collect();
    assert_eq!(bad.len(), 4);
    assert!(!bad.contains(&good));

    // Mended one by one, and a good one spoiled: nothing is lost on the way.
    *world.get::<&mut Bounds>(nan).unwrap() = unit_at(1.0);
    *world.get::<&mut Bounds>(good).unwrap() = Bounds(Aabb::new(Vec3::ONE, Vec3::NAN));
    world.insert_one(slack, Slack(0.25)).unwrap();
    assert_eq!(sync(&mut scene, &world).bad, 3);
    assert_eq!(scene.len(), 5);
    world.despawn(inverted).unwrap();
    *world.get::<&mut Bounds>(good).unwrap() = unit_at(2.0);
    *world.get::<&mut Bounds>(infinite).unwrap() = unit_at(3.0);
    assert_eq!(sync(&mut scene, &world).bad, 0);
    assert_eq!(scene.tree().len(), 4);
}

#[test]
fn optional_components_come_and_go() {
    let (mut scene, mut world) = (Scene::new(SceneConfig::default()), World::new());
    let entity = world.spawn((unit_at(0.0),));
    sync(&mut scene, &world);
    let state = |scene: &Scene| scene.objects().next().unwrap();
    world.insert(entity, (NeverCull, NotOccluder)).unwrap();
    assert_eq!(sync(&mut scene, &world).moved, 1);
    assert!(state(&scene).traits.never_cull && state(&scene).traits.not_occluder);
    assert!(scene.tree().is_empty(), "an object that is drawn always is not in the tree");
    assert_eq!(sync(&mut scene, &world).moved, 0);
    world.remove_one::<NeverCull>(entity).unwrap();
    sync(&mut scene, &world);
    assert_eq!(scene.tree().len(), 1);
    world.insert_one(entity, Slack(2.0)).unwrap();
    sync(&mut scene, &world);
    let grown = state(&scene).bounds.unwrap();
    assert!(grown.contains(&Aabb::from_center(Vec3::ZERO, Vec3::splat(2.5))), "{grown:?}");
    assert!(Aabb::from_center(Vec3::ZERO, Vec3::splat(2.51)).contains(&grown), "{grown:?}");
}

#[test]
fn f64_bounds_are_relative_to_the_origin_and_rounded_outward() {
    let origin = DVec3::new(1e7, -2e7, 3e6);
    let mut scene = Scene::new(SceneConfig { origin, ..SceneConfig::default() });
    let mut world = World::new();
    let min = origin + DVec3::new(0.012_345_678_9, 1.0, -1.0);
    let max = min + DVec3::splat(0.01);
    world.spawn((BoundsF64 { min, max },));
    scene.sync(&world);
    let check = |scene: &Scene| {
        let held = scene.objects().next().unwrap().bounds.unwrap();
        let (low, high) = (held.min.as_dvec3() + scene.origin(), held.max.as_dvec3() + scene.origin());
        assert!(low.cmple(min).all() && high.cmpge(max).all(), "outward");
        (low - min).abs().max_element().max((high - max).abs().max_element())
    };
    assert!(check(&scene) < 1e-6, "centimetres stay centimetres");
    scene.rebase(DVec3::ZERO);
    scene.tree().validate().unwrap();
    assert!(check(&scene) > 1e-3, "at 1e7 from the origin f32 is coarse, and still outward");
    scene.sync(&world);
    check(&scene);
    scene.rebase(origin + DVec3::ONE);
    scene.sync(&world);
    assert!(check(&scene) < 1e-6, "precise again");
}

#[test]
fn direct_edits_and_a_world_do_not_disturb_each_other() {
    let (mut scene, mut world) = (Scene::new(SceneConfig::default()), World::new());
    let entity = world.spawn((unit_at(0.0),));
    scene.sync(&world);
    let direct = scene.insert(unit_at(4.0).0, Traits::default());
    let mirrored = scene.objects().find(|o| o.object.entity() == entity).unwrap().object.id;
    assert!(scene.remove(mirrored), "the app removes an object behind its world's back");
    let second = scene.insert(unit_at(8.0).0, Traits::default());
    let report = scene.sync(&world);
    assert_eq!(report.spawned, 1, "the entity is still there, so it is an object again");
    assert!(scene.object(direct).is_some() && scene.object(second).is_some());
    world.despawn(entity).unwrap();
    scene.sync(&world);
    assert_eq!(scene.len(), 2);
    assert_eq!(scene.sync_moved([(direct, unit_at(5.0).0), (mirrored, unit_at(6.0).0)]), 1);
    assert_eq!(scene.object(direct).unwrap().bounds, Some(unit_at(5.0).0));
}

/// Random worlds against a recount, over many frames.
#[test]
fn churn_keeps_the_mirror_true() {
    let (mut scene, mut world) = (Scene::new(SceneConfig::default()), World::new());
    let mut state = 12345u64;
    let mut random = move |n: u64| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) % n
    };
    for _ in 0..200 {
        for _ in 0..random(12) {
            world.spawn((unit_at(random(200) as f32),));
        }
        let all: Vec<_> = world.iter().map(|e| e.entity()).collect();
        for _ in 0..random(8) {
            if all.is_empty() {
                continue;
            }
            let entity = all[random(all.len() as u64) as usize];
            match random(4) {
                0 => drop(world.despawn(entity)),
                1 => drop(world.insert_one(entity, unit_at(random(300) as f32))),
                2 => drop(world.remove_one::<Bounds>(entity)),
                _ => drop(world.insert_one(entity, Bounds(Aabb::new(Vec3::NAN, Vec3::NAN)))),
            }
        }
        sync(&mut scene, &world);
    }
    assert!(scene.len() > 100);
}
