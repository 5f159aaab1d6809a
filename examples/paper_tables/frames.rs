//! The figures of each frame of each run.

use std::path::Path;

use anyhow::Context;

use support::lockstep::Measured;
use support::report::FrameRecord;

/// Writes a line a frame, after the names of the scene and of the algorithm that ran it.
pub fn write<'a>(
    path: &Path,
    runs: impl IntoIterator<Item = (&'a str, &'a str, &'a Measured)>,
) -> anyhow::Result<()> {
    // A record inside a tuple has no header of its own, so the names are taken from a lone one.
    let mut lone = csv::Writer::from_writer(Vec::new());
    lone.serialize(FrameRecord::default())?;
    let lone = lone.into_inner()?;
    let mut names = csv::Reader::from_reader(&lone[..]);

    let mut csv = csv::WriterBuilder::new()
        .has_headers(false)
        .from_path(path)
        .with_context(|| format!("cannot write {}", path.display()))?;
    csv.write_record(["scene", "algorithm"].into_iter().chain(names.headers()?))?;
    for (scene, algorithm, measured) in runs {
        for frame in &measured.frames {
            csv.serialize((scene, algorithm, frame))?;
        }
    }
    Ok(csv.flush()?)
}
