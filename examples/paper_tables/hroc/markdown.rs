//! `hroc.md`: the tables, to be read.

use std::fmt::Write;

use super::algorithms::{self, ALGORITHMS, AUTO, FILTERED, HI_Z, HROC, HYBRID, ROC, VFC};
use super::{Outcome, adapter};
use support::flags::Flags;
use support::markdown::{command, known, lost, percent, setting_on, table};
use support::table::count;

/// The whole page.
pub fn page(flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<String> {
    let mut page = format!(
        "# The comparison of hierarchical raster occlusion culling (Lee et al. 2021), run again\n\n\
         `{}`\n\nWorlds at scale {}, {} frames a scene, {}. All algorithms go the same way at the same time, \
         frame by frame, in an order that changes; each keeps a tree of its own, with the same dials.\n\n\
         ## Time over REF\n\n{}\n\
         The time of drawing the exact visible set alone is 1; in brackets the paper's, on a GPU.\n\n\
         ## Culled of what is hidden inside the frustum\n\n{}\n{}\
         ## Against the best of its kind\n\n{}\n{COLUMNS}\n",
        command("paper_tables"),
        flags.scale,
        flags.frames,
        setting_on(flags, adapter(outcomes))?,
        by_scene(outcomes, |outcome, n| {
            let paper = outcome.scene.published.and_then(|p| p.time_over_ref(n));
            let paper = paper.map_or(String::new(), |x| format!(" ({x:.1})"));
            format!("{:.2}{paper}", outcome.time_over_ref(n))
        }),
        by_scene(outcomes, |outcome, n| percent(outcome.culled_of_hidden(n))),
        at_best(outcomes),
        best(outcomes),
    );
    for outcome in outcomes {
        let _ = write!(page, "\n## {}\n\n{}\n\n{}", heading(outcome), seen(outcome), algorithms(outcome));
    }
    page += "\n";
    page += NOTES;
    page += if adapter(outcomes).is_some() { ON_A_DEVICE } else { ON_THE_CPU };
    page += &lost(outcomes.iter().flat_map(|outcome| &outcome.lanes));
    Ok(page)
}

const COLUMNS: &str = "\
*Median ms* is a frame's time: keeping the tree, culling and drawing. *Of REF* is the median of the ratios \
frame by frame. *C/R* is the share of the objects that REF leaves out; *of hidden* the same of the objects \
inside the frustum. *Triangles* are those drawn over REF's. *Wrongly culled* is the total of all frames.";

const NOTES: &str = "\
- NOC draws everything, VFC what meets the view frustum, REF the exact visible set, found beforehand. OF is \
occluder filtering: only what showed is drawn first in the next frame.
- The share of hidden objects is taken from what REF draws, which is exact.
";

const ON_THE_CPU: &str = "\
- All but HROC without a filter draw only what shows by its geometry (`by_geometry`): an object counts as drawn \
if a sample of it passes the depth test behind all before it. *Triangles* are all that went to the rasteriser, \
those of objects that were left out included. HROC without a filter goes by boxes alone, as published.
- All of this is the CPU's own: rasterising, sweeping and drawing. The paper's figures are of a GPU, where the \
sweep is nearly free and drawing is not; its worlds are not ours either.
";

const ON_A_DEVICE: &str = "\
- What is tested is boxes: by their rasterised proxies, by rays, or by a map of farthest depths. Filtering \
reads an item buffer: what was drawn and owns no sample in the end counts as left out. Its triangles were drawn all \
the same, and *triangles* has them; before anything of it is drawn, boxes cull what the row HROC says. What is GPU-driven is culled by the device alone: nothing comes back, and every \
frame draws twice at least.
- A frame's time ends when the device has finished. Drawing, sweeping and culling are in it. The paper's \
worlds are not ours.
";

fn heading(outcome: &Outcome) -> String {
    match outcome.scene.published {
        Some(published) => format!("{} (the paper's {})", outcome.scene.name, published.scene),
        None => outcome.scene.name.to_owned(),
    }
}

/// A row an algorithm, a column a scene.
fn by_scene(outcomes: &[Outcome], cell: impl Fn(&Outcome, usize) -> String) -> String {
    let header: Vec<&str> = std::iter::once("").chain(outcomes.iter().map(|o| o.scene.name)).collect();
    let rows = super::algorithms(outcomes).enumerate().map(|(n, algorithm)| {
        let cells = outcomes.iter().map(|outcome| cell(outcome, n));
        std::iter::once(algorithm.name.to_owned()).chain(cells).collect()
    });
    table(&header, rows)
}

/// What there is to win by asking about boxes alone.
fn at_best(outcomes: &[Outcome]) -> String {
    let known = |outcome: &Outcome| {
        Some(format!("{} {}", outcome.scene.name, percent(outcome.boxes_cull_of_hidden()?)))
    };
    let all: Option<Vec<String>> = outcomes.iter().map(known).collect();
    let text = |all: Vec<String>| {
        format!(
            "Some objects are hidden though their boxes are not. Whoever asks about the boxes of objects alone \
             culls at best: {}.\n\n",
            all.join(", ")
        )
    };
    all.map_or(String::new(), text)
}

/// How hybrid and auto do beside what they choose from: the better of two, and the best of all.
fn best(outcomes: &[Outcome]) -> String {
    let header: Vec<&str> =
        std::iter::once("time over").chain(outcomes.iter().map(|o| o.scene.name)).collect();
    let row = |what: &str, of: usize, among: &[usize]| {
        let cell = |outcome: &Outcome| {
            let rivals = among.iter().map(|&n| outcome.lanes[of].time_over(outcome.lanes[n].times()));
            format!("{:.2}", rivals.fold(0.0, f64::max))
        };
        std::iter::once(what.to_owned()).chain(outcomes.iter().map(cell)).collect()
    };
    let fixed: Vec<usize> = (VFC..AUTO).chain(AUTO + 1..ALGORITHMS.len() - 1).collect();
    let rows = [
        row("hybrid / the better of ROC and HROC OF", HYBRID, &[ROC, FILTERED]),
        row("auto / the best fixed policy", AUTO, &fixed),
        row("HROC OF / HROC", FILTERED, &[HROC]),
        row("HROC OF / Hi-Z", FILTERED, &[HI_Z]),
    ];
    table(&header, rows)
}

/// What there was to see.
fn seen(outcome: &Outcome) -> String {
    let s = &outcome.lanes[VFC].summary;
    format!(
        "{} objects of {} triangles; in the frustum {}; really visible {}.",
        count(s.objects as f64),
        count(s.triangles as f64),
        count(s.in_frustum.mean),
        count(outcome.visible())
    )
}

/// A scene, algorithm by algorithm.
fn algorithms(outcome: &Outcome) -> String {
    const HEADER: [&str; 9] = [
        "algorithm",
        "median ms",
        "of REF",
        "drawn",
        "C/R",
        "C/R, paper",
        "of hidden",
        "triangles",
        "wrongly culled",
    ];
    let rows = algorithms::all().zip(&outcome.lanes).enumerate().map(|(n, (algorithm, lane))| {
        let s = &lane.summary;
        let paper = outcome.scene.published.and_then(|p| p.culled(n));
        vec![
            algorithm.name.to_owned(),
            format!("{:.2}", s.frame_ms.median),
            format!("{:.2}", outcome.time_over_ref(n)),
            count(s.drawn.mean),
            format!("{:.3}", outcome.culled(n)),
            known(paper.map(|x| format!("{x:.2}"))),
            percent(outcome.culled_of_hidden(n)),
            format!("{:.2}", outcome.overdraw(n)),
            known(s.false_culls.map(|n| n.to_string())),
        ]
    });
    table(&HEADER, rows)
}
