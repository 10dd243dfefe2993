//! The point inside the pixel.

use glam::{DMat3, DVec3, Vec3};
use raystream_shaders::math::random::PIXEL;
use raystream_shaders::scene::abilities::{BASIC, Fixed};
use raystream_shaders::scene::camera::Camera;
use raystream_tests::histogram::{SAMPLERS, assert_uniform_over_square, points};

/// An oblique camera, so that mixed-up axes show.
fn camera() -> Camera {
    Camera {
        origin: Vec3::new(3.0, -2.0, 5.0),
        width: 200,
        top_left: Vec3::new(-0.9, 0.8, -1.1),
        height: 100,
        right: Vec3::new(0.009, 0.001, 0.002),
        down: Vec3::new(0.001, -0.012, 0.003),
        ..Default::default()
    }
}

/// Where a ray from the pinhole meets the picture plane, in pixels.
fn picture_place(camera: &Camera, direction: DVec3) -> [f64; 2] {
    let axes = [camera.top_left, camera.right, camera.down].map(Vec3::as_dvec3);
    let along = DMat3::from_cols(axes[0], axes[1], axes[2]).inverse() * direction;
    assert!(along.x > 0.0, "the ray goes forwards");
    [along.y / along.x, along.z / along.x]
}

#[test]
fn rays_are_uniform_over_their_pixel() {
    let camera = camera();
    for (kind, name) in SAMPLERS {
        for (x, y) in [(0, 0), (137, 42), (199, 99), (0, 99)] {
            let inside = points(kind, PIXEL, 1 << 18).map(|jitter| {
                let place = [x as f32 + jitter[0], y as f32 + jitter[1]];
                let ray = camera.ray(Fixed::<BASIC>, place, [0.0; 2]);
                assert_eq!(ray.origin, camera.origin);
                assert!((ray.direction.length() - 1.0).abs() < 1e-6);
                let [u, v] = picture_place(&camera, ray.direction.as_dvec3());
                let (u, v) = (u - f64::from(x), v - f64::from(y));
                // Directions are exact to some 1e-7, and a pixel is some 1e-2 of the picture
                // plane's distance.
                for (drawn, found) in jitter.into_iter().zip([u, v]) {
                    assert!(
                        (f64::from(drawn) - found).abs() < 1e-4,
                        "{jitter:?} became ({u}, {v})"
                    );
                }
                [u, v].map(|place| place.clamp(0.0, 1.0 - 1e-6) as f32)
            });
            assert_uniform_over_square(inside, &format!("{name}: pixel ({x}, {y})"));
        }
    }
}
