//! glTF files become the scenes that they mean, or errors that say where they are wrong.

mod broken;
mod geometry;
mod materials;
mod models;
mod picture;
mod surroundings;

use raystream::scene::Scene;

#[track_caller]
fn assert_warns(scene: &Scene, parts: &[&str]) {
    let found =
        scene.warnings.iter().any(|warning| parts.iter().all(|part| warning.contains(part)));
    assert!(found, "{:?} say not {parts:?}", scene.warnings);
}
