//! Whole scenes from glTF files: what is in the file is in the scene, and where it belongs.

#![cfg(feature = "gltf")]

mod malformed;
#[path = "../support/scenes.rs"]
mod scenes;
#[path = "../support/writer.rs"]
mod writer;

use std::path::PathBuf;

use glam::{DMat4, DVec3, Vec3};
use serde_json::json;
use tempfile::TempDir;
use tercet::draw::Drawable;
use tercet::geom::{Aabb, Frustum, View, Viewport};
use tercet::query::software::SoftwareQueries;
use tercet::scene::import::{self, Imported};
use tercet::scene::{Bounds, NotOccluder, Scene, SceneConfig};
use tercet::{Culler, policy};

use scenes::Interior;
use writer::{F32, U8, U16, U32, Writer};

fn folder() -> TempDir {
    tempfile::tempdir().expect("there is a folder for temporary files")
}

fn read(file: &Writer) -> Imported {
    let folder = folder();
    import::load(file.write_glb(folder.path())).expect("the file is well formed")
}

/// The property that culling rests on: whatever is drawn lies in the box.
fn check_bounds(imported: &Imported) {
    let model = &imported.model;
    let mut all = Aabb::EMPTY;
    for (o, object) in model.objects.iter().enumerate() {
        let m = object.world_from_object;
        for &p in model.meshes[object.mesh].levels().iter().flat_map(|level| &level.positions) {
            let plain = m.transform_point3(p);
            // Another order of the same sums, with fused products.
            let (x, y, z) = (Vec3::from(m.matrix3.x_axis), Vec3::from(m.matrix3.y_axis), m.matrix3.z_axis);
            let fused =
                [0, 1, 2].map(|i| p.x.mul_add(x[i], p.y.mul_add(y[i], p.z.mul_add(z[i], m.translation[i]))));
            for drawn in [plain, Vec3::from(fused)] {
                assert!(
                    object.bounds.contains_point(drawn),
                    "object {o}: {drawn} is not in {:?}",
                    object.bounds
                );
            }
        }
        all = all.union(&object.bounds);
    }
    assert_eq!(all, model.bounds);
}

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
    let draw_all = |pass: &mut tercet::query::software::SoftwarePass,
                    objects: &[tercet::scene::ObjectRef]| {
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
fn the_buffer_may_be_in_the_file_beside_it_or_in_a_data_uri() {
    let (w, folder) = (scenes::nested(), folder());
    let paths: [PathBuf; 3] =
        [w.write_glb(folder.path()), w.write_embedded(folder.path()), w.write_beside(folder.path())];
    let [glb, embedded, beside] = paths.map(|path| import::load(path).expect("the file is well formed"));
    assert_eq!(glb.model.objects, embedded.model.objects);
    assert_eq!(glb.model.objects, beside.model.objects);
    assert_eq!(glb.report, beside.report);
    assert_eq!(beside.model.name, "beside");
}

/// The triangles of a file with one primitive, as positions.
fn triangles_of(w: &Writer) -> Vec<[f32; 3]> {
    let imported = read(w);
    let level = &imported.model.meshes[0].levels()[0];
    level.indices.iter().map(|&i| level.positions[i as usize].to_array()).collect()
}

/// Vertex n lies at x = n.
fn numbered(count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|n| [n as f32, (n * n % 7) as f32, 1.0]).collect()
}

fn picked(vertices: &[usize]) -> Vec<[f32; 3]> {
    let all = numbered(1000);
    vertices.iter().map(|&v| all[v]).collect()
}

fn one_primitive(primitive: impl Fn(&mut Writer) -> serde_json::Value) -> Writer {
    let mut w = Writer::new();
    let primitive = primitive(&mut w);
    let mesh = w.mesh("Shape", json!([primitive]));
    w.root(json!({ "mesh": mesh }));
    w
}

#[test]
fn indices_come_in_three_widths_or_not_at_all() {
    let wanted = picked(&[1, 2, 4, 4, 2, 5]);
    for component in [U8, U16, U32] {
        let w = one_primitive(|w| {
            let (p, i) = (w.positions(&numbered(6)), w.indices(component, &[1, 2, 4, 4, 2, 5]));
            json!({ "attributes": { "POSITION": p }, "indices": i })
        });
        assert_eq!(triangles_of(&w), wanted);
    }
    let w = one_primitive(|w| json!({ "attributes": { "POSITION": w.positions(&wanted) } }));
    assert_eq!(triangles_of(&w), wanted);
}

#[test]
fn strips_and_fans_become_triangles() {
    let shape = |mode: u32| {
        one_primitive(|w| json!({ "attributes": { "POSITION": w.positions(&numbered(5)) }, "mode": mode }))
    };
    assert_eq!(triangles_of(&shape(5)), picked(&[0, 1, 2, 2, 1, 3, 2, 3, 4]));
    assert_eq!(triangles_of(&shape(6)), picked(&[1, 2, 0, 2, 3, 0, 3, 4, 0]));
}

