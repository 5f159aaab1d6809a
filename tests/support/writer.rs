//! Writes glTF files: a JSON tree that tests fill in, and spoil, as they like.

use std::fs;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

pub(crate) const U8: u32 = 5121;
pub(crate) const U16: u32 = 5123;
pub(crate) const U32: u32 = 5125;
pub(crate) const F32: u32 = 5126;

/// A file with one scene and one buffer.
#[derive(Clone)]
pub(crate) struct Writer {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

impl Writer {
    pub(crate) fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [] }],
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// Appends to one of the root's arrays; returns the number of the new element.
    pub(crate) fn push(&mut self, list: &str, element: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list of the root");
        list.push(element);
        list.len() - 1
    }

    /// Adds bytes to the buffer, aligned to four, and a view of them.
    pub(crate) fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let start = self.bin.len();
        self.bin.extend(bytes);
        let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bin.len() - start });
        self.push("bufferViews", view)
    }

    pub(crate) fn accessor(&mut self, view: usize, component: u32, shape: &str, count: usize) -> usize {
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": shape, "count": count });
        self.push("accessors", accessor)
    }

    /// An accessor of positions. Its stated box is wrong on purpose: nobody may believe it.
    pub(crate) fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let view = self.view(positions.iter().flatten().flat_map(|c| c.to_le_bytes()));
        let accessor = self.accessor(view, F32, "VEC3", positions.len());
        self.json["accessors"][accessor]["min"] = json!([7.0, 7.0, 7.0]);
        self.json["accessors"][accessor]["max"] = json!([7.5, 7.5, 7.5]);
        accessor
    }

    /// An accessor of indices, each in 1, 2 or 4 bytes, as the component type says.
    pub(crate) fn indices(&mut self, component: u32, indices: &[u32]) -> usize {
        let bytes = match component {
            U8 => 1,
            U16 => 2,
            _ => 4,
        };
        let view = self.view(indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(bytes)));
        self.accessor(view, component, "SCALAR", indices.len())
    }

    pub(crate) fn material(&mut self, color: [f32; 4], alpha_mode: &str) -> usize {
        let pbr = json!({ "baseColorFactor": color });
        self.push("materials", json!({ "pbrMetallicRoughness": pbr, "alphaMode": alpha_mode }))
    }

    pub(crate) fn mesh(&mut self, name: &str, primitives: Value) -> usize {
        self.push("meshes", json!({ "name": name, "primitives": primitives }))
    }

    /// A mesh of one primitive: a list of triangles with 16-bit indices.
    pub(crate) fn simple_mesh(&mut self, name: &str, positions: &[[f32; 3]], indices: &[u32]) -> usize {
        let (positions, indices) = (self.positions(positions), self.indices(U16, indices));
        self.mesh(name, json!([{ "attributes": { "POSITION": positions }, "indices": indices }]))
    }

    /// A node at the top of the scene.
    pub(crate) fn root(&mut self, node: Value) -> usize {
        let node = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().expect("a scene").push(node.into());
        node
    }

    /// A node below another.
    pub(crate) fn child(&mut self, parent: usize, node: Value) -> usize {
        let node = self.push("nodes", node);
        let parent = &mut self.json["nodes"][parent];
        match parent.get_mut("children").and_then(Value::as_array_mut) {
            Some(children) => children.push(node.into()),
            None => parent["children"] = json!([node]),
        }
        node
    }

    /// The file as a GLB.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let json = self.finished(None).to_string();
        glb(json.as_bytes(), Some(&self.bin))
    }

    pub(crate) fn write_glb(&self, folder: &Path) -> PathBuf {
        put(folder, "scene.glb", &self.glb())
    }

    /// JSON with the buffer in a data URI.
    pub(crate) fn write_embedded(&self, folder: &Path) -> PathBuf {
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&self.bin));
        put(folder, "embedded.gltf", self.finished(Some(uri)).to_string().as_bytes())
    }

    /// JSON with the buffer in a file beside it, whose name needs escaping.
    pub(crate) fn write_beside(&self, folder: &Path) -> PathBuf {
        put(folder, "the buffer.bin", &self.bin);
        put(folder, "beside.gltf", self.finished(Some("the%20buffer.bin".into())).to_string().as_bytes())
    }

    fn finished(&self, uri: Option<String>) -> Value {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
            if let Some(uri) = uri {
                json["buffers"][0]["uri"] = uri.into();
            }
        }
        json
    }
}

/// A GLB of two chunks, each padded to four bytes.
pub(crate) fn glb(json: &[u8], bin: Option<&[u8]>) -> Vec<u8> {
    let mut file = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    let chunks = [(b"JSON", Some(json), b' '), (b"BIN\0", bin, 0)];
    for (kind, data, padding) in chunks {
        let Some(data) = data else { continue };
        let size = data.len().next_multiple_of(4);
        file.extend((size as u32).to_le_bytes());
        file.extend(kind);
        file.extend(data);
        file.resize(file.len() + size - data.len(), padding);
    }
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    file
}

pub(crate) fn put(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).expect("the temporary folder takes files");
    path
}
