//! Meshes from glTF 2.0 files.
//!
//! # Levels of detail
//!
//! A node lists coarser stand-ins for itself, finest first, in the extension
//! [`MSFT_lod`](https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/MSFT_lod).
//! The extension has no place for the one number that this engine chooses levels by, so each
//! coarser mesh says in its `extras` how far it lies from the finest, in metres of object space:
//! `"extras": { "error": 0.0012 }`. A level that does not say so is left out. Viewers that do
//! not know the extension show the finest level.

use std::path::Path;

use glam::Vec3;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use gltf::json::{Value, deserialize};
use gltf::mesh::{Mode, Semantic};

use super::compact::compact;
use super::import::read_uri;
use super::mesh::{Level, Mesh};
use crate::Error;

/// Reads the mesh of the first node that has one and is not itself a level of another, with its levels of detail (see the
/// [module's documentation](self)). The node's own transform is not applied: the mesh is in object
/// space. All triangle primitives of the mesh are joined; their materials are not read.
///
/// # Errors
/// [`Error::File`], naming the file and the element: when it cannot be read or is not glTF, when
/// no node has a mesh, when a primitive is not a triangle list or has no positions, or when an
/// accessor reaches beyond its buffer.
pub fn load_mesh(path: impl AsRef<Path>) -> Result<Mesh, Error> {
    let path = path.as_ref();
    read_mesh(path).map_err(|why| Error::File { path: path.display().to_string(), why })
}

fn read_mesh(path: &Path) -> Result<Mesh, String> {
    // Images are not asked for, and so neither found missing nor decoded.
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    check_header(&bytes)?;
    let unchecked = gltf::Gltf::from_slice_without_validation(&bytes).map_err(|e| e.to_string())?;
    check_accessors(unchecked.document.as_json())?;
    let file = gltf::Gltf::from_slice(&bytes).map_err(|e| e.to_string())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let buffers = read_buffers(&file.document, folder, file.blob)?;
    let mut stand_ins = Vec::new();
    for node in file.document.nodes() {
        stand_ins.extend(coarser_nodes(&node)?);
    }
    let own = |n: &gltf::Node<'_>| n.mesh().is_some() && !stand_ins.contains(&n.index());
    let node = file.document.nodes().find(own).ok_or("no node has a mesh")?;
    let finest = node.mesh().ok_or("no node has a mesh")?;
    let mut levels = vec![read_level(&finest, 0.0, &buffers)?];
    for coarser in coarser_nodes(&node)? {
        let lod = file.document.nodes().nth(coarser).ok_or(format!("MSFT_lod names node {coarser}: none"))?;
        let mesh = lod.mesh().ok_or(format!("node {coarser}, a level of detail, has no mesh"))?;
        if let Some(error) = stated_error(&mesh)? {
            levels.push(read_level(&mesh, error, &buffers)?);
        }
    }
    let name = finest.name().map_or_else(|| format!("mesh {}", finest.index()), str::to_owned);
    Mesh::with_levels(name, levels).map_err(|e| e.to_string())
}

/// Whether a binary file says that it is as long as its header, at least: gltf subtracts the one from the other.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    const HEADER: usize = 12;
    match bytes.get(8..HEADER) {
        Some(&[a, b, c, d]) if bytes.starts_with(b"glTF") => {
            let length = u32::from_le_bytes([a, b, c, d]) as usize;
            if length >= HEADER { Ok(()) } else { Err(format!("its header says that it has {length} bytes")) }
        }
        _ => Ok(()),
    }
}

/// Whether every primitive's attributes exist: gltf's own validation panics where they do not.
fn check_accessors(root: &gltf::json::Root) -> Result<(), String> {
    let count = root.accessors.len();
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    match primitives.flat_map(|p| p.attributes.values()).find(|index| index.value() >= count) {
        None => Ok(()),
        Some(index) => Err(format!("accessor {} does not exist: the file has {count}", index.value())),
    }
}

