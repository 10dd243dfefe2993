//! A camera for what comes without one.

use super::camera::Camera;
use super::description::Scene;
use super::film::FilmSize;
use glam::Vec3;

/// From the middle of what is seen to the camera: from the front, a little from the right and from
/// above. glTF's front is +z.
const TOWARDS_CAMERA: Vec3 = Vec3::new(0.5, 0.4, 1.0);
/// Vertical angle of view, in degrees.
const FOV_Y: f32 = 35.0;
/// So many times as far as where all would just be in the picture.
const MARGIN: f32 = 1.08;

/// How warnings end of scenes whose file has no camera.
pub(super) const FRAMED: &str = "the picture is taken from where all of it is seen.";

/// The camera of a scene until it [is framed](Scene::frame_all), where its file has none.
pub(super) const TO_BE_FRAMED: Camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);

impl Scene {
    /// Puts the camera where all meshes and instances are in the picture, which has the default
    /// size: before them, a little to the right and above.
    pub fn frame_all(&mut self) {
        self.film = FilmSize::default();
        self.camera = around(self);
    }
}

/// A camera that sees all of the meshes in a picture of the film's size.
fn around(scene: &Scene) -> Camera {
    let corners = || scene.outermost();
    let Some([low, high]) = scene.bounds().filter(|[low, high]| low != high) else {
        return Camera::new(TOWARDS_CAMERA, Vec3::ZERO, FOV_Y);
    };
    let middle = low * 0.5 + high * 0.5;
    let back = TOWARDS_CAMERA.normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let across_y = (FOV_Y.to_radians() / 2.0).tan();
    let across_x = across_y * scene.film.width as f32 / scene.film.height as f32;
    let needed = |corner: Vec3| {
        let from = corner - middle;
        let aside = (from.dot(right).abs() / across_x).max(from.dot(up).abs() / across_y);
        from.dot(back) + aside
    };
    let distance = corners().map(needed).fold(0.0, f32::max) * MARGIN;
    Camera::new(middle + back * distance, middle, FOV_Y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Projection};

    #[test]
    fn all_is_seen_and_fills_the_picture() {
        let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
        for (scale, at) in [(1.0, Vec3::ZERO), (1e-4, Vec3::ONE), (1e6, Vec3::new(-3e6, 0.0, 7e5))]
        {
            let mut scene = Scene::new(camera, FilmSize { width: 2, height: 1 });
            let grey = scene.add_material(Material::diffuse(Vec3::ONE));
            let corners = [Vec3::ZERO, Vec3::new(4.0, 1.0, 0.0), Vec3::new(0.0, 3.0, -2.0)];
            let positions = corners.map(|corner| at + corner * scale).to_vec();
            scene.add_mesh(Mesh::new(grey, positions.clone(), vec![[0, 1, 2]]));
            scene.frame_all();
            let Camera { origin, target, projection, .. } = scene.camera;
            let Projection::Perspective { fov_y, .. } = projection else {
                panic!("{projection:?}");
            };
            let view = (target - origin).normalize();
            let right = view.cross(Vec3::Y).normalize();
            let up = right.cross(view);
            let across = (fov_y.to_radians() / 2.0).tan();
            let aspect = scene.film.width as f32 / scene.film.height as f32;
            let place = |p: &Vec3| {
                let (from, depth) = (*p - origin, (*p - origin).dot(view));
                assert!(depth > 0.0);
                (from.dot(right).abs() / aspect).max(from.dot(up).abs()) / (depth * across)
            };
            let farthest = positions.iter().map(place).fold(0.0, f32::max);
            assert!((0.7..1.0).contains(&farthest), "{scale}: {farthest}");
            assert_eq!(scene.check(), Ok(()));
        }
    }
}
