//! Adds levels of detail to a mesh: reads a glTF file, writes a `.glb` that holds the same mesh
//! as level 0 and coarser ones after it, in the form that `tercet::scene::gltf` reads back.
//!
//! `cargo run --release --features lod --example bake_levels -- assets/bunny.glb assets/bunny.glb`
//!
//! All levels share one array of positions: a level costs its indices, two bytes each.

use std::path::PathBuf;

use clap::Parser;
use serde_json::{Value, json};
use tercet::scene::gltf::load_mesh;
use tercet::scene::lod::generate;
use tercet::scene::mesh::Level;

/// Adds levels of detail to a mesh.
#[derive(Parser)]
struct Arguments {
    /// The glTF file to read; levels that it already has are made anew
    input: PathBuf,
    /// The .glb file to write
    output: PathBuf,
    /// The mesh's name; as in the input when not given
    #[arg(long)]
    name: Option<String>,
    /// Stop before a level would have fewer triangles than this
    #[arg(long, default_value_t = 100)]
    least: usize,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let mesh = load_mesh(&arguments.input)?;
    let finest = &mesh.levels()[0];
    let name = arguments.name.as_deref().unwrap_or(mesh.name());
    let coarser = generate(&finest.positions, &finest.indices, arguments.least)?;
    let mut levels = vec![(finest.indices.as_slice(), 0.0)];
    levels.extend(coarser.iter().map(|c| (c.indices.as_slice(), c.error)));
    for (number, (indices, error)) in levels.iter().enumerate() {
        println!("level {number}: {:6} triangles, error {error:.3e} m", indices.len() / 3);
    }
    let bytes = glb(name, finest, &levels)?;
    std::fs::write(&arguments.output, &bytes)?;
    println!("{}: {} bytes", arguments.output.display(), bytes.len());
    Ok(())
}

/// The file: a header, a JSON chunk, a chunk of positions and then each level's indices.
fn glb(name: &str, finest: &Level, levels: &[(&[u32], f32)]) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let short = finest.positions.len() <= usize::from(u16::MAX);
    let mut binary: Vec<u8> =
        finest.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let bounds = tercet::geom::Aabb::from_points(finest.positions.iter().copied());
    views.push(json!({ "buffer": 0, "byteOffset": 0, "byteLength": binary.len(), "target": 34962 }));
    accessors.push(json!({
        "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": finest.positions.len(),
        "min": bounds.min.to_array(), "max": bounds.max.to_array(),
    }));
    for (indices, _) in levels {
        let start = binary.len();
        for &index in *indices {
            if short {
                binary.extend((index as u16).to_le_bytes());
            } else {
                binary.extend(index.to_le_bytes());
            }
        }
        let component = if short { 5123 } else { 5125 };
        let length = binary.len() - start;
        accessors.push(json!({
            "bufferView": views.len(), "componentType": component, "type": "SCALAR", "count": indices.len(),
        }));
        views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": length, "target": 34963 }));
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let mut document = header(name, levels);
    document["buffers"] = json!([{ "byteLength": binary.len() }]);
    document["bufferViews"] = Value::Array(views);
    document["accessors"] = Value::Array(accessors);
    let mut text = serde_json::to_vec(&document)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = u32::try_from(12 + 8 + text.len() + 8 + binary.len())?;
    let mut file = Vec::with_capacity(total as usize);
    for word in [0x4654_6C67, 2, total, text.len() as u32, 0x4E4F_534A] {
        file.extend(word.to_le_bytes());
    }
    file.extend(text);
    for word in [binary.len() as u32, 0x004E_4942] {
        file.extend(word.to_le_bytes());
    }
    file.extend(binary);
    Ok(file)
}

/// One node and one mesh a level. Only node 0 is in the scene; it names the others.
fn header(name: &str, levels: &[(&[u32], f32)]) -> Value {
    let mesh = |(level, (_, error)): (usize, &(&[u32], f32))| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": level + 1, "mode": 4 });
        if level == 0 {
            json!({ "name": name, "primitives": [primitive] })
        } else {
            let name = format!("{name}.lod{level}");
            json!({ "name": name, "primitives": [primitive], "extras": { "error": error } })
        }
    };
    let mut nodes: Vec<Value> = (0..levels.len()).map(|level| json!({ "mesh": level })).collect();
    nodes[0]["name"] = json!(name);
    nodes[0]["extensions"] = json!({ "MSFT_lod": { "ids": (1..levels.len()).collect::<Vec<_>>() } });
    json!({
        "asset": { "version": "2.0", "generator": "tercet bake_levels" },
        "extensionsUsed": ["MSFT_lod"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes,
        "meshes": levels.iter().enumerate().map(mesh).collect::<Vec<_>>(),
    })
}
