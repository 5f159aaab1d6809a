//! What is run in a world: dials one at a time, all combinations of some, and the search.

use tercet::PRESETS;

use crate::dials::{self, Setting, Space};
use crate::figures::Figures;
use crate::finder::{Finder, LEAST_GAIN, Point, Score};
use crate::outcome::{Found, Outcome, PRESET, Row, group};
use crate::runner::Runner;

/// How many of the fastest run once more, side by side, before one is named.
const CHECKED: usize = 4;

/// The dial whose error is of another kind: it is searched only when it is named.
const DETAIL: &str = "max_error_px";

/// What to run.
pub struct Search {
    /// What all others are compared with.
    pub base: Setting,
    /// The dials that are turned one at a time.
    singles: Space,
    /// The dials of which all combinations are run.
    grid: Option<Space>,
    /// The dials among which is searched, if anything is.
    searched: Space,
    /// Wrong samples that are allowed, of all.
    allowed: Option<f64>,
}

impl Search {
    /// Around a base: dials one at a time (all `usable`, if neither these nor a grid is named), all combinations of
    /// others, and the fastest within an allowed error.
    ///
    /// # Errors
    /// When a dial does not take a value.
    pub fn new(
        base: Setting,
        usable: &[&'static str],
        only: &[String],
        grid: &[String],
        allowed: Option<f64>,
    ) -> anyhow::Result<Self> {
        let all = only.is_empty() && grid.is_empty();
        let space = |wanted: &dyn Fn(&str) -> bool| {
            let keys: Vec<&'static str> = dials::names().filter(|key| wanted(key)).collect();
            Space::new(base.tradeoff, &keys)
        };
        let is_in = |list: &[String], key: &str| list.iter().any(|name| name == key);
        Ok(Self {
            singles: space(&|key| is_in(only, key) || all && usable.contains(&key))?,
            grid: if grid.is_empty() { None } else { Some(space(&|key| is_in(grid, key))?) },
            searched: match (grid, only) {
                ([], []) => space(&|key| key != DETAIL && usable.contains(&key))?,
                ([], only) => space(&|key| is_in(only, key))?,
                (grid, _) => space(&|key| is_in(grid, key))?,
            },
            allowed,
            base,
        })
    }

    /// Runs all of it in a world.
    ///
    /// # Errors
    /// When something cannot be run.
    pub fn run(&self, runner: &mut Runner<'_>) -> anyhow::Result<Outcome> {
        let mut rows = measured(runner, &self.singles, &self.singles.singles())?;
        let presets: Vec<Setting> = PRESETS.iter().map(|(_, preset)| Setting::new(*preset)).collect();
        let of_presets = runner.measure(&presets, 0)?;
        let preset = |(setting, figures)| Row { group: PRESET, setting, figures };
        rows.extend(presets.into_iter().zip(of_presets).map(preset));
        let combined = match &self.grid {
            Some(grid) => measured(runner, grid, &grid.grid())?,
            None => Vec::new(),
        };
        let found = match self.allowed {
            Some(allowed) => Some(self.find(runner, allowed, &combined, &mut rows)?),
            None => None,
        };
        rows.extend(combined);
        Ok(Outcome::new(runner.world(), runner.frames(), rows, found))
    }

    /// Searches, and puts what was looked at to the rows. `combined` is every combination, if all ran.
    fn find(
        &self,
        runner: &mut Runner<'_>,
        allowed: f64,
        combined: &[Row],
        rows: &mut Vec<Row>,
    ) -> anyhow::Result<Found> {
        let space = &self.searched;
        let lengths = space.lengths();
        let measure = |points: &[Point]| {
            let new = measured(runner, space, points)?;
            let scores = new.iter().map(|row| score(&row.figures)).collect();
            rows.extend(new);
            Ok(scores)
        };
        let mut finder = Finder::new(&lengths, allowed, measure);
        let found = finder.find()?;
        let (ranking, looked) = (finder.ranking(), finder.scores.len());
        let others = ranking.into_iter().filter(|point| found.as_ref() != Some(point)).take(CHECKED - 1);
        let checked = found.clone().into_iter().chain(others).map(|point| space.setting(&point));
        let mut settings = checked.collect::<anyhow::Result<Vec<_>>>()?;
        let own = settings.len();
        settings.extend(fastest(combined, allowed));
        // Noise has made the fastest look faster than they are, and which they are may be noise, too.
        let figures = runner.measure(&settings, 1)?;
        let all: Vec<(Setting, Figures)> = settings.into_iter().zip(figures).collect();
        let best = |checked: &[(Setting, Figures)]| {
            let within = || checked.iter().filter(|(_, figures)| figures.error() <= allowed);
            let fastest = within().map(|(_, figures)| figures.time_ratio).fold(f64::INFINITY, f64::min);
            let about = within().filter(|(_, figures)| figures.time_ratio <= fastest * (1.0 + LEAST_GAIN));
            about.min_by_key(|(setting, _)| setting.turned()).cloned()
        };
        Ok(Found {
            allowed,
            looked: (looked, lengths.iter().product()),
            best: best(&all[..own]),
            best_of_all: if combined.is_empty() { None } else { best(&all) },
        })
    }
}

/// Points with what came out.
fn measured(runner: &mut Runner<'_>, space: &Space, points: &[Point]) -> anyhow::Result<Vec<Row>> {
    let settings = points.iter().map(|point| space.setting(point)).collect::<anyhow::Result<Vec<_>>>()?;
    let figures = runner.measure(&settings, 0)?;
    let rows = points.iter().zip(settings).zip(figures);
    Ok(rows.map(|((point, setting), figures)| Row { group: group(space, point), setting, figures }).collect())
}

fn score(figures: &Figures) -> Score {
    Score { time: figures.time_ratio, error: figures.error() }
}

/// The fastest rows within an allowed error.
fn fastest(rows: &[Row], allowed: f64) -> impl Iterator<Item = Setting> {
    let mut within: Vec<&Row> = rows.iter().filter(|row| row.figures.error() <= allowed).collect();
    within.sort_by(|a, b| a.figures.time_ratio.total_cmp(&b.figures.time_ratio));
    within.into_iter().take(CHECKED).map(|row| row.setting.clone())
}
