//! The device's camera from the scene's.

use crate::scene::{self, FilmSize, Lens, Projection};
use glam::{DVec3, Vec3};
use raystream_shaders::scene::camera::{Camera, ORTHOGRAPHIC, PANORAMA, PINHOLE, THIN_LENS};
use std::f32::consts::PI;

/// How many widths of its picture a pinhole is away whose rays are taken for parallel.
const FAR_AWAY: f32 = 1000.0;

/// The camera for a picture of `size`. Right-handed, square pixels; `fov_y` spans the picture's
/// height.
pub fn camera(description: &scene::Camera, size: FilmSize) -> Camera {
    let origin = description.origin.as_dvec3();
    let forward = (description.target.as_dvec3() - origin).normalize();
    let right = forward.cross(description.up.as_dvec3()).normalize();
    let up = right.cross(forward);
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    // The plane at this distance, and how large a pixel is there.
    let plane = |distance: f64, pixel: f64| {
        let top_left: DVec3 = forward * distance + (up * height - right * width) * (0.5 * pixel);
        Camera {
            origin: description.origin,
            width: size.width,
            top_left: top_left.as_vec3(),
            height: size.height,
            right: (right * pixel).as_vec3(),
            projection: PINHOLE,
            down: (-up * pixel).as_vec3(),
            lens_radius: 0.0,
        }
    };
    match description.projection {
        Projection::Perspective { fov_y, lens } => {
            let pixel = 2.0 * (f64::from(fov_y).to_radians() / 2.0).tan() / height;
            match lens.filter(|lens| lens.radius > 0.0) {
                None => plane(1.0, pixel),
                Some(Lens { radius, focus_distance, blades }) => {
                    let focus = f64::from(focus_distance);
                    let projection = THIN_LENS + blades;
                    Camera { projection, lens_radius: radius, ..plane(focus, pixel * focus) }
                }
            }
        }
        Projection::Orthographic { width: across } => {
            Camera { projection: ORTHOGRAPHIC, ..plane(0.0, f64::from(across) / width) }
        }
        Projection::Panorama => Camera {
            top_left: forward.as_vec3(),
            right: right.as_vec3(),
            down: (-up).as_vec3(),
            projection: PANORAMA,
            ..plane(1.0, 1.0)
        },
    }
}

/// A pinhole, in world units, and the side of a pixel at distance 1 from it, to whom pixels are as
/// large as to the camera: filters ask no more of it.
pub fn pinhole(camera: &Camera) -> (Vec3, f32) {
    let pixel = camera.right.length();
    match camera.projection {
        PINHOLE => (camera.origin, pixel),
        PANORAMA => (camera.origin, PI / camera.height as f32),
        ORTHOGRAPHIC => {
            let distance = FAR_AWAY * pixel * camera.width.max(camera.height) as f32;
            let axis = camera.right.cross(camera.down).normalize();
            (camera.origin - axis * distance, pixel / distance)
        }
        _ => {
            let axis = camera.right.cross(camera.down).normalize();
            (camera.origin, pixel / axis.dot(camera.top_left))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::scene::abilities::{ALL, Fixed};

    const SIZE: FilmSize = FilmSize { width: 200, height: 100 };
    const MIDDLE: [f32; 2] = [0.5; 2];

    fn close(a: Vec3, b: Vec3) {
        assert!((a - b).length() < 1e-6, "{a} {b}");
    }

    fn of(projection: Projection) -> Camera {
        let description = scene::Camera::new(Vec3::ZERO, Vec3::NEG_Z, 90.0);
        camera(&scene::Camera { projection, ..description }, SIZE)
    }

    fn perspective(lens: Option<Lens>) -> Camera {
        of(Projection::Perspective { fov_y: 90.0, lens })
    }

    #[test]
    fn the_middle_of_the_picture_is_the_target_and_the_top_is_up() {
        let lens = Lens { radius: 0.2, focus_distance: 3.0, blades: 0 };
        for camera in [perspective(None), perspective(Some(lens))] {
            let direction = |x, y| camera.ray(Fixed::<ALL>, [x, y], MIDDLE).direction;
            close(direction(100.0, 50.0), Vec3::NEG_Z);
            close(direction(100.0, 0.0), Vec3::new(0.0, 1.0, -1.0).normalize());
            close(direction(200.0, 50.0), Vec3::new(2.0, 0.0, -1.0).normalize());
        }
    }

    #[test]
    fn a_lens_of_radius_0_is_a_pinhole() {
        let lens = Lens { radius: 0.0, focus_distance: 3.0, blades: 5 };
        assert_eq!(perspective(Some(lens)), perspective(None));
    }

    #[test]
    fn parallel_rays_start_on_the_plane_through_the_camera() {
        let camera = of(Projection::Orthographic { width: 4.0 });
        for (place, origin) in [
            ([100.0, 50.0], Vec3::ZERO),
            ([0.0, 0.0], Vec3::new(-2.0, 1.0, 0.0)),
            ([200.0, 100.0], Vec3::new(2.0, -1.0, 0.0)),
        ] {
            let ray = camera.ray(Fixed::<ALL>, place, MIDDLE);
            close(ray.origin, origin);
            close(ray.direction, Vec3::NEG_Z);
        }
    }

    #[test]
    fn a_panorama_has_the_target_in_its_middle_and_up_at_its_top() {
        let camera = of(Projection::Panorama);
        for (place, direction) in [
            ([100.0, 50.0], Vec3::NEG_Z),
            ([150.0, 50.0], Vec3::X),
            ([50.0, 50.0], Vec3::NEG_X),
            ([0.0, 50.0], Vec3::Z),
            ([77.0, 0.0], Vec3::Y),
            ([100.0, 75.0], Vec3::new(0.0, -1.0, -1.0).normalize()),
        ] {
            close(camera.ray(Fixed::<ALL>, place, MIDDLE).direction, direction);
        }
    }

    #[test]
    fn filters_see_pixels_as_large_as_the_camera_does() {
        let side = |camera: &Camera, point: Vec3| {
            let (origin, pitch) = pinhole(camera);
            pitch * (point - origin).length()
        };
        let at_2 = Vec3::NEG_Z * 2.0;
        let lens = Lens { radius: 0.2, focus_distance: 3.0, blades: 0 };
        for (camera, expected) in [
            (perspective(None), 0.04),
            (perspective(Some(lens)), 0.04),
            (of(Projection::Orthographic { width: 4.0 }), 0.02),
            (of(Projection::Panorama), 2.0 * PI / 100.0),
        ] {
            let found = side(&camera, at_2);
            assert!((found / expected - 1.0).abs() < 1e-3, "{camera:?}: {found} {expected}");
        }
    }
}
