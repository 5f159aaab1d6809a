//! What the examples share: flags, measuring, plots and pictures.

pub mod canvas;
pub mod flags;
pub mod last_frame;
pub mod painter;
pub mod picture;
pub mod plots;
pub mod reference;
pub mod report;
pub mod run;
pub mod table;
pub mod top_view;
