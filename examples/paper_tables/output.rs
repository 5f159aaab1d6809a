//! Where a table's files go, and how far its runs are.

use std::fs;
use std::path::PathBuf;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};

use support::flags::Flags;
use support::lockstep::{self, Lane, Measured};
use support::scenario::Scenario;

/// The files of one table, with a bar that shows how long it will take.
pub struct Output {
    folder: PathBuf,
    /// What the files' names begin with.
    table: &'static str,
    bar: ProgressBar,
}

impl Output {
    /// Makes the folder. `frames` is how many frames all lanes of all runs have together.
    pub fn new(flags: &Flags, table: &'static str, frames: u64) -> anyhow::Result<Self> {
        let folder = flags.out();
        fs::create_dir_all(&folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let style = "{bar:30} frame {pos} of {len}, {elapsed} so far, {eta} left: {msg}";
        let bar = ProgressBar::new(frames).with_style(ProgressStyle::with_template(style)?);
        Ok(Self { folder, table, bar })
    }

    /// Runs lanes through a scenario, see [`lockstep::run`].
    pub fn run(&self, scenario: Scenario, flags: &Flags, lanes: Vec<Lane>) -> anyhow::Result<Vec<Measured>> {
        self.bar.set_message(scenario.name.clone());
        lockstep::run(scenario, flags, lanes, || self.bar.inc(1))
    }

    /// Prints a line above the bar.
    pub fn say(&self, line: &str) {
        self.bar.suspend(|| println!("{line}"));
    }

    /// A file of the table: what its name ends with.
    pub fn file(&self, ending: &str) -> PathBuf {
        self.folder.join(format!("{}{ending}", self.table))
    }

    /// Writes the page, once all runs are done, and says where it is.
    pub fn finish(&self, page: &str) -> anyhow::Result<()> {
        self.bar.finish_and_clear();
        let path = self.file(".md");
        fs::write(&path, page).with_context(|| format!("cannot write {}", path.display()))?;
        println!("the table is {}; figures are beside it", path.display());
        Ok(())
    }
}
