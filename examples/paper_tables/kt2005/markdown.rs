//! `kt2005.md`: the table, to be read.

use std::fmt::Write;

use super::Outcome;
use super::rows::{self, seconds};
use super::scenes::Published;
use support::flags::Flags;
use support::lockstep::Measured;
use support::markdown::{command, known, percent, ratio, setting, table};
use support::table::count;

/// The whole page.
pub fn page(flags: &Flags, outcomes: &[Outcome]) -> anyhow::Result<String> {
    Ok(format!(
        "# Table 1 of Kovalčík and Tobola (2005), run again\n\n{}\n\n{COLUMNS}\n\n{}\n\
         ## More of the same runs\n\n{}\n{}",
        introduction(flags)?,
        comparison(outcomes),
        details(outcomes),
        notes(flags, outcomes)
    ))
}

const COLUMNS: &str = "\
*Time* is that of the whole flight: keeping up with the world, keeping the tree, culling and drawing, \
first frame included. *Drawn* and *queries* are means a frame. *Ratio* is new over old: below 1, the new \
algorithm needs less. The last column of each group is the paper's ratio.";

fn introduction(flags: &Flags) -> anyhow::Result<String> {
    let size = if flags.scale == 1.0 && flags.objects == 2500 {
        String::new()
    } else {
        format!(
            "**This run is not the paper's size**: scale {}, {} moving objects. ",
            flags.scale, flags.objects
        )
    };
    Ok(format!(
        "`{}`\n\n{size}The *new* algorithm (dual queries on a ternary tree, which the answers shape) against \
         the *old* one (statistically optimised queries on a binary tree) over {} frames a scene, \
         {}. Both fly through the same world at the same \
         time, frame by frame, and take turns in going first.",
        command("paper_tables"),
        flags.frames,
        setting(flags)?
    ))
}

/// The main table.
fn comparison(outcomes: &[Outcome]) -> String {
    const HEADER: [&str; 10] = [
        "scene",
        "time, s: new / old",
        "ratio",
        "paper",
        "drawn: new / old",
        "ratio",
        "paper",
        "queries: new / old",
        "ratio",
        "paper",
    ];
    let groups: [Group; 3] = [
        (seconds, |p| p.seconds, |x| format!("{x:.1}")),
        (|m| m.summary.drawn.mean, |p| p.drawn, count),
        (|m| m.summary.queries.mean, |p| p.queries, count),
    ];
    let row = |outcome: &Outcome| {
        let Outcome { scene, name, new, old } = outcome;
        let mut cells = vec![name.clone()];
        for (here, paper, words) in groups {
            let (a, b) = (here(new), here(old));
            cells.push(format!("{} / {}", words(a), words(b)));
            cells.push(format!("**{}**", ratio(a, b)));
            cells.push(ratio(paper(&scene.new), paper(&scene.old)));
        }
        cells
    };
    table(&HEADER, outcomes.iter().map(row))
}

/// What is measured, the same in the paper, and how it is written.
type Group = (fn(&Measured) -> f64, fn(&Published) -> f64, fn(f64) -> String);

/// The second table.
fn details(outcomes: &[Outcome]) -> String {
    const HEADER: [&str; 13] = [
        "scene",
        "algorithm",
        "objects",
        "median ms",
        "tree's share",
        "waves",
        "triangles drawn",
        "in the frustum",
        "box visible",
        "drawn / box visible",
        "really visible",
        "of the drawn",
        "wrongly culled",
    ];
    let row = |name: &str, algorithm: &str, measured: &Measured| {
        let s = &measured.summary;
        vec![
            name.to_owned(),
            algorithm.to_owned(),
            count(s.objects as f64),
            format!("{:.1}", s.frame_ms.median),
            percent(s.tree.maintenance_share),
            format!("{:.1}", s.waves.mean),
            count(s.drawn_triangles.mean),
            count(s.in_frustum.mean),
            known(s.box_visible.map(|m| count(m.mean))),
            known(s.box_visible.map(|m| ratio(s.drawn.mean, m.mean))),
            known(s.exact_visible.map(|m| count(m.mean))),
            known(s.exact_visible.map(|m| percent(m.mean / s.drawn.mean.max(1.0)))),
            known(s.false_culls.map(|n| n.to_string())),
        ]
    };
    let both = |o: &Outcome| [row(&o.name, rows::NEW, &o.new), row(&o.name, rows::OLD, &o.old)];
    table(&HEADER, outcomes.iter().flat_map(both))
}

fn notes(flags: &Flags, outcomes: &[Outcome]) -> String {
    let mut notes = "\
        - Times are those of this machine, which draws on the CPU; the paper's was an Athlon MP 2600+ with a \
        GeForce 6800 GT, so only ratios compare. Counts hardly depend on the machine: only \
        `n_skip=auto` and `leaf_size=costs` weigh the times seen.\n\
        - *Tree's share* is the time for placing, refitting, splitting and merging over all time (the paper: \
        0.2 % to nearly 30 %). *Waves* are the times that a frame waits for answers.\n\
        - The paper's power plant is the one of the University of North Carolina; ours is generated, with as \
        many objects and about as many triangles. The bunny is the paper's.\n\
        - Old and new share the dials of the tree, but for the binary tree's straddlers, which stay in their \
        parent. The old one skips a visible node's question for at most 8 frames: our rule, for the text gives \
        none.\n"
        .to_owned();
    if flags.oracle {
        let lost: u64 =
            outcomes.iter().flat_map(|o| [&o.new, &o.old]).filter_map(|m| m.summary.false_culls).sum();
        let _ = writeln!(
            notes,
            "- *Box visible* are the objects whose own box would be found visible, the least that asking about \
             boxes can draw; *really visible* those that own a pixel. Objects wrongly culled in all runs: {lost}."
        );
    } else {
        notes.push_str("- The visible sets are known with `--oracle`, which leaves the times as they are.\n");
    }
    notes
}
