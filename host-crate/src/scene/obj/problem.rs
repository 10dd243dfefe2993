//! What can be wrong with a line of an OBJ, and what its content costs.

use crate::scene::error::SceneError;
use std::path::Path;

/// What is wrong, and with which line (from 1).
#[derive(Debug, PartialEq)]
pub(super) struct BadLine {
    pub line: usize,
    pub what: Problem,
}

/// What is wrong with a line.
#[derive(Debug, PartialEq)]
pub(super) enum Problem {
    /// This.
    Malformed(String),
    /// With it the scene takes more memory than this.
    TooLarge(u64),
}

impl BadLine {
    pub(super) fn new(line: usize, what: String) -> Self {
        Self { line, what: Problem::Malformed(what) }
    }

    /// The error of a scene with the OBJ `path`.
    pub(super) fn error(self, path: &Path) -> SceneError {
        let (path, line) = (path.to_owned(), self.line);
        match self.what {
            Problem::Malformed(what) => SceneError::Obj { path, line, what },
            Problem::TooLarge(limit) => {
                SceneError::TooLarge { path, place: format!("line {line}"), limit }
            }
        }
    }
}

/// Memory that a scene takes for each triangle at the peak, in bytes. Of two million triangles with
/// vertices of their own 450 were measured, vertices and text included, and of the scene
/// `conference` 410.
const PER_TRIANGLE: u64 = 400;
/// Memory for each line v, vt or vn, and for each corner of a face, besides its text.
const PER_VERTEX: u64 = 60;
/// Memory for each material or file that is named, besides its name.
const PER_NAME: u64 = 2048;

/// The memory that a scene takes, by an estimate of its peak.
pub(super) struct Cost {
    limit: u64,
    left: u64,
}

impl Cost {
    /// Of a scene that may take `limit` bytes.
    pub(super) fn new(limit: u64) -> Self {
        Self { limit, left: limit }
    }

    /// A line v, vt or vn of so many bytes.
    pub(super) fn vertex(&mut self, line: usize, bytes: usize) -> Result<(), BadLine> {
        self.take(line, PER_VERTEX + 2 * bytes as u64)
    }

    /// A face of so many corners, in a line of so many bytes.
    pub(super) fn face(
        &mut self,
        line: usize,
        corners: usize,
        bytes: usize,
    ) -> Result<(), BadLine> {
        let corners = corners as u64;
        let triangles = corners.saturating_sub(2) * PER_TRIANGLE;
        // Of a triangle they are among what was measured.
        let corners = corners.saturating_sub(3) * PER_VERTEX;
        self.take(line, triangles + corners + 2 * bytes as u64)
    }

    /// Whether there is memory for a face of so many corners.
    pub(super) fn check(&self, line: usize, corners: usize) -> Result<(), BadLine> {
        Self { ..*self }.face(line, corners, 0)
    }

    /// A name of so many bytes, of a material or a file.
    pub(super) fn name(&mut self, line: usize, bytes: usize) -> Result<(), BadLine> {
        self.take(line, PER_NAME + 2 * bytes as u64)
    }

    fn take(&mut self, line: usize, bytes: u64) -> Result<(), BadLine> {
        let too_large = || BadLine { line, what: Problem::TooLarge(self.limit) };
        self.left = self.left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }
}
