//! What a run is compared with: the exact visible set, and what reference policies are to draw.

use hecs::World;
use tercet::Culler;
use tercet::geom::View;
use tercet::policy::{Policy, Recording, StopAndWait};
use tercet::query::oracle::{Oracle, Truth};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{ObjectId, ObjectSet, Scene};

use super::painter::Painter;
use super::report::FrameRecord;
use super::run::Eye;

/// Looks at frames beside the one that is measured, outside the clock.
pub struct Reference {
    painter: Painter,
    /// Whether every frame is compared (`--oracle`).
    compare: bool,
    oracle: Oracle,
    truth: Option<Truth>,
    stop_and_wait: Culler<StopAndWait>,
    queries: SoftwareQueries,
}

impl Reference {
    /// `compare` asks for the oracle's figures of every frame.
    pub fn new(painter: Painter, compare: bool) -> Self {
        Self {
            painter,
            compare,
            oracle: Oracle::new(),
            truth: None,
            stop_and_wait: Culler::new(StopAndWait::default()),
            queries: SoftwareQueries::new(),
        }
    }

    /// Finds out what the next frame is compared with, and hands a policy that is itself a
    /// reference what it is to draw.
    pub fn look(&mut self, scene: &Scene, world: &World, view: &View, eye: &mut Eye) -> anyhow::Result<()> {
        let painter = self.painter;
        let recording = eye.policy().wants_recorded();
        if self.compare || recording == Some(Recording::ExactSet) {
            let truth = self.oracle.look(scene, view, |pass, objects| {
                painter.draw(world, view, pass, objects);
            })?;
            self.truth = Some(truth);
        }
        match recording {
            None => {}
            Some(Recording::ExactSet) => {
                let exact = self.truth.as_ref().map(|truth| &truth.exact);
                let is_seen = |id: &ObjectId| exact.is_some_and(|exact| exact.contains(*id));
                let seen: Vec<_> = scene.objects().map(|o| o.object.id).filter(is_seen).collect();
                eye.policy_mut().give_recorded(&seen);
            }
            Some(Recording::StopAndWait) => {
                self.stop_and_wait.frame(scene, view, &mut self.queries, |pass, objects| {
                    painter.draw(world, view, pass, objects);
                })?;
                let seen: Vec<_> = self.stop_and_wait.visible().iter().map(|object| object.id).collect();
                eye.policy_mut().give_recorded(&seen);
            }
        }
        Ok(())
    }

    /// Fills the oracle's figures in, if every frame is compared.
    pub fn judge(&self, scene: &Scene, eye: &Eye, queries: &SoftwareQueries, record: &mut FrameRecord) {
        let (true, Some(truth)) = (self.compare, &self.truth) else { return };
        let mut drawn = ObjectSet::default();
        for object in eye.visible() {
            drawn.insert(object.id);
        }
        let is_lost = |id: &ObjectId| truth.exact.contains(*id) && !drawn.contains(*id);
        let lost = scene.objects().map(|o| o.object.id).filter(is_lost).count();
        record.exact_visible = Some(truth.exact.len() as u32);
        record.box_visible = Some(truth.box_visible.len() as u32);
        record.false_culls = Some(lost as u32);
        record.wrong_pixels = Some(self.oracle.wrong_pixels(queries));
    }
}
