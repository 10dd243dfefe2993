//! A scene of one triangle in a temporary folder, for tests to change.

use glam::DVec3;
use raystream::scene::{Scene, SceneError, load};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use tempfile::TempDir;

/// One triangle of each of two materials, the second with texture coordinates.
pub const OBJ: &str = "mtllib a.mtl\n\
    v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n\
    usemtl plain\nf 1//1 2//1 3//1\nusemtl red wall\nf 1/1/1 2/2/1 3/3/1\n";

/// Describes both materials.
pub const MTL: &str = "newmtl plain\nKd 0.1 0.2 0.3\nnewmtl red wall\nKd 1 0 0\n";

/// A folder with `scene.json`, `a.obj` and `a.mtl`, removed when dropped.
pub struct SceneFolder {
    folder: TempDir,
}

impl Default for SceneFolder {
    fn default() -> Self {
        Self::new()
    }
}

impl SceneFolder {
    /// The scene that loads.
    pub fn new() -> Self {
        let folder = Self { folder: tempfile::tempdir().unwrap() };
        folder.with("a.obj", OBJ).with("a.mtl", MTL).json(|_| ())
    }

    /// Writes a file.
    pub fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        std::fs::write(self.path(name), content).unwrap();
        self
    }

    /// Removes a file.
    pub fn without(self, name: &str) -> Self {
        std::fs::remove_file(self.path(name)).unwrap();
        self
    }

    /// Writes the scene file after `change`.
    pub fn json(self, change: impl FnOnce(&mut Value)) -> Self {
        let mut scene = json!({
            "format": 1,
            "name": "test",
            "obj": "a.obj",
            "film": {"width": 8, "height": 6},
            "camera": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40},
            "quads": [{"corner": [0, 0, 3], "u": [1, 0, 0], "v": [0, 1, 0], "radiance": [1, 2, 3]}],
        });
        change(&mut scene);
        let text = serde_json::to_string_pretty(&scene).unwrap();
        self.with("scene.json", text)
    }

    /// Overrides the material `plain`.
    pub fn plain(self, rule: Value) -> Self {
        self.json(|scene| scene["materials"] = json!({"plain": rule}))
    }

    /// The path of a file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Loads `scene.json`.
    pub fn load(&self) -> Result<Scene, SceneError> {
        load(&self.path("scene.json"))
    }

    /// The message of the error that loading gives.
    pub fn error(&self) -> String {
        match self.load() {
            Ok(_) => panic!("a bad scene was accepted"),
            Err(error) => error.to_string(),
        }
    }
}

/// The meshes of `scene` as an OBJ, their positions where `at` puts them, with all digits. Material
/// number 3 is called `m3`.
pub fn obj_of(scene: &Scene, at: impl Fn(DVec3) -> DVec3) -> String {
    let mut obj = String::new();
    let mut vertices = 0;
    for mesh in &scene.meshes {
        writeln!(obj, "usemtl m{}", mesh.material.0).unwrap();
        for position in &mesh.positions {
            let DVec3 { x, y, z } = at(position.as_dvec3());
            writeln!(obj, "v {x} {y} {z}").unwrap();
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| vertices + corner + 1);
            writeln!(obj, "f {a} {b} {c}").unwrap();
        }
        vertices += mesh.positions.len() as u32;
    }
    obj
}