/// The bytes of every buffer: the file's binary chunk, data URIs, files beside it.
fn read_buffers(
    document: &gltf::Document,
    folder: &Path,
    mut chunk: Option<Vec<u8>>,
) -> Result<Vec<Vec<u8>>, String> {
    let read = |buffer: gltf::Buffer<'_>| {
        let in_buffer = |why: String| format!("buffer {}: {why}", buffer.index());
        let bytes = match buffer.source() {
            Source::Bin => chunk.take().ok_or_else(|| "there is no binary chunk for it".to_owned()),
            Source::Uri(uri) => read_uri(folder, uri),
        };
        let bytes = bytes.map_err(in_buffer)?;
        if bytes.len() >= buffer.length() {
            Ok(bytes)
        } else {
            Err(in_buffer(format!("it has {} bytes of the {} that it claims", bytes.len(), buffer.length())))
        }
    };
    document.buffers().map(read).collect()
}

/// The nodes that stand in for a node, finest first.
fn coarser_nodes(node: &gltf::Node<'_>) -> Result<Vec<usize>, String> {
    let Some(lod) = node.extension_value("MSFT_lod") else { return Ok(Vec::new()) };
    let bad = || format!("node {}: MSFT_lod needs ids, a list of node numbers", node.index());
    let ids = lod.get("ids").and_then(Value::as_array).ok_or_else(bad)?;
    ids.iter().map(|id| id.as_u64().and_then(|n| usize::try_from(n).ok()).ok_or_else(bad)).collect()
}

/// The error that a coarser mesh states, in metres.
fn stated_error(mesh: &gltf::Mesh<'_>) -> Result<Option<f32>, String> {
    let Some(extras) = mesh.extras() else { return Ok(None) };
    let bad = |why: String| format!("mesh {}: extras {why}", mesh.index());
    let extras: Value = deserialize::from_str(extras.get()).map_err(|e| bad(e.to_string()))?;
    let Some(error) = extras.get("error") else { return Ok(None) };
    match error.as_f64() {
        Some(metres) if metres.is_finite() && metres >= 0.0 => Ok(Some(metres as f32)),
        _ => Err(bad(format!("error is {error}, not a distance in metres"))),
    }
}

