//! What was found in one world.

use tercet::{PRESETS, Tradeoff};

use crate::dials::{Setting, Space};
use crate::figures::Figures;
use crate::pareto::front;

/// A setting that was run.
pub struct Row {
    /// Why: a dial's name, or one of the constants below.
    pub group: &'static str,
    /// What was run.
    pub setting: Setting,
    /// What came out.
    pub figures: Figures,
}

/// The group of the setting that all others are compared with.
pub const BASE: &str = "base";
/// The group of presets that are no dial alone.
pub const PRESET: &str = "preset";
/// The group of combinations.
pub const COMBINED: &str = "combination";

/// A world, and all settings that were run in it.
pub struct Outcome {
    /// Its name.
    pub world: String,
    /// How many frames were run.
    pub frames: u32,
    /// Each setting once, the base first.
    pub rows: Vec<Row>,
    /// The indices of rows that none is both faster and more exact than.
    pub error_front: Vec<usize>,
    /// The indices of rows that none is both faster and draws less in vain than.
    pub draws_front: Vec<usize>,
    /// The search's result, if one was asked for.
    pub found: Option<Found>,
}

/// What the search came to. Times are those of its last batch, in which the best ran once more.
pub struct Found {
    /// Wrong samples that were allowed, of all.
    pub allowed: f64,
    /// How many settings it looked at, and of how many.
    pub looked: (usize, usize),
    /// The fastest within what is allowed, and its figures; None if nothing is.
    pub best: Option<(Setting, Figures)>,
    /// The fastest of every combination, where all ran, likewise.
    pub best_of_all: Option<(Setting, Figures)>,
}

impl Row {
    /// The setting's name, with that of the preset that it is.
    pub fn label(&self) -> String {
        match preset(&self.setting.tradeoff) {
            Some(preset) if preset != self.setting.name => format!("{} ({preset})", self.setting.name),
            _ => self.setting.name.clone(),
        }
    }
}

impl Outcome {
    /// Settings with their figures, each with its group.
    pub fn new(world: String, frames: u32, all: Vec<Row>, found: Option<Found>) -> Self {
        let mut rows: Vec<Row> = Vec::new();
        for row in all {
            if rows.iter().all(|known| known.setting != row.setting) {
                rows.push(row);
            }
        }
        let by = |figure: fn(&Figures) -> f64| {
            let points: Vec<_> =
                rows.iter().map(|row| (row.figures.time_ratio, figure(&row.figures))).collect();
            front(&points)
        };
        let (error_front, draws_front) = (by(Figures::error), by(Figures::extra_ratio));
        Self { world, frames, rows, error_front, draws_front, found }
    }

    /// The base's figures.
    pub fn base(&self) -> &Figures {
        &self.rows[0].figures
    }

    /// By how much two copies of the base ever differed in time.
    pub fn noise(&self) -> f64 {
        self.rows.iter().map(|row| row.figures.noise).fold(0.0, f64::max)
    }
}

/// The group of a point: the dial, where one alone is turned.
pub fn group(space: &Space, point: &[usize]) -> &'static str {
    let mut turned = space.sweeps.iter().zip(point).filter(|(_, value)| **value != 0);
    match (turned.next(), turned.next()) {
        (None, _) => BASE,
        (Some((sweep, _)), None) => sweep.key,
        _ => COMBINED,
    }
}

/// The name of a preset.
fn preset(tradeoff: &Tradeoff) -> Option<&'static str> {
    PRESETS.iter().find(|(_, preset)| preset == tradeoff).map(|(name, _)| *name)
}
