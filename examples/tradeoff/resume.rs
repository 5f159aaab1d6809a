//! The file that an interrupted run goes on from: a line that says what is run, then a line for each
//! setting that is finished. A line that was cut is dropped, and its setting run again.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use crate::figures::Figures;

/// What must be the same for figures to be comparable, by flag.
pub type Identity = BTreeMap<String, String>;

/// A finished setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Where.
    pub world: String,
    /// 0 for the first time that it was run, then how often it was checked.
    pub round: u32,
    /// Its name.
    pub setting: String,
    /// What came out.
    pub figures: Figures,
}

/// The file, and what stands in it.
pub struct Resume {
    path: PathBuf,
    file: File,
    lines: Vec<Line>,
}

impl Resume {
    /// Opens the file, or makes it; with `restart`, makes it anew.
    ///
    /// # Errors
    /// When it is another run's, or damaged elsewhere than at its end, or cannot be read or written.
    pub fn open(path: &Path, identity: &Identity, restart: bool) -> anyhow::Result<Self> {
        let text = if restart { String::new() } else { whole_lines(path)? };
        let mut lines = text.lines();
        if let Some(header) = lines.next() {
            let known: Identity = serde_json::from_str(header).with_context(|| damaged(path, 1))?;
            same_run(path, &known, identity)?;
        }
        let parse = |(n, line)| serde_json::from_str(line).with_context(|| damaged(path, n + 2));
        let lines: Vec<Line> = lines.enumerate().map(parse).collect::<anyhow::Result<_>>()?;
        let why = || format!("cannot write {}", path.display());
        let file =
            OpenOptions::new().create(true).truncate(false).write(true).open(path).with_context(why)?;
        file.set_len(text.len() as u64).with_context(why)?;
        drop(file);
        let file = OpenOptions::new().append(true).open(path).with_context(why)?;
        let mut resume = Self { path: path.to_owned(), file, lines };
        if text.is_empty() {
            resume.write(&(serde_json::to_string(identity)? + "\n"))?;
        }
        Ok(resume)
    }

    /// How many settings are finished.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// A finished setting's figures.
    pub fn get(&self, world: &str, round: u32, setting: &str) -> Option<&Figures> {
        let is_it = |line: &&Line| line.world == world && line.round == round && line.setting == setting;
        self.lines.iter().find(is_it).map(|line| &line.figures)
    }

    /// Adds what a batch has finished; all of it is in the file when this returns.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn append(&mut self, lines: Vec<Line>) -> anyhow::Result<()> {
        let mut text = String::new();
        for line in &lines {
            text += &serde_json::to_string(line)?;
            text.push('\n');
        }
        self.write(&text)?;
        self.lines.extend(lines);
        Ok(())
    }

    fn write(&mut self, text: &str) -> anyhow::Result<()> {
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.sync_data());
        written.with_context(|| format!("cannot write {}", self.path.display()))
    }
}

/// The file's text up to its last line break: what follows was cut. Empty if there is no file.
fn whole_lines(path: &Path) -> anyhow::Result<String> {
    let mut bytes = match fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        read => read.with_context(|| format!("cannot read {}", path.display()))?,
    };
    let end = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    bytes.truncate(end);
    String::from_utf8(bytes).with_context(|| format!("{} is no text", path.display()))
}

/// Refuses a file whose figures were measured otherwise.
fn same_run(path: &Path, known: &Identity, wanted: &Identity) -> anyhow::Result<()> {
    let keys = known.keys().chain(wanted.keys().filter(|key| !known.contains_key(*key)));
    let of = |run: &Identity, key: &str| run.get(key).map_or("nothing".to_owned(), String::clone);
    let differences: Vec<String> = keys
        .filter(|key| known.get(*key) != wanted.get(*key))
        .map(|key| format!("{key} was {} and is {} now", of(known, key), of(wanted, key)))
        .collect();
    if !differences.is_empty() {
        bail!(
            "{} is of another run: {}. Give this one another --out, or --restart to throw the old figures away",
            path.display(),
            differences.join(", ")
        );
    }
    Ok(())
}

