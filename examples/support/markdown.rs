//! Pieces of the pages that programs write.

use std::fmt::Write;

use super::flags::Flags;
use super::lockstep::Measured;

/// What was typed to run this program, as it can be typed anywhere: without this machine's paths.
pub fn command(example: &str) -> String {
    command_of(example, std::env::args().skip(1))
}

/// How everything was drawn on the software backend.
pub fn setting(flags: &Flags) -> anyhow::Result<String> {
    setting_on(flags, None)
}

/// The same on a graphics adapter, if there is one.
pub fn setting_on(flags: &Flags, adapter: Option<&str>) -> anyhow::Result<String> {
    let (width, height) = flags.size;
    let detail = match flags.detail()?.max_error_px {
        0.0 => "every mesh with all its triangles".to_owned(),
        pixels => format!("levels of detail within {pixels} pixels"),
    };
    let backend = adapter.unwrap_or("the software backend");
    Ok(format!("{width} × {height}, {detail}, on {backend}"))
}

/// A table: a header, and rows of as many cells.
pub fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = format!("| {} |\n|{}\n", header.join(" | "), "---|".repeat(header.len()));
    for row in rows {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}

/// One figure over another, to two digits.
pub fn ratio(a: f64, b: f64) -> String {
    known((b > 0.0).then(|| format!("{:.2}", a / b)))
}

/// A share of 1 in percent.
pub fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// A figure, or a dash for one that was not measured.
pub fn known(figure: Option<String>) -> String {
    figure.unwrap_or_else(|| "–".to_owned())
}

/// A line on what was lost in all of some runs, as far as that is known.
pub fn lost<'a>(lanes: impl Iterator<Item = &'a Measured>) -> String {
    match lanes.map(|lane| lane.summary.false_culls).sum::<Option<u64>>() {
        Some(lost) => format!("- Objects wrongly culled in all runs: {lost}.\n"),
        None => {
            "- The visible sets are known with `--oracle`, which leaves the times as they are.\n".to_owned()
        }
    }
}

fn command_of(example: &str, mut arguments: impl Iterator<Item = String>) -> String {
    let mut line = format!("cargo run --release --example {example}");
    let mut separator = " -- ";
    while let Some(argument) = arguments.next() {
        if argument == "--out" {
            arguments.next();
        } else if !argument.starts_with("--out=") {
            line += separator;
            line += &argument;
            separator = " ";
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_has_no_paths() {
        let command = |line: &str| command_of("x", line.split_whitespace().map(str::to_owned));
        assert_eq!(command("--out /a"), "cargo run --release --example x");
        assert_eq!(
            command("--frames 6 --out /a -b --out=/c"),
            "cargo run --release --example x -- --frames 6 -b"
        );
    }

    #[test]
    fn a_table_has_a_rule_below_its_header() {
        let rows = [vec!["1".to_owned(), "2".to_owned()]];
        assert_eq!(table(&["a", "b"], rows), "| a | b |\n|---|---|\n| 1 | 2 |\n");
    }
}
