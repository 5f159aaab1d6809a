//! Backends whose pyramid of farthest depths can be looked at.

use tercet::Error;
use tercet::query::QueryBackend;
use tercet::query::gpu::GpuQueries;
use tercet::query::software::SoftwareQueries;
use tercet::record::Logged;

/// A level of the pyramid: the farthest nearness of 2 × 2 pixels, of 4 × 4 on the next one, and so on.
#[derive(Clone, Debug, Default)]
pub struct Level {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Texel by texel, from the upper left corner.
    pub nearness: Vec<f32>,
}

/// What can say how its pyramid looks.
pub trait Inspected: QueryBackend {
    /// All levels of what was drawn so far, in a frame.
    ///
    /// # Errors
    /// What the device reports.
    fn levels(&mut self) -> Result<Vec<Level>, Error>;
}

impl Inspected for Logged<SoftwareQueries> {
    fn levels(&mut self) -> Result<Vec<Level>, Error> {
        let level = |level: &tercet::query::software::PyramidLevel| Level {
            width: level.width,
            height: level.height,
            nearness: level.farthest.clone(),
        };
        Ok(self.backend.inspect_pyramid().levels().iter().map(level).collect())
    }
}

impl Inspected for Logged<GpuQueries> {
    fn levels(&mut self) -> Result<Vec<Level>, Error> {
        let level = |level: tercet::query::gpu::Level| Level {
            width: level.width,
            height: level.height,
            nearness: level.nearness,
        };
        Ok(self.backend.inspect_pyramid()?.into_iter().map(level).collect())
    }
}