#[test]
fn only_vertices_that_are_used_are_kept() {
    let w = one_primitive(|w| {
        let (p, i) = (w.positions(&numbered(1000)), w.indices(U16, &[900, 3, 40, 40, 900, 41]));
        json!({ "attributes": { "POSITION": p }, "indices": i })
    });
    assert_eq!(triangles_of(&w), picked(&[900, 3, 40, 40, 900, 41]));
    assert_eq!(
        read(&w).model.meshes[0].levels()[0].positions,
        [3, 40, 41, 900].map(|v| Vec3::from_array(numbered(1000)[v]))
    );
}

#[test]
fn many_primitives_may_share_one_large_accessor() {
    let mut w = Writer::new();
    let all = w.positions(&vec![[1.0; 3]; 400_000]);
    let far_apart = w.indices(U32, &[0, 399_999, 200_000]);
    let primitive = |first: usize, w: &mut Writer| {
        let mut indices = w.json["accessors"][far_apart].clone();
        indices["count"] = json!(3);
        indices["name"] = json!(format!("copy {first}"));
        json!({ "attributes": { "POSITION": all }, "indices": w.push("accessors", indices) })
    };
    let primitives: Vec<_> = (0..2000).map(|n| primitive(n, &mut w)).collect();
    let mesh = w.mesh("Crumbs", primitives.into());
    w.root(json!({ "mesh": mesh }));
    // A copy of the array for each would be ten gigabytes.
    let imported = read(&w);
    let kept: usize = imported.model.meshes.iter().map(|m| m.levels()[0].positions.len()).sum();
    assert_eq!((imported.report.meshes, kept), (2000, 6000));
}

#[test]
fn sparse_accessors_replace_elements_of_a_base_or_of_zeros() {
    let moved = [[50.0, 1.0, 2.0], [60.0, 3.0, 4.0]];
    for based in [true, false] {
        let w = one_primitive(|w| {
            let p = w.positions(&numbered(6));
            let (values, at) = (w.positions(&moved), w.indices(U8, &[1, 4]));
            let view = |accessor: usize| w.json["accessors"][accessor]["bufferView"].clone();
            let sparse = json!({
                "count": 2,
                "indices": { "bufferView": view(at), "componentType": U8 },
                "values": { "bufferView": view(values) },
            });
            let mut accessor = w.json["accessors"][p].clone();
            accessor["sparse"] = sparse;
            if !based {
                accessor.as_object_mut().expect("an accessor").remove("bufferView");
            }
            json!({ "attributes": { "POSITION": w.push("accessors", accessor) } })
        });
        let base = if based { numbered(6) } else { vec![[0.0; 3]; 6] };
        let wanted = [base[0], moved[0], base[2], base[3], moved[1], base[5]];
        assert_eq!(triangles_of(&w), wanted);
    }
}

#[test]
fn positions_may_be_interleaved_offset_and_quantised() {
    let w = one_primitive(|w| {
        // Two bytes of something else, three positions of normalised i16, padded to stride 12.
        let rows: [[i16; 6]; 3] = [[9, 32767, 0, -32768, 9, 9], [9, 0, 16384, 0, 9, 9], [9, 1, 2, 3, 9, 9]];
        let view = w.view(rows.iter().flatten().flat_map(|c| c.to_le_bytes()));
        w.json["bufferViews"][view]["byteStride"] = json!(12);
        let p = w.accessor(view, 5122, "VEC3", 3);
        w.json["accessors"][p]["byteOffset"] = json!(2);
        w.json["accessors"][p]["normalized"] = json!(true);
        json!({ "attributes": { "POSITION": p } })
    });
    let unit = |i: i16| f32::from(i) / 32767.0;
    let wanted = [[1.0, 0.0, -1.0], [0.0, unit(16384), 0.0], [unit(1), unit(2), unit(3)]];
    assert_eq!(triangles_of(&w), wanted);
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
fn materials_give_colours_and_say_what_is_see_through() {
    let mut w = Writer::new();
    let p = w.positions(&scenes::FLAG);
    let materials = [
        json!({}),
        json!({ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.5, 0.0, 1.0] }, "doubleSided": true }),
        json!({ "alphaMode": "MASK" }),
        json!({ "alphaMode": "BLEND" }),
        json!({ "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 } } }),
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [0.0, 0.0, 1.0, 1.0] } } }),
    ];
    let primitives: Vec<_> = materials
        .into_iter()
        .map(|m| json!({ "attributes": { "POSITION": p }, "material": w.push("materials", m) }))
        .collect();
    let mesh = w.mesh("Swatches", primitives.into());
    w.root(json!({ "mesh": mesh }));
    let imported = read(&w);
    let looks: Vec<_> = imported.model.objects.iter().map(|o| (o.color, o.not_occluder)).collect();
    let white = [255; 3];
    let wanted = [
        (white, false),
        ([255, 188, 0], false),
        (white, true),
        (white, true),
        (white, true),
        ([0, 0, 255], false),
    ];
    assert_eq!(looks, wanted);
    assert_eq!(imported.report.meshes, 1, "one shape, six looks");
}

