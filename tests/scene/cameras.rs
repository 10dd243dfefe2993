//! Cameras that are no pinholes: where their rays start and go, and what they say of that.

use glam::{DVec3, Vec3};
use raystream::render::scene::camera::camera;
use raystream::scene::{self, FilmSize};
use raystream_shaders::math::random::{LENS, hash, unit_float};
use raystream_shaders::scene::abilities::{ALL, Fixed};
use raystream_shaders::scene::camera::{Camera, NO_PIXEL, Sight, THIN_LENS};
use raystream_tests::cameras::others;
use raystream_tests::histogram::{SAMPLERS, assert_uniform, cell, histogram, points};
use raystream_tests::prepare;
use std::f64::consts::{FRAC_PI_2, TAU};

const SIZE: FilmSize = FilmSize { width: 200, height: 100 };
const ABILITIES: Fixed<ALL> = Fixed;

/// Those of an oblique view, the pinhole first.
fn cameras() -> Vec<(&'static str, Camera)> {
    let origin = Vec3::new(3.0, -2.0, 5.0);
    let pinhole = scene::Camera::new(origin, Vec3::new(0.0, 1.0, -2.0), 50.0);
    let all = [vec![("a pinhole", pinhole)], others(pinhole)].concat();
    all.into_iter().map(|(name, description)| (name, camera(&description, SIZE))).collect()
}

#[test]
fn seeing_through_another_camera_is_preparing_the_scene_for_it() {
    for name in ["cornell_ball", "tea", "daylight"] {
        let mut scene = scene::load_named(name).unwrap();
        let middle = scene.meshes[0].positions[0];
        let mut moved = prepare(&scene);
        let pinhole = scene::Camera::new(middle + Vec3::new(0.01, 0.02, 0.03), Vec3::Z * 9.0, 50.0);
        let all = [vec![("a pinhole", pinhole)], others(pinhole)].concat();
        let own = [("its own", scene.camera)];
        for (kind, camera) in all.into_iter().chain(own) {
            moved.set_camera(camera).unwrap();
            scene.camera = camera;
            let anew = prepare(&scene);
            assert_eq!(moved.camera, camera);
            assert_eq!(moved.abilities, anew.abilities, "{name} by {kind}");
            assert!(moved.surfaces == anew.surfaces, "{name} by {kind}");
            assert!(moved.geometry == anew.geometry, "{name} by {kind}");
        }
    }
}

#[test]
fn a_camera_without_a_direction_is_refused_and_the_one_before_stays() {
    let scene = scene::load_named("cornell_ball").unwrap();
    let mut prepared = prepare(&scene);
    let camera = scene::Camera::new(Vec3::ONE, Vec3::ONE, 40.0);
    let error = prepared.set_camera(camera).unwrap_err().to_string();
    assert!(error.contains("camera") && error.contains("direction"), "{error}");
    assert_eq!(prepared.camera, scene.camera);
}

fn number(k: u32) -> f32 {
    unit_float(hash(k))
}

/// What a ray meets is seen where the ray came from.
#[test]
fn rays_and_sights_are_inverse() {
    for (name, camera) in cameras() {
        for k in 0..2000 {
            let [x, y, u, v, t] = [0, 1, 2, 3, 4].map(|n| number(5 * k + n));
            let (place, lens) = ([200.0 * x, 1.0 + 98.0 * y], [u, v]);
            let ray = camera.ray(ABILITIES, place, lens);
            assert!((ray.direction.length() - 1.0).abs() < 1e-6, "{name}");
            let distance = 0.5 + 20.0 * t;
            let point = ray.origin + ray.direction * distance;
            let sight: Sight = camera.sight(ABILITIES, point, lens);
            assert!(sight.is_ahead, "{name}");
            // A direction has some 1e-6 of error, a pixel is 1e-2; near a panorama's poles its
            // columns are as much narrower as the sine of 1 in 100 of half a turn.
            let mut off = [0, 1].map(|i| (sight.place[i] - place[i]).abs());
            if name == "a panorama" {
                off[0] = off[0].min(200.0 - off[0]);
            }
            let off = off[0].max(off[1]);
            assert!(off < 0.02, "{name}: {place:?} {:?}", sight.place);
            assert!((sight.direction + ray.direction).length() < 2e-5, "{name}");
            assert!((sight.origin - ray.origin).length() < 2e-5 * distance, "{name}");
            let pixel = place[1] as u32 * 200 + place[0] as u32;
            let is_near_edge = place.iter().any(|&place| (place - place.round()).abs() < 0.02);
            assert!(is_near_edge || camera.pixel_at(sight.place) == pixel, "{name}: {place:?}");
        }
        assert_eq!(camera.pixel_at([-0.1, 5.0]), NO_PIXEL);
        assert_eq!(camera.pixel_at([5.0, 100.0]), NO_PIXEL);
    }
}

