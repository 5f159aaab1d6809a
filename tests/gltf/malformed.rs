//! Files that are not what they should be: each gives an error that names the file and the
//! element, and none a panic.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use tercet::scene::import;

use crate::writer::{self, F32, U8, U16, Writer};
use crate::{check_bounds, folder, scenes};

/// A sound file: a wall of two primitives, the second indexed; three nodes in a row.
fn sound() -> Writer {
    let mut w = Writer::new();
    let loose = w.positions(&scenes::FLAG);
    let (corners, indices) = (w.positions(&scenes::cube_corners()), w.indices(U16, &scenes::CUBE));
    w.material([1.0; 4], "OPAQUE");
    let wall = w.mesh(
        "Wall",
        json!([
            { "attributes": { "POSITION": loose } },
            { "attributes": { "POSITION": corners }, "indices": indices, "material": 0 },
        ]),
    );
    let top = w.root(json!({ "name": "Top" }));
    let middle = w.child(top, json!({ "name": "Middle", "mesh": wall }));
    w.child(middle, json!({ "mesh": wall, "translation": [1, 2, 3] }));
    w
}

/// Makes accessor 0 sparse, with indices of one byte.
fn sparse(w: &mut Writer, indices: &[u32], count: usize) {
    let at = w.indices(U8, indices);
    let values = w.positions(&vec![[1.0; 3]; indices.len()]);
    let view = |accessor: usize| w.json["accessors"][accessor]["bufferView"].clone();
    let (at, values) = (view(at), view(values));
    w.json["accessors"][0]["sparse"] = json!({
        "count": count,
        "indices": { "bufferView": at, "componentType": U8 },
        "values": { "bufferView": values },
    });
}

fn remove(value: &mut Value, key: &str) {
    value.as_object_mut().expect("an object").remove(key);
}

type Spoil = fn(&mut Writer);