#[test]
fn what_is_not_a_surface_is_left_out_and_reported() {
    let mut w = Writer::new();
    let p = w.positions(&numbered(6));
    let empty = w.indices(U16, &[]);
    let hollow = w.push("accessors", json!({ "componentType": F32, "type": "VEC3", "count": 3 }));
    let part = |mode: u32| json!({ "attributes": { "POSITION": p }, "mode": mode });
    let mesh = w.mesh(
        "Lamp",
        json!([
            part(0), part(1), part(2), part(3), part(4),
            { "attributes": { "NORMAL": p } },
            { "attributes": { "POSITION": p }, "indices": empty },
            { "attributes": { "POSITION": hollow } },
            { "attributes": { "POSITION": p }, "targets": [{ "POSITION": p }] },
        ]),
    );
    w.mesh("Never used, and never read", json!([{ "attributes": { "POSITION": 999 } }]));
    w.root(json!({ "mesh": mesh }));
    w.root(json!({ "mesh": mesh, "name": "Far", "scale": [1e30, 1e30, 1e30], "translation": [3e38, 0, 0] }));
    w.root(json!({ "mesh": mesh, "skin": 0 }));
    w.push("scenes", json!({ "name": "Other", "nodes": [] }));
    let imported = read(&w);
    check_bounds(&imported);
    let far = imported.model.objects.iter().filter(|o| o.bounds.max.x > 1e30).count();
    let remarks = |list: &[import::Remark]| {
        list.iter().map(|r| format!("{}: {}", r.element, r.reason)).collect::<Vec<_>>()
    };
    assert_eq!(
        remarks(&imported.report.skipped),
        [
            "scene 1 'Other': the file's default scene is another",
            "mesh 0 'Lamp', primitive 0: it is made of points",
            "mesh 0 'Lamp', primitive 1: it is made of lines",
            "mesh 0 'Lamp', primitive 2: it is made of lines",
            "mesh 0 'Lamp', primitive 3: it is made of lines",
            "mesh 0 'Lamp', primitive 5: it has no positions",
            "mesh 0 'Lamp', primitive 6: it has no triangle",
            "mesh 0 'Lamp', primitive 7: its positions, accessor 2, have no data",
        ]
    );
    assert_eq!(far, 2, "3e38 + 5e30 is still a number");
    assert_eq!(
        remarks(&imported.report.altered),
        [
            "node 2: its skin is not applied: it stands as it was modelled",
            "mesh 0 'Lamp', primitive 8: its morph targets are not applied",
        ]
    );
    assert_eq!(imported.report.objects, 6);
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

#[cfg(feature = "lod")]
#[test]
fn levels_are_made_for_meshes_whose_vertices_are_split() {
    // A sphere as a soup of triangles: no vertex is shared.
    const N: u32 = 32;
    let point = |u: u32, v: u32| {
        let (sin, cos) = (std::f32::consts::TAU * (u % N) as f32 / N as f32).sin_cos();
        let (radius, y) = (std::f32::consts::PI * v as f32 / N as f32).sin_cos();
        [radius * cos, y, radius * sin]
    };
    let cells = (0..N * N).map(|c| (c % N, c / N));
    let soup: Vec<[f32; 3]> = cells
        .flat_map(|(u, v)| [(u, v), (u, v + 1), (u + 1, v), (u + 1, v), (u, v + 1), (u + 1, v + 1)])
        .map(|(u, v)| point(u, v))
        .collect();
    let w = one_primitive(|w| json!({ "attributes": { "POSITION": w.positions(&soup) } }));
    let mut imported = read(&w);
    let before = imported.model.meshes[0].clone();
    imported.generate_levels(100).expect("a sphere can be simplified");
    check_bounds(&imported);
    let after = &imported.model.meshes[0];
    assert_eq!((after.bounds(), after.name()), (before.bounds(), before.name()));
    let triangles: Vec<usize> = after.levels().iter().map(|level| level.indices.len() / 3).collect();
    assert_eq!(triangles[0], 2048);
    assert!(triangles.len() == 5 && triangles.windows(2).all(|t| t[1] <= t[0] * 5 / 8), "{triangles:?}");
    assert!(after.levels()[4].error < 0.3, "it is still a ball of radius 1");
}
