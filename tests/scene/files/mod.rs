//! Files as other programs write them become the scene that they mean.

mod alone;
mod geometry;
mod materials;
mod refused;
mod texts;

use raystream::scene::Scene;
use raystream_tests::scene_folder::SceneFolder;
use std::path::Path;

/// A square of the material `plain`, with texture coordinates.
const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl plain\nf 1/1 2/2 3/3 4/4\n";
const TEXTURED: &str = "newmtl plain\nKd 0 1 0\nmap_Kd t.png\n";

fn loaded(folder: &SceneFolder) -> Scene {
    folder.load().unwrap_or_else(|error| panic!("{error}"))
}

/// The scene of an OBJ and an MTL, with a picture of red beside blue called `t.png`.
fn scene(obj: impl AsRef<[u8]>, mtl: impl AsRef<[u8]>) -> Scene {
    loaded(&folder(obj, mtl))
}

fn folder(obj: impl AsRef<[u8]>, mtl: impl AsRef<[u8]>) -> SceneFolder {
    let folder = SceneFolder::new().with("a.obj", obj).with("a.mtl", mtl);
    picture(&folder.path("t.png"));
    folder
}

/// Red beside blue.
fn picture(path: &Path) {
    image::RgbImage::from_raw(2, 1, vec![255, 0, 0, 0, 0, 255]).unwrap().save(path).unwrap();
}

/// The scenes show the same.
#[track_caller]
fn assert_same(scene: &Scene, right: &Scene) {
    assert_eq!(scene.meshes, right.meshes);
    assert_eq!(scene.materials, right.materials);
    assert_eq!(scene.textures, right.textures);
}

#[track_caller]
fn assert_warns(scene: &Scene, parts: &[&str]) {
    let found =
        scene.warnings.iter().any(|warning| parts.iter().all(|part| warning.contains(part)));
    assert!(found, "{:?} say not {parts:?}", scene.warnings);
}