/// How a sound file is spoilt, and what the message must say.
const SPOILT: &[(Spoil, &[&str])] = &[
    (
        |w| w.json["accessors"][2]["count"] = json!(37),
        &["mesh 0 'Wall', primitive 1", "accessor 2 reads past its buffer view 2", "74 bytes", "72"],
    ),
    (
        |w| w.json["accessors"][1]["byteOffset"] = json!(4),
        &["primitive 1: accessor 1 reads past its buffer view 1"],
    ),
    (|w| w.json["accessors"][1]["byteOffset"] = json!(u64::MAX), &["accessor 1 reads past"]),
    (
        |w| w.json["accessors"][0]["count"] = json!(u64::MAX),
        &["primitive 0: accessor 0 claims 18446744073709551615 elements"],
    ),
    (|w| w.json["accessors"][0]["count"] = json!(-1), &["accessors[0].count"]),
    (
        |w| w.json["accessors"][0]["type"] = json!("VEC2"),
        &["primitive 0: accessor 0 holds Vec2; positions need Vec3"],
    ),
    (|w| w.json["accessors"][0]["type"] = json!("VEC5"), &["accessor 0 has a type that glTF does not know"]),
    (
        |w| w.json["accessors"][0]["componentType"] = json!(5125),
        &["accessor 0 holds U32, which positions cannot be"],
    ),
    (
        |w| w.json["accessors"][2]["componentType"] = json!(F32),
        &["accessor 2 holds F32, which indices cannot be"],
    ),
    (|w| w.json["accessors"][2]["componentType"] = json!(1), &["accessor 2 has a componentType"]),
    (
        |w| w.json["accessors"][0]["bufferView"] = json!(77),
        &["primitive 0: accessor 0", "buffer view 77 does not exist: the file has 3"],
    ),
    (
        |w| w.json["bufferViews"][0]["byteStride"] = json!(8),
        &["accessor 0 has elements of 12 bytes in buffer view 0 of stride 8"],
    ),
    (
        |w| w.json["bufferViews"][1]["byteLength"] = json!(100_000),
        &["accessor 1", "buffer view 1: 100000 bytes from byte 36 reach past buffer 0"],
    ),
    (|w| w.json["bufferViews"][1]["byteOffset"] = json!(u64::MAX), &["buffer view 1"]),
    (|w| w.json["bufferViews"][0]["buffer"] = json!(5), &["buffer view 0: buffer 5 does not exist"]),
    (
        |w| w.json["buffers"] = json!([{ "byteLength": 1_u64 << 40 }]),
        &["buffer 0 has", "of the 1099511627776 that it claims"],
    ),
    (|w| w.json["buffers"] = json!([{ "byteLength": 36, "uri": "gone.bin" }]), &["buffer 0: gone.bin: "]),
    (
        |w| w.json["buffers"] = json!([{ "byteLength": 36, "uri": "%FF.bin" }]),
        &["buffer 0: %FF.bin: not a file name"],
    ),
    (
        |w| w.json["buffers"] = json!([{ "byteLength": 36, "uri": "https://example.org/a.bin" }]),
        &["buffer 0: https://example.org/a.bin"],
    ),
    (
        |w| w.json["buffers"] = json!([{ "byteLength": 36, "uri": "data:;base64,!!!!" }]),
        &["buffer 0: its data URI"],
    ),
    (|w| w.json["buffers"] = json!([{ "byteLength": 0 }, { "byteLength": 9 }]), &["buffer 0, which has 0"]),
    (
        |w| w.bin[0..4].copy_from_slice(&f32::NAN.to_le_bytes()),
        &["primitive 0: accessor 0: position 0 is not finite"],
    ),
    (
        |w| w.bin[60..64].copy_from_slice(&f32::INFINITY.to_le_bytes()),
        &["primitive 1: accessor 1: position 2 is not finite"],
    ),
    (
        |w| {
            let at = w.bin.len() - 2;
            w.bin[at] = 8
        },
        &["primitive 1: accessor 2: index 35 is 8, of 8 vertices"],
    ),
    (
        |w| w.json["accessors"][2]["count"] = json!(35),
        &["mesh 0 'Wall', primitive 1: 35 vertices are not whole triangles"],
    ),
    (|w| sparse(w, &[0, 3], 2), &["accessor 0 is sparse, and replaces element 3 of 3"]),
    (|w| sparse(w, &[2, 1], 2), &["accessor 0 is sparse, and replaces element 1 after element 2"]),
    (|w| sparse(w, &[0, 1], 4), &["accessor 0 is sparse, and replaces 4 elements of 3"]),
    (|w| sparse(w, &[0], 3), &["accessor 0 is sparse, and reads past its buffer view 3"]),
    (
        |w| {
            remove(&mut w.json["accessors"][0], "bufferView");
            w.json["accessors"][0]["count"] = json!(4_000_000_000_u32)
        },
        &["accessor 0 claims 4000000000 elements and has no buffer view"],
    ),
    (
        |w| w.json["meshes"][0]["primitives"][1]["indices"] = json!(9),
        &["mesh 0 'Wall', primitive 1: accessor 9 does not exist: the file has 3"],
    ),
    (
        |w| w.json["meshes"][0]["primitives"][1]["material"] = json!(4),
        &["mesh 0 'Wall', primitive 1: material 4 does not exist"],
    ),
    (|w| w.json["meshes"][0]["primitives"][0]["mode"] = json!(7), &["mesh 0 'Wall', primitive 0: its mode"]),
    (|w| w.json["materials"][0]["alphaMode"] = json!("GHOST"), &["primitive 1: the alphaMode of material 0"]),
    (|w| w.json["nodes"][2]["mesh"] = json!(3), &["node 2: mesh 3 does not exist: the file has 1"]),
    (|w| w.json["nodes"][2]["children"] = json!([12]), &["node 2: child node 12 does not exist"]),
    (
        |w| w.json["nodes"][2]["children"] = json!([1]),
        &["node 1 'Middle' has two parents: node 0 'Top' and node 2"],
    ),
    (|w| w.json["nodes"][2]["children"] = json!([0]), &["is its own ancestor"]),
    (
        |w| {
            w.push("nodes", json!({ "children": [4] }));
            w.push("nodes", json!({ "children": [3] }));
        },
        &["node 4 is its own ancestor"],
    ),
    (
        |w| w.json["scenes"][0]["nodes"] = json!([0, 2]),
        &["scene 0: node 2 is listed as a root, and is a child of node 1 'Middle'"],
    ),
    (|w| w.json["scenes"][0]["nodes"] = json!([0, 0]), &["scene 0: node 0 'Top' is listed twice"]),
    (|w| w.json["scenes"][0]["nodes"] = json!([8]), &["scene 0: node 8 does not exist"]),
    (|w| w.json["scene"] = json!(2), &["scene: scene 2 does not exist: the file has 1"]),
    (
        |w| w.json["nodes"][1]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 1]),
        &["node 1 'Middle': the last row of its matrix"],
    ),
    (|w| w.json["nodes"][1]["scale"] = json!([1, 2]), &["nodes[1].scale"]),
    (
        |w| w.json["nodes"][1]["extensions"] = json!({ "EXT_mesh_gpu_instancing": {} }),
        &["node 1 'Middle': EXT_mesh_gpu_instancing: it has no attribute"],
    ),
    (
        |w| {
            w.json["nodes"][1]["extensions"] =
                json!({ "EXT_mesh_gpu_instancing": { "attributes": { "SCALE": 2 } } })
        },
        &["EXT_mesh_gpu_instancing: SCALE: accessor 2 holds U16"],
    ),
    (
        |w| {
            w.json["nodes"][1]["extensions"] =
                json!({ "EXT_mesh_gpu_instancing": { "attributes": { "SCALE": 0, "TRANSLATION": 1 } } })
        },
        &["its attributes are not of one length"],
    ),
    (
        |w| w.json["nodes"][1]["extensions"] = json!({ "MSFT_lod": { "ids": [3] } }),
        &["node 1 'Middle': MSFT_lod: node 3 does not exist"],
    ),
    (|w| w.json["asset"]["version"] = json!("1.0"), &["asset: glTF 1.0"]),
    (|w| remove(&mut w.json, "asset"), &["missing field `asset`"]),
    (
        |w| w.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
        &["extensionsRequired: KHR_draco_mesh_compression is not read"],
    ),
];

