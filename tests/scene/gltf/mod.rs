//! glTF files become the scenes that they mean, or errors that say where they are wrong.

mod animation;
mod broken;
mod draco;
mod geometry;
mod layouts;
mod materials;
mod meshopt;
mod models;
mod picture;
mod surroundings;
mod tangents;

use glam::Vec3;
use raystream::scene::Scene;

/// The corners of all triangles.
fn corners(scene: &Scene) -> Vec<[Vec3; 3]> {
    let meshes = scene.meshes.iter();
    meshes.flat_map(|mesh| (0..mesh.triangles.len()).map(|at| mesh.corners(at))).collect()
}

#[track_caller]
fn assert_warns(scene: &Scene, parts: &[&str]) {
    let found =
        scene.warnings.iter().any(|warning| parts.iter().all(|part| warning.contains(part)));
    assert!(found, "{:?} say not {parts:?}", scene.warnings);
}
