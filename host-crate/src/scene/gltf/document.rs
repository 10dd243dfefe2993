//! The file itself: its JSON, its buffers, and what of it would take too much memory.

use super::{extensions, meshopt};
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::options::{Instancing, LoadOptions};
use crate::scene::source::{SceneBytes, Source, find_foreign};
use crate::scene::text::{Name, plain_text};
use gltf::binary::Glb;
use gltf::json::buffer::View;
use gltf::json::{Root, Value};
use serde::de::Error as _;
use std::borrow::Cow;
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// How binary files begin.
const MAGIC: &[u8] = b"glTF";
/// The bytes before the first chunk of a binary file.
const HEADER: usize = 12;
/// Memory that a scene takes for each triangle at the peak, in bytes, by an estimate; that of an
/// OBJ was measured.
pub(super) const PER_TRIANGLE: u64 = 400;
/// Memory for each vertex.
const PER_VERTEX: u64 = 60;

/// Whether a file is a binary glTF.
pub(in crate::scene) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// A glTF whose buffers are at hand.
pub(super) struct Document<'a> {
    pub path: &'a Path,
    pub folder: &'a Path,
    pub root: Root,
    /// The bytes of each buffer; none where the file names none.
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    /// The bytes of each view that is compressed, as they are without; and of what was decoded.
    decompressed: Vec<Option<Vec<u8>>>,
    /// What becomes of shapes that stand in several places.
    pub instancing: Instancing,
    limit: u64,
    left: Cell<u64>,
}

impl<'a> Document<'a> {
    /// Reads a file and the buffers that it names.
    pub(super) fn parse(
        source: &dyn Source,
        SceneBytes { path, folder, bytes }: SceneBytes<'a>,
        options: &LoadOptions,
    ) -> Result<Self, SceneError> {
        let (json, mut binary) = split(path, bytes)?;
        let root = root(path, &json)?;
        let limit = options.max_memory;
        let left = Cell::new(limit);
        let (buffers, decompressed) = (Vec::new(), Vec::new());
        let instancing = options.instancing;
        let mut document =
            Self { path, folder, root, buffers, decompressed, instancing, limit, left };
        extensions::check_required(&document.root, document.path)?;
        for index in 0..document.root.buffers.len() {
            let place = format!("buffers[{index}]");
            let buffer = &document.root.buffers[index];
            let bytes = match &buffer.uri {
                _ if meshopt::is_fallback(buffer) => None,
                Some(uri) => {
                    let place = format!("{place}.uri");
                    let bytes = document.resource(source, uri, options.geometry_bytes(), &place)?;
                    Some(bytes.map(Cow::Owned).map_err(|wanted| SceneError::Missing {
                        path: path.to_owned(),
                        key: place,
                        wanted,
                    })?)
                }
                // The chunk is the first buffer's.
                None => binary.take().filter(|_| index == 0).map(Cow::Borrowed),
            };
            document.charge(bytes.as_ref().map_or(0, |bytes| bytes.len() as u64), &place)?;
            document.buffers.push(bytes);
        }
        for index in 0..document.root.buffer_views.len() {
            let bytes = document.decompress(index)?;
            document.decompressed.push(bytes);
        }
        document.decode_primitives()?;
        Ok(document)
    }

    /// The bytes that a URI names, at most `limit` of them; the error within is a file that is not
    /// there.
    pub(super) fn resource(
        &self,
        source: &dyn Source,
        uri: &str,
        limit: u64,
        place: &str,
    ) -> Result<Result<Vec<u8>, PathBuf>, SceneError> {
        if uri.starts_with("data:") {
            let wrong = |what: String| self.wrong(place, format!("is a data URI that {what}"));
            let data = data_url::DataUrl::process(uri)
                .map_err(|error| wrong(format!("cannot be read: {error:?}")))?;
            let (bytes, _) = data
                .decode_to_vec()
                .map_err(|error| wrong(format!("cannot be decoded: {error:?}")))?;
            return Ok(Ok(bytes));
        }
        let name: Vec<u8> = percent_encoding::percent_decode_str(uri).collect();
        // A file's name may have a percent sign of its own.
        let found = [name.as_slice(), uri.as_bytes()]
            .into_iter()
            .find_map(|name| find_foreign(source, &[self.folder], &Name::new(name)));
        match found {
            Some(found) => source.read(&found.path, limit).map(Ok),
            None => Ok(Err(self.folder.join(Name::new(&name).to_string()))),
        }
    }

