//! What the examples share: flags, measuring, plots and pictures.

pub mod canvas;
pub mod chart;
pub mod flags;
pub mod last_frame;
pub mod lockstep;
pub mod markdown;
pub mod painter;
pub mod picture;
pub mod plots;
pub mod program;
pub mod reference;
pub mod report;
pub mod run;
pub mod scenario;
pub mod table;
pub mod top_view;
