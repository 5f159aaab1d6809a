//! Settings that ran in all worlds, judged by all of them: what presets are chosen from.

use std::fmt::Write;

use crate::figures::Figures;
use crate::outcome::{Outcome, Row};
use crate::pareto::front;
use crate::report::share;
use support::markdown::{percent, table};
use support::table::count;

/// A setting's figures in all worlds.
struct Together<'a> {
    row: &'a Row,
    figures: Vec<&'a Figures>,
}

impl Together<'_> {
    /// The geometric mean of its times over the base's.
    fn time(&self) -> f64 {
        let logs: f64 = self.figures.iter().map(|figures| figures.time_ratio.ln()).sum();
        (logs / self.figures.len() as f64).exp()
    }

    /// A figure in the world where it is the greatest.
    fn most(&self, figure: impl Fn(&Figures) -> f64) -> f64 {
        self.figures.iter().map(|figures| figure(figures)).fold(0.0, f64::max)
    }
}

/// A section with a table; nothing for a single world.
pub fn section(outcomes: &[Outcome]) -> String {
    let [first, others @ ..] = outcomes else { return String::new() };
    if others.is_empty() {
        return String::new();
    }
    let of =
        |row: &Row, outcome: &'_ Outcome| outcome.rows.iter().position(|other| other.setting == row.setting);
    let in_all = |row| {
        let places: Vec<usize> = outcomes.iter().map(|outcome| of(row, outcome)).collect::<Option<_>>()?;
        let figures = outcomes.iter().zip(places).map(|(outcome, n)| &outcome.rows[n].figures);
        Some(Together { row, figures: figures.collect() })
    };
    let all: Vec<Together<'_>> = first.rows.iter().filter_map(in_all).collect();
    let points: Vec<_> = all.iter().map(|setting| (setting.time(), setting.most(Figures::error))).collect();
    let unbeaten = front(&points);
    let cells = |(n, setting): (usize, &Together<'_>)| {
        let label = setting.row.label();
        vec![
            if unbeaten.contains(&n) { format!("**{label}**") } else { label },
            format!("{:.3}", setting.time()),
            format!("{:.3}", setting.most(|figures| figures.time_ratio)),
            share(setting.most(|figures| figures.wrong_mean)),
            share(setting.most(|figures| figures.wrong_worst)),
            count(setting.most(|figures| figures.longest_run.into())),
            count(setting.most(|figures| figures.largest_lost.into())),
            share(setting.most(|figures| figures.detail_mean)),
            percent(setting.most(Figures::extra_ratio)),
        ]
    };
    const HEADER: [&str; 9] = [
        "setting",
        "of base",
        "at worst",
        "wrong, mean",
        "worst",
        "longest run",
        "largest lost",
        "coarser",
        "in vain",
    ];
    let mut text =
        "\n## All worlds together\n\n*Of base* is the geometric mean of the worlds; every other figure is \
                    that of the world where it is the worst.\n\n"
            .to_owned();
    let _ = write!(text, "{}", table(&HEADER, all.iter().enumerate().map(cells)));
    text
}

#[cfg(test)]
mod tests {
    use tercet::Tradeoff;

    use super::*;
    use crate::dials::Setting;
    use crate::outcome::BASE;

    fn world(times: &[(u32, f64, f64)]) -> Outcome {
        let row = |&(visible_pixels, time_ratio, wrong_mean): &(u32, f64, f64)| Row {
            group: BASE,
            setting: Setting::new(Tradeoff { visible_pixels, ..Tradeoff::EXACT }),
            figures: Figures { time_ratio, wrong_mean, ..Figures::default() },
        };
        Outcome::new(String::new(), 1, times.iter().map(row).collect(), None)
    }

    #[test]
    fn a_setting_is_as_wrong_as_in_its_worst_world_and_must_have_run_in_all() {
        let worlds = [
            world(&[(0, 1.0, 0.0), (7, 0.5, 0.01), (9, 0.9, 0.0)]),
            world(&[(0, 1.0, 0.0), (7, 0.32, 0.001)]),
        ];
        let text = section(&worlds);
        assert!(text.contains("| **visible_pixels=7** | 0.400 | 0.500 | 1.00 % |"), "{text}");
        assert!(!text.contains("visible_pixels=9"), "{text}");
        assert_eq!(section(&worlds[..1]), "");
    }
}
