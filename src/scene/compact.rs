//! Levels of detail that share one array of vertices are stored by their indices alone; in
//! memory each gets just the vertices it uses, in the order of first use.

use glam::Vec3;

use super::mesh::Level;

/// The level that `indices` cut out of shared `positions`. An index without a vertex is kept as
/// one beyond the end, for [`Mesh::with_levels`](super::mesh::Mesh::with_levels) to refuse.
/// O(vertices + indices).
pub(super) fn compact(positions: &[Vec3], indices: &[u32], error: f32) -> Level {
    const UNUSED: u32 = u32::MAX;
    let mut new_index = vec![UNUSED; positions.len()];
    let mut used = Vec::new();
    let mut place = |&old: &u32| {
        let Some(new) = new_index.get_mut(old as usize) else { return UNUSED };
        if *new == UNUSED {
            *new = used.len() as u32;
            used.push(positions[old as usize]);
        }
        *new
    };
    let indices = indices.iter().map(&mut place).collect();
    Level { positions: used, indices, error }
}
