//! Random numbers on the GPU.

use glam::Vec3;
use raystream::render::Settings;
use raystream::scene::FilmSize;
use raystream_tests::{prepare, render, render_on, scenes, settings, with_gpu};

/// The positions on a flat wall straight ahead are the tracer's random numbers: both samplers draw
/// the same on the GPU.
#[test]
fn random_numbers_are_equal() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::NEG_Z);
    scene.film = FilmSize { width: 16, height: 16 };
    let wall = scene.add_material(scenes::diffuse(0.5));
    scenes::add_quad(&mut scene, Vec3::new(-4.0, -4.0, -1.0), Vec3::X * 8.0, Vec3::Y * 8.0, wall);
    let prepared = prepare(&scene);
    with_gpu(|gpu| {
        for independent_sampler in [false, true] {
            let settings = Settings { independent_sampler, max_depth: 1, ..settings(&scene) };
            let cpu = render(&prepared, &settings, 4).position();
            let gpu = render_on(gpu, &prepared, &settings, 4).position();
            for (pixel, (a, b)) in gpu.iter().zip(&cpu).enumerate() {
                // Pixels are 0.045 wide: a wrong bit among the upper 15 of a number moves the point
                // by more than this.
                assert!((*a - *b).abs().max_element() < 2e-6, "pixel {pixel}: {a} and {b}");
            }
        }
    });
}
