//! Sums of very many samples: the same on the GPU and on the CPU, bit for bit, and right.

use glam::{DVec3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor, kernels};
use raystream::scene::{Camera, FilmSize, QuadLight, Scene};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::accumulate::{AccumulateParams, LANES_PER_STRETCH};
use raystream_shaders::film::stream::{BY_TURNS, Slot, sample_number};
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::math::random::{hash, unit_float};
use raystream_tests::{prepare, render_on, scenes, settings, with_gpu};

/// Pixels of the film, each brighter than the one before.
const PIXELS: u32 = 64;

/// The unit of films is 2 to this power: lights of 2000 are the brightest.
const UNIT: i32 = -54;

/// A film that has been given the same contributions, a run for each pixel, `times` times.
fn accumulated<E: Executor>(executor: &E, runs: &[Contribution], times: u32) -> Vec<PixelSums> {
    let count = runs.len() as u32;
    let samples = count / PIXELS;
    let slot = |k| Slot { rank: k / samples, sample: sample_number(BY_TURNS, k % samples) };
    let slots: Vec<Slot> = (0..count).map(slot).collect();
    let slots = Array::from_slice(executor, "slots", &slots).unwrap();
    let contributions = Array::from_slice(executor, "contributions", runs).unwrap();
    let film: Array<_, PixelSums> = Array::zeroed(executor, "film", PIXELS as usize).unwrap();
    // Not the length of runs.
    let stretch = 48;
    let parameters = AccumulateParams {
        threads: count.div_ceil(stretch) * LANES_PER_STRETCH,
        first_slot: 0,
        end_slot: count,
        first_rank: 0,
        pixels: PIXELS,
        unit_exponent: UNIT,
        in_runs: 1,
        stretch,
    };
    for _ in 0..times {
        let (from, to) = (contributions.view().cast(), film.view().cast());
        executor.run(&[kernels::accumulate(&parameters, slots.view(), from, to)]).unwrap();
    }
    film.read(executor).unwrap()
}

/// Asserts that the means of a film are those of the contributions that it was given.
fn assert_means(film: &[PixelSums], runs: &[Contribution], what: &str) {
    let samples = runs.len() / PIXELS as usize;
    for (pixel, run) in film.iter().zip(runs.chunks(samples)) {
        let pixel = pixel.to_pixel(UNIT);
        let mean = |of: &dyn Fn(DVec3) -> DVec3| {
            run.iter().map(|c| of(c.radiance.as_dvec3())).sum::<DVec3>() / samples as f64
        };
        let count = f64::from(pixel.samples());
        let error = (pixel.sum().as_dvec3() / count - mean(&|c| c)).abs();
        let squares = (pixel.sum_of_squares.as_dvec3() / count - mean(&|c| c * c)).abs();
        // One rounding of each half's sum, one of their sum.
        let bound = 2.0 * 2_f64.powi(-24);
        assert!(
            error.cmple(bound * mean(&|c| c)).all()
                && squares.cmple(bound * mean(&|c| c * c)).all(),
            "{what}: {pixel:?} after {count} samples"
        );
    }
}

/// The radiance of a slot where each pixel has so many.
type Radiance<'a> = &'a dyn Fn(u32, u32) -> Vec3;

