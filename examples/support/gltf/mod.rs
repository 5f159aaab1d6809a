//! Scenes of glTF files, with a camera's way through them.

mod camera_file;
mod walk;

use std::path::Path;

use anyhow::{Context, ensure};
use hecs::World;
use tercet::geom::Aabb;
use tercet::scene::import::{self, ImportReport, Imported};

use super::flags::Flags;
use super::scenario::{Flight, Scenario};

/// A file that was read.
pub struct GltfScene {
    imported: Imported,
    flight: Flight,
    near: f32,
}

impl GltfScene {
    /// Reads a scene, and a camera's path if there is one; without it, the camera walks through the
    /// middle of the scene, or around it where there is only one thing to see.
    ///
    /// # Errors
    /// When a file cannot be read, or there is nothing to see.
    pub fn load(flags: &Flags, file: &Path, camera: Option<&Path>) -> anyhow::Result<Self> {
        let imported = import::load(file)
            .with_context(|| format!("{} is to be a .glb or .gltf file", file.display()))?;
        let imported = with_levels(imported, flags)?;
        let model = &imported.model;
        ensure!(!model.objects.is_empty(), "{}: there is nothing to see in it", file.display());
        let flight = match camera {
            Some(file) => Flight::Poses(camera_file::read(file)?),
            None => {
                let boxes: Vec<Aabb> = model.objects.iter().map(|o| o.bounds).collect();
                Flight::Path(walk::through(&model.bounds, &boxes))
            }
        };
        let near = walk::near(&model.bounds);
        Ok(Self { imported, flight, near })
    }

    /// What there is to know about the reading.
    pub fn report(&self) -> &ImportReport {
        &self.imported.report
    }

    /// How many frames are run: as many as the camera's path has, as far as it is flown, or as many as
    /// the flags say.
    ///
    /// # Errors
    /// When a flag has no meaning.
    pub fn frames(&self, flags: &Flags) -> anyhow::Result<u32> {
        let Flight::Poses(poses) = &self.flight else { return Ok(flags.frames) };
        let flown = flags.flight_end()? * poses.len() as f32;
        Ok((flown.ceil() as u32).max(1))
    }

    /// The scene in a world of its own.
    pub fn scenario(&self) -> Scenario {
        let mut world = World::new();
        self.imported.spawn(&mut world);
        let name = self.imported.model.name.clone();
        Scenario { name, world, swarm: None, flight: self.flight.clone(), near: self.near }
    }
}

/// A file says nothing of levels of detail: they are made here, unless nobody wants them.
#[cfg(feature = "lod")]
fn with_levels(mut imported: Imported, flags: &Flags) -> anyhow::Result<Imported> {
    const LEAST_TRIANGLES: usize = 64;
    if !flags.full_detail {
        imported.generate_levels(LEAST_TRIANGLES)?;
    }
    Ok(imported)
}

/// Without the feature that makes levels of detail, a scene is drawn as it is.
#[cfg(not(feature = "lod"))]
fn with_levels(imported: Imported, _: &Flags) -> anyhow::Result<Imported> {
    Ok(imported)
}
