//! What is flown through.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use support::flags::Flags;
use support::gltf::GltfScene;
use support::scenario::Scenario;

/// A world that is generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Made {
    /// A power plant, and bunnies that move about in it
    MovingBunnies,
    /// A cloud of moving teapots, in which little is hidden
    Teapots,
    /// Streets, and what can be seen from the roofs
    City,
    /// Machines in cells between aisles and walls
    Factory,
    /// Parts of satellites in formation
    Satellites,
}

/// A world that can be built again and again, the same each time.
pub enum World {
    /// By the seed.
    Made(Made),
    /// From a file: what was typed, and what was read.
    File(PathBuf, Box<GltfScene>),
}

impl World {
    /// The scene of a glTF file, with a camera's path if there is one.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn load(flags: &Flags, file: &Path, camera: Option<&Path>) -> anyhow::Result<Self> {
        Ok(Self::File(file.to_owned(), Box::new(GltfScene::load(flags, file, camera)?)))
    }

    /// As the resume file calls it.
    pub fn key(&self) -> String {
        match self {
            Self::Made(made) => {
                made.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
            }
            Self::File(path, _) => path.display().to_string(),
        }
    }

    /// How many frames are run.
    ///
    /// # Errors
    /// When a flag has no meaning.
    pub fn frames(&self, flags: &Flags) -> anyhow::Result<u32> {
        match self {
            Self::Made(_) => Ok(flags.frames),
            Self::File(_, scene) => scene.frames(flags),
        }
    }

    /// Builds it.
    ///
    /// # Errors
    /// When it cannot be.
    pub fn scenario(&self, flags: &Flags) -> anyhow::Result<Scenario> {
        let moves = !flags.still;
        Ok(match self {
            Self::Made(Made::MovingBunnies) => Scenario::power_plant(flags, moves)?,
            Self::Made(Made::Teapots) => Scenario::teapots(flags, flags.objects, moves),
            Self::Made(Made::City) => Scenario::city(flags, false),
            Self::Made(Made::Factory) => Scenario::factory(flags),
            Self::Made(Made::Satellites) => Scenario::satellites(flags),
            Self::File(_, scene) => scene.scenario(),
        })
    }
}
