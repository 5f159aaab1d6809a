//! What the examples share: scenarios, backends, flags, measuring, plots, pictures and a window.

pub mod audits;
pub mod axis;
pub mod canvas;
pub mod chart;
pub mod demo;
pub mod flags;
pub mod gltf;
pub mod headless;
pub mod last_frame;
pub mod lockstep;
pub mod markdown;
pub mod painter;
pub mod picture;
pub mod plots;
pub mod program;
pub mod recording;
pub mod reference;
pub mod report;
pub mod run;
pub mod scenario;
pub mod stage;
pub mod table;
pub mod ticks;
pub mod top_view;
pub mod window;