#[test]
fn what_is_behind_is_not_seen() {
    for (name, camera) in cameras() {
        let ray = camera.ray(ABILITIES, [100.0, 50.0], [0.5; 2]);
        let behind = ray.origin - ray.direction;
        let is_ahead = camera.sight(ABILITIES, behind, [0.5; 2]).is_ahead;
        assert_eq!(is_ahead, name == "a panorama", "{name}");
    }
}

/// Places on the film are uniform, so the density of directions is 1 over the solid angle that a
/// unit of the film takes, and that of parallel rays 1 over its area.
#[test]
fn densities_are_those_of_the_rays() {
    const STEP: f32 = 0.5;
    for (name, camera) in cameras() {
        for k in 0..200 {
            let place = [1.0 + 198.0 * number(2 * k), 2.0 + 96.0 * number(2 * k + 1)];
            let lens = [0.3, 0.8];
            let at = |dx: f32, dy: f32| {
                let ray = camera.ray(ABILITIES, [place[0] + dx, place[1] + dy], lens);
                let parallel = name == "parallel rays";
                (if parallel { ray.origin } else { ray.direction }).as_dvec3()
            };
            let across: DVec3 = at(STEP, 0.0) - at(-STEP, 0.0);
            let down: DVec3 = at(0.0, STEP) - at(0.0, -STEP);
            let extent = across.cross(down).length() / f64::from(4.0 * STEP * STEP);
            let direction = camera.ray(ABILITIES, place, lens).direction;
            let pdf = f64::from(camera.pdf(ABILITIES, direction));
            // Chords of half a pixel's arc, and directions rounded to 1e-7 of 1e-2.
            assert!((pdf * extent - 1.0).abs() < 2e-3, "{name}: {pdf} {extent} at {place:?}");
        }
    }
}

#[test]
fn points_of_the_lens_are_uniform() {
    for (name, camera) in cameras().into_iter().filter(|(_, c)| c.projection >= THIN_LENS) {
        let blades = camera.projection - THIN_LENS;
        for (kind, sampler) in SAMPLERS {
            let cells = points(kind, LENS, 1 << 16).map(|lens| {
                let ray = camera.ray(ABILITIES, [13.0, 70.0], lens);
                let from = (ray.origin - camera.origin).as_dvec3() / f64::from(camera.lens_radius);
                let [right, down] = [camera.right, camera.down].map(|v| v.as_dvec3().normalize());
                let (x, y) = (from.dot(right), from.dot(down));
                // Corners lie on the unit circle, one of them at the top.
                let turns = ((y.atan2(x) + FRAC_PI_2) / TAU).rem_euclid(1.0);
                let (side, outwards) = if blades == 0 {
                    (cell(turns, 20), x * x + y * y)
                } else {
                    let corners = f64::from(blades);
                    let side = (turns * corners).floor();
                    let middle = (side + 0.5) / corners * TAU - FRAC_PI_2;
                    let height =
                        (x * middle.cos() + y * middle.sin()) / (0.5 * TAU / corners).cos();
                    (side as usize, height * height)
                };
                assert!(outwards < 1.0 + 1e-5, "{name}: ({x}, {y})");
                side * 16 + cell(outwards, 16)
            });
            let sides = if blades == 0 { 20 } else { blades as usize };
            assert_uniform(&histogram(sides * 16, cells), &format!("{name}, {sampler}"));
        }
    }
}

/// All rays through a place of the film meet where the lens is in focus. Elsewhere they spread over
/// a picture of the aperture.
#[test]
fn a_point_in_focus_stays_where_it_is() {
    for (name, camera) in cameras().into_iter().filter(|(_, c)| c.projection >= THIN_LENS) {
        let axis = camera.right.cross(camera.down).normalize();
        let focus = axis.dot(camera.top_left);
        let spread = |depth: f32| {
            let on_plane = camera.top_left + camera.right * 31.0 + camera.down * 12.0;
            let at = |lens| {
                let ray = camera.ray(ABILITIES, [31.0, 12.0], lens);
                ray.origin + ray.direction * (depth / axis.dot(ray.direction))
            };
            let centre = camera.origin + on_plane * (depth / focus);
            let offsets =
                (0..1000).map(|k| (at([number(2 * k), number(2 * k + 1)]) - centre).length());
            offsets.fold(0.0, f32::max)
        };
        assert!(spread(focus) < 1e-5 * focus, "{name}: {}", spread(focus));
        // Similar triangles.
        for depth in [0.5 * focus, 2.0 * focus] {
            let blur = camera.lens_radius * (depth / focus - 1.0).abs();
            let found = spread(depth);
            assert!(found < 1.001 * blur && found > 0.9 * blur, "{name}: {found} {blur}");
        }
    }
}
