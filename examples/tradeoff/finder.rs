//! The fastest setting within an allowed error, without running every combination.
//!
//! 1. Every value of every dial runs alone.
//! 2. From these, times are taken to multiply and errors to add up. The combinations that then are the
//!    fastest within the allowed error run, a few of them.
//! 3. From the fastest found so far, one dial at a time goes through all its values, the others as they
//!    are, until a round through all dials gains nothing. Where dials get in each other's way, this mends
//!    what the guess got wrong.
//! 4. Step 2 again from there, and step 3 again if that gained something.
//! 5. Dials that turn out to gain nothing are put back.
//!
//! Whatever is within the allowed error was measured to be.

use std::collections::HashMap;

use crate::pareto::front;

/// A value of each dial, by index; 0 is the base's.
pub type Point = Vec<usize>;

/// What a point was measured to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Over the base's.
    pub time: f64,
    /// A share of 1.
    pub error: f64,
}

/// A gain below this is taken for noise.
pub const LEAST_GAIN: f64 = 0.01;

/// How many guesses are run.
const GUESSES: usize = 12;

/// Of more partial combinations, only the unbeaten ones are kept.
const MOST_PARTIAL: usize = 4096;

/// What was run, and what came out.
pub struct Finder<M> {
    lengths: Vec<usize>,
    allowed: f64,
    measure: M,
    /// All that was run.
    pub scores: HashMap<Point, Score>,
}

impl<M: FnMut(&[Point]) -> anyhow::Result<Vec<Score>>> Finder<M> {
    /// Over dials of so many values each, the base's among them; `measure` runs points.
    pub fn new(lengths: &[usize], allowed: f64, measure: M) -> Self {
        Self { lengths: lengths.to_vec(), allowed, measure, scores: HashMap::new() }
    }

    /// The fastest point within the allowed error, as far as this search goes; None if no point that
    /// was run is within it.
    ///
    /// # Errors
    /// What `measure` reports.
    pub fn find(&mut self) -> anyhow::Result<Option<Point>> {
        let base = vec![0; self.lengths.len()];
        self.run_around(&base)?;
        let Some(mut best) = self.fastest(self.scores.keys()) else { return Ok(None) };
        loop {
            best = self.descend(best)?;
            self.run_around(&best)?;
            match self.fastest(self.scores.keys()) {
                Some(other) if self.gains(&other, &best) => best = other,
                _ => return self.simplify(best).map(Some),
            }
        }
    }

    /// Runs the combinations that look best from a point, by what each dial does to it alone.
    fn run_around(&mut self, point: &Point) -> anyhow::Result<()> {
        let mut turned = vec![point.clone()];
        for dial in 0..self.lengths.len() {
            turned.extend(self.turned(point, dial));
        }
        self.run(turned)?;
        let guesses = self.guesses(point);
        self.run(guesses)
    }

    /// Turns one dial at a time, as long as it gains.
    fn descend(&mut self, mut best: Point) -> anyhow::Result<Point> {
        loop {
            let before = best.clone();
            for dial in 0..self.lengths.len() {
                let turned = self.turned(&best, dial);
                self.run(turned.clone())?;
                best = self.fastest(turned.iter()).filter(|other| self.gains(other, &best)).unwrap_or(best);
            }
            if best == before {
                return Ok(best);
            }
        }
    }

    /// Puts dials back that gain nothing.
    fn simplify(&mut self, best: Point) -> anyhow::Result<Point> {
        let most = self.scores[&best].time * (1.0 + LEAST_GAIN);
        let mut simple = best;
        for dial in 0..self.lengths.len() {
            let mut without = simple.clone();
            without[dial] = 0;
            self.run(vec![without.clone()])?;
            if self.is_allowed(&without) && self.scores[&without].time <= most {
                simple = without;
            }
        }
        Ok(simple)
    }

    fn gains(&self, point: &Point, over: &Point) -> bool {
        self.scores[point].time < self.scores[over].time * (1.0 - LEAST_GAIN)
    }

    /// The fastest points that were run within the allowed error, fastest first.
    pub fn ranking(&self) -> Vec<Point> {
        let mut points: Vec<&Point> = self.scores.keys().filter(|point| self.is_allowed(point)).collect();
        points.sort_by(|a, b| self.compare(a, b));
        points.into_iter().cloned().collect()
    }