    /// The element `index` of one of the file's lists, which is called `list`; `place` names it.
    pub(super) fn get<'d, T>(
        &self,
        elements: &'d [T],
        index: usize,
        list: &str,
        place: &str,
    ) -> Result<&'d T, SceneError> {
        elements.get(index).ok_or_else(|| {
            self.wrong(place, format!("names {list}[{index}], but there are {}", elements.len()))
        })
    }

    /// The bytes of a buffer view, and how far its elements are apart, if it says so.
    pub(super) fn view(
        &self,
        index: usize,
        place: &str,
    ) -> Result<(&[u8], Option<usize>), SceneError> {
        let view = self.get(&self.root.buffer_views, index, "bufferViews", place)?;
        let stride = view.byte_stride.map(|stride| stride.0);
        if let Some(Some(bytes)) = self.decompressed.get(index) {
            return Ok((bytes, stride));
        }
        let here = format!("bufferViews[{index}]");
        let start = view.byte_offset.unwrap_or_default().0;
        Ok((self.bytes(view.buffer.value(), start, view.byte_length.0, &here)?, stride))
    }

    /// So many bytes of a buffer from `start` on; `place` names them.
    pub(super) fn bytes(
        &self,
        buffer: usize,
        start: u64,
        length: u64,
        place: &str,
    ) -> Result<&[u8], SceneError> {
        let declared = self.get(&self.root.buffers, buffer, "buffers", place)?.byte_length.0;
        let Some(Some(bytes)) = self.buffers.get(buffer) else {
            return Err(self.wrong(&format!("buffers[{buffer}]"), "has no bytes"));
        };
        if declared > bytes.len() as u64 {
            let what = format!("has {} bytes, but byteLength says {declared}", bytes.len());
            return Err(self.wrong(&format!("buffers[{buffer}]"), what));
        }
        let bytes = &bytes[..declared as usize];
        let end = start.saturating_add(length);
        let range = usize::try_from(start).ok().zip(usize::try_from(end).ok());
        range.and_then(|(start, end)| bytes.get(start..end)).ok_or_else(|| {
            let length = bytes.len();
            self.wrong(place, format!("is bytes {start} to {end} of a buffer of {length}"))
        })
    }

    /// An error of a part of the file.
    pub(super) fn wrong(&self, place: &str, what: impl Into<String>) -> SceneError {
        SceneError::Part { path: self.path.to_owned(), place: place.to_owned(), what: what.into() }
    }

    /// A warning about the file.
    pub(super) fn warning(&self, what: &str) -> String {
        format!("{}: {what}", self.path.display())
    }

    /// Counts so many bytes of memory.
    pub(super) fn charge(&self, bytes: u64, place: &str) -> Result<(), SceneError> {
        let left = self.left().checked_sub(bytes).ok_or_else(|| self.too_large(place))?;
        self.left.set(left);
        Ok(())
    }

    /// The bytes of memory that are left to count.
    pub(super) fn left(&self) -> u64 {
        self.left.get()
    }

    /// The error of a part that takes too much memory.
    pub(super) fn too_large(&self, place: &str) -> SceneError {
        SceneError::TooLarge {
            path: self.path.to_owned(),
            place: place.to_owned(),
            limit: self.limit,
        }
    }

    /// Adds a view that has these bytes; its number.
    pub(super) fn add_bytes(&mut self, view: View, bytes: Vec<u8>) -> usize {
        self.root.buffer_views.push(view);
        self.decompressed.push(Some(bytes));
        self.decompressed.len() - 1
    }

    /// Counts triangles of the scene.
    pub(super) fn charge_triangles(&self, count: usize, place: &str) -> Result<(), SceneError> {
        self.charge((count as u64).saturating_mul(PER_TRIANGLE), place)
    }

    /// Counts vertices of the scene.
    pub(super) fn charge_vertices(&self, count: usize, place: &str) -> Result<(), SceneError> {
        self.charge((count as u64).saturating_mul(PER_VERTEX), place)
    }

    /// Says what the picture does not show of the file as a whole.
    pub(super) fn warn(&self, is_posed: bool, scene: &mut Scene) {
        if let Some(unread) = extensions::unread(&self.root) {
            scene.warnings.push(self.warning(&unread));
        }
        match (self.root.animations.len(), is_posed) {
            (0, false) | (1, true) => (),
            (0, true) => scene.warnings.push(
                self.warning("it has no animation: whatever the time, it is shown as it stands."),
            ),
            (count, false) => scene.warnings.push(self.warning(&format!(
                "animations are not played, all is shown as it is without them: {count}."
            ))),
            (count, true) => scene.warnings.push(self.warning(&format!(
                "it has {count} animations, of which the first is shown at its time."
            ))),
        }
        if self.root.scenes.len() > 1 {
            let shown = self.root.scene.map_or(0, |scene| scene.value());
            scene.warnings.push(self.warning(&format!(
                "it has {} scenes, of which scenes[{shown}] is shown.",
                self.root.scenes.len()
            )));
        }
    }
}

