//! Where things stand: chains of transforms, instances, levels, scenes.

use glam::{DMat4, DVec3, Vec3};
use serde_json::json;
use tercet::draw::Drawable;
use tercet::geom::{Aabb, Frustum, View, Viewport};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::scene::{Bounds, NotOccluder, ObjectRef, Scene, SceneConfig};
use tercet::{Culler, policy};

use crate::scenes::{self, Interior};
use crate::writer::Writer;
use crate::{check_bounds, read};

#[test]
fn nested_transforms_multiply_out() {
    let imported = read(&scenes::nested());
    check_bounds(&imported);
    // The same chain, written out as matrices, columns first.
    let links: [[f64; 16]; 5] = [
        [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 10., -4., 0.5, 1.],
        [0., 0., -2., 0., 0., 3., 0., 0., 0.5, 0., 0., 0., 0., 0., 0., 1.],
        [-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 3., 1.],
        [1., 0., 0., 0., 0.5, 1., 0., 0., 0., 0.25, -2., 0., 5., 6., 7., 1.],
        [1., 0., 0., 0., 0., 0., 0., 0., 0., -0.96, 0.28, 0., 0., 0., 0., 1.],
    ];
    let mut world_from_link = DMat4::IDENTITY;
    assert_eq!(imported.model.objects.len(), links.len());
    for (link, object) in links.iter().zip(&imported.model.objects) {
        world_from_link *= DMat4::from_cols_array(link);
        for p in scenes::FLAG {
            let wanted = world_from_link.transform_point3(DVec3::from_array(p.map(f64::from)));
            let got = object.world_from_object.transform_point3(Vec3::from_array(p));
            assert!(got.as_dvec3().abs_diff_eq(wanted, 1e-5), "{got} is not {wanted}");
        }
    }
    let mirrored = |i: usize| imported.model.objects[i].world_from_object.matrix3.determinant() < 0.0;
    assert_eq!([0, 1, 2, 3].map(mirrored), [false, false, true, false]);
    assert_eq!(imported.model.objects[4].world_from_object.matrix3.determinant(), 0.0);
    assert!(imported.report.skipped.is_empty());
}

#[test]
fn a_grove_has_transforms_of_every_kind() {
    let imported = read(&scenes::grove(24));
    check_bounds(&imported);
    let objects = &imported.model.objects;
    assert_eq!((objects.len(), imported.report.meshes), (24 * scenes::LINKS.len() + 8, 1));
    let determinants: Vec<f32> = objects.iter().map(|o| o.world_from_object.matrix3.determinant()).collect();
    let share =
        |is: fn(&f32) -> bool| determinants.iter().filter(|d| is(d)).count() as f32 / objects.len() as f32;
    assert!(share(|&d| d < 0.0) > 0.3 && share(|&d| d > 0.0) > 0.3 && share(|&d| d == 0.0) > 0.1);
}

#[test]
fn deep_transforms_do_not_gather_rounding_errors() {
    // Each pair of links cancels but for one unit; f32 products would drift at 16 million.
    let mut w = Writer::new();
    let flag = w.simple_mesh("Flag", &scenes::FLAG, &[0, 1, 2]);
    let mut at = w.root(json!({ "translation": [16_777_216.0, 0.0, 0.0] }));
    for _ in 0..20_000 {
        at = w.child(at, json!({ "translation": [0.125, 0.0, 0.0] }));
    }
    at = w.child(at, json!({ "translation": [-16_777_216.0, 0.0, 0.0] }));
    w.child(at, json!({ "mesh": flag }));
    let imported = read(&w);
    assert_eq!(imported.model.objects[0].world_from_object.translation.x, 2500.0);
}

#[test]
fn thousands_of_parts_share_a_few_meshes() {
    let imported = read(&scenes::parts(20, 10, 25));
    check_bounds(&imported);
    let (model, report) = (&imported.model, &imported.report);
    assert_eq!((report.objects, report.meshes, report.nodes), (5000, 1, 20 + 200 + 5000));
    assert_eq!((report.triangles, report.mesh_triangles), (60_000, 12));
    let colors: std::collections::BTreeSet<_> = model.objects.iter().map(|o| o.color).collect();
    assert_eq!(colors.len(), 6, "each material keeps its colour");
    assert_eq!(model.meshes[0].name(), "mesh 0 'Box', primitive 0");
    // The last part of the last shelf of the last rack, cube corners at ±1, flattened by half.
    let last = model.objects[4999].bounds;
    let wanted = Aabb::from_center(Vec3::new(76.0, 22.5, 60.0), Vec3::new(1.0, 0.5, 1.0));
    assert!(last.contains(&wanted) && wanted.inflated(1e-3).contains(&last));
    let mut world = hecs::World::new();
    imported.spawn(&mut world);
    let first = world.query::<&Drawable>().iter().next().map(|d| d.mesh.levels().as_ptr());
    let same =
        world.query::<(&Bounds, &Drawable)>().iter().all(|(_, d)| Some(d.mesh.levels().as_ptr()) == first);
    assert!(same, "one handle, five thousand objects");
    assert_eq!(Scene::new(SceneConfig::default()).sync(&world).spawned, 5000);
}