#[test]
fn the_sound_file_is_sound() {
    let folder = folder();
    let imported = import::load(sound().write_glb(folder.path())).expect("it is well formed");
    assert_eq!(imported.report.objects, 4);
}

#[test]
fn every_fault_is_told_by_file_and_element() {
    let folder = folder();
    for (n, (spoil, wanted)) in SPOILT.iter().enumerate() {
        let mut w = sound();
        spoil(&mut w);
        let path = w.write_glb(folder.path());
        let Err(error) = import::load(&path) else { panic!("fault {n} passes: {wanted:?}") };
        let text = error.to_string();
        assert!(text.starts_with(&format!("{}: ", path.display())), "fault {n}: {text}");
        for part in *wanted {
            assert!(text.contains(part), "fault {n}: {text:?} does not say {part:?}");
        }
    }
}

#[test]
fn broken_containers_are_told() {
    let folder = folder();
    let sound = sound().glb();
    let with = |at: usize, bytes: &[u8]| {
        let mut file = sound.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let cases: [(Vec<u8>, &str); 10] = [
        (Vec::new(), "not glTF"),
        (b"solid cube".to_vec(), "not glTF"),
        (b"{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": }]}".to_vec(), "nodes[0].mesh"),
        (b"{\"asset\": {\"version\": \"2.0\"}} {}".to_vec(), "not glTF: trailing"),
        (sound[..10].to_vec(), "the GLB header is cut short"),
        (sound[..sound.len() - 8].to_vec(), "the GLB header claims"),
        (with(4, &1_u32.to_le_bytes()), "GLB version 1"),
        (with(8, &16_u32.to_le_bytes()), "the GLB chunk at byte 12"),
        (with(12, &u32::MAX.to_le_bytes()), "the GLB chunk at byte 12 claims 4294967295 bytes"),
        (with(16, b"NOSJ"), "the GLB has no JSON chunk"),
    ];
    for (bytes, wanted) in cases {
        let path = writer::put(folder.path(), "broken.glb", &bytes);
        let text = import::load(path).expect_err(wanted).to_string();
        assert!(text.contains("broken.glb: ") && text.contains(wanted), "{text:?} does not say {wanted:?}");
    }
    let gone = import::load(folder.path().join("gone.glb")).expect_err("there is no such file");
    assert!(gone.to_string().contains("gone.glb: "));
}