fn damaged(path: &Path, line: usize) -> String {
    format!("{}, line {line}, is damaged: mend or delete it, or --restart", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(frames: &str) -> Identity {
        [("frames", frames), ("policy", "chc")].map(|(key, value)| (key.to_owned(), value.to_owned())).into()
    }

    fn line(setting: &str) -> Line {
        let figures = Figures {
            median_ms: 2.5,
            time_ratio: 0.1 + 0.2,
            noise: 0.0,
            wrong_mean: 1.0 / 3.0,
            wrong_worst: 1e-7,
            longest_run: 3,
            largest_lost: 17,
            lost: 4,
            detail_mean: 0.0,
            drawn: 100.0,
            exact: 80.0,
            extra: 24.0,
            queries: 7.0,
            triangles: 1e6,
        };
        Line { world: "wörld".to_owned(), round: 0, setting: setting.to_owned(), figures }
    }

    /// Cut anywhere, the file is read up to its last whole line, and goes on as if nothing had been.
    #[test]
    fn a_file_cut_at_any_byte_goes_on_from_its_last_whole_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.jsonl");
        let mut resume = Resume::open(&path, &identity("6"), false).expect("it is new");
        resume.append(vec![line("a"), line("b")]).expect("it can be written");
        resume.append(vec![line("c")]).expect("it can be written");
        drop(resume);
        let whole = fs::read(&path).expect("it was written");
        // Every seventh byte, and those around the end of a line.
        let is_tried = |cut: &usize| {
            cut.is_multiple_of(7) || whole[cut.saturating_sub(1)..].iter().take(2).any(|&b| b == b'\n')
        };
        for cut in (0..=whole.len()).filter(is_tried) {
            fs::write(&path, &whole[..cut]).expect("it can be written");
            let breaks = whole[..cut].iter().filter(|&&byte| byte == b'\n').count();
            let mut resume = Resume::open(&path, &identity("6"), false).expect("a cut file is read");
            assert_eq!(resume.len(), breaks.saturating_sub(1), "cut at byte {cut}");
            let left = ["a", "b", "c"].into_iter().filter(|name| resume.get("wörld", 0, name).is_none());
            let left: Vec<Line> = left.map(line).collect();
            resume.append(left).expect("it can be written");
            drop(resume);
            let mended = fs::read(&path).expect("it was written");
            assert!(mended == whole, "cut at byte {cut}: {}", String::from_utf8_lossy(&mended));
        }
        let resume = Resume::open(&path, &identity("6"), false).expect("it is whole");
        assert_eq!(resume.get("wörld", 0, "b"), Some(&line("b").figures));
        assert_eq!(resume.get("wörld", 1, "b"), None, "it was not checked");
        assert_eq!(resume.get("world", 0, "b"), None, "it was run elsewhere");
    }

    #[test]
    fn other_flags_are_refused_until_it_is_restarted() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.jsonl");
        let mut resume = Resume::open(&path, &identity("6"), false).expect("it is new");
        resume.append(vec![line("a")]).expect("it can be written");
        let refused = Resume::open(&path, &identity("7"), false).err().expect("another number of frames");
        let why = refused.to_string();
        assert!(why.contains("frames was 6 and is 7 now") && why.contains("--restart"), "{why}");
        assert!(!why.contains("policy"), "{why}");
        let resume = Resume::open(&path, &identity("7"), true).expect("the old one is thrown away");
        assert_eq!(resume.len(), 0);
        assert!(Resume::open(&path, &identity("7"), false).is_ok());
    }

    #[test]
    fn damage_before_the_end_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.jsonl");
        let mut resume = Resume::open(&path, &identity("6"), false).expect("it is new");
        resume.append(vec![line("a"), line("b")]).expect("it can be written");
        let text = fs::read_to_string(&path).expect("it was written").replacen("\"lost\":4", "\"lost\":", 1);
        fs::write(&path, text).expect("it can be written");
        let why = Resume::open(&path, &identity("6"), false).err().expect("line 2 is no JSON").to_string();
        assert!(why.contains("line 2"), "{why}");
    }
}
