//! The figures as tables: `tradeoff.csv` and `tradeoff.md`.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use anyhow::Context;
use serde::Serialize;

use crate::figures::Figures;
use crate::outcome::{Found, Outcome, Row};
use crate::together;
use support::flags::Flags;
use support::markdown::{command, percent, setting, table};
use support::report::write_csv;
use support::table::count;

/// A line of `tradeoff.csv`. Shares are of 1; see [`Figures`].
#[derive(Debug, Serialize)]
struct CsvRow<'a> {
    world: &'a str,
    group: &'a str,
    setting: &'a str,
    frames: u32,
    median_ms: f64,
    time_ratio: f64,
    noise: f64,
    wrong_mean: f64,
    wrong_worst: f64,
    longest_run: u32,
    largest_lost: u32,
    lost: u64,
    detail_mean: f64,
    drawn: f64,
    exact: f64,
    extra: f64,
    queries: f64,
    triangles: f64,
    /// Whether no setting is both faster and more exact.
    error_front: bool,
    /// Whether no setting is both faster and draws less in vain.
    draws_front: bool,
}

/// Writes both files into a folder that exists.
pub fn write(out: &Path, flags: &Flags, base: &str, outcomes: &[Outcome]) -> anyhow::Result<()> {
    let rows = outcomes.iter().flat_map(|o| o.rows.iter().enumerate().map(|(n, row)| csv_row(o, n, row)));
    write_csv(&out.join("tradeoff.csv"), rows)?;
    let path = out.join("tradeoff.md");
    let page = page(flags, base, outcomes)?;
    fs::write(&path, page).with_context(|| format!("cannot write {}", path.display()))
}

fn csv_row<'a>(outcome: &'a Outcome, n: usize, row: &'a Row) -> CsvRow<'a> {
    let f = &row.figures;
    CsvRow {
        world: &outcome.world,
        group: row.group,
        setting: &row.setting.name,
        frames: outcome.frames,
        median_ms: f.median_ms,
        time_ratio: f.time_ratio,
        noise: f.noise,
        wrong_mean: f.wrong_mean,
        wrong_worst: f.wrong_worst,
        longest_run: f.longest_run,
        largest_lost: f.largest_lost,
        lost: f.lost,
        detail_mean: f.detail_mean,
        drawn: f.drawn,
        exact: f.exact,
        extra: f.extra,
        queries: f.queries,
        triangles: f.triangles,
        error_front: outcome.error_front.contains(&n),
        draws_front: outcome.draws_front.contains(&n),
    }
}

fn page(flags: &Flags, base: &str, outcomes: &[Outcome]) -> anyhow::Result<String> {
    let mut page = format!(
        "# Speed against accuracy\n\n`{}`\n\n\
         Policy {}, {}, seed {}. The base is `{base}`. Settings run a few at a time, frame by frame side by \
         side with two copies of the base, in an order that changes; *of base* is the median of the ratios to \
         the copies' times, so that batches compare. Times are this machine's.\n\n\
         Of each frame the exact visible set is known, at the level of detail that the setting draws. *Wrong* \
         is the share of samples that differ in depth from the same frame drawn whole, in the mean and in the \
         worst frame; *longest run* is for how many frames in a row one and the same object was wrongly \
         missing; *largest lost* is the largest object missing from any frame, in samples of the finished \
         frame. *Coarser* stands apart: the share of samples that show another object only because meshes are \
         drawn more coarsely than in the base. *In vain* are objects drawn beyond the exact set, over that \
         set. Bold are settings that none is both faster and more exact than (`wrong` and `coarser` \
         together); of time and objects drawn in vain, the same are marked *.\n",
        command("tradeoff"),
        flags.policy,
        setting(flags)?,
        flags.seed,
    );
    for outcome in outcomes {
        let _ = write!(
            page,
            "\n## {}\n\n{} frames; the base takes {:.2} ms (median), and draws {} objects where {} are visible. \
             Its copies differed by up to {} in time: smaller effects are noise.\n\n{}{}",
            outcome.world,
            outcome.frames,
            outcome.base().median_ms,
            count(outcome.base().drawn),
            count(outcome.base().exact),
            percent(outcome.noise()),
            settings(outcome),
            outcome.found.as_ref().map_or(String::new(), found),
        );
    }
    page += &together::section(outcomes);
    Ok(page)
}

fn settings(outcome: &Outcome) -> String {
    const HEADER: [&str; 11] = [
        "setting",
        "median ms",
        "of base",
        "wrong, mean",
        "worst",
        "longest run",
        "largest lost",
        "coarser",
        "in vain",
        "questions",
        "triangles",
    ];
    let rows = outcome.rows.iter().enumerate().map(|(n, row)| {
        let mark = if outcome.draws_front.contains(&n) { " *" } else { "" };
        let mut cells = vec![format!("{}{mark}", row.label())];
        cells.extend(figures(&row.figures));
        if outcome.error_front.contains(&n) {
            cells[0] = format!("**{}**{mark}", row.label());
        }
        cells
    });
    table(&HEADER, rows)
}

fn figures(f: &Figures) -> [String; 10] {
    [
        format!("{:.2}", f.median_ms),
        format!("{:.3}", f.time_ratio),
        share(f.wrong_mean),
        share(f.wrong_worst),
        f.longest_run.to_string(),
        count(f.largest_lost.into()),
        share(f.detail_mean),
        percent(f.extra_ratio()),
        count(f.queries),
        count(f.triangles),
    ]
}

/// What the search found, in words.
pub fn found(found: &Found) -> String {
    let allowed = share(found.allowed);
    let (looked, all) = found.looked;
    let Some((setting, figures)) = &found.best else {
        return format!("\nNo setting that was run stays within {allowed} wrong samples.\n");
    };
    let mut text = format!(
        "\nThe fastest setting found with at most {allowed} wrong samples in the mean frame: `{}`, in {:.3} of \
         the base's time with {} wrong. The search looked at {looked} of {} combinations, and ran the best of them \
         once more, side by side.\n",
        setting.name,
        figures.time_ratio,
        share(figures.error()),
        count(all as f64),
    );
    if let Some((best, of_best)) = &found.best_of_all {
        let _ = writeln!(
            text,
            "All combinations ran. The fastest of them is `{}`, in {:.3}: what the search found takes {:.1} % of \
             its time.",
            best.name,
            of_best.time_ratio,
            100.0 * figures.time_ratio / of_best.time_ratio,
        );
    }
    text
}

/// A share of 1 in percent, to three digits.
pub fn share(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        0.0 => "0".to_owned(),
        _ => {
            let digits = (2 - percent.log10().floor() as i32).clamp(0, 7);
            format!("{percent:.*} %", digits as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_have_three_digits_however_small() {
        let shares = [0.0, 1.0, 0.123_456, 1e-3, 4.321e-6, 1e-8];
        assert_eq!(shares.map(share), ["0", "100 %", "12.3 %", "0.100 %", "0.000432 %", "0.0000010 %"]);
    }
}
