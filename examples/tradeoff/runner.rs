//! Runs settings: a few at a time, side by side with the base, and none that is finished.

use indicatif::ProgressBar;

use crate::dials::Setting;
use crate::figures::{Figures, base_of};
use crate::resume::{Line, Resume};
use crate::worlds::World;
use support::flags::Flags;
use support::lockstep::{self, Lane};

/// Settings that run side by side, beside two copies of the base: each holds a scene of its own.
const BATCH: usize = 6;

/// The two copies.
const COPIES: usize = 2;

/// Runs settings in one world.
pub struct Runner<'a> {
    /// How: the frames are the world's.
    flags: Flags,
    world: &'a World,
    /// What all others are compared with.
    base: Setting,
    resume: &'a mut Resume,
    bar: &'a ProgressBar,
    /// What was run by now, not taken from the file.
    pub ran: usize,
}

impl<'a> Runner<'a> {
    /// For one world.
    ///
    /// # Errors
    /// When a flag has no meaning.
    pub fn new(
        flags: &Flags,
        world: &'a World,
        base: Setting,
        resume: &'a mut Resume,
        bar: &'a ProgressBar,
    ) -> anyhow::Result<Self> {
        let flags = Flags { frames: world.frames(flags)?, oracle: true, ..flags.clone() };
        Ok(Self { flags, world, base, resume, bar, ran: 0 })
    }

    /// The world's name.
    pub fn world(&self) -> String {
        self.world.key()
    }

    /// How many frames are run.
    pub fn frames(&self) -> u32 {
        self.flags.frames
    }

    /// The figures of settings, in their order. Those that are not in the file are run, and put there
    /// batch by batch.
    ///
    /// # Errors
    /// When something cannot be run or written.
    pub fn measure(&mut self, settings: &[Setting], round: u32) -> anyhow::Result<Vec<Figures>> {
        let key = self.world.key();
        let mut left: Vec<&Setting> = Vec::new();
        for setting in settings {
            if self.resume.get(&key, round, &setting.name).is_none() && !left.contains(&setting) {
                left.push(setting);
            }
        }
        let is_base = left.iter().any(|setting| **setting == self.base);
        left.retain(|setting| **setting != self.base);
        let batches: Vec<Vec<&Setting>> = match left.is_empty() && is_base {
            // The copies alone.
            true => vec![Vec::new()],
            false => left.chunks(BATCH).map(<[_]>::to_vec).collect(),
        };
        let lanes: usize = batches.iter().map(|batch| COPIES + batch.len()).sum();
        self.bar.inc_length(lanes as u64 * u64::from(self.flags.frames));
        for batch in batches {
            let lines = self.run(&batch, round)?;
            self.ran += lines.len();
            self.resume.append(lines)?;
        }
        let of = |setting: &Setting| self.resume.get(&key, round, &setting.name).cloned();
        settings.iter().map(|setting| of(setting).ok_or_else(|| self.missing(setting))).collect()
    }

    /// One batch. The base is among its lines if it has none yet.
    fn run(&self, settings: &[&Setting], round: u32) -> anyhow::Result<Vec<Line>> {
        let flags = &self.flags;
        let scenario = self.world.scenario(flags)?;
        let all = [&self.base; COPIES].into_iter().chain(settings.iter().copied());
        let lane = |setting: &Setting| {
            let tree = setting.tradeoff.tree(flags.tree()?);
            Ok(Lane::new(flags, flags.policy()?, tree)?.with_tradeoff(setting.tradeoff))
        };
        let lanes = all.clone().map(lane).collect::<anyhow::Result<_>>()?;
        let measured = lockstep::run(scenario, flags, lanes, || self.bar.inc(1))?;
        let (base_ms, noise) = base_of(&measured[0], &measured[1]);
        let samples = f64::from(flags.size.0) * f64::from(flags.size.1);
        let world = self.world.key();
        let figures = |setting: &Setting, lane| {
            let figures = Figures::new(lane, (&base_ms, noise), samples);
            // By definition: what one copy takes more than both is noise.
            if *setting == self.base { Figures { time_ratio: 1.0, ..figures } } else { figures }
        };
        let has_base = self.resume.get(&world, round, &self.base.name).is_some();
        let lanes = all.zip(&measured).skip(if has_base { COPIES } else { COPIES - 1 });
        Ok(lanes
            .map(|(setting, lane)| Line {
                world: world.clone(),
                round,
                setting: setting.name.clone(),
                figures: figures(setting, lane),
            })
            .collect())
    }

    fn missing(&self, setting: &Setting) -> anyhow::Error {
        anyhow::anyhow!("{}: {} was run, and left no figures", self.world.key(), setting.name)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use tercet::Tradeoff;

    use super::*;
    use crate::resume::Identity;
    use crate::worlds::Made;

    fn setting(key: &str, value: &str) -> Setting {
        let mut tradeoff = Tradeoff::EXACT;
        tradeoff.set(key, value).expect("it takes that");
        Setting::new(tradeoff)
    }

    /// A few frames of a small plant: what is finished is not run again, and each kind of error is seen
    /// where it belongs.
    #[test]
    fn every_setting_runs_once_and_its_errors_are_told_apart() {
        let line = "tradeoff --policy dual-query --scale 0.05 --objects 60 --frames 4 --size 160x90 --set flight_end=0.4";
        let flags = Flags::try_parse_from(line.split(' ')).expect("flags");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.jsonl");
        let (world, bar) = (World::Made(Made::MovingBunnies), ProgressBar::hidden());
        let exact = Setting::new(Tradeoff::EXACT);
        let all = [exact.clone(), setting("visible_pixels", "400"), setting("max_error_px", "16")];
        let measure = |settings: &[Setting], round| {
            let mut resume = Resume::open(&path, &Identity::new(), false).expect("a file");
            let mut runner =
                Runner::new(&flags, &world, exact.clone(), &mut resume, &bar).expect("its frames");
            let figures = runner.measure(settings, round).expect("it runs");
            (figures, runner.ran)
        };
        let (first, ran) = measure(&all[..2], 0);
        assert_eq!(ran, 2);
        let (figures, ran) = measure(&all, 0);
        assert_eq!((&figures[..2], ran), (&first[..], 1), "only the third is new");
        assert_eq!(measure(&all, 0), (figures.clone(), 0));
        assert_eq!(measure(&all[2..], 1).1, 2, "a check runs anew, with a base of its own");

        let [exact, blind, coarse] = &figures[..] else { panic!("three were asked for") };
        assert_eq!((exact.time_ratio, exact.error(), exact.lost, exact.longest_run), (1.0, 0.0, 0, 0));
        assert!(exact.exact > 0.0 && exact.drawn - exact.exact == exact.extra, "{exact:?}");
        assert!(blind.wrong_mean > 0.0 && blind.wrong_worst >= blind.wrong_mean, "{blind:?}");
        assert!(blind.wrong_worst <= 1.0 && blind.detail_mean == 0.0, "{blind:?}");
        assert!((1..=400).contains(&blind.largest_lost), "no box that shows more is culled: {blind:?}");
        assert!((1..=4).contains(&blind.longest_run) && blind.lost > 0, "{blind:?}");
        assert!(coarse.wrong_mean == 0.0 && coarse.lost == 0, "{coarse:?}");
        assert!(coarse.detail_mean > 0.0 && coarse.triangles < exact.triangles, "{coarse:?}");
    }
}
