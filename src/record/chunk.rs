//! The file: its beginning, its chunks, and what is in them.

use std::io::{self, Read, Write};

use glam::{DVec3, Mat4};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::log::Log;
use crate::geom::{DepthDirection, DepthFormat, View, Viewport};
use crate::scene::SceneEdit;
use crate::{Costs, Error, Tradeoff};

/// The first bytes of every recording.
const MAGIC: [u8; 8] = *b"tercet\r\n";
/// Of the format. A change that older files do not follow makes it greater.
const VERSION: u32 = 4;
/// No chunk is longer: a length beyond it is damage, and no memory is asked for.
const LONGEST: u32 = 1 << 30;

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// In the words of whoever recorded it.
    pub about: String,
    /// The policy's name.
    pub policy: String,
    /// Its dials.
    pub dials: Vec<(String, String)>,
    /// The tree's dials.
    pub tree: Vec<(String, String)>,
    /// What positions are relative to at the start, metres.
    pub origin: DVec3,
    /// Whether cuts are detected.
    pub detects_cuts: bool,
}

/// One frame of the view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Frame {
    /// What was done to the scene since the last frame.
    pub(super) edits: Vec<SceneEdit>,
    pub(super) view: RecordedView,
    pub(super) tradeoff: Tradeoff,
    /// Whether the app had announced a cut.
    pub(super) cut: bool,
    /// What the policy was told of costs.
    pub(super) costs: Costs,
    pub(super) log: Log,
    pub(super) drawn: Digest,
}

/// What a frame drew, in short.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Digest {
    pub(super) count: u32,
    pub(super) checksum: u32,
}

/// What a [`View`] is made from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RecordedView {
    view_from_world: Mat4,
    clip_from_view: Mat4,
    viewport: Viewport,
    depth: DepthDirection,
    format: DepthFormat,
    samples: u32,
}

impl RecordedView {
    pub(super) fn new(view: &View) -> Self {
        Self {
            view_from_world: view.view_from_world(),
            clip_from_view: view.clip_from_view(),
            viewport: view.viewport(),
            depth: view.depth(),
            format: view.format(),
            samples: view.samples(),
        }
    }

    pub(super) fn view(&self) -> Result<View, Error> {
        let view = View::new(self.view_from_world, self.clip_from_view, self.viewport)?;
        Ok(view.with_target(self.depth, self.format, self.samples))
    }
}

/// Writes what every recording begins with.
pub(super) fn write_start(file: &mut impl Write, header: &Header) -> Result<(), Error> {
    let start = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
    file.write_all(&start).map_err(cannot_write)?;
    write(file, header)
}

/// Writes a chunk.
pub(super) fn write(file: &mut impl Write, chunk: &impl Serialize) -> Result<(), Error> {
    let bytes = postcard::to_stdvec(chunk).map_err(|error| failed(format!("cannot be encoded: {error}")))?;
    let length = u32::try_from(bytes.len()).ok().filter(|&length| length <= LONGEST);
    let length = length.ok_or_else(|| failed("a frame of more than a gigabyte".to_owned()))?;
    write_raw(file, length, &bytes)
}

/// Writes the mark at the end: a chunk without content, and the number of frames.
pub(super) fn write_end(file: &mut impl Write, frames: u32) -> Result<(), Error> {
    file.write_all(&0u32.to_le_bytes()).map_err(cannot_write)?;
    file.write_all(&frames.to_le_bytes()).map_err(cannot_write)?;
    file.flush().map_err(cannot_write)
}

fn write_raw(file: &mut impl Write, length: u32, bytes: &[u8]) -> Result<(), Error> {
    file.write_all(&length.to_le_bytes()).map_err(cannot_write)?;
    file.write_all(&checksum(length, bytes).to_le_bytes()).map_err(cannot_write)?;
    file.write_all(bytes).map_err(cannot_write)
}

/// Reads what every recording begins with.
pub(super) fn read_start(file: &mut impl Read) -> Result<Header, Error> {
    let mut start = [0; MAGIC.len()];
    file.read_exact(&mut start).map_err(|error| ends(error, "before it begins"))?;
    if start != MAGIC {
        return Err(failed("it is none: it does not begin with the mark of one".to_owned()));
    }
    let version = read_u32(file, "in its first line")?;
    if version != VERSION {
        return Err(failed(format!(
            "it has version {version}, and this is a reader of version {VERSION}: replay it with the release \
             that made it"
        )));
    }
    read(file, "header")?.ok_or_else(|| failed("it has no header".to_owned()))
}

/// Reads a chunk; None at the end. `what` names the chunk in messages.
pub(super) fn read<T: DeserializeOwned>(file: &mut impl Read, what: &str) -> Result<Option<T>, Error> {
    let inside = format!("in its {what}");
    let length = read_u32(file, &inside)?;
    if length == 0 {
        return Ok(None);
    }
    if length > LONGEST {
        return Err(failed(format!("the {what} is damaged: it claims to have {length} bytes")));
    }
    let expected = read_u32(file, &inside)?;
    let mut bytes = Vec::new();
    file.take(length.into()).read_to_end(&mut bytes).map_err(|error| ends(error, &inside))?;
    if bytes.len() < length as usize {
        return Err(truncated(&inside));
    }
    if checksum(length, &bytes) != expected {
        return Err(failed(format!("the {what} is damaged: its checksum is another one")));
    }
    let chunk = postcard::from_bytes(&bytes);
    chunk.map(Some).map_err(|error| failed(format!("the {what} cannot be understood: {error}")))
}

/// Reads the number after the mark at the end.
pub(super) fn read_end(file: &mut impl Read) -> Result<u32, Error> {
    read_u32(file, "at its end")
}

/// Of a chunk: of its length, too, which is otherwise unprotected.
fn checksum(length: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&length.to_le_bytes());
    hasher.update(bytes);
    hasher.finalize()
}

fn read_u32(file: &mut impl Read, place: &str) -> Result<u32, Error> {
    let mut bytes = [0; 4];
    file.read_exact(&mut bytes).map_err(|error| ends(error, place))?;
    Ok(u32::from_le_bytes(bytes))
}

fn ends(error: io::Error, place: &str) -> Error {
    if error.kind() == io::ErrorKind::UnexpectedEof {
        truncated(place)
    } else {
        failed(format!("it cannot be read {place}: {error}"))
    }
}

fn truncated(place: &str) -> Error {
    failed(format!("it ends {place}: the file was cut short, and what comes before can be replayed"))
}

fn cannot_write(error: io::Error) -> Error {
    failed(format!("it cannot be written: {error}"))
}

pub(super) fn failed(why: String) -> Error {
    Error::Recording { why }
}
