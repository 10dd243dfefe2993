//! Buffer views that are compressed: the extension `EXT_meshopt_compression`, by its
//! specification.
//!
//! A view names bytes of another buffer, from which its own are made; the buffer that it lies in may
//! have none.

mod attributes;
mod filters;
mod indices;
mod stream;

use super::document::Document;
use super::extensions::MESHOPT;
use crate::scene::error::SceneError;
use gltf::json::{Buffer, Value, buffer::View};
use serde::Deserialize;

/// The largest stride of attributes, in bytes.
const MAX_STRIDE: usize = 256;

/// What is wrong with a stream.
#[derive(Debug, thiserror::Error)]
enum Broken {
    #[error("is cut short")]
    CutShort,
    #[error("has {0} bytes more than it needs")]
    TooLong(usize),
    #[error("begins with {found:#04x}, not with {expected:#04x}: it is of another mode or version")]
    Header { found: u8, expected: u8 },
    #[error("has an integer that does not end")]
    Integer,
    #[error("has a table that names vertices by number")]
    Table,
    #[error("has the index {0}, which two bytes do not hold")]
    Index(u32),
}

/// How a view is compressed.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: u64,
    byte_length: u64,
    byte_stride: usize,
    mode: Mode,
    count: usize,
    #[serde(default)]
    filter: Filter,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
#[serde(rename_all = "UPPERCASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
}

/// Whether nothing but compressed views lies in a buffer, which therefore is not read.
pub(super) fn is_fallback(buffer: &Buffer) -> bool {
    let extension = buffer.extensions.as_ref().and_then(|all| all.others.get(MESHOPT));
    extension.and_then(|it| it.get("fallback")).and_then(Value::as_bool).unwrap_or(false)
}

impl Document<'_> {
    /// The bytes that the view of this number stands for, if it is compressed.
    pub(super) fn decompress(&self, index: usize) -> Result<Option<Vec<u8>>, SceneError> {
        let view = &self.root.buffer_views[index];
        let extensions = view.extensions.as_ref();
        let Some(value) = extensions.and_then(|all| all.others.get(MESHOPT)) else {
            return Ok(None);
        };
        let place = format!("bufferViews[{index}].extensions.{MESHOPT}");
        let compressed = Compressed::deserialize(value)
            .map_err(|error| self.wrong(&place, format!("cannot be read: {error}")))?;
        compressed.check(view).map_err(|what| self.wrong(&place, what))?;
        let Compressed { buffer, byte_offset, byte_length, .. } = compressed;
        let bytes = self.bytes(buffer, byte_offset, byte_length, &place)?;
        self.charge(view.byte_length.0, &place)?;
        let decoded = compressed.decode(bytes);
        decoded.map(Some).map_err(|broken| self.wrong(&place, broken.to_string()))
    }
}

impl Compressed {
    /// Checks what the specification demands.
    fn check(&self, view: &View) -> Result<(), String> {
        let Self { byte_stride: stride, count, mode, filter, .. } = *self;
        let length = (count as u64).checked_mul(stride as u64);
        if length != Some(view.byte_length.0) {
            return Err(format!(
                "has {count} elements of {stride} bytes, but the view has {} bytes",
                view.byte_length.0
            ));
        }
        if let Some(own) = view.byte_stride
            && own.0 != stride
        {
            return Err(format!("has a byteStride of {stride}, but the view one of {}", own.0));
        }
        let fits = match mode {
            Mode::Attributes => stride > 0 && stride <= MAX_STRIDE && stride.is_multiple_of(4),
            _ => stride == 2 || stride == 4,
        };
        if !fits {
            return Err(format!("has a byteStride of {stride}, which its mode does not have"));
        }
        if mode == Mode::Triangles && !count.is_multiple_of(3) {
            return Err(format!("has {count} indices: triangles have three each"));
        }
        let fits = match filter {
            Filter::None => true,
            Filter::Octahedral => stride == 4 || stride == 8,
            Filter::Quaternion => stride == 8,
            Filter::Exponential => true,
        };
        if filter != Filter::None && (mode != Mode::Attributes || !fits) {
            return Err("has a filter that its mode or byteStride does not have".to_owned());
        }
        Ok(())
    }

    fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, Broken> {
        let Self { byte_stride: stride, count, .. } = *self;
        let indices = match self.mode {
            Mode::Attributes => {
                let mut rows = attributes::decode(bytes, count, stride)?;
                match self.filter {
                    Filter::None => (),
                    Filter::Octahedral => filters::octahedral(&mut rows, stride),
                    Filter::Quaternion => filters::quaternions(&mut rows),
                    Filter::Exponential => filters::exponential(&mut rows),
                }
                return Ok(rows);
            }
            Mode::Triangles => indices::triangles(bytes, count)?,
            Mode::Indices => indices::indices(bytes, count)?,
        };
        if stride == 4 {
            return Ok(indices.into_iter().flat_map(u32::to_le_bytes).collect());
        }
        let mut shorts = Vec::with_capacity(2 * count);
        for index in indices {
            let short = u16::try_from(index).map_err(|_| Broken::Index(index))?;
            shorts.extend(short.to_le_bytes());
        }
        Ok(shorts)
    }
}