    fn is_allowed(&self, point: &Point) -> bool {
        self.scores[point].error <= self.allowed
    }

    /// By time; of equal ones, the one that turns less comes first.
    fn compare(&self, a: &Point, b: &Point) -> std::cmp::Ordering {
        self.scores[a].time.total_cmp(&self.scores[b].time).then_with(|| a.cmp(b))
    }

    fn fastest<'p>(&self, points: impl Iterator<Item = &'p Point>) -> Option<Point> {
        points.filter(|point| self.is_allowed(point)).min_by(|a, b| self.compare(a, b)).cloned()
    }

    /// A point with one dial at each of its other values.
    fn turned(&self, point: &[usize], dial: usize) -> Vec<Point> {
        let others = (0..self.lengths[dial]).filter(|&value| value != point[dial]);
        let with = |value| {
            let mut turned = point.to_vec();
            turned[dial] = value;
            turned
        };
        others.map(with).collect()
    }

    /// Runs those that have not been run.
    fn run(&mut self, mut points: Vec<Point>) -> anyhow::Result<()> {
        points.retain(|point| !self.scores.contains_key(point));
        if !points.is_empty() {
            let scores = (self.measure)(&points)?;
            self.scores.extend(points.into_iter().zip(scores));
        }
        Ok(())
    }

    /// The combinations that are fastest within the allowed error, if times multiply and errors add up
    /// from a point on that was run with each dial at each value.
    fn guesses(&self, around: &Point) -> Vec<Point> {
        let start = self.scores[around];
        let mut partial = vec![(Vec::new(), start)];
        for dial in 0..self.lengths.len() {
            let alone = |value| {
                let mut point = around.clone();
                point[dial] = value;
                (value, self.scores[&point])
            };
            let values = (0..self.lengths[dial]).map(alone).filter(|&(value, alone)| {
                let gains = alone.time < start.time * (1.0 - LEAST_GAIN) || alone.error < start.error;
                value == around[dial] || gains
            });
            let values: Vec<_> = values.collect();
            let with = |point: &Point, score: &Score, &(value, alone): &(usize, Score)| {
                let time = score.time * alone.time / start.time;
                let error = score.error + alone.error - start.error;
                ([point.as_slice(), &[value]].concat(), Score { time, error })
            };
            let longer = partial
                .iter()
                .flat_map(|(point, score)| values.iter().map(move |value| with(point, score, value)));
            partial = promising(longer.collect());
        }
        let is_new = |point: &Point| !self.scores.contains_key(point);
        partial.retain(|(point, score)| score.error <= self.allowed && is_new(point));
        partial.sort_by(|a, b| a.1.time.total_cmp(&b.1.time).then_with(|| a.0.cmp(&b.0)));
        partial.into_iter().take(GUESSES).map(|(point, _)| point).collect()
    }
}

