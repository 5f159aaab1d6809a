//! Meshes from glTF 2.0 files.

use std::path::Path;

use glam::Vec3;

use super::mesh::{Level, Mesh};
use crate::Error;

/// Reads the first mesh of a file, with the levels of detail that follow it.
///
/// # Errors
/// [`Error::File`], naming the file and the element.
pub fn load_mesh(path: impl AsRef<Path>) -> Result<Mesh, Error> {
    let path = path.as_ref();
    let fail = |why: String| Error::File { path: path.display().to_string(), why };
    let (document, buffers, _) = gltf::import(path).map_err(|e| fail(e.to_string()))?;
    let mesh = document.meshes().next().ok_or_else(|| fail("holds no mesh".into()))?;
    let primitive = mesh.primitives().next().ok_or_else(|| fail("mesh 0 has no primitive".into()))?;
    let reader = primitive.reader(|b| buffers.get(b.index()).map(|d| &d.0[..]));
    let positions = reader
        .read_positions()
        .ok_or_else(|| fail("mesh 0 has no positions".into()))?
        .map(Vec3::from)
        .collect();
    let indices =
        reader.read_indices().ok_or_else(|| fail("mesh 0 has no indices".into()))?.into_u32().collect();
    Mesh::with_levels(mesh.name().unwrap_or("bunny"), vec![Level { positions, indices, error: 0.0 }])
        .map_err(|e| fail(e.to_string()))
}