#[test]
fn an_interior_hides_most_of_itself() {
    let interior = Interior::new(8);
    let imported = read(&interior.file);
    check_bounds(&imported);
    let panes = imported.model.objects.iter().filter(|o| o.not_occluder).count();
    assert_eq!(panes, interior.rooms());
    let walls = 2 + 2 * (interior.side * (2 + 3 * (interior.side - 1)));
    assert_eq!(imported.report.objects, walls + interior.rooms() * Interior::FURNITURE);
    // All boxes are one mesh, whatever their material.
    assert_eq!(imported.report.meshes, 3);

    let mut world = hecs::World::new();
    imported.spawn(&mut world);
    assert_eq!(world.query::<(&Drawable, &NotOccluder)>().iter().count(), panes);
    let mut culler = Culler::new(policy::by_name("stop-and-wait").expect("a policy"));
    let mut scene = Scene::new(SceneConfig::default());
    // There is only one frame: leaves are to be fine from the start.
    scene.adapt([&mut culler]);
    scene.sync(&world);
    let eye = Vec3::new(7.0, 1.7, 9.0);
    let viewport = Viewport::new(320, 180);
    let view = View::look_at(eye, Vec3::new(38.0, 1.5, 38.0), 70.0, 0.05, viewport).expect("a view");
    let frustum = Frustum::new(&view);
    let in_view = imported.model.objects.iter().filter(|o| frustum.intersects(&o.bounds)).count();
    let draw_all = |pass: &mut SoftwarePass, objects: &[ObjectRef]| {
        for object in objects {
            let drawable = world.get::<&Drawable>(object.entity()).expect("it was spawned with one");
            pass.draw_mesh(&drawable.mesh, &drawable.world_from_object);
        }
    };
    let stats = culler.frame(&scene, &view, &mut SoftwareQueries::new(), draw_all).expect("a frame");
    assert!(in_view > 500, "{in_view} in view");
    assert!(stats.drawn as usize * 3 < in_view, "{} drawn of {in_view} in view", stats.drawn);
}

#[test]
fn a_node_may_stand_in_many_places() {
    let mut w = Writer::new();
    let flag = w.simple_mesh("Flag", &scenes::FLAG, &[0, 1, 2]);
    let places = w.positions(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    let view = w.view([0, 0, 0, 127, 0, 127, 0, 0, 0, 0, 0, 0]);
    let turns = w.accessor(view, 5120, "VEC4", 3);
    w.json["accessors"][turns]["normalized"] = json!(true);
    let attributes = json!({ "TRANSLATION": places, "ROTATION": turns });
    w.root(json!({
        "mesh": flag, "translation": [0, 5, 0],
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } },
    }));
    w.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let imported = read(&w);
    check_bounds(&imported);
    let at = |p: Vec3| imported.model.objects.iter().map(move |o| o.world_from_object.transform_point3(p));
    let origin: Vec<Vec3> = at(Vec3::ZERO).collect();
    assert_eq!(origin, [Vec3::new(1.0, 5.0, 0.0), Vec3::new(2.0, 5.0, 0.0), Vec3::new(3.0, 5.0, 0.0)]);
    // A half turn about y, and no turn for a quaternion of no length.
    let x: Vec<Vec3> = at(Vec3::X).collect();
    assert_eq!(x, [Vec3::new(2.0, 5.0, 0.0), Vec3::new(1.0, 5.0, 0.0), Vec3::new(4.0, 5.0, 0.0)]);
}

#[test]
fn objects_beyond_f32_are_left_out_and_singular_ones_kept() {
    let mut w = Writer::new();
    let flag = w.simple_mesh("Flag", &scenes::FLAG, &[0, 1, 2]);
    let huge = w.root(json!({ "scale": [1e30, 1e30, 1e30] }));
    w.child(huge, json!({ "mesh": flag, "name": "Beyond", "scale": [1e30, 1.0, 1.0] }));
    // Too large for f32 on the way, but not at the end.
    let huger = w.child(huge, json!({ "scale": [1e30, 1e30, 1e30] }));
    let small = w.child(huger, json!({ "scale": [1e-30, 1e-30, 1e-30] }));
    w.child(small, json!({ "mesh": flag, "scale": [1e-30, 1e-30, 1e-30] }));
    w.root(json!({ "mesh": flag, "scale": [0, 0, 0], "translation": [1, 2, 3] }));
    w.root(json!({ "mesh": flag, "matrix": [0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }));
    let imported = read(&w);
    check_bounds(&imported);
    let skipped = &imported.report.skipped;
    assert_eq!((skipped.len(), skipped[0].element.as_str()), (1, "node 1 'Beyond'"));
    assert_eq!(imported.report.objects, 3);
    assert!((imported.model.objects[0].bounds.max.y - 2.0).abs() < 1e-4);
    assert!(imported.model.objects[1].bounds.contains_point(Vec3::new(1.0, 2.0, 3.0)));
    assert!(imported.model.objects[2].bounds.size().x < 1e-30);
}

#[test]
fn a_coarser_level_is_not_shown_beside_the_finest() {
    let mut w = scenes::nested();
    w.json["nodes"][0]["extensions"] = json!({ "MSFT_lod": { "ids": [4, 3] } });
    let imported = read(&w);
    let skipped: Vec<_> = imported.report.skipped.iter().map(|r| (&*r.element, &*r.reason)).collect();
    let reason = "it is a coarser level of node 0";
    assert_eq!((imported.report.objects, skipped), (3, vec![("node 3", reason), ("node 4", reason)]));
}

#[test]
fn a_file_without_scenes_shows_every_node() {
    let mut w = scenes::nested();
    let json = w.json.as_object_mut().expect("a root");
    json.remove("scenes");
    json.remove("scene");
    assert_eq!(read(&w).report.objects, 5);
}

#[test]
fn an_empty_scene_is_no_error() {
    let imported = read(&Writer::new());
    assert!(imported.model.objects.is_empty() && imported.model.bounds.is_empty());
}
