//! What the examples share: flags, measuring, plots and pictures. The bunny of some scenarios is
//! read from a glTF file.

pub mod canvas;
pub mod chart;
pub mod flags;
pub mod last_frame;
#[cfg(feature = "gltf")]
pub mod lockstep;
pub mod markdown;
pub mod painter;
pub mod picture;
pub mod plots;
pub mod program;
pub mod reference;
pub mod report;
pub mod run;
#[cfg(feature = "gltf")]
pub mod scenario;
pub mod table;
pub mod top_view;
