//! Tables: printed for people, and written for programs.

use std::fs::File;
use std::path::Path;

use crate::measure::Row;

/// A frame at 60 Hz, in seconds: what shares are of.
const FRAME: f64 = 1.0 / 60.0;

/// A table that is printed row by row, and written beside.
pub struct Table(csv::Writer<File>);

impl Table {
    pub fn new(path: &Path, names: &[&str]) -> anyhow::Result<Self> {
        let mut csv = csv::Writer::from_path(path)?;
        csv.write_record(names)?;
        println!("\n| {} |\n|{}", names.join(" | "), "---|".repeat(names.len()));
        Ok(Self(csv))
    }

    pub fn add(&mut self, cells: Vec<String>) -> anyhow::Result<()> {
        println!("| {} |", cells.join(" | "));
        self.0.write_record(cells)?;
        Ok(self.0.flush()?)
    }
}

/// The columns by number of objects.
pub const BY_NUMBER: [&str; 16] = [
    "objects",
    "moving",
    "update, µs",
    "/ write",
    "/ copy",
    "/ scan",
    "ns a mover",
    "/ reads",
    "% of a frame",
    "worst / median",
    "last / first",
    "wide / scan",
    "mid / scan",
    "near / scan",
    "tree B/object",
    "scene B/object",
];

/// What stands in them.
pub fn by_number(row: &Row) -> Vec<String> {
    let mut cells = vec![row.case.count.to_string(), row.case.moving.to_string()];
    cells.extend(update(row));
    cells.extend([row.worst_update / row.update, row.ageing].map(|ratio| format!("{ratio:.2}")));
    cells.extend((0..3).map(|i| format!("{:.2}", row.query[i] / row.scan[i])));
    cells.extend([row.tree_bytes, row.scene_bytes].map(|bytes| format!("{bytes:.0}")));
    cells
}

/// The columns by manner of moving.
pub const BY_MANNER: [&str; 15] = [
    "manner",
    "objects",
    "update, µs",
    "/ write",
    "/ copy",
    "/ scan",
    "ns a mover",
    "/ reads",
    "% of a frame",
    "straddling, %",
    "movers leaving, %",
    "wide / scan",
    "mid / scan",
    "near / scan",
    "tree B/object",
];

/// What stands in them.
pub fn by_manner(row: &Row) -> Vec<String> {
    let mut cells = vec![row.case.name.clone(), row.case.count.to_string()];
    cells.extend(update(row));
    cells.extend([format!("{:.0}", 100.0 * row.straddling), format!("{:.2}", 100.0 * row.leaving)]);
    cells.extend((0..3).map(|i| format!("{:.2}", row.query[i] / row.scan[i])));
    cells.push(format!("{:.0}", row.tree_bytes));
    cells
}

fn update(row: &Row) -> [String; 7] {
    let over = |what: f64| format!("{:.2}", row.update / what);
    let moved = |text: String| if row.case.moving > 0.0 { text } else { "–".to_owned() };
    [
        format!("{:.1}", row.update * 1e6),
        moved(over(row.write)),
        over(row.copy),
        over(row.scan[0]),
        moved(format!("{:.1}", row.update * 1e9 / (row.case.count as f64 * row.case.moving))),
        moved(over(row.reads)),
        format!("{:.3}", 100.0 * row.update / FRAME),
    ]
}
