//! How scenes are loaded: from files, from memory, from the program.

use super::description::Scene;
use super::error::SceneError;
use super::formats;
use super::memory::{Memory, Over};
use super::options::LoadOptions;
use super::shipped::{self, DEFAULT_SCENE};
use super::source::{Disk, Listed, SceneBytes, read_up_to};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

impl LoadOptions {
    /// Loads a scene file with its OBJs, MTLs, textures and environment, a glTF (`.gltf` or `.glb`)
    /// with its buffers and textures, an OBJ with its MTLs, or a PLY. What a file is goes by its
    /// content, or else by the end of its name.
    ///
    /// A glTF, OBJ or PLY without a camera is seen from where all of it is in the picture, and one
    /// without light is lit by [`Environment::studio`](super::Environment::studio).
    ///
    /// # Errors
    ///
    /// When a file is missing, malformed or too large, or a value out of range: the message names
    /// the file, the place in it and what to do.
    pub fn load(&self, path: &Path) -> Result<Scene, SceneError> {
        formats::load_from(&Disk, path, self)
    }

    /// The same, with the files that were read, also where one of them is wrong: for who wants to
    /// load the scene again when one changes.
    pub fn load_listing(&self, path: &Path) -> (Result<Scene, SceneError>, Vec<PathBuf>) {
        let source = Listed::default();
        let scene = formats::load_from(&source, path, self);
        (scene, source.into_files())
    }

    /// Reads a scene from `input`, such as standard input; it is called `name` in messages.
    /// The paths in it start from the working directory.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn read(&self, input: &mut dyn Read, name: &str) -> Result<Scene, SceneError> {
        let path = Path::new(name);
        let text = read_up_to(input, path, self.text_bytes())?;
        let file = SceneBytes { path, folder: Path::new(""), bytes: &text };
        formats::load_bytes(&Disk, file, self)
    }

    /// Loads a scene whose files are all in memory, by their paths: `scene` with what it names, as
    /// [`load`](Self::load). No file of the disk is read.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn load_files(
        &self,
        files: &BTreeMap<PathBuf, Vec<u8>>,
        scene: &Path,
    ) -> Result<Scene, SceneError> {
        formats::load_from(&Memory(files), scene, self)
    }

    /// As [`load_files`](Self::load_files), but what is not in memory is read from the disk: for
    /// meshes of a program, with textures of files.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn load_files_over_disk(
        &self,
        files: &BTreeMap<PathBuf, Vec<u8>>,
        scene: &Path,
    ) -> Result<Scene, SceneError> {
        formats::load_from(&Over(Memory(files)), scene, self)
    }

    /// Loads the scene that ships under the name `name`.
    ///
    /// # Errors
    ///
    /// When there is no such scene, or when its geometry must be fetched first and `SCENES_DIR`
    /// does not lead to it.
    pub fn load_named(&self, name: &str) -> Result<Scene, SceneError> {
        shipped::load(name, self)
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

/// Loads the built-in Cornell box with a ball.
///
/// # Errors
///
/// None for the scene as it ships.
pub fn embedded() -> Result<Scene, SceneError> {
    load_named(DEFAULT_SCENE)
}
