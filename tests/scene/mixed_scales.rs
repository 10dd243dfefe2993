//! Something small on a surface that goes on far: how far is not to be seen.

use glam::{DVec3, Mat3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::{Settings, Techniques};
use raystream::scene::{Camera, FilmSize, Scene};
use raystream_tests::scenes::{add_box, add_quad, diffuse, emissive};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render_on, settings, with_gpu};

/// How far the surface goes.
const EXTENTS: [f32; 3] = [16.0, 1e4, 1e6];

/// A block of a tenth that stands on the middle of a square of `extent`, lit by a small lamp. The
/// square is turned by an angle whose sine and cosine are 0.6 and 0.8: all of its corners are
/// numbers without a rounding.
fn block_on_plane(extent: f32) -> Scene {
    let turn = Mat3::from_cols(Vec3::new(0.8, -0.6, 0.0), Vec3::new(0.6, 0.8, 0.0), Vec3::Z);
    let size = FilmSize { width: 24, height: 16 };
    let camera = Camera::new(turn * Vec3::new(0.3, 0.35, 0.6), turn * Vec3::Y * 0.03, 30.0);
    let mut scene = Scene::new(camera, size);
    let [ground, block] = [0.8, 0.5].map(|reflectance| scene.add_material(diffuse(reflectance)));
    let lamp = scene.add_material(emissive(6.0, 0.0));
    let (u, v) = (Vec3::Z * extent, Vec3::new(4.0, -3.0, 0.0) * (extent / 4.0));
    add_quad(&mut scene, -u - v, 2.0 * u, 2.0 * v, ground);
    let first = scene.meshes.len();
    let low = Vec3::new(-0.05, 0.0, -0.05);
    add_box(&mut scene, low, Vec3::new(0.05, 0.1, 0.05), false, block);
    let across = Vec3::X * 0.2;
    add_quad(&mut scene, Vec3::new(-0.5, 0.8, -0.1), across, Vec3::Z * 0.2, lamp);
    for mesh in &mut scene.meshes[first..] {
        for position in &mut mesh.positions {
            *position = turn * *position;
        }
    }
    scene
}

/// A small block under a lamp that goes on far, both turned as above: the block's shadow is a hole
/// in the light that comes from all sides, so all of the picture is the lamp's.
fn block_under_wide_lamp(extent: f32) -> Scene {
    let mut scene = block_on_plane(EXTENTS[0]);
    scene.meshes.pop();
    let lamp = scene.add_material(emissive(1.0, 0.0));
    // Faces down, at a height of one: its middle is (0.6, 0.8, 0).
    let (u, v) = (Vec3::Z * extent, Vec3::new(4.0, -3.0, 0.0) * (extent / 4.0));
    add_quad(&mut scene, Vec3::new(0.6, 0.8, 0.0) - u - v, 2.0 * v, 2.0 * u, lamp);
    scene
}

fn mean(film: &Film) -> DVec3 {
    film.color().iter().map(|color| color.as_dvec3()).sum::<DVec3>() / film.color().len() as f64
}

#[test]
fn a_wide_plane_keeps_the_shadows_on_it() {
    let of = |extent: f32, seed| {
        let scene = block_on_plane(extent);
        let settings = Settings { seed, ..settings(&scene) };
        (prepare(&scene), settings)
    };
    let (scene, settings) = of(EXTENTS[0], 1);
    let near = render_on(&CpuExecutor, &scene, &settings, 1024);
    for (seed, extent) in (2..).zip(EXTENTS) {
        let (scene, settings) = of(extent, seed);
        let wide = render_on(&CpuExecutor, &scene, &settings, 1024);
        assert_same_expectation(&near, &wide, &format!("a plane of {extent}"));
        with_gpu(|gpu| {
            let wide = render_on(gpu, &scene, &settings, 64);
            assert_same_expectation(&near, &wide, &format!("a plane of {extent} on a GPU"));
        });
    }
}

/// What light sampling finds of a lamp is what BSDF sampling finds of it, however far it goes: no
/// point of the lamp is in the lamp's own way.
#[test]
fn a_wide_lamp_does_not_shade_itself() {
    for (seed, extent) in (1..).zip(EXTENTS) {
        let scene = block_under_wide_lamp(extent);
        let prepared = prepare(&scene);
        let [both, by_direction] =
            [(Techniques::Both, seed), (Techniques::BsdfSampling, seed + 10)].map(
                |(techniques, seed)| {
                    let settings = Settings { seed, techniques, ..settings(&scene) };
                    render_on(&CpuExecutor, &prepared, &settings, 1024)
                },
            );
        assert!(mean(&by_direction).min_element() > 0.2, "the lamp is seen");
        assert_same_expectation(&both, &by_direction, &format!("a lamp of {extent}"));
    }
}
