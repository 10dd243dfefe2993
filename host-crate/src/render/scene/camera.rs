//! The device's camera from the scene's.

use crate::scene::{self, FilmSize};
use glam::DVec3;
use raystream_shaders::scene::camera::Camera;

/// The camera for a picture of `size`. Right-handed, square pixels; `fov_y` spans the picture's
/// height.
pub fn camera(description: &scene::Camera, size: FilmSize) -> Camera {
    let origin = description.origin.as_dvec3();
    let forward = (description.target.as_dvec3() - origin).normalize();
    let right = forward.cross(description.up.as_dvec3()).normalize();
    let up = right.cross(forward);
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let pixel = 2.0 * (f64::from(description.fov_y).to_radians() / 2.0).tan() / height;
    let top_left: DVec3 = forward + (up * height - right * width) * (0.5 * pixel);
    Camera {
        origin: description.origin,
        width: size.width,
        top_left: top_left.as_vec3(),
        height: size.height,
        right: (right * pixel).as_vec3(),
        pad0: 0,
        down: (-up * pixel).as_vec3(),
        pad1: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_middle_of_the_picture_is_the_target_and_the_top_is_up() {
        let description = scene::Camera::new(Vec3::ZERO, Vec3::NEG_Z, 90.0);
        let camera = camera(&description, FilmSize { width: 200, height: 100 });
        let close = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-6, "{a} {b}");
        close(camera.ray(100, 50, [0.0, 0.0]).direction, Vec3::NEG_Z);
        close(camera.ray(100, 0, [0.0, 0.0]).direction, Vec3::new(0.0, 1.0, -1.0).normalize());
        close(camera.ray(199, 50, [1.0, 0.0]).direction, Vec3::new(2.0, 0.0, -1.0).normalize());
    }
}