/// The JSON of a file, and the chunk of bytes behind it.
type Chunks<'a> = (Cow<'a, [u8]>, Option<&'a [u8]>);

/// Takes a file apart.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<Chunks<'a>, SceneError> {
    let wrong = |what: String| SceneError::WrongKind { path: path.to_owned(), what };
    if !is_binary(bytes) {
        return Ok((Cow::Borrowed(plain_text(bytes).map_err(wrong)?), None));
    }
    let length = bytes.get(8..HEADER).and_then(|word| word.try_into().ok()).map(u32::from_le_bytes);
    let whole = length
        .and_then(|length| bytes.get(..length as usize))
        .filter(|whole| whole.len() >= HEADER)
        .ok_or_else(|| wrong("is a binary glTF that is cut short".to_owned()))?;
    let glb = Glb::from_slice(whole)
        .map_err(|error| wrong(format!("is a broken binary glTF: {error}")))?;
    let binary = glb.bin.map(|bin| match bin {
        Cow::Borrowed(bytes) => bytes,
        // The crate lends what it was lent.
        Cow::Owned(_) => &[],
    });
    Ok((glb.json, binary))
}

/// What a file's JSON says.
fn root(path: &Path, json: &[u8]) -> Result<Root, SceneError> {
    let fail = |key: String, source| SceneError::Json { path: path.to_owned(), key, source };
    let mut value: Value =
        serde_json::from_slice(json).map_err(|source| fail(String::new(), source))?;
    let text = |key: &str| value.get("asset")?.get(key)?.as_str().map(str::to_owned);
    let version = text("version").unwrap_or_default();
    let least = text("minVersion").unwrap_or_else(|| "2.0".to_owned());
    if !version.starts_with("2.") || least != "2.0" {
        let what = if version.is_empty() {
            "is no glTF: it has no `asset.version`".to_owned()
        } else {
            format!("is glTF {version} (at least {least}); this version reads glTF 2.0")
        };
        return Err(SceneError::WrongKind { path: path.to_owned(), what });
    }
    make_regular(&mut value);
    serde_path_to_error::deserialize(&value).map_err(|error| {
        let key = error.path().to_string();
        let key = key.trim_end_matches('?').trim_end_matches('.').to_owned();
        fail(key, serde_json::Error::custom(error.into_inner()))
    })
}

/// Leaves out what may be anything and what nothing here reads, and adds what may be left out but
/// not by the crate.
fn make_regular(value: &mut Value) {
    remove_extras(value);
    let animations = value.get_mut("animations").and_then(Value::as_array_mut);
    for channels in animations.into_iter().flatten().filter_map(|a| a.get_mut("channels")) {
        // One without a node does nothing.
        let moves = |channel: &Value| channel.pointer("/target/node").is_some();
        channels.as_array_mut().into_iter().for_each(|channels| channels.retain(moves));
    }
    let lists = [("scenes", "nodes"), ("skins", "joints")];
    for (list, key) in lists {
        let elements = value.get_mut(list).and_then(Value::as_array_mut);
        for element in elements.into_iter().flatten().filter_map(Value::as_object_mut) {
            element.entry(key).or_insert_with(|| Value::Array(Vec::new()));
        }
    }
}

/// Removes the `extras` of everything. (JSON goes 128 levels deep, as the parser has seen to.)
fn remove_extras(value: &mut Value) {
    match value {
        Value::Object(map) => {
            map.remove("extras");
            map.values_mut().for_each(remove_extras);
        }
        Value::Array(elements) => elements.iter_mut().for_each(remove_extras),
        _ => (),
    }
}
