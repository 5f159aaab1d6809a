//! With `Tradeoff::EXACT` a culled object never owned a sample: every policy on worlds in which
//! everything changes every frame, each frame against the exact oracle. Each suite also asserts
//! that hidden things were culled, so that a policy that draws everything cannot pass.

mod caught;
mod dropping;
mod faulty;
mod fickle;
#[cfg(feature = "gltf")]
mod imported;
#[path = "../support/lying.rs"]
mod lying;
#[path = "../support/painter.rs"]
mod painter;
mod run;
#[cfg(feature = "gltf")]
#[path = "../support/scenes.rs"]
mod scenes;
#[path = "../support/stage.rs"]
mod stage;
mod suite;
mod tally;
mod trusting;
mod ways;
mod worlds;
#[cfg(feature = "gltf")]
#[path = "../support/writer.rs"]
mod writer;

use run::Shown;
