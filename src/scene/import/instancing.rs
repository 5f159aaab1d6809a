//! `EXT_mesh_gpu_instancing`: one node, many places.

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::{Index, Node, Value};

use super::accessor::{Elements, Wanted};
use super::file::File;
use super::nodes::{rotation, wide};

const VECTORS: Wanted =
    Wanted { what: "an instance's vectors", shape: Type::Vec3, components: &[ComponentType::F32] };

const ROTATIONS: Wanted = Wanted {
    what: "an instance's rotations",
    shape: Type::Vec4,
    components: &[ComponentType::F32, ComponentType::I8, ComponentType::I16],
};

/// Where a node's mesh is, relative to the node: in one place, unless the extension lists more.
pub(super) fn transforms(file: &File, node: &Node) -> Result<Vec<DAffine3>, String> {
    let Some(extension) = node.extensions.as_ref().and_then(|e| e.others.get("EXT_mesh_gpu_instancing"))
    else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    read(file, extension).map_err(|why| format!("EXT_mesh_gpu_instancing: {why}"))
}

fn read(file: &File, extension: &Value) -> Result<Vec<DAffine3>, String> {
    let translations = attribute(file, extension, "TRANSLATION", &VECTORS)?;
    let rotations = attribute(file, extension, "ROTATION", &ROTATIONS)?;
    let scales = attribute(file, extension, "SCALE", &VECTORS)?;
    let given = [&translations, &rotations, &scales].map(|e| e.as_ref().map(Elements::count));
    let count = given.into_iter().flatten().next().ok_or("it has no attribute that places anything")?;
    if given.into_iter().flatten().any(|other| other != count) {
        return Err("its attributes are not of one length".into());
    }
    let place = |i: usize| {
        let vector = |e: &Option<Elements<'_>>, neutral| {
            e.as_ref().and_then(|e| e.floats(i..=i).next()).map_or(neutral, wide)
        };
        let turn = rotations.as_ref().and_then(|e| e.floats(i..=i).next()).map_or(DQuat::IDENTITY, rotation);
        let (scale, translation) = (vector(&scales, DVec3::ONE), vector(&translations, DVec3::ZERO));
        DAffine3::from_scale_rotation_translation(scale, turn, translation)
    };
    Ok((0..count).map(place).collect())
}

fn attribute<'a>(
    file: &'a File,
    extension: &Value,
    name: &str,
    wanted: &Wanted,
) -> Result<Option<Elements<'a>>, String> {
    let Some(accessor) = extension.get("attributes").and_then(|a| a.get(name)) else { return Ok(None) };
    let number = accessor.as_u64().and_then(|a| u32::try_from(a).ok());
    let number = number.ok_or_else(|| format!("{name} is {accessor}, not an accessor's number"))?;
    Elements::new(file, Index::new(number), wanted).map(Some).map_err(|why| format!("{name}: {why}"))
}
