//! The file itself: JSON text or the chunks of a GLB, and the buffers that it names.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use data_url::DataUrl;
use gltf::json::buffer::View;
use gltf::json::{Index, Root};

/// A parsed file. Nothing in it has been checked but that it is JSON of the right shape.
pub(super) struct File {
    pub(super) root: Root,
    folder: PathBuf,
    bytes: Vec<u8>,
    /// The GLB's binary chunk, within `bytes`.
    bin: Option<Range<usize>>,
    /// Buffers outside this file, read when first needed: images may live in buffers of their own.
    outside: Vec<OnceLock<Result<Vec<u8>, String>>>,
}

/// The bytes of a buffer view.
pub(super) struct ViewBytes<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: Option<usize>,
}

impl File {
    /// Reads and parses a `.gltf` or a `.glb`; which of them it is, its first bytes say.
    pub(super) fn open(path: &Path) -> Result<Self, String> {
        let bytes = fs::read(path).map_err(|e| e.to_string())?;
        let (json, bin) = chunks(&bytes)?;
        let root = parse(&bytes[json])?;
        check_version(&root)?;
        check_extensions(&root)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let outside = root.buffers.iter().map(|_| OnceLock::new()).collect();
        Ok(Self { root, folder, bytes, bin, outside })
    }

    /// The bytes of a buffer view, checked against its buffer.
    pub(super) fn view(&self, index: Index<View>) -> Result<ViewBytes<'_>, String> {
        let v = index.value();
        let view = get(&self.root.buffer_views, index, "buffer view")?;
        let in_view = |why: String| format!("buffer view {v}: {why}");
        let buffer = self.buffer(view.buffer.value()).map_err(in_view)?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0);
        let bytes = end.and_then(|end| buffer.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        let bytes = bytes.ok_or_else(|| {
            let (length, b, all) = (view.byte_length.0, view.buffer.value(), buffer.len());
            in_view(format!("{length} bytes from byte {start} reach past buffer {b}, which has {all}"))
        })?;
        Ok(ViewBytes { bytes, stride: view.byte_stride.map(|s| s.0) })
    }

    fn buffer(&self, index: usize) -> Result<&[u8], String> {
        let buffers = &self.root.buffers;
        let buffer = buffers.get(index).ok_or_else(|| missing("buffer", index, buffers.len()))?;
        let bytes = match (&buffer.uri, &self.bin) {
            (Some(uri), _) => self.outside[index]
                .get_or_init(|| read_uri(&self.folder, uri))
                .as_ref()
                .map(Vec::as_slice)
                .map_err(|why| format!("buffer {index}: {why}")),
            (None, Some(bin)) if index == 0 => Ok(&self.bytes[bin.clone()]),
            (None, _) => Err(format!("buffer {index} has no uri, and the file has no binary chunk for it")),
        }?;
        let length = buffer.byte_length.0;
        // A binary chunk may be longer than its buffer, by its padding.
        usize::try_from(length)
            .ok()
            .and_then(|length| bytes.get(..length))
            .ok_or_else(|| format!("buffer {index} has {} bytes of the {length} that it claims", bytes.len()))
    }
}

/// An element of one of the file's arrays.
pub(super) fn get<'a, T>(list: &'a [T], index: Index<T>, kind: &str) -> Result<&'a T, String> {
    list.get(index.value()).ok_or_else(|| missing(kind, index.value(), list.len()))
}

fn missing(kind: &str, index: usize, count: usize) -> String {
    format!("{kind} {index} does not exist: the file has {count}")
}

/// Where the JSON and the binary chunk lie. A file without GLB's magic is all JSON.
fn chunks(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), String> {
    if !bytes.starts_with(b"glTF") {
        let mark = if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
        return Ok((mark..bytes.len(), None));
    }
    let word = |at: usize| -> Option<usize> {
        let bytes = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
    };
    let header = || "the GLB header is cut short".to_owned();
    let version = word(4).ok_or_else(header)?;
    if version != 2 {
        return Err(format!("GLB version {version}: only version 2 can be read"));
    }
    let length = word(8).ok_or_else(header)?;
    if length > bytes.len() {
        return Err(format!("the GLB header claims {length} bytes; the file has {}", bytes.len()));
    }
    let (mut json, mut bin) = (None, None);
    let mut at = 12;
    while at < length {
        let chunk = word(at).and_then(|size| Some((size, word(at + 4)?.to_le_bytes())));
        let (size, kind) = chunk.ok_or_else(|| format!("the GLB chunk at byte {at} is cut short"))?;
        let data = at + 8..at + 8 + size;
        if data.end > length {
            return Err(format!("the GLB chunk at byte {at} claims {size} bytes, past the end of the file"));
        }
        // A chunk is padded to four bytes. Chunks of other kinds are to be passed over.
        at = data.end.next_multiple_of(4);
        match &kind[..4] {
            b"JSON" if json.is_none() => json = Some(data),
            b"BIN\0" if bin.is_none() => bin = Some(data),
            _ => {}
        }
    }
    Ok((json.ok_or("the GLB has no JSON chunk")?, bin))
}

fn parse(json: &[u8]) -> Result<Root, String> {
    let mut text = serde_json::Deserializer::from_slice(json);
    let root =
        serde_path_to_error::deserialize(&mut text).map_err(|e| match e.path().to_string().as_str() {
            "." => format!("not glTF: {}", e.inner()),
            path => format!("{path}: {}", e.inner()),
        })?;
    text.end().map_err(|e| format!("not glTF: {e}"))?;
    Ok(root)
}

fn check_version(root: &Root) -> Result<(), String> {
    let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    match version.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(format!("asset: glTF {version}: only glTF 2 can be read")),
    }
}

/// Of the extensions that a file cannot be read without, those that only change what surfaces
/// look like are no obstacle.
fn check_extensions(root: &Root) -> Result<(), String> {
    let readable = |name: &str| {
        matches!(name, "KHR_mesh_quantization" | "EXT_mesh_gpu_instancing" | "KHR_lights_punctual")
            || name.starts_with("KHR_materials_")
            || name.contains("_texture_")
    };
    match root.extensions_required.iter().find(|name| !readable(name)) {
        None => Ok(()),
        Some(name) => Err(format!("extensionsRequired: {name} is not read: export the file without it")),
    }
}

/// The bytes of a buffer outside the file: in a data URI, or in a file of this folder.
pub(in crate::scene) fn read_uri(folder: &Path, uri: &str) -> Result<Vec<u8>, String> {
    if uri.starts_with("data:") {
        let url = DataUrl::process(uri).map_err(|e| format!("its data URI cannot be read: {e}"))?;
        let (bytes, _) = url.decode_to_vec().map_err(|e| format!("its data URI cannot be read: {e}"))?;
        return Ok(bytes);
    }
    if uri.contains("://") {
        return Err(format!("{uri}: only files and data URIs are read"));
    }
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8();
    let name = decoded.map_err(|_| format!("{uri}: not a file name"))?;
    fs::read(folder.join(&*name)).map_err(|e| format!("{name}: {e}"))
}
