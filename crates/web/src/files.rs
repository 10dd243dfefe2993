//! Files that were given to the page, and the scene among them.

use raystream::scene::{LoadOptions, Scene, SceneError};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files by their paths, as they were given.
#[derive(Default)]
pub struct Files(BTreeMap<PathBuf, Vec<u8>>);

/// Ends of the names of scenes. Where there are several, earlier ones name later ones.
const ENDINGS: [&str; 5] = ["json", "gltf", "glb", "ply", "obj"];
/// Memory of a scene in bytes at most: WebAssembly has 4 GiB, and a part of it is the render's.
const MAX_MEMORY: u64 = 2 << 30;

/// What can go wrong with files.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    /// None of them is a scene.
    #[error(
        "there is no scene among {files}: give a .gltf, .glb, .ply, .obj or scene file (.json)"
    )]
    NoScene {
        /// What there is.
        files: String,
    },
    /// More than one might be meant.
    #[error("{files} are scenes: give one of them, with the files that it needs")]
    Several {
        /// What there is.
        files: String,
    },
    /// The scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Files {
    /// Keeps a file, in place of one of the same path.
    pub fn add(&mut self, path: &str, bytes: Vec<u8>) {
        self.0.insert(PathBuf::from(path), bytes);
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether there is one of this path.
    pub fn has(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }

    /// The path of the scene: the one file whose name ends like one that may name the others.
    ///
    /// # Errors
    /// If there is none, or more than one.
    pub fn scene(&self) -> Result<&Path, FilesError> {
        let found = ENDINGS.iter().map(|ending| self.ending(ending)).find(|all| !all.is_empty());
        match found.as_deref() {
            Some(&[scene]) => Ok(scene),
            Some(several) => Err(FilesError::Several { files: listed(several) }),
            None => {
                let all: Vec<_> = self.0.keys().map(PathBuf::as_path).collect();
                Err(FilesError::NoScene { files: listed(&all) })
            }
        }
    }

    fn ending(&self, ending: &str) -> Vec<&Path> {
        let ends =
            |path: &&Path| path.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending));
        self.0.keys().map(PathBuf::as_path).filter(ends).collect()
    }

    /// The scene of a file and of those that it names.
    ///
    /// # Errors
    /// If a file is missing or wrong; the message names it.
    pub fn load(&self, scene: &Path) -> Result<Scene, SceneError> {
        let options = LoadOptions { max_memory: MAX_MEMORY, ..LoadOptions::default() };
        options.load_files(&self.0, scene)
    }
}

fn listed(paths: &[&Path]) -> String {
    if paths.is_empty() {
        return "no files".to_owned();
    }
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const OBJ: &str =
        "mtllib Box.mtl\nv -1 0 0\nv 3 0 0\nv 3 2 0\nv -1 2 -1\nusemtl red\nf 1 2 3 4\n";
    const MTL: &str = "newmtl red\nKd 0.8 0.1 0.1\n";

    fn files(all: &[(&str, &str)]) -> Files {
        let mut files = Files::default();
        for (path, text) in all {
            files.add(path, text.as_bytes().to_vec());
        }
        files
    }

    #[test]
    fn the_scene_is_the_file_that_names_the_others() {
        let scene = |all: &[(&str, &str)]| {
            files(all).scene().map(Path::to_path_buf).map_err(|error| error.to_string())
        };
        assert_eq!(scene(&[("a.obj", ""), ("a.mtl", ""), ("b.JSON", "")]), Ok("b.JSON".into()));
        assert_eq!(scene(&[("d/a.bin", ""), ("d/a.gltf", "")]), Ok("d/a.gltf".into()));
        assert_eq!(scene(&[("a.obj", ""), ("a.mtl", "")]), Ok("a.obj".into()));
        let message = scene(&[("a.glb", ""), ("b.glb", "")]).unwrap_err();
        assert!(message.starts_with("a.glb, b.glb are scenes"), "{message}");
        let message = scene(&[("a.png", ""), ("b.txt", "")]).unwrap_err();
        assert!(message.contains("no scene among a.png, b.txt"), "{message}");
        assert!(scene(&[]).unwrap_err().contains("no files"));
    }

    #[test]
    fn what_a_file_names_is_found() {
        let files = files(&[("d/box.obj", OBJ), ("d/box.mtl", MTL), ("other.txt", "")]);
        let scene = files.load(Path::new("d/box.obj")).unwrap();
        assert_eq!((scene.name.as_str(), scene.triangle_count()), ("box", 2));
        assert!(!scene.warnings.iter().any(|warning| warning.contains("MTL")));
    }

    #[test]
    fn what_is_wrong_is_said_by_name() {
        let files = files(&[("a.glb", "no glTF"), ("b.obj", "f 1 2 3\n"), ("c.json", "{")]);
        for (path, part) in [("a.glb", "a.glb"), ("b.obj", "b.obj"), ("c.json", "c.json")] {
            let message = files.load(Path::new(path)).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
