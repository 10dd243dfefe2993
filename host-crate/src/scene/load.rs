//! How scenes are loaded, and how much memory that may take.

use super::description::Scene;
use super::error::SceneError;
use super::json;
use super::memory::Memory;
use super::shipped;
use super::source::{Disk, read_up_to};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

/// How a scene is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadOptions {
    /// Memory in bytes that a scene may take while it is loaded and made ready, by estimates that
    /// err on the high side; 8 GiB by default.
    ///
    /// It bounds all that is read: the OBJ may have a quarter of it, each picture an eighth, the
    /// scene file and each MTL 1/128.
    pub max_memory: u64,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_memory: 8 << 30 }
    }
}

impl LoadOptions {
    /// Loads a scene file of format 1 with its OBJ, MTL and textures.
    ///
    /// # Errors
    ///
    /// When a file is missing, malformed or too large, or a value out of range: the message names
    /// the file, the place in it and what to do.
    pub fn load(&self, path: &Path) -> Result<Scene, SceneError> {
        json::load_from(&Disk, path, *self)
    }

    /// Reads a scene file from `input`, such as standard input; it is called `name` in messages.
    /// The paths in it start from the working directory.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn read(&self, input: &mut dyn Read, name: &str) -> Result<Scene, SceneError> {
        let path = Path::new(name);
        let text = read_up_to(input, path, self.text_bytes())?;
        json::load_text(&Disk, json::SceneText { path, folder: Path::new(""), text: &text }, *self)
    }

    /// Loads a scene whose files are all in memory, by their paths: the scene file `scene` with its
    /// OBJ, MTL and textures. No file of the disk is read.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn load_files(
        &self,
        files: &BTreeMap<PathBuf, Vec<u8>>,
        scene: &Path,
    ) -> Result<Scene, SceneError> {
        json::load_from(&Memory(files), scene, *self)
    }

    /// Loads the scene that ships under the name `name`.
    ///
    /// # Errors
    ///
    /// When there is no such scene, or when its geometry must be fetched first and `SCENES_DIR`
    /// does not lead to it.
    pub fn load_named(&self, name: &str) -> Result<Scene, SceneError> {
        shipped::load(name, *self)
    }

    /// The most bytes of a scene file or an MTL.
    pub(super) fn text_bytes(&self) -> u64 {
        self.max_memory / 128
    }

    /// The most bytes of an OBJ.
    pub(super) fn obj_bytes(&self) -> u64 {
        self.max_memory / 4
    }

    /// The most bytes of a picture file.
    pub(super) fn picture_bytes(&self) -> u64 {
        self.max_memory / 8
    }
}

/// Loads a scene file with the default [`LoadOptions`].
///
/// # Errors
///
/// As [`LoadOptions::load`].
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    LoadOptions::default().load(path)
}

/// Loads the scene that ships under the name `name` with the default [`LoadOptions`].
///
/// # Errors
///
/// As [`LoadOptions::load_named`].
pub fn load_named(name: &str) -> Result<Scene, SceneError> {
    LoadOptions::default().load_named(name)
}