#[test]
fn a_glb_may_hold_chunks_of_other_kinds() {
    let folder = folder();
    let mut file = sound().glb();
    file.extend(5_u32.to_le_bytes());
    file.extend(b"XTRAhello");
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    let path = writer::put(folder.path(), "more.glb", &file);
    assert_eq!(import::load(path).expect("it is well formed").report.objects, 4);
}

/// Random bytes changed in sound files: whatever comes of it is an error or a sound scene.
#[test]
fn no_change_of_a_file_makes_it_panic() {
    let folder = folder();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut w = sound();
    sparse(&mut w, &[0, 2], 2);
    let file = w.glb();
    let mut refused = 0;
    for _ in 0..3000 {
        let mut spoilt = file.clone();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..spoilt.len());
            // A digit for a digit keeps the JSON readable, so that faults get past the parser.
            spoilt[at] = match spoilt[at] {
                b'0'..=b'9' => random.random_range(b'0'..=b'9'),
                _ => random.random(),
            };
        }
        match import::load(writer::put(folder.path(), "spoilt.glb", &spoilt)) {
            Ok(imported) => check_bounds(&imported),
            Err(_) => refused += 1,
        }
    }
    assert!((300..2900).contains(&refused), "{refused} of 3000 were refused");
}

/// Random numbers put in place of the numbers of a sound file's JSON.
#[test]
fn no_number_in_a_file_makes_it_panic() {
    let folder = folder();
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut w = sound();
    sparse(&mut w, &[0, 2], 2);
    w.json["buffers"] = json!([{ "byteLength": w.bin.len() }]);
    let mut refused = 0;
    for _ in 0..3000 {
        let mut spoilt = w.clone();
        let mut numbers = Vec::new();
        numbers_of(&mut spoilt.json, &mut numbers);
        let at = random.random_range(0..numbers.len());
        let extremes = [
            json!(0),
            json!(1),
            json!(2),
            json!(3),
            json!(-1),
            json!(255),
            json!(5121),
            json!(u32::MAX),
            json!(i64::MAX),
            json!(u64::MAX),
            json!(1e300),
            json!(-1e39),
            json!(0.5),
        ];
        *numbers.swap_remove(at) = extremes[random.random_range(0..extremes.len())].clone();
        match import::load(spoilt.write_glb(folder.path())) {
            Ok(imported) => check_bounds(&imported),
            Err(_) => refused += 1,
        }
    }
    assert!((300..2900).contains(&refused), "{refused} of 3000 were refused");
}

fn numbers_of<'a>(value: &'a mut Value, numbers: &mut Vec<&'a mut Value>) {
    match value {
        Value::Number(_) => numbers.push(value),
        Value::Array(list) => list.iter_mut().for_each(|v| numbers_of(v, numbers)),
        Value::Object(map) => map.values_mut().for_each(|v| numbers_of(v, numbers)),
        _ => {}
    }
}
