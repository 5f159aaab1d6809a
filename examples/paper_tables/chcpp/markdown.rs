//! `chcpp.md`: the tables, to be read.

use std::fmt::Write;

use super::Outcome;
use super::algorithms::{ALGORITHMS, OPT, VFC};
use super::claims::{CLAIMS, Claim};
use super::shading::{self, Shaded};
use support::flags::Flags;
use support::markdown::{command, known, lost, setting, table};
use support::table::count;

/// The whole page.
pub fn page(flags: &Flags, outcomes: &[Outcome], shaded: &[Shaded]) -> anyhow::Result<String> {
    let mut page = format!(
        "# The comparison of CHC++ (Mattausch, Bittner and Wimmer 2008), run again\n\n{}\n\n\
         ## Beside the paper\n\n{}\n{COLUMNS}\n",
        introduction(flags, outcomes)?,
        claims(outcomes)
    );
    for outcome in outcomes {
        let _ = write!(page, "\n## {}\n\n{}\n\n{}", outcome.name, seen(outcome), algorithms(outcome));
    }
    page += "\n";
    page += NOTES;
    page += &lost(outcomes.iter().flat_map(|outcome| &outcome.lanes));
    page += &shading::section(shaded);
    Ok(page)
}

fn introduction(flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<String> {
    let objects = outcomes.first().map_or(0, |outcome| outcome.lanes[VFC].summary.objects);
    Ok(format!(
        "`{}`\n\nThe city at scale {} ({} objects), {} frames a scene, {}. All algorithms go the same way at \
         the same time, frame by frame, in an order that changes; each keeps a tree of its own, with the same \
         dials. `n_av` is 10 for CHC and CHC++ alike, `b` 50, `d_max` 3, `s_max` 1.4.",
        command("paper_tables"),
        flags.scale,
        count(objects as f64),
        flags.frames,
        setting(flags)?
    ))
}

const COLUMNS: &str = "\
*Median ms* is a frame's time: keeping the tree, culling and drawing. *Of OPT* is the median of the ratios \
frame by frame; OPT draws what stop-and-wait on its tree found visible beforehand, and asks nothing. The \
other columns are means a frame: objects drawn, questions, changes between drawing and asking (and back), \
times that a frame waited for answers, questions about several nodes, and those of them that found \
something visible and were asked again node by node. *Wrongly culled* is the total of all frames.";

const NOTES: &str = "\
- VFC is view-frustum culling; B are batches, R is randomised sampling, TB tight bounding volumes, MQ \
multiqueries, each with all before it, by the published rules; G is what is ours: guesses about what comes \
into view, and large multiqueries that fail repeated in groups.
- Times are those of this machine, which draws and answers on the CPU, where answers come at once and \
there is little waiting to be filled. The paper's figures come from a GPU; questions and state changes \
compare, times much less.
- OPT's set is found outside the clock, just before its frame and on its tree, which is then warm in the \
caches.
- The paper's scenes are Vienna, Pompeii and a power plant.
- Shader complexity (the paper draws with up to 40 look-ups a pixel) is run with `--backend wgpu`.
- *Box visible* are the objects whose own box would be found visible; *really visible* those that own a \
pixel.
";

/// The paper's figures and ours.
fn claims(outcomes: &[Outcome]) -> String {
    let header: Vec<&str> = ["", "paper"].into_iter().chain(outcomes.iter().map(|o| o.name)).collect();
    let row = |claim: &Claim| {
        let here = outcomes.iter().map(|o| known(claim.here(o).map(|x| format!("**{x:.2}**"))));
        [claim.what.to_owned(), claim.paper.to_owned()].into_iter().chain(here).collect()
    };
    table(&header, CLAIMS.iter().map(row))
}

/// What there was to see.
fn seen(outcome: &Outcome) -> String {
    let s = &outcome.lanes[VFC].summary;
    format!(
        "In the frustum: {}; box visible: {}; really visible: {}.",
        count(s.in_frustum.mean),
        known(s.box_visible.map(|m| count(m.mean))),
        known(s.exact_visible.map(|m| count(m.mean)))
    )
}

/// A scene, algorithm by algorithm.
fn algorithms(outcome: &Outcome) -> String {
    const HEADER: [&str; 10] = [
        "algorithm",
        "median ms",
        "of OPT",
        "drawn",
        "questions",
        "state changes",
        "waits",
        "multiqueries",
        "failed",
        "wrongly culled",
    ];
    let rows = ALGORITHMS.iter().zip(&outcome.lanes).map(|(algorithm, lane)| {
        let s = &lane.summary;
        vec![
            algorithm.name.to_owned(),
            format!("{:.2}", s.frame_ms.median),
            format!("{:.2}", lane.time_over(outcome.lanes[OPT].times())),
            count(s.drawn.mean),
            count(s.queries.mean),
            format!("{:.1}", s.state_changes.mean),
            format!("{:.1}", s.waves.mean),
            known(lane.counter("multiqueries").map(|x| format!("{x:.1}"))),
            known(lane.counter("failed_multiqueries").map(|x| format!("{x:.1}"))),
            known(s.false_culls.map(|n| n.to_string())),
        ]
    });
    table(&HEADER, rows)
}
