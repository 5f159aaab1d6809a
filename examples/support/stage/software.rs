//! The CPU answers, and draws what the questions are put to: depth.

use hecs::World;
use tercet::draw::Detail;
use tercet::geom::View;
use tercet::query::software::SoftwareQueries;
use tercet::record::Logged;
use tercet::scene::Scene;

use super::{Drawn, Watched};
use crate::painter::Painter;
use crate::run::Eye;

/// The software backend, with the renderer for its passes.
pub struct SoftwareStage {
    pub(super) queries: Watched<Logged<SoftwareQueries>>,
    pub(super) painter: Painter,
}

impl SoftwareStage {
    /// Draws as finely as `detail` says.
    pub fn new(detail: Detail) -> Self {
        let mut queries = SoftwareQueries::new();
        // The painter paints what there is to see.
        queries.set_true_shapes(true);
        Self { queries: Watched::new(Logged::silent(queries)), painter: Painter { detail } }
    }

    /// What is seen is drawn by another renderer, which rounds otherwise: boxes, which allow for that, have the
    /// last word.
    pub fn shown_by_another(&mut self) {
        self.queries.backend().backend.set_true_shapes(false);
    }

    /// The backend, as a recorder listens to it.
    pub fn log(&mut self) -> &mut Logged<SoftwareQueries> {
        self.queries.backend()
    }

    /// See [`Stage::frame`](super::Stage::frame).
    pub fn frame(
        &mut self,
        eye: &mut Eye,
        scene: &Scene,
        world: &World,
        view: &View,
    ) -> anyhow::Result<Drawn> {
        let mut triangles = 0;
        let stats = eye.frame(scene, view, &mut self.queries, |pass, objects| {
            triangles += self.painter.draw(world, view, pass, objects);
        })?;
        Ok(Drawn { stats, triangles })
    }
}
