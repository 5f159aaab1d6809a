//! Levels of detail for meshes that come without (feature `lod`).

use std::collections::HashMap;

use glam::Vec3;
use rayon::prelude::*;

use super::Imported;
use crate::Error;
use crate::scene::lod;
use crate::scene::mesh::{Level, Mesh};

impl Imported {
    /// Gives every mesh coarser levels, each of about half the triangles of the one before, down
    /// to `least`; level 0 stays as it is. Meshes are worked on in parallel. Bounds do not change:
    /// a coarser level is made of some of its mesh's vertices.
    ///
    /// See [`lod::generate`] for how it is done and what it costs.
    ///
    /// # Errors
    /// [`Error::Mesh`], naming the mesh.
    pub fn generate_levels(&mut self, least: usize) -> Result<(), Error> {
        let with_levels = |mesh: &Mesh| with_levels(mesh, least);
        self.model.meshes = self.model.meshes.par_iter().map(with_levels).collect::<Result<_, _>>()?;
        Ok(())
    }
}

fn with_levels(mesh: &Mesh, least: usize) -> Result<Mesh, Error> {
    let finest = &mesh.levels()[0];
    let (positions, indices) = welded(finest);
    let coarser = lod::generate(&positions, &indices, least)?;
    let coarser = coarser.iter().map(|simplified| simplified.level(&positions));
    Mesh::with_levels(mesh.name(), std::iter::once(finest.clone()).chain(coarser).collect())
}

/// The level with one vertex for each position. Files split vertices where normals or texture
/// coordinates jump; nothing here has either, and a simplifier would tear the mesh there.
fn welded(level: &Level) -> (Vec<Vec3>, Vec<u32>) {
    let mut numbers = HashMap::with_capacity(level.positions.len());
    let mut positions = Vec::new();
    let number_of: Vec<u32> = level
        .positions
        .iter()
        .map(|p| {
            *numbers.entry(p.to_array().map(f32::to_bits)).or_insert_with(|| {
                positions.push(*p);
                positions.len() as u32 - 1
            })
        })
        .collect();
    let indices = level.indices.iter().map(|&i| number_of[i as usize]).collect();
    (positions, indices)
}
