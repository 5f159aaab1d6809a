//! The section of `chcpp.md`.

use std::fmt::Write;

use super::{COMPARED, PART, Shaded};
use crate::chcpp::algorithms::ALGORITHMS;
use support::lockstep::Measured;
use support::markdown::{known, lost, table};
use support::table::count;

/// A heading, a table of times, and what they are of.
pub fn section(all: &[Shaded]) -> String {
    let Some(first) = all.first().and_then(|shaded| shaded.lanes.first()) else { return String::new() };
    let summary = &first.summary;
    let mut text = format!(
        "\n## Shader complexity\n\nThe first part of the way at street level (one in {PART}, {} frames), drawn and asked \
         by {}, with so many texture look-ups a fragment. Each look-up says where the next one is. In the table: \
         median milliseconds of a frame, from sync until the device has finished; its time over VFC's, the median \
         of the ratios frame by frame; and, where the device has a clock, the median milliseconds of the app's draws \
         by it.\n\n",
        summary.frames,
        summary.adapter.as_deref().unwrap_or("the GPU")
    );
    let names = COMPARED.iter().map(|&n| ALGORITHMS[n].name);
    let header: Vec<&str> = ["look-ups", ""].into_iter().chain(names).collect();
    text += &table(&header, all.iter().flat_map(rows));
    let drawn: Vec<String> = all
        .iter()
        .take(1)
        .flat_map(Shaded::by_algorithm)
        .map(|(algorithm, lane)| format!("{} {}", algorithm.name, count(lane.summary.drawn.mean)))
        .collect();
    let _ = write!(text, "\nObjects drawn, mean a frame: {}.\n\n", drawn.join(", "));
    text += "\
- The paper says that its figures hardly depend on what a fragment costs: depth alone, a plain shader, or \
one with 40 look-ups.
- The depth test spares hidden fragments behind what was drawn before, so what VFC shades in vain depends on \
its order of drawing.
";
    text += &lost(all.iter().flat_map(|shaded| &shaded.lanes));
    text
}

/// Three lines a number of look-ups.
fn rows(shaded: &Shaded) -> [Vec<String>; 3] {
    let line = |first: String, what: &str, cells: Vec<String>| [vec![first, what.to_owned()], cells].concat();
    let each = |cell: &dyn Fn(&Measured) -> String| shaded.lanes.iter().map(cell).collect::<Vec<_>>();
    [
        line(
            format!("**{}**", shaded.look_ups),
            "median ms",
            each(&|lane| format!("{:.2}", lane.summary.frame_ms.median)),
        ),
        line(String::new(), "of VFC", each(&|lane| format!("{:.2}", shaded.over_vfc(lane)))),
        line(
            String::new(),
            "drawing on the device",
            each(&|lane| known(lane.device_draw_ms().map(|ms| format!("{ms:.2}")))),
        ),
    ]
}