fn read_level(mesh: &gltf::Mesh<'_>, error: f32, buffers: &[Vec<u8>]) -> Result<Level, String> {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for primitive in mesh.primitives() {
        let bad = |why: &str| format!("mesh {}, primitive {}: {why}", mesh.index(), primitive.index());
        if primitive.mode() != Mode::Triangles {
            return Err(bad("is not a list of triangles"));
        }
        // gltf's readers take for granted what the bytes are.
        let positions_fit = |accessor: gltf::Accessor<'_>| {
            (accessor.data_type(), accessor.dimensions()) == (DataType::F32, Dimensions::Vec3)
        };
        if !primitive.get(&Semantic::Positions).is_some_and(positions_fit) {
            return Err(bad("has no positions of three floats"));
        }
        let indices_fit = |accessor: gltf::Accessor<'_>| {
            let whole = [DataType::U8, DataType::U16, DataType::U32].contains(&accessor.data_type());
            whole && accessor.dimensions() == Dimensions::Scalar
        };
        if !primitive.indices().is_none_or(indices_fit) {
            return Err(bad("has indices that are no whole numbers"));
        }
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let first = positions.len() as u32;
        let read = reader.read_positions().ok_or_else(|| bad("has no positions that can be read"))?;
        positions.extend(read.map(Vec3::from));
        match reader.read_indices() {
            Some(read) => indices.extend(read.into_u32().map(|i| first.saturating_add(i))),
            None if primitive.indices().is_some() => return Err(bad("has indices that cannot be read")),
            None => indices.extend(first..positions.len() as u32),
        }
    }
    Ok(compact(&positions, &indices, error))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// A file of one triangle whose header `edit` changes before it is written.
    fn file(name: &str, edit: impl Fn(String) -> String) -> PathBuf {
        // Three corners of nine floats, and the indices 0 1 2 as bytes, padded.
        let bytes = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA==";
        let header = format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [{{ "mesh": 0, "extensions": {{ "MSFT_lod": {{ "ids": [1, 2] }} }} }},
               {{ "mesh": 1 }}, {{ "mesh": 2 }}],
               "extensionsUsed": ["MSFT_lod"],
               "meshes": [{{ "name": "tri", "primitives": [{{ "attributes": {{ "POSITION": 0 }}, "indices": 1 }}] }},
                 {{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}], "extras": {{ "error": 0.25 }} }},
                 {{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}],
               "accessors": [{{ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0] }},
                 {{ "bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 3 }}],
               "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}, {{ "buffer": 0, "byteOffset": 36, "byteLength": 4 }}],
               "buffers": [{{ "byteLength": 40, "uri": "data:application/octet-stream;base64,{bytes}" }}] }}"#
        );
        let path = std::env::temp_dir().join(format!("tercet-{}-{name}.gltf", std::process::id()));
        std::fs::write(&path, edit(header)).unwrap();
        path
    }

    /// What goes wrong with a file in which `from` was replaced by `to`.
    fn message(name: &str, from: &str, to: &str) -> String {
        let path = file(name, |header| {
            assert!(header.contains(from), "the header has no {from}");
            header.replace(from, to)
        });
        let result = load_mesh(&path);
        std::fs::remove_file(&path).unwrap();
        let message = result.unwrap_err().to_string();
        assert!(message.contains(name), "{message} does not name the file");
        message
    }

    #[test]
    fn reads_levels_that_state_their_error_and_leaves_out_the_others() {
        let path = file("good", |header| header);
        let mesh = load_mesh(&path).unwrap();
        std::fs::remove_file(path).unwrap();
        assert_eq!((mesh.name(), mesh.levels().len()), ("tri", 2));
        assert_eq!(mesh.levels().iter().map(|l| l.error).collect::<Vec<_>>(), [0.0, 0.25]);
        assert_eq!(mesh.levels()[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(mesh.levels()[1].indices, [0, 1, 2]);
    }

    #[test]
    fn a_binary_file_shorter_than_its_header_is_refused() {
        let short = b"glTF\x02\0\0\0\x0b\0\0\0";
        assert!(check_header(short).is_err_and(|why| why.contains("11 bytes")));
        assert!(check_header(b"glTF\x02\0\0\0\x0c\0\0\0").is_ok() && check_header(b"{}").is_ok());
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        let missing = load_mesh("no/such/file.glb").unwrap_err().to_string();
        assert!(missing.contains("no/such/file.glb"), "{missing}");
        for (name, from, to, expected) in [
            (
                "points",
                r#""indices": 1 }"#,
                r#""indices": 1, "mode": 0 }"#,
                "mesh 0, primitive 0: is not a list",
            ),
            ("accessor", r#""POSITION": 0 }, "indices""#, r#""POSITION": 2 }, "indices""#, "accessor 2"),
            ("lod-ids", r#"[1, 2]"#, r#"["a"]"#, "node 0: MSFT_lod"),
            ("lod-range", r#"[1, 2]"#, r#"[7]"#, "node 7"),
            ("error", "0.25", r#""far""#, "mesh 1: extras error"),
            ("negative", "0.25", "-0.25", "mesh 1: extras error"),
            ("no-node", r#""nodes""#, r#""knots""#, "no node has a mesh"),
            (
                "short",
                r#""type": "VEC3", "count": 3"#,
                r#""type": "VEC3", "count": 300"#,
                "mesh 0, primitive 0",
            ),
            ("index", "AAECAA==", "AAEJAA==", "index 2"),
            (
                "short-buffer",
                r#""byteLength": 40"#,
                r#""byteLength": 400"#,
                "buffer 0: it has 40 bytes of the 400",
            ),
            ("no-chunk", r#""uri""#, r#""url""#, "buffer 0: there is no binary chunk"),
            ("short-positions", "5126", "5123", "no positions of three floats"),
            ("flat-positions", r#""VEC3""#, r#""VEC2""#, "no positions of three floats"),
            ("float-indices", "5121", "5126", "no whole numbers"),
            ("index-pairs", r#""SCALAR""#, r#""VEC2""#, "no whole numbers"),
        ] {
            let message = message(name, from, to);
            assert!(message.contains(expected), "{name}: {message}");
        }
    }
}
