//! Bytes as a glTF file: it is read, or refused with words.

use std::io::Write;

use tercet::scene::{gltf, import};

/// Reads the bytes as a file. If they begin with `J`, they are a GLB's JSON up to the first zero
/// and its binary chunk from there: so a mutation need not get the GLB's lengths right.
pub fn run(bytes: &[u8]) {
    let glb;
    let bytes = match bytes.split_first() {
        Some((b'J', rest)) => {
            glb = wrapped(rest);
            &glb
        }
        _ => bytes,
    };
    let mut file = tempfile::Builder::new().suffix(".glb").tempfile().expect("a temporary file");
    file.write_all(bytes).expect("it can be written");
    if let Ok(imported) = import::load(file.path()) {
        check(&imported);
    }
    if let Ok(mesh) = gltf::load_mesh(file.path()) {
        assert!(mesh.bounds().is_valid());
    }
}

/// Whatever is drawn lies in its box, and every index names a corner.
fn check(imported: &import::Imported) {
    let model = &imported.model;
    for mesh in &model.meshes {
        for level in mesh.levels() {
            assert!(level.indices.iter().all(|&i| (i as usize) < level.positions.len()));
            assert!(level.positions.iter().all(|&p| mesh.bounds().contains_point(p)));
        }
    }
    // A small file can name very many objects: some of each kind will do.
    for object in model.objects.iter().step_by(1 + model.objects.len() / 1000) {
        assert!(object.world_from_object.is_finite());
        let corners = model.meshes[object.mesh].levels().iter().flat_map(|level| &level.positions);
        for &p in corners.take(1000) {
            let drawn = object.world_from_object.transform_point3(p);
            // What overflows on the way is no place on any screen.
            let held = !object.bounds.is_valid() || !drawn.is_finite() || object.bounds.contains_point(drawn);
            assert!(held, "{drawn} is not in {:?}", object.bounds);
        }
    }
}

fn wrapped(rest: &[u8]) -> Vec<u8> {
    let split = rest.iter().position(|&b| b == 0).unwrap_or(rest.len());
    let (json, bin) = rest.split_at(split);
    let (json, bin) = (padded(json, b' '), padded(bin.get(1..).unwrap_or_default(), 0));
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut glb = Vec::with_capacity(28 + json.len() + bin.len());
    glb.extend_from_slice(b"glTF\x02\0\0\0");
    glb.extend_from_slice(&word(28 + json.len() + bin.len()));
    for (chunk, kind) in [(json, b"JSON"), (bin, b"BIN\0")] {
        glb.extend_from_slice(&word(chunk.len()));
        glb.extend_from_slice(kind);
        glb.extend_from_slice(&chunk);
    }
    glb
}

fn padded(bytes: &[u8], with: u8) -> Vec<u8> {
    let mut padded = bytes.to_vec();
    padded.resize(bytes.len().next_multiple_of(4), with);
    padded
}
