//! Files in memory, as a place to load a scene from.

use super::error::SceneError;
use super::source::{Disk, Source};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Files by their paths.
pub(super) struct Memory<'a>(pub &'a BTreeMap<PathBuf, Vec<u8>>);

impl Source for Memory<'_> {
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        let path: PathBuf =
            folder.join(name).components().filter(|part| *part != Component::CurDir).collect();
        if self.0.contains_key(&path) {
            return Some(path);
        }
        let lower = |path: &Path| path.to_str().map(str::to_lowercase);
        let wanted = lower(&path)?;
        self.0.keys().find(|known| lower(known).as_ref() == Some(&wanted)).cloned()
    }

    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        let missing = || SceneError::Read {
            path: path.to_owned(),
            source: std::io::ErrorKind::NotFound.into(),
        };
        let bytes = self.0.get(path).ok_or_else(missing)?;
        if bytes.len() as u64 > limit {
            return Err(SceneError::TooLong { path: path.to_owned(), limit });
        }
        Ok(bytes.clone())
    }
}

/// Files of the disk, but for those that are in memory.
pub(super) struct Over<'a>(pub Memory<'a>);

impl Source for Over<'_> {
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        self.0.find(folder, name).or_else(|| Disk.find(folder, name))
    }

    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        let Self(Memory(files)) = self;
        if files.contains_key(path) { self.0.read(path, limit) } else { Disk.read(path, limit) }
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::{LoadOptions, SceneError};
    use std::collections::BTreeMap;
    use std::path::{Path, PathBuf};

    #[test]
    fn a_scene_in_memory_is_loaded() {
        let json = r#"{"format": 1, "name": "x", "obj": "./Parts/A.obj",
            "film": {"width": 8, "height": 6},
            "camera": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40}}"#;
        let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
        let files = [("s.json", json), ("parts/a.obj", obj), ("parts/a.mtl", "newmtl a\nKe 1 1 1")];
        let mut files: BTreeMap<PathBuf, Vec<u8>> =
            files.map(|(path, text)| (path.into(), text.into())).into();
        let load =
            |files: &BTreeMap<_, _>| LoadOptions::default().load_files(files, Path::new("s.json"));
        let scene = load(&files).unwrap();
        assert_eq!((scene.triangle_count(), scene.warnings.len()), (1, 0), "{:?}", scene.warnings);
        files.remove(Path::new("parts/a.obj"));
        assert!(matches!(load(&files), Err(SceneError::Missing { .. })));
        files.clear();
        assert!(matches!(load(&files), Err(SceneError::Read { .. })));
    }
    #[test]
    fn files_in_memory_lie_over_those_of_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        let on_disk = folder.path().join("a.mtl");
        std::fs::write(&on_disk, "newmtl a\nKe 1 1 1").unwrap();
        let json = format!(
            r#"{{"format": 2, "name": "x", "film": {{"width": 8, "height": 6}},
            "meshes": [{{"file": {:?}}}],
            "camera": {{"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40}}}}"#,
            folder.path().join("a.obj")
        );
        let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
        let files = [("s.json".into(), json), (folder.path().join("a.obj"), obj.to_owned())];
        let files = files.map(|(path, text)| (path, text.into_bytes())).into();
        let load = || LoadOptions::default().load_files_over_disk(&files, Path::new("s.json"));
        assert!(load().unwrap().emits());
        std::fs::remove_file(on_disk).unwrap();
        assert!(!load().unwrap().emits());
    }
}