/// All of them, or only those that nothing beats in time and error if they are too many.
fn promising(all: Vec<(Point, Score)>) -> Vec<(Point, Score)> {
    if all.len() <= MOST_PARTIAL {
        return all;
    }
    let figures: Vec<_> = all.iter().map(|(_, score)| (score.time, score.error)).collect();
    front(&figures).into_iter().map(|n| all[n].clone()).collect()
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A made-up engine: each value of each dial saves a share of one of the parts that a frame's time is
    /// made of, and errs; dials that save of the same part get in each other's way, and so do errors,
    /// which overlap.
    struct Model {
        /// By part, of a frame.
        parts: Vec<f64>,
        /// By dial and value: the part, what is left of it, the error.
        dials: Vec<Vec<(usize, f64, f64)>>,
    }

    impl Model {
        fn new(seed: u64, lengths: &[usize]) -> Self {
            let mut dice = ChaCha8Rng::seed_from_u64(seed);
            let parts = (0..3).map(|_| dice.random_range(0.1..1.0)).collect();
            let mut dial = |&length: &usize| {
                let part = dice.random_range(0..3);
                let (mut left, mut error) = (1.0, 0.0);
                let mut values = vec![(part, left, error)];
                for _ in 1..length {
                    left *= dice.random_range(0.6..1.02);
                    // Some dials cost no accuracy at all.
                    error += if part == 2 { 0.0 } else { dice.random_range(0.0..5e-4) };
                    values.push((part, left, error));
                }
                values
            };
            Self { parts, dials: lengths.iter().map(&mut dial).collect() }
        }

        fn score(&self, point: &Point) -> Score {
            // Of each part: what is left if all save as they do alone, and if only the best one does.
            let mut left = vec![(1.0, 1.0); self.parts.len()];
            let mut right = 1.0;
            for (dial, &value) in self.dials.iter().zip(point) {
                let (part, alone, error) = dial[value];
                left[part] = (left[part].0 * alone, f64::min(left[part].1, alone));
                right *= 1.0 - error;
            }
            let time = |(part, (all, best)): (&f64, &(f64, f64))| part * f64::sqrt(all * best);
            let total: f64 = self.parts.iter().sum();
            Score { time: self.parts.iter().zip(&left).map(time).sum::<f64>() / total, error: 1.0 - right }
        }
    }

    fn grid(lengths: &[usize]) -> Vec<Point> {
        lengths.iter().fold(vec![Vec::new()], |points: Vec<Point>, &length| {
            points
                .iter()
                .flat_map(|point| (0..length).map(move |value| [point.as_slice(), &[value]].concat()))
                .collect()
        })
    }

    #[test]
    fn it_comes_within_five_percent_of_the_best_of_all_combinations() {
        let mut looked = 0;
        let mut all = 0;
        for seed in 0..200 {
            let lengths: &[usize] = match seed % 3 {
                0 => &[6, 4],
                1 => &[5, 4, 6, 3],
                _ => &[7, 4, 5, 3, 4],
            };
            let model = Model::new(seed, lengths);
            for allowed in [0.0, 2e-4, 1e-3, 5e-3] {
                let measure = |points: &[Point]| Ok(points.iter().map(|p| model.score(p)).collect());
                let mut finder = Finder::new(lengths, allowed, measure);
                let found = finder.find().expect("a model").expect("the base is exact");
                let score = model.score(&found);
                assert!(score.error <= allowed, "seed {seed}: {found:?} errs by {}", score.error);
                let within = grid(lengths).into_iter().map(|point| model.score(&point));
                let best = within.filter(|s| s.error <= allowed).map(|s| s.time).fold(1.0, f64::min);
                assert!(
                    score.time <= 1.05 * best,
                    "seed {seed}, {allowed}: {found:?} takes {}, and the best {best}",
                    score.time
                );
                looked += finder.scores.len();
                all += lengths.iter().product::<usize>();
            }
        }
        assert!(looked * 10 < all, "it ran {looked} of {all} combinations");
    }

    #[test]
    fn a_base_that_errs_too_much_leaves_nothing_to_find_unless_a_dial_mends_it() {
        let errs = |points: &[Point]| Ok(vec![Score { time: 1.0, error: 0.5 }; points.len()]);
        assert_eq!(Finder::new(&[3, 2], 0.1, errs).find().expect("a model"), None);
        let mends = |points: &[Point]| {
            let score =
                |p: &Point| Score { time: 1.0 + p[0] as f64, error: if p[0] == 0 { 0.5 } else { 0.0 } };
            Ok(points.iter().map(score).collect())
        };
        assert_eq!(Finder::new(&[3, 2], 0.1, mends).find().expect("a model"), Some(vec![1, 0]));
    }

    #[test]
    fn a_dial_that_gains_nothing_is_left_as_it_was() {
        // The second dial only helps while the first has not been turned.
        let measure = |points: &[Point]| {
            let time =
                |p: &Point| if p[0] == 1 { 0.5 - 0.001 * p[1] as f64 } else { 1.0 - 0.3 * p[1] as f64 };
            Ok(points.iter().map(|p| Score { time: time(p), error: 0.0 }).collect())
        };
        assert_eq!(Finder::new(&[2, 2], 0.0, measure).find().expect("a model"), Some(vec![1, 0]));
    }

    #[test]
    fn what_was_run_is_not_run_again() {
        let mut seen = std::collections::HashSet::new();
        let model = Model::new(5, &[5, 4, 3]);
        let measure = |points: &[Point]| {
            assert!(points.iter().all(|point| seen.insert(point.clone())), "{points:?}");
            Ok(points.iter().map(|p| model.score(p)).collect())
        };
        Finder::new(&[5, 4, 3], 1e-3, measure).find().expect("a model");
    }
}