#[test]
fn long_sums_are_right_and_equal_on_all_devices() {
    let constant = |slot: u32, samples: u32| {
        let value = 0.1 * 1.3_f32.powi((slot / samples) as i32 - 30);
        Vec3::new(value, value / 3.0, 0.7 * value)
    };
    let random = |slot: u32, samples: u32| {
        let number = |k: u32| unit_float(hash(slot * 3 + k)).powi(4);
        constant(slot, samples) * Vec3::new(number(0), number(1), number(2))
    };
    for (what, radiance) in [("constants", &constant as Radiance<'_>), ("random numbers", &random)]
    {
        let samples = 4096;
        let run: Vec<Contribution> = (0..PIXELS * samples)
            .map(|slot| Contribution { radiance: radiance(slot, samples), rays: 1 })
            .collect();
        // 2^20 samples a pixel: plain sums would be off by a percent.
        let film = accumulated(&CpuExecutor, &run, 256);
        assert_means(&film, &run, what);
        with_gpu(|gpu| {
            let times = 32;
            let film = accumulated(&CpuExecutor, &run, times);
            assert!(accumulated(gpu, &run, times) == film, "{what}: the GPU's sums");
        });
    }
}

/// A lamp that fills a picture of so many pixels a side.
fn lamp(radiance: f32, side: u32) -> Scene {
    let mut scene = scenes::empty(Vec3::Z * 3.0, Vec3::ZERO);
    scene.film = FilmSize { width: side, height: side };
    let (u, v) = (Vec3::X * 8.0, Vec3::Y * 8.0);
    let light = QuadLight::new(-0.5 * (u + v), u, v, Vec3::splat(radiance));
    scene.add_quad_light(light);
    scene
}

#[test]
fn a_pixel_full_of_light_has_its_radiance_after_ten_million_samples() {
    let radiance = 0.1;
    let assert_exact = |film: &raystream::film::Film, what: &str| {
        for (color, variance) in film.color().iter().zip(film.variance()) {
            let error = (color / radiance - Vec3::ONE).abs().max_element();
            assert!(error < 1e-6, "{what}: off by {error:e}");
            // A constant has no noise but the rounding of its square.
            let spread = variance.max_element() * (film.samples()[0] - 1) as f32;
            assert!(spread < 1e-7 * radiance * radiance, "{what}: {spread:e}");
        }
    };
    let (scene, samples) = (lamp(radiance, 1), 10_000_000);
    let film = render_on(&CpuExecutor, &prepare(&scene), &settings(&scene), samples);
    assert_eq!(film.samples(), [samples]);
    assert_exact(&film, "on the CPU");
    with_gpu(|gpu| {
        let scene = lamp(radiance, 16);
        let film = render_on(gpu, &prepare(&scene), &settings(&scene), 1 << 14);
        assert_exact(&film, "on a GPU");
    });
}

/// A white floor under a small lamp: the mean is known in closed form, and so is the noise.
#[test]
fn a_lit_pixel_keeps_its_mean_over_millions_of_samples() {
    let (side, height, radiance) = (0.1_f64, 1.0_f64, 100.0_f64);
    let mut scene = scenes::empty(Vec3::new(0.0, 0.5, 0.0001), Vec3::ZERO);
    let camera = Camera::new(scene.camera.origin, scene.camera.target, 0.1);
    scene.camera = Camera { up: Vec3::NEG_Z, ..camera };
    scene.film = FilmSize { width: 1, height: 1 };
    scene.limits.max_depth = 2;
    let floor = scene.add_material(scenes::diffuse(1.0));
    scenes::add_quad(&mut scene, Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, floor);
    let corner = Vec3::new(-0.5 * side as f32, height as f32, -0.5 * side as f32);
    let (u, v) = (Vec3::X * side as f32, Vec3::Z * side as f32);
    scene.add_quad_light(QuadLight::new(corner, u, v, Vec3::splat(radiance as f32)));
    // Form factor of a square, seen from below its middle: four of its quarters.
    let ratio = 0.5 * side / height;
    let root = (1.0 + ratio * ratio).sqrt();
    let factor = 4.0 * 2.0 * ratio / root * (ratio / root).atan() / std::f64::consts::TAU;
    let expected = radiance * factor;
    let film = render_on(&CpuExecutor, &prepare(&scene), &settings(&scene), 1 << 22);
    let (color, error) = (f64::from(film.color()[0].x), f64::from(film.variance()[0].x).sqrt());
    assert!(
        (color - expected).abs() < 5.0 * error + 1e-6 * expected && error < 1e-3 * expected,
        "{color} +- {error}, not {expected}"
    );
}
