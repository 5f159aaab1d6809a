//! What asking and drawing cost, as seen: rules that weigh one against the other read it here.

use std::time::Duration;

use crate::stats::FrameStats;

/// Smoothed times of one view's last frames. To policies and to the tree they are a recorded
/// argument like any other: the same costs and answers, the same decisions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Costs {
    /// Natural logarithm of what [`Costs::question`] returns.
    log: f32,
    last: Option<FrameCost>,
}

/// What one frame of a view took.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameCost {
    /// Seconds from its begin to its end, the device's drawing included.
    pub total: f32,
    /// The part of it that was drawing, seconds.
    pub draw: f32,
    /// Objects drawn.
    pub drawn: u32,
    /// Whether a device drew: its part of the time is then that of a frame some frames ago.
    pub is_late: bool,
}

/// How much a new frame counts.
const WEIGHT: f32 = 0.125;

impl Default for Costs {
    fn default() -> Self {
        Self::of(0.25)
    }
}

impl Costs {
    /// A question that costs as much as drawing `objects` objects, within 1/256 to 256.
    pub fn of(objects: f32) -> Self {
        let objects = if objects.is_nan() { 1.0 } else { objects };
        Self { log: objects.clamp(1.0 / 256.0, 256.0).ln(), last: None }
    }

    /// What the view's last frame took; None before the first, and where nobody knows how long a
    /// device draws.
    pub fn last_frame(&self) -> Option<FrameCost> {
        self.last
    }

    /// The same costs, after a frame that took this.
    pub fn after(self, last: FrameCost) -> Self {
        Self { last: Some(last), ..self }
    }

    /// What a question costs, policy and waiting included, in objects that could be drawn
    /// instead: greater than 0.
    pub fn question(&self) -> f32 {
        self.log.exp()
    }

    /// Takes the times of the last frame as they are.
    pub(crate) fn record(&mut self, stats: &FrameStats, is_late: bool) {
        // Answers waited for a part of the device's drawing, which then is in the waiting already.
        let after = stats.device_draw.saturating_sub(stats.awaited_draw);
        let total = stats.policy + stats.query + stats.wait + stats.draw + after;
        let draw = stats.draw + stats.device_draw;
        let [total, draw] = [total, draw].map(|time| time.as_secs_f32());
        self.last = Some(FrameCost { total, draw, drawn: stats.drawn, is_late });
    }

    /// The same costs, without the last frame: nobody knows what it took, or it was not the asker's.
    pub(crate) fn without_last(self) -> Self {
        Self { last: None, ..self }
    }

    /// Takes a frame's times. A frame that drew or asked nothing, or took no time, tells nothing.
    pub fn learn(&mut self, stats: &FrameStats) {
        let each = |time: Duration, n: u32| time.as_secs_f32() / n as f32;
        // Who waits for an answer waits for what the device draws before it: that is no part of
        // asking. The two are of different frames, so the one may be longer than the other.
        let waited = stats.wait.saturating_sub(stats.awaited_draw);
        let question = each(stats.policy + stats.query + waited, stats.queries);
        let object = each(stats.draw + stats.device_draw, stats.drawn + stats.left_out);
        let ratio = question / object;
        if ratio.is_finite() && ratio > 0.0 {
            // Of logarithms: twice as dear and half as dear weigh alike.
            self.log += WEIGHT * (Self::of(ratio).log - self.log);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(asking: u64, queries: u32, drawing: u64, drawn: u32) -> FrameStats {
        FrameStats {
            queries,
            drawn,
            wait: Duration::from_micros(asking),
            draw: Duration::from_micros(drawing),
            ..FrameStats::default()
        }
    }

    #[test]
    fn costs_approach_what_is_seen() {
        let mut costs = Costs::default();
        for _ in 0..100 {
            costs.learn(&frame(100, 10, 800, 20));
        }
        let expected = 10.0 / 40.0;
        assert!((costs.question() / expected - 1.0).abs() < 1e-3, "{costs:?}");
    }

    #[test]
    fn what_a_device_draws_is_no_part_of_asking() {
        let (mut apart, mut together) = (Costs::default(), Costs::default());
        apart.learn(&frame(100, 10, 900, 20));
        let device_draw = Duration::from_micros(800);
        together.learn(&FrameStats { device_draw, awaited_draw: device_draw, ..frame(900, 10, 100, 20) });
        assert_eq!(apart, together);
    }

    #[test]
    fn what_is_drawn_after_the_last_question_makes_asking_no_cheaper() {
        let (mut apart, mut after) = (Costs::default(), Costs::default());
        apart.learn(&frame(500, 10, 900, 20));
        let [device_draw, awaited_draw] = [800, 200].map(Duration::from_micros);
        after.learn(&FrameStats { device_draw, awaited_draw, ..frame(700, 10, 100, 20) });
        assert_eq!(apart, after);
    }

    #[test]
    fn a_frame_is_as_long_as_its_parts_and_no_device_time_counts_twice() {
        let [device_draw, awaited_draw] = [700, 500].map(Duration::from_micros);
        let mut costs = Costs::default();
        assert_eq!(costs.last_frame(), None);
        costs.record(&FrameStats { device_draw, awaited_draw, ..frame(600, 10, 100, 20) }, true);
        let FrameCost { total, draw, drawn, is_late } = costs.last_frame().expect("it was recorded");
        assert!(
            (total - 900e-6).abs() < 1e-8 && (draw - 800e-6).abs() < 1e-8 && drawn == 20 && is_late,
            "{costs:?}"
        );
        assert_eq!(costs.question(), Costs::default().question());
        assert_eq!(costs.without_last(), Costs::default());
    }

    #[test]
    fn frames_that_tell_nothing_change_nothing() {
        let mut costs = Costs::of(3.0);
        for empty in [frame(0, 0, 100, 10), frame(100, 10, 0, 0), frame(0, 10, 100, 10), frame(9, 9, 0, 9)] {
            costs.learn(&empty);
        }
        assert_eq!(costs, Costs::of(3.0));
        assert!(Costs::of(f32::INFINITY).question().is_finite() && Costs::of(0.0).question() > 0.0);
    }
}
