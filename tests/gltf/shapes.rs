//! What shape things have: indices, strips, fans, accessors of every kind.

use std::path::PathBuf;

use glam::Vec3;
use serde_json::json;
use tercet::scene::import;

use crate::writer::{U8, U16, U32, Writer};
use crate::{folder, read, scenes};

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

/// The triangles of a file with one primitive, as positions.
fn triangles_of(w: &Writer) -> Vec<[f32; 3]> {
    let imported = read(w);
    let level = &imported.model.meshes[0].levels()[0];
    level.indices.iter().map(|&i| level.positions[i as usize].to_array()).collect()
}

/// Vertex n lies at x = n.
pub(super) fn numbered(count: usize) -> Vec<[f32; 3]> {
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
