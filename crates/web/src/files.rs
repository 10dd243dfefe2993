//! Files that were given to the page, and the scene among them.

use raystream::scene::{Environment, FilmSize, LoadOptions, Scene, SceneError};
use serde_json::json;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ffi::OsStr;
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

    /// The scene of a file and of those that it names. An OBJ, which has neither camera nor
    /// background, is seen from where all of it is in the picture, and lit from all around unless
    /// something of it emits light.
    ///
    /// # Errors
    /// If a file is missing or wrong; the message names it.
    pub fn load(&mut self, scene: &Path) -> Result<Scene, SceneError> {
        let options = LoadOptions { max_memory: MAX_MEMORY, ..LoadOptions::default() };
        if scene.extension().is_none_or(|end| !end.eq_ignore_ascii_case("obj")) {
            return options.load_files(&self.0, scene);
        }
        let description = scene.with_extension("obj.json");
        self.0.insert(description.clone(), description_of(scene).into_bytes());
        let loaded = options.load_files(&self.0, &description);
        self.0.remove(&description);
        let mut loaded = loaded?;
        loaded.frame_all();
        if !loaded.emits() {
            loaded.set_environment(Environment::studio());
        }
        let name = scene.display();
        loaded.warnings.push(format!("{name}: an OBJ has no camera; all of it is seen."));
        Ok(loaded)
    }
}

/// A scene file that names an OBJ, with a camera that stands anywhere.
fn description_of(obj: &Path) -> String {
    fn name(part: Option<&OsStr>) -> Cow<'_, str> {
        part.unwrap_or_default().to_string_lossy()
    }
    let FilmSize { width, height } = FilmSize::default();
    json!({
        "format": 1,
        "name": name(obj.file_stem()),
        "obj": name(obj.file_name()),
        "normals": "smooth",
        "film": { "width": width, "height": height },
        "camera": { "origin": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40 },
    })
    .to_string()
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
    use glam::Vec3;
    use raystream::render::scene::camera::camera as on_film;
    use raystream_shaders::scene::abilities::{ALL, Fixed};
    use raystream_shaders::scene::camera::NO_PIXEL;

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
    fn an_obj_is_seen_and_lit_as_a_whole() {
        let mut files = files(&[("d/box.obj", OBJ), ("d/box.mtl", MTL), ("other.txt", "")]);
        let scene = files.load(Path::new("d/box.obj")).unwrap();
        assert_eq!((scene.name.as_str(), scene.triangle_count()), ("box", 2));
        assert!(scene.environment.is_some());
        let camera = on_film(&scene.camera, scene.film);
        let is_seen = |corner: &Vec3| {
            let sight = camera.sight(Fixed::<ALL>, *corner, [0.5; 2]);
            sight.is_ahead && camera.pixel_at(sight.place) != NO_PIXEL
        };
        assert!(scene.meshes.iter().all(|mesh| mesh.positions.iter().all(is_seen)));
        assert!(!is_seen(&Vec3::new(9.0, 0.0, 0.0)));
        assert_eq!(files.0.len(), 3, "nothing is left behind");
    }

    #[test]
    fn an_obj_that_emits_light_is_lit_by_itself() {
        let mut files = files(&[("a.obj", OBJ), ("box.mtl", "newmtl red\nKe 1 1 1\n")]);
        assert!(files.load(Path::new("a.obj")).unwrap().environment.is_none());
    }

    #[test]
    fn what_is_wrong_is_said_by_name() {
        let mut files = files(&[("a.glb", "no glTF"), ("b.obj", "f 1 2 3\n"), ("c.json", "{")]);
        for (path, part) in [("a.glb", "a.glb"), ("b.obj", "b.obj"), ("c.json", "c.json")] {
            let message = files.load(Path::new(path)).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
        assert_eq!(files.0.len(), 3);
    }
}
