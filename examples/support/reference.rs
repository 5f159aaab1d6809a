//! What a run is compared with: the exact visible set, and what reference policies are to draw.

use std::collections::{HashMap, HashSet};

use hecs::{Entity, World};
use tercet::Culler;
use tercet::geom::View;
use tercet::policy::{Policy, Recording, StopAndWait};
use tercet::query::QueryBackend;
use tercet::query::oracle::{Oracle, Truth};
use tercet::query::software::{SoftwareQueries, VisibilityImage};
use tercet::scene::{ObjectId, ObjectRef, Scene};

use super::painter::Painter;
use super::report::FrameRecord;
use super::run::Eye;

/// Looks at frames beside the one that is measured, outside the clock.
pub struct Reference {
    /// Draws what is looked at.
    pub painter: Painter,
    /// Whether every frame is compared (`--oracle`).
    compare: bool,
    oracle: Oracle,
    truth: Option<Truth>,
    /// Whose pixels the truth shows.
    seen: Vec<Entity>,
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
            seen: Vec::new(),
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
            self.find_truth(scene, world, view)?;
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

    /// Finds out what this frame is compared with, if every frame is; for runs in which no policy
    /// is itself a reference.
    pub fn compare(&mut self, scene: &Scene, world: &World, view: &View) -> anyhow::Result<()> {
        if self.compare { self.find_truth(scene, world, view) } else { Ok(()) }
    }

    /// Fills the oracle's figures in, if every frame is compared: what the culler drew is drawn once
    /// more, in software, and compared with the truth. `eye` may have looked at another scene of the
    /// same world: entities are compared.
    pub fn judge(
        &mut self,
        world: &World,
        view: &View,
        eye: &Eye,
        record: &mut FrameRecord,
    ) -> anyhow::Result<()> {
        let (true, Some(truth)) = (self.compare, &self.truth) else { return Ok(()) };
        let drawn: HashSet<Entity> = eye.visible().iter().map(|object| object.entity()).collect();
        let lost: Vec<Entity> = self.seen.iter().copied().filter(|entity| !drawn.contains(entity)).collect();
        self.queries.begin(view)?;
        self.queries.draw(|pass| {
            self.painter.draw(world, view, pass, eye.visible());
        })?;
        self.queries.end()?;
        record.exact_visible = Some(truth.exact.len() as u32);
        record.box_visible = Some(truth.box_visible.len() as u32);
        record.false_culls = Some(lost.len() as u32);
        record.lost = self.samples_of(lost);
        record.wrong_pixels = Some(self.oracle.wrong_pixels(&self.queries));
        Ok(())
    }

    /// How many samples of the frame show another object here than there: the two draw at different
    /// levels of detail.
    pub fn differs_from(&self, other: &Self) -> u64 {
        let owners = |reference: &Self, pixel: usize| {
            let call = reference.oracle.image().call[pixel];
            (call != VisibilityImage::NOTHING).then(|| reference.oracle.owner(call).entity())
        };
        let pixels = self.oracle.image().call.len();
        (0..pixels).filter(|&pixel| owners(self, pixel) != owners(other, pixel)).count() as u64
    }

    /// Of how many samples each of these is the nearest. It may be none: at equal depths, another
    /// object counts as the nearest.
    fn samples_of(&self, entities: Vec<Entity>) -> Vec<(Entity, u32)> {
        let mut samples: HashMap<Entity, u32> = entities.iter().map(|&entity| (entity, 0)).collect();
        if !samples.is_empty() {
            let nearest = self.oracle.image().call.iter().filter(|&&call| call != VisibilityImage::NOTHING);
            for &call in nearest {
                if let Some(count) = samples.get_mut(&self.oracle.owner(call).entity()) {
                    *count += 1;
                }
            }
        }
        entities.into_iter().map(|entity| (entity, samples[&entity])).collect()
    }

    fn find_truth(&mut self, scene: &Scene, world: &World, view: &View) -> anyhow::Result<()> {
        let painter = self.painter;
        let truth = self.oracle.look(scene, view, |pass, objects| {
            painter.draw(world, view, pass, objects);
        })?;
        let exact = scene.objects().map(|o| o.object).filter(|o| truth.exact.contains(o.id));
        self.seen = exact.map(ObjectRef::entity).collect();
        self.truth = Some(truth);
        Ok(())
    }
}
