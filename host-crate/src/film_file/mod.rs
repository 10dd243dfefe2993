//! Film files: a render that outlives its process.
//!
//! A film file holds a [`Checkpoint`] and what it is one of ([`Header`]). It is written whole or
//! not at all, and a damaged one is not read.
//!
//! ```text
//! "Raystream film\x1a\n", format, bytes of the header      16, 4 and 4 bytes
//! the header                                               JSON
//! radiance, features, splats: chunk for chunk              4 bytes of its length, then its bytes
//! SHA-256 of all before                                    32 bytes
//! ```
//!
//! Numbers have their low bytes first. How chunks are packed, `planes.rs` says.

mod digest;
mod error;
mod header;
mod merge;
mod picture;
mod planes;

pub use digest::{hexadecimal, kernels_digest, scene_digest};
pub use error::FilmFileError;
pub use header::{Command, Difference, Header, Part};
pub use merge::merge;

use crate::image::{ImageError, check_replaceable, open_file, read_file, replace_file_with};
use crate::render::Checkpoint;
use crate::render::film::splats::SplatSums;
use bytemuck::Pod;
use sha2::{Digest as _, Sha256};
use std::io::{self, Read, Write};
use std::path::Path;

const MAGIC: &[u8; 16] = b"Raystream film\x1a\n";
/// The form of the file, and of the numbers in it.
const FORMAT: u32 = 2;
const DIGEST_BYTES: usize = 32;
/// Bytes before the header.
const HEADER_START: usize = MAGIC.len() + 8;

/// A film file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// What it is a film of.
    pub header: Header,
    /// How far it is.
    pub checkpoint: Checkpoint,
}

impl FilmFile {
    /// Fails now if [`Self::write`] would: see [`crate::image::check_writable`].
    ///
    /// # Errors
    /// Those that writing would give.
    pub fn check_writable(path: &Path) -> Result<(), FilmFileError> {
        Ok(check_replaceable(path)?)
    }

    /// Writes it. On any error an existing file keeps its contents.
    ///
    /// # Errors
    /// If there is no room for it, or no permission to write it.
    pub fn write(&self, path: &Path) -> Result<(), FilmFileError> {
        let header = serde_json::to_vec(&self.header.with_progress(&self.checkpoint))
            .map_err(|error| broken(path, &error.to_string()))?;
        let Checkpoint { radiance, features, splats, .. } = &self.checkpoint;
        let words = splats.as_ref().map_or(&[][..], |sums| &sums.words);
        let arrays = [planes::pack(radiance), planes::pack(features), planes::pack(words)];
        replace_file_with(path, |file| {
            let mut out = Hashed { out: io::BufWriter::new(file), hash: Sha256::new() };
            out.write_all(MAGIC)?;
            out.write_all(&FORMAT.to_le_bytes())?;
            out.write_all(&(header.len() as u32).to_le_bytes())?;
            out.write_all(&header)?;
            for chunk in arrays.iter().flatten() {
                out.write_all(&(chunk.len() as u32).to_le_bytes())?;
                out.write_all(chunk)?;
            }
            let digest = out.hash.finalize();
            out.out.write_all(&digest)?;
            out.out.flush()
        })?;
        Ok(())
    }

    /// Reads one.
    ///
    /// # Errors
    /// If it is missing, no film file, of another format, or damaged.
    pub fn read(path: &Path) -> Result<Self, FilmFileError> {
        let bytes = read_file(path)?;
        let mut rest = Bytes { path, bytes: &bytes };
        // What is no film file, or one of another format, has no checksum to be wrong.
        Bytes { ..rest }.header_bytes()?;
        let hashed = bytes.len().saturating_sub(DIGEST_BYTES);
        let (hashed, digest) = bytes.split_at(hashed);
        if Sha256::digest(hashed).as_slice() != digest {
            return Err(broken(path, "its checksum is wrong"));
        }
        let header = rest.header()?;
        let pixels = header.pixels().map_err(|what| broken(path, &what))?;
        let (radiance, features) = (rest.array(pixels)?, rest.array(pixels)?);
        let splats = header.splats.map(|splats| {
            let header::Splats { words, unit_exponent, light_paths } = splats;
            Ok::<_, FilmFileError>(SplatSums {
                words: rest.array(words)?,
                unit_exponent,
                light_paths,
            })
        });
        let splats = splats.transpose()?;
        let unit_exponent = header.unit_exponent;
        let (header, size, progress) = header.take_apart();
        let checkpoint = Checkpoint { size, radiance, unit_exponent, features, splats, progress };
        Ok(Self { header, checkpoint })
    }

    /// Reads the header of one; whether the rest is whole, it does not see.
    ///
    /// # Errors
    /// If it is missing, no film file, of another format, or its header is damaged.
    pub fn read_header(path: &Path) -> Result<Header, FilmFileError> {
        let mut bytes = Vec::with_capacity(HEADER_START);
        let mut file = open_file(path)?;
        let mut read = |bytes: &mut Vec<u8>, count: usize| {
            let read = Read::by_ref(&mut file).take(count as u64).read_to_end(bytes);
            read.map_err(|error| FilmFileError::from(ImageError::from_read(path, error)))
        };
        read(&mut bytes, HEADER_START)?;
        let length = Bytes { path, bytes: &bytes }.header_bytes()?;
        read(&mut bytes, length as usize)?;
        let (header, _, _) = Bytes { path, bytes: &bytes }.header()?.take_apart();
        Ok(header)
    }
}

fn broken(path: &Path, reason: &str) -> FilmFileError {
    let reason = reason.to_owned();
    ImageError::Broken { path: path.to_owned(), format: "film", reason }.into()
}

/// Hashes what goes through.
struct Hashed<W> {
    out: W,
    hash: Sha256,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// What has not been read of a file.
struct Bytes<'a> {
    path: &'a Path,
    bytes: &'a [u8],
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], FilmFileError> {
        let cut = || broken(self.path, "it ends too early");
        let (taken, rest) = self.bytes.split_at_checked(count).ok_or_else(cut)?;
        self.bytes = rest;
        Ok(taken)
    }

    fn number(&mut self) -> Result<u32, FilmFileError> {
        let bytes = self.take(size_of::<u32>())?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
    }

    /// The length of the header, which follows.
    fn header_bytes(&mut self) -> Result<u32, FilmFileError> {
        let path = || self.path.to_owned();
        if !self.bytes.starts_with(MAGIC) {
            return Err(FilmFileError::NotAFilm { path: path() });
        }
        self.take(MAGIC.len())?;
        match self.number()? {
            FORMAT => self.number(),
            found => Err(FilmFileError::Format { path: path(), found, reads: FORMAT }),
        }
    }

    fn header(&mut self) -> Result<header::Whole, FilmFileError> {
        let length = self.header_bytes()?;
        let header = self.take(length as usize)?;
        serde_json::from_slice(header)
            .map_err(|error| broken(self.path, &format!("its header: {error}")))
    }

    fn array<T: Pod + Send>(&mut self, elements: usize) -> Result<Vec<T>, FilmFileError> {
        let mut chunk = || {
            let length = self.number()?;
            self.take(length as usize)
        };
        let chunks: Result<Vec<&[u8]>, _> =
            (0..planes::chunks(elements)).map(|_| chunk()).collect();
        planes::unpack(&chunks?, elements).map_err(|what| broken(self.path, &what))
    }
}
