//! The node graph: a forest, walked without recursion, its transforms multiplied in f64.

use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::json::{Index, Node, Root, Scene, Value};

use super::file::{File, get};
use super::instancing;
use super::report::{ImportReport, named};

/// A node of the scene that has a mesh, once for each place it is at.
pub(super) struct Place {
    pub(super) node: usize,
    pub(super) mesh: usize,
    pub(super) world_from_mesh: DAffine3,
}

const NO_PARENT: usize = usize::MAX;

/// Everything that the scene shows: the default scene, else the first; in a file without scenes,
/// all nodes. In the order of a walk from the roots down. O(nodes).
pub(super) fn places(file: &File, report: &mut ImportReport) -> Result<Vec<Place>, String> {
    let root = &file.root;
    let parents = parents(root)?;
    let roots = roots(root, &parents, report)?;
    let stands_for = coarser_levels(root)?;
    let mut places = Vec::new();
    let mut stack: Vec<(usize, DAffine3)> = roots.iter().rev().map(|&n| (n, DAffine3::IDENTITY)).collect();
    while let Some((n, world_from_parent)) = stack.pop() {
        let node = &root.nodes[n];
        let in_node = |why: String| format!("{}: {why}", name(root, n));
        let world_from_node = world_from_parent * local(node).map_err(in_node)?;
        report.nodes += 1;
        if let Some(finer) = stands_for[n] {
            report.skip(name(root, n), format!("it is a coarser level of {}", name(root, finer)));
        } else if let Some(mesh) = node.mesh {
            get(&root.meshes, mesh, "mesh").map_err(in_node)?;
            if node.skin.is_some() {
                report.alter(name(root, n), "its skin is not applied: it stands as it was modelled");
            }
            for node_from_mesh in instancing::transforms(file, node).map_err(in_node)? {
                let world_from_mesh = world_from_node * node_from_mesh;
                places.push(Place { node: n, mesh: mesh.value(), world_from_mesh });
            }
        }
        let children = node.children.as_deref().unwrap_or_default();
        stack.extend(children.iter().rev().map(|child| (child.value(), world_from_node)));
    }
    Ok(places)
}

/// How messages call a node.
pub(super) fn name(root: &Root, node: usize) -> String {
    named("node", node, root.nodes[node].name.as_deref())
}

/// Each node's parent. A node has one at most, and is not its own ancestor.
fn parents(root: &Root) -> Result<Vec<usize>, String> {
    let mut parents = vec![NO_PARENT; root.nodes.len()];
    for (n, node) in root.nodes.iter().enumerate() {
        for &child in node.children.iter().flatten() {
            get(&root.nodes, child, "node").map_err(|why| format!("{}: child {why}", name(root, n)))?;
            let parent = &mut parents[child.value()];
            if *parent != NO_PARENT {
                let (child, first, second) = (name(root, child.value()), name(root, *parent), name(root, n));
                return Err(format!("{child} has two parents: {first} and {second}"));
            }
            *parent = n;
        }
    }
    // Whatever hangs below a node without a parent is a tree; only a ring is left over.
    let mut below: Vec<usize> = (0..parents.len()).filter(|&n| parents[n] == NO_PARENT).collect();
    let mut reached = vec![false; parents.len()];
    while let Some(n) = below.pop() {
        reached[n] = true;
        below.extend(root.nodes[n].children.iter().flatten().map(|child| child.value()));
    }
    match reached.iter().position(|&r| !r) {
        None => Ok(parents),
        Some(n) => {
            // After as many steps up as there are nodes, one stands in the ring itself.
            let in_ring = parents.iter().fold(n, |at, _| parents[at]);
            Err(format!("{} is its own ancestor", name(root, in_ring)))
        }
    }
}

/// Which node each node is a coarser level of, as `MSFT_lod` says: it is not shown beside it.
fn coarser_levels(root: &Root) -> Result<Vec<Option<usize>>, String> {
    let mut stands_for = vec![None; root.nodes.len()];
    for (n, node) in root.nodes.iter().enumerate() {
        let Some(lod) = node.extensions.as_ref().and_then(|e| e.others.get("MSFT_lod")) else { continue };
        for id in lod.get("ids").and_then(Value::as_array).into_iter().flatten() {
            let coarser = id.as_u64().and_then(|id| stands_for.get_mut(usize::try_from(id).ok()?));
            *coarser.ok_or_else(|| format!("{}: MSFT_lod: node {id} does not exist", name(root, n)))? =
                Some(n);
        }
    }
    Ok(stands_for)
}

/// The roots of the scene that is shown.
fn roots(root: &Root, parents: &[usize], report: &mut ImportReport) -> Result<Vec<usize>, String> {
    let shown = root.scene.unwrap_or(Index::new(0));
    if root.scene.is_none() && root.scenes.is_empty() {
        return Ok((0..parents.len()).filter(|&n| parents[n] == NO_PARENT).collect());
    }
    let scene = get(&root.scenes, shown, "scene").map_err(|why| format!("scene: {why}"))?;
    let scene_name = |s: usize, scene: &Scene| named("scene", s, scene.name.as_deref());
    for (s, other) in root.scenes.iter().enumerate().filter(|&(s, _)| s != shown.value()) {
        report.skip(scene_name(s, other), "the file's default scene is another");
    }
    let in_scene = |why: String| format!("{}: {why}", scene_name(shown.value(), scene));
    let mut listed = vec![false; parents.len()];
    for &node in &scene.nodes {
        get(&root.nodes, node, "node").map_err(in_scene)?;
        let n = node.value();
        if parents[n] != NO_PARENT {
            let (child, parent) = (name(root, n), name(root, parents[n]));
            return Err(in_scene(format!("{child} is listed as a root, and is a child of {parent}")));
        }
        if std::mem::replace(&mut listed[n], true) {
            return Err(in_scene(format!("{} is listed twice", name(root, n))));
        }
    }
    Ok(scene.nodes.iter().map(|n| n.value()).collect())
}

/// A node's own transform. A matrix counts before translation, rotation and scale.
fn local(node: &Node) -> Result<DAffine3, String> {
    /// How far the last row may be off: exporters that invert matrices leave dust there.
    const DUST: f64 = 1e-4;
    if let Some(columns) = node.matrix {
        let matrix = DMat4::from_cols_array(&columns.map(f64::from));
        let row = matrix.row(3);
        return match (row - glam::DVec4::W).abs().max_element() <= DUST {
            true => Ok(DAffine3::from_mat4(matrix)),
            false => Err(format!("the last row of its matrix is {row}, not that of an affine transform")),
        };
    }
    let translation = node.translation.map_or(DVec3::ZERO, wide);
    let scale = node.scale.map_or(DVec3::ONE, wide);
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| rotation(q.0));
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}

/// A rotation from a quaternion of any length but 0, which turns nothing.
pub(super) fn rotation(q: [f32; 4]) -> DQuat {
    let q = DQuat::from_array(q.map(f64::from));
    if q.length_squared() > 0.0 { q.normalize() } else { DQuat::IDENTITY }
}

pub(super) fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}
