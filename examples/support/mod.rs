//! What the examples share: flags, measuring, plots and pictures.

pub mod canvas;
pub mod picture;
pub mod plots;
pub mod report;
pub mod table;
pub mod top_view;
