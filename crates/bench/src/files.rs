//! The folder that results go to.

use super::BenchError;
use raystream::image::replace_file;
use std::path::{Path, PathBuf};

/// A folder that can be written to.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Makes the folder, and those above it, unless it is there, and makes sure that it takes
    /// files.
    ///
    /// # Errors
    /// [`BenchError::Folder`] if it cannot be made or written to.
    pub fn create(path: &Path) -> Result<Self, BenchError> {
        let error = |source| BenchError::Folder { path: path.to_owned(), source };
        std::fs::create_dir_all(path).map_err(error)?;
        tempfile::tempfile_in(path).map_err(error)?;
        Ok(Self(path.to_owned()))
    }

    /// The folder `name` in this one.
    pub fn folder(&self, name: &str) -> Result<Self, BenchError> {
        Self::create(&self.0.join(name))
    }

    /// The path of the file `name`.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes the file `name`, whole or not at all.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), BenchError> {
        Ok(replace_file(&self.file(name), contents)?)
    }
}
