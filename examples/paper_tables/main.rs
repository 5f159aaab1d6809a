//! The tables of the papers, run again: the same comparisons, on our worlds and machines.
//!
//! ```text
//! cargo run --release --example paper_tables -- --table kt2005
//! cargo run --release --example paper_tables -- --table kt2005 --frames 120 --oracle
//! cargo run --release --example paper_tables -- --help
//! ```

mod kt2005;
#[path = "../support/mod.rs"]
pub mod support;

use clap::{Args, ValueEnum};
use support::flags::Flags;
use support::program::Program;

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Choice {
    /// Whose table
    #[arg(long, value_enum)]
    table: Table,
}

/// A published table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Table {
    /// Kovalčík and Tobola 2005, table 1: dual queries on the ternary tree against their predecessor
    Kt2005,
}

const PROGRAM: Program = Program {
    name: "paper_tables",
    about: "Runs the comparison of a published table again, and sets our figures beside the paper's.",
    examples: &[
        ("--table kt2005", "five scenes at full size and detail, 120 frames each"),
        ("--table kt2005 --oracle", "with the exact visible set of every frame: slower, same timings"),
        ("--table kt2005 --set max_error_px=1", "with levels of detail, which the paper did not have"),
        ("--table kt2005 --scale 0.1 --objects 250 --frames 30", "a look in a minute"),
        ("--table kt2005 --set n_skip=4", "a dial of the new algorithm; those of the tree are for both"),
    ],
    frames: "120",
    full_detail: true,
    refused: &[
        ("backend", "--backend has no meaning here: all lanes run on the software backend"),
        ("policy", "--policy has no meaning here: the table says which algorithms run"),
        ("still", "--static has no meaning here: the table says what moves"),
    ],
};

fn main() -> anyhow::Result<()> {
    let (flags, choice) = Flags::parse_for::<Choice>(&PROGRAM);
    match choice.table {
        Table::Kt2005 => kt2005::run(&flags),
    }
}
