//! What asking and drawing cost, as seen: rules that weigh one against the other read it here.

use std::time::Duration;

use crate::query::{DeviceTimes, DrawTime};
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

/// What one frame of a view took, the last one of which that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameCost {
    /// Seconds from its begin to its end, the device's drawing included.
    pub total: f32,
    /// The part of it that was drawing, seconds.
    pub draw: f32,
    /// Objects drawn of which something showed.
    pub drawn: u32,
    /// How many frames ago it was, seen from the next: 1 is the last one. A device tells later.
    pub ago: u32,
}

/// What the host knows of the last frames of a view, until a device tells its part.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HostTimes([HostTime; KEPT]);

/// Of one frame.
#[derive(Clone, Copy, Debug, Default)]
struct HostTime {
    /// The view's number of it, and the backend's.
    frame: u32,
    of: u64,
    stats: FrameStats,
    /// Nothing is known that was not told.
    is_told: bool,
}

/// Frames of a view whose times may be on their way. Whoever holds a time against its frame keeps as many.
pub(crate) const KEPT: usize = 8;

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

    /// What the view's last frame took, or that which a device has told of since it was last asked; None
    /// before the first, if there is no news, and where nobody knows how long a device draws.
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

    /// Takes the times of a frame that has just ended, the view's by this number, or of an earlier one that a
    /// device has told of.
    pub(crate) fn record(
        &mut self,
        (frame, stats): (u32, &FrameStats),
        drawing: DrawTime,
        host: &mut HostTimes,
        told: impl Fn(u64) -> Option<DeviceTimes>,
    ) {
        self.last = match drawing {
            DrawTime::AtOnce => Some(FrameCost::of(stats, DeviceTimes::default(), 1)),
            DrawTime::Device { now, .. } => {
                host.keep(frame, now, *stats);
                host.news(frame, told)
            }
            // Drawing that is not told apart from waiting would make questions look dear.
            DrawTime::Unknown => None,
        };
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

impl FrameCost {
    fn of(stats: &FrameStats, DeviceTimes { total: device, awaited }: DeviceTimes, ago: u32) -> Self {
        // Answers waited for a part of the device's drawing, which then is in the waiting already.
        let after = device.saturating_sub(awaited);
        let total = stats.policy + stats.query + stats.wait + stats.draw + after;
        let [total, draw] = [total, stats.draw + device].map(|time| time.as_secs_f32());
        Self { total, draw, drawn: stats.drawn, ago }
    }
}

impl HostTimes {
    fn keep(&mut self, frame: u32, of: u64, stats: FrameStats) {
        self.0[frame as usize % KEPT] = HostTime { frame, of, stats, is_told: false };
    }

    /// The first frame of which nobody has heard and a device tells by now; each is told once.
    fn news(&mut self, frame: u32, told: impl Fn(u64) -> Option<DeviceTimes>) -> Option<FrameCost> {
        (0..KEPT as u32).rev().find_map(|before| {
            let kept = &mut self.0[frame.wrapping_sub(before) as usize % KEPT];
            let is_new = kept.of > 0 && kept.frame == frame.wrapping_sub(before) && !kept.is_told;
            let times = told(kept.of).filter(|_| is_new)?;
            kept.is_told = true;
            Some(FrameCost::of(&kept.stats, times, before + 1))
        })
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
        let drawing =
            |now| DrawTime::Device { times: DeviceTimes { total: device_draw, awaited: awaited_draw }, now };
        let tells = |first: u64, last: u64| {
            move |of: u64| {
                (first..=last)
                    .contains(&of)
                    .then_some(DeviceTimes { total: device_draw, awaited: awaited_draw })
            }
        };
        let mut host = HostTimes::default();
        // Of several views that share a backend, in turns: each hears of its own frames alone.
        let mut learn = |costs: &mut Costs, number: u32, now: u64, told: (u64, u64)| {
            let stats = frame(100 * u64::from(number), 10, 100, 20);
            costs.record((number, &stats), drawing(now), &mut host, tells(told.0, told.1));
            costs.last_frame().map(|last| ((last.total * 1e6).round() as u32, last.ago))
        };
        assert_eq!(learn(&mut costs, 6, 7, (4, 6)), None);
        assert_eq!(learn(&mut costs, 7, 9, (4, 6)), None);
        // Two have arrived at once, and are told one after the other.
        assert_eq!(learn(&mut costs, 8, 11, (4, 9)), Some((900, 3)));
        assert_eq!(learn(&mut costs, 9, 13, (4, 9)), Some((1000, 3)));
        assert_eq!(learn(&mut costs, 10, 15, (4, 9)), None);
        // The frame after that failed, and has no number of the backend's.
        assert_eq!(learn(&mut costs, 12, 19, (4, 12)), Some((1100, 5)));
        // Of these too much time has passed.
        assert_eq!(learn(&mut costs, 30, 40, (4, 39)), None);
        assert_eq!(costs.question(), Costs::default().question());
        assert_eq!(costs.without_last(), Costs::default());
    }

    #[test]
    fn a_frame_that_is_drawn_at_once_is_known_at_once() {
        let mut costs = Costs::default();
        let stats = frame(600, 10, 100, 20);
        costs.record((1, &stats), DrawTime::AtOnce, &mut HostTimes::default(), |_| None);
        let last = costs.last_frame().expect("it was recorded");
        assert!((last.total - 700e-6).abs() < 1e-8 && last.ago == 1, "{last:?}");
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
