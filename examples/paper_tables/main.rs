//! The tables of the papers, run again: the same comparisons, on our worlds and machines.
//!
//! ```text
//! cargo run --release --example paper_tables -- --table kt2005
//! cargo run --release --example paper_tables -- --table chcpp --oracle
//! cargo run --release --example paper_tables -- --table chcpp --backend wgpu
//! cargo run --release --example paper_tables -- --table bh2001
//! cargo run --release --example paper_tables -- --table hroc --oracle
//! cargo run --release --example paper_tables -- --table hroc --backend wgpu
//! cargo run --release --example paper_tables -- --help
//! ```

mod algorithm;
mod bh2001;
mod chcpp;
mod frames;
mod hroc;
mod kt2005;
mod output;

use anyhow::ensure;
use clap::{Args, ValueEnum};

use support::flags::{Backend, Flags};
use support::program::Program;

/// What the command line says beside the shared flags.
#[derive(Args)]
struct Choice {
    /// Whose table
    #[arg(long, value_enum)]
    table: Table,
}

/// A published table, or what stands in a paper's text and plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Table {
    /// Kovalčík and Tobola 2005, table 1: dual queries on the ternary tree against their predecessor
    Kt2005,
    /// Bittner and Havran 2001: questions saved by coherence, against speed and p_skip; a tenth of
    /// the worlds by default
    Bh2001,
    /// Mattausch et al. 2008: CHC++ and its parts against CHC, VFC and OPT in the city; a quarter of
    /// it by default; with --backend wgpu, and shaders of 0, 1 and 40 texture look-ups on the GPU
    Chcpp,
    /// Lee et al. 2021: raster occlusion with and without a hierarchy, in worlds after the paper's; a
    /// quarter of each by default; with --backend wgpu, on the GPU
    Hroc,
}

const PROGRAM: Program = Program {
    name: "paper_tables",
    about: "Runs the comparison of a published table again, and sets our figures beside the paper's.",
    examples: &[
        ("--table kt2005", "five scenes at full size and detail, 120 frames each"),
        ("--table bh2001", "the hierarchy family through a tenth of the plant and of the city"),
        (
            "--table chcpp --oracle",
            "CHC++ through a quarter of the city, checked against the exact visible set",
        ),
        (
            "--table chcpp --backend wgpu",
            "with shaders of 0, 1 and 40 texture look-ups on the GPU as well; needs a graphics adapter",
        ),
        ("--table hroc", "raster occlusion in six worlds, against everything else that there is"),
        (
            "--table hroc --backend wgpu --scale 0.05 --frames 24 --size 640x360",
            "the same on the GPU, small enough for a CPU that plays its part",
        ),
        ("--table kt2005 --oracle", "with the exact visible set of every frame: slower, same timings"),
        ("--table kt2005 --set max_error_px=1", "with levels of detail, which the paper did not have"),
        ("--table kt2005 --scale 0.1 --objects 250 --frames 30", "a look in a minute"),
        ("--table kt2005 --set n_skip=4", "a dial of the new algorithm; those of the tree are for both"),
    ],
    frames: "120",
    policy: "dual-query",
    full_detail: true,
    gate: false,
    policies: &["hierarchy-a", "hierarchy-b", "hierarchy-c", "hierarchy-d", "chc", "chc++", "nohc"],
    refused: &[
        ("audit", "--audit has no meaning here: --oracle checks every frame"),
        ("policy", "--policy has no meaning here: the table says which algorithms run"),
        ("still", "--static has no meaning here: the table says what moves"),
    ],
};

fn main() -> anyhow::Result<()> {
    let (flags, choice) = Flags::parse_for::<Choice>(&PROGRAM);
    let has_gpu_lanes = matches!(choice.table, Table::Chcpp | Table::Hroc);
    ensure!(
        has_gpu_lanes || flags.backend != Backend::Wgpu,
        "--backend wgpu has no meaning for this table: all its lanes run on the software backend"
    );
    match choice.table {
        Table::Kt2005 => kt2005::run(&flags),
        Table::Bh2001 => bh2001::run(&flags),
        Table::Chcpp => chcpp::run(&flags),
        Table::Hroc => hroc::run(&flags),
    }
}
