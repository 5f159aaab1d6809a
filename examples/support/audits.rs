//! Error accounting while running (`--audit N`): every n-th frame is checked, each object that was lost is
//! told once, and the estimate goes to the table, to `summary.json` and to the window.

use std::collections::{BTreeMap, HashSet};

use hecs::{Entity, World};
use serde::Serialize;
use tercet::Tradeoff;
use tercet::audit::{Auditor, Blame, Estimate};
use tercet::draw::Drawable;
use tercet::geom::View;
use tercet::scene::Scene;

use super::painter::Painter;
use super::run::Eye;

/// Objects of which it is told that they were lost.
const MOST_TOLD: usize = 20;

/// Checks frames, and tells what they lost.
pub struct Audits {
    auditor: Auditor,
    painter: Painter,
    /// What the checked frames have in common.
    tradeoff: Tradeoff,
    told: HashSet<Entity>,
}

/// What was found: `audit` in `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct AuditFigures {
    /// Every how many frames one was checked.
    pub every: u32,
    /// What they say.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// False culls by what is to blame: a dial of [`Tradeoff`], `bounds`, `list`, or `defect`.
    pub blamed: BTreeMap<&'static str, u64>,
}

impl Audits {
    /// Checks every n-th frame. `painter` draws as finely as what is checked.
    pub fn new(every: u32, painter: Painter) -> Self {
        let auditor = Auditor::new(every);
        Self { auditor, painter, tradeoff: Tradeoff::EXACT, told: HashSet::new() }
    }

    /// Every how many frames one is checked.
    pub fn every(&self) -> u32 {
        self.auditor.every()
    }

    /// Checks the frame that `eye` has just drawn, if it is due. Returns what is to be told of it; a turned
    /// dial starts the estimate anew.
    pub fn check(
        &mut self,
        scene: &Scene,
        world: &World,
        view: &View,
        eye: &Eye,
    ) -> anyhow::Result<Vec<String>> {
        if self.tradeoff != eye.tradeoff {
            self.auditor = Auditor::new(self.every());
            self.tradeoff = eye.tradeoff;
        }
        let painter = self.painter;
        let audit = self.auditor.check(scene, view, eye, |pass, objects| {
            painter.draw(world, view, pass, objects);
        })?;
        let mut lines = Vec::new();
        for lost in audit.iter().flat_map(|audit| &audit.lost) {
            let entity = lost.object.entity();
            if self.told.len() <= MOST_TOLD && self.told.insert(entity) {
                lines.push(match world.get::<&Drawable>(entity) {
                    _ if self.told.len() > MOST_TOLD => {
                        "lost: more objects, which are counted only".to_owned()
                    }
                    Ok(drawable) => format!("lost: {}, {lost}", drawable.mesh.name()),
                    Err(_) => format!("lost: {lost}"),
                });
            }
        }
        Ok(lines)
    }

    /// What was found so far.
    pub fn figures(&self) -> AuditFigures {
        let name = |blame: Blame| match blame {
            Blame::Dial(key) => key,
            Blame::Bounds => "bounds",
            Blame::List => "list",
            Blame::Defect => "defect",
        };
        AuditFigures {
            every: self.every(),
            estimate: self.auditor.estimate(),
            blamed: self.auditor.blamed().map(|(blame, lost)| (name(blame), lost)).collect(),
        }
    }
}

impl AuditFigures {
    /// The same in words, a few lines; the intervals hold in nineteen of twenty runs at either end.
    pub fn lines(&self) -> Vec<String> {
        let Estimate { frames, lossy_frames, wrong_share, lost, worst_lost, .. } = &self.estimate;
        if *frames == 0 {
            return vec![format!("no frame was checked yet; every {}th is", self.every)];
        }
        if *lost == 0 {
            let high = 100.0 * lossy_frames.high;
            return vec![format!("{frames} frames: nothing lost; at most {high:.1} % of all lose something")];
        }
        let each = self.estimate.lost_per_frame();
        let worst = 100.0 * self.estimate.worst_wrong_share;
        let blamed: Vec<String> = self.blamed.iter().map(|(name, lost)| format!("{name} {lost}")).collect();
        vec![
            format!("{frames} frames: {lost} objects lost, {each:.1} a frame, {worst_lost} at worst"),
            format!("frames that lose something: {lossy_frames}"),
            format!("pixels wrong: {wrong_share}, {worst:.3} % at worst"),
            format!("to blame: {}", blamed.join(", ")),
        ]
    }
}

#[cfg(test)]
mod tests {
    use tercet::audit::Share;

    use super::*;

    fn figures(lost: u64, blamed: &[(&'static str, u64)]) -> AuditFigures {
        let share = |mean| Share { mean, low: 0.5 * mean, high: 2.0 * mean + 0.1 };
        let estimate = Estimate {
            frames: 10,
            lossy_frames: share(0.3),
            wrong_share: share(0.001),
            worst_wrong_share: 0.005,
            lost,
            worst_lost: 4,
        };
        AuditFigures { every: 24, estimate, blamed: blamed.iter().copied().collect() }
    }

    #[test]
    fn the_keys_in_the_summary_are_the_contract() {
        let json = serde_json::to_string(&figures(12, &[("latency", 2), ("visible_pixels", 10)]));
        let expected = concat!(
            r#"{"every":24,"frames":10,"lossy_frames":{"mean":0.3,"low":0.15,"high":0.7},"#,
            r#""wrong_share":{"mean":0.001,"low":0.0005,"high":0.10200000000000001},"#,
            r#""worst_wrong_share":0.005,"lost":12,"worst_lost":4,"blamed":{"latency":2,"visible_pixels":10}}"#,
        );
        assert_eq!(json.expect("plain data"), expected);
    }

    #[test]
    fn figures_read_well() {
        let lines = figures(12, &[("latency", 2), ("visible_pixels", 10)]).lines();
        assert_eq!(lines[0], "10 frames: 12 objects lost, 1.2 a frame, 4 at worst");
        assert_eq!(lines[1], "frames that lose something: 30 % (15 to 70 %)");
        assert_eq!(lines[2], "pixels wrong: 0.10 % (0.050 to 10 %), 0.500 % at worst");
        assert_eq!(lines[3], "to blame: latency 2, visible_pixels 10");
        let nothing = figures(0, &[]).lines();
        assert_eq!(nothing, ["10 frames: nothing lost; at most 70.0 % of all lose something"]);
    }
}
