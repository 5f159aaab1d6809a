//! From a primitive to a mesh: topology to triangles, and just the vertices that they use.

use glam::Vec3;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index};

use super::accessor::{Elements, INDICES, POSITIONS};
use super::file::File;
use crate::scene::mesh::Mesh;

/// What a primitive's triangles are read from. Primitives of one shape share one [`Mesh`], even
/// if they belong to different meshes of the file, with different materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Shape {
    /// Numbers of accessors.
    positions: u32,
    indices: Option<u32>,
    topology: Topology,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Topology {
    List,
    Strip,
    Fan,
}

/// Why a primitive, though well formed, gives no mesh.
pub(super) type Reason = String;

/// The shape of a primitive. Points, lines and primitives without positions have none.
pub(super) fn shape(primitive: &Primitive) -> Result<Result<Shape, Reason>, String> {
    let topology = match primitive.mode {
        Checked::Valid(Mode::Triangles) => Topology::List,
        Checked::Valid(Mode::TriangleStrip) => Topology::Strip,
        Checked::Valid(Mode::TriangleFan) => Topology::Fan,
        Checked::Valid(Mode::Points) => return Ok(Err("it is made of points".into())),
        Checked::Valid(Mode::Lines | Mode::LineLoop | Mode::LineStrip) => {
            return Ok(Err("it is made of lines".into()));
        }
        Checked::Invalid => return Err("its mode is none that glTF knows (0 to 6)".into()),
    };
    let Some(positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
        return Ok(Err("it has no positions".into()));
    };
    let number = |accessor: Index<Accessor>| accessor.value() as u32;
    Ok(Ok(Shape { positions: number(*positions), indices: primitive.indices.map(number), topology }))
}

/// Reads a shape. O(indices · log indices) at worst, and memory for what is used only: any number
/// of primitives may share one large accessor.
pub(super) fn read(file: &File, shape: Shape, name: &str) -> Result<Result<Mesh, Reason>, String> {
    let positions = Elements::new(file, Index::new(shape.positions), &POSITIONS)?;
    let indices = match shape.indices {
        Some(accessor) => {
            let elements = Elements::new(file, Index::new(accessor), &INDICES)?;
            if !elements.has_data() {
                return Ok(Err(format!("its indices, accessor {accessor}, have no data")));
            }
            let indices = elements.integers();
            if let Some(i) = indices.iter().position(|&v| v as usize >= positions.count()) {
                let (vertex, count) = (indices[i], positions.count());
                return Err(format!("accessor {accessor}: index {i} is {vertex}, of {count} vertices"));
            }
            indices
        }
        None if positions.has_data() => (0..positions.count() as u32).collect(),
        None => Vec::new(),
    };
    if !positions.has_data() {
        return Ok(Err(format!("its positions, accessor {}, have no data", shape.positions)));
    }
    let mut triangles = triangles(indices, shape.topology)?;
    if triangles.is_empty() {
        return Ok(Err("it has no triangle".into()));
    }
    let positions = gather(&positions, &mut triangles)
        .map_err(|i| format!("accessor {}: position {i} is not finite", shape.positions))?;
    Mesh::new(name, positions, triangles).map(Ok).map_err(|e| e.to_string())
}

/// Three indices a triangle.
fn triangles(indices: Vec<u32>, topology: Topology) -> Result<Vec<u32>, String> {
    // Strips are joined by triangles of no area, which nothing is gained by keeping.
    let flat = |t: &[u32; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    match topology {
        Topology::List if !indices.len().is_multiple_of(3) => {
            Err(format!("{} vertices are not whole triangles", indices.len()))
        }
        Topology::List => Ok(indices),
        Topology::Strip => {
            let turned =
                |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            Ok(indices.windows(3).enumerate().map(turned).filter(|t| !flat(t)).flatten().collect())
        }
        Topology::Fan => {
            let from = |pair: &[u32]| [pair[0], pair[1], indices[0]];
            Ok(indices.windows(2).skip(1).map(from).filter(|t| !flat(t)).flatten().collect())
        }
    }
}

/// The positions that some triangles use, in the file's order; the indices are changed to suit.
/// On failure, the number of a position that is not finite.
fn gather(elements: &Elements<'_>, indices: &mut [u32]) -> Result<Vec<Vec3>, u32> {
    let used = used(indices);
    let (Some(&least), Some(&most)) = (used.first(), used.last()) else { return Ok(Vec::new()) };
    let without_gaps = used.len() == (most - least) as usize + 1;
    for i in indices {
        *i = if without_gaps { *i - least } else { used.partition_point(|u| u < i) as u32 };
    }
    let positions = elements.floats(used.iter().map(|&v| v as usize));
    let positions: Vec<Vec3> = positions.map(Vec3::from_array).collect();
    match positions.iter().position(|p| !p.is_finite()) {
        Some(k) => Err(used[k]),
        None => Ok(positions),
    }
}

/// Each index that occurs, once, ascending.
fn used(indices: &[u32]) -> Vec<u32> {
    let least = indices.iter().copied().min().unwrap_or(0);
    let most = indices.iter().copied().max().unwrap_or(0);
    let span = (most - least) as usize + 1;
    if span <= indices.len() {
        let mut occurs = vec![false; span];
        indices.iter().for_each(|&i| occurs[(i - least) as usize] = true);
        return (least..=most).filter(|&i| occurs[(i - least) as usize]).collect();
    }
    // A few vertices picked out of a large array: a table of it would cost every such primitive.
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    used
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_alternates_its_winding_and_drops_its_joints() {
        let strip = triangles(vec![0, 1, 2, 3, 3, 4, 4, 5, 6], Topology::Strip);
        assert_eq!(strip, Ok(vec![0, 1, 2, 2, 1, 3, 4, 5, 6]));
    }

    #[test]
    fn a_fan_turns_about_its_first_vertex() {
        assert_eq!(triangles(vec![7, 1, 2, 3], Topology::Fan), Ok(vec![1, 2, 7, 2, 3, 7]));
        assert_eq!(triangles(vec![7, 1], Topology::Fan), Ok(vec![]));
    }

    #[test]
    fn used_indices_are_found_with_and_without_a_table() {
        assert_eq!(used(&[5, 7, 5, 6, 9, 5, 9]), [5, 6, 7, 9]);
        assert_eq!(used(&[4_000_000_000, 3, 3]), [3, 4_000_000_000]);
    }
}
