//! Light from all around, against what is known of it, and by all ways to find it.

use glam::{DVec3, Vec3};
use raystream::film::Film;
use raystream::render::{Settings, Techniques};
use raystream::scene::{Environment, Scene};
use raystream_tests::scenes::{self, add_ball, add_quad};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, settings, with_gpu};
use std::f64::consts::{PI, TAU};

const TECHNIQUES: [Techniques; 3] =
    [Techniques::Both, Techniques::LightSampling, Techniques::BsdfSampling];

/// The same radiance from everywhere.
fn constant(radiance: f32) -> Environment {
    Environment::new(8, 4, vec![Vec3::splat(radiance); 32])
}

fn mean_and_error(film: &Film) -> (DVec3, f64) {
    let pixels = film.radiance.len() as f64;
    let mean = film.color().iter().map(|c| c.as_dvec3()).sum::<DVec3>() / pixels;
    let variance = film.variance().iter().map(|v| f64::from(v.x)).sum::<f64>() / (pixels * pixels);
    (mean, variance.sqrt())
}

/// Two balls, one of them of glass, before a floor.
fn balls() -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.5, 4.0), Vec3::ZERO);
    let floor = scene.add_material(scenes::diffuse(0.6));
    let glass = scene.add_material(scenes::glass(1.5));
    add_quad(&mut scene, Vec3::new(-3.0, -1.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0, floor);
    add_ball(&mut scene, Vec3::new(-0.8, 0.0, 0.0), 0.8, 2, floor);
    add_ball(&mut scene, Vec3::new(0.7, 0.1, 0.3), 0.6, 2, glass);
    scene
}

#[test]
fn a_constant_environment_is_a_background() {
    let mut before = balls();
    before.background = Vec3::splat(0.75);
    let mut around = balls();
    around.set_environment(constant(0.75));
    let expected = render(&prepare(&before), &settings(&before), 1024);
    for techniques in TECHNIQUES {
        let settings = Settings { seed: 2, techniques, ..settings(&around) };
        let found = render(&prepare(&around), &settings, 1024);
        assert_same_expectation(&expected, &found, &format!("{techniques:?}"));
    }
}

#[test]
fn a_white_furnace_stays_white_on_average() {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.3, 4.0), Vec3::ZERO);
    let white = scene.add_material(scenes::diffuse(1.0));
    add_ball(&mut scene, Vec3::new(-0.8, 0.0, 0.0), 0.8, 3, white);
    add_ball(&mut scene, Vec3::new(0.7, 0.1, 0.3), 0.6, 2, white);
    scene.set_environment(constant(1.0));
    for techniques in TECHNIQUES {
        let settings =
            Settings { techniques, max_depth: 1000, roulette_depth: 2000, ..settings(&scene) };
        let (mean, error) = mean_and_error(&render(&prepare(&scene), &settings, 64));
        let off = (mean - 1.0).abs().max_element();
        assert!(off <= 4.5 * error + 1e-4, "{techniques:?}: {mean}, {error}");
    }
}

/// One bright texel on black lights a floor of reflectance 1/2: its radiance is the integral of
/// that texel's share in directions by the cosine, over 2 pi.
#[test]
fn one_bright_texel_is_a_sum() {
    let (width, height) = (32, 16);
    let (column, row, radiance) = (20_u32, 5_u32, 128.0);
    let mut texels = vec![Vec3::ZERO; 512];
    texels[(row * width + column) as usize] = Vec3::new(radiance, 0.0, radiance / 2.0);
    let mut scene = scenes::empty(Vec3::new(0.0, 2.0, 0.1), Vec3::ZERO);
    let floor = scene.add_material(scenes::diffuse(0.5));
    add_quad(&mut scene, Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0, floor);
    scene.set_environment(Environment {
        rotation: 25.0,
        strength: 3.0,
        ..Environment::new(width, height, texels)
    });
    // A hat over two texels' width has the mean of one texel; across, by the midpoint rule.
    let fine = 20_000;
    let step = 2.0 / f64::from(height) / f64::from(fine);
    let across: f64 = (0..fine)
        .map(|k| {
            let v = (f64::from(row) - 0.5) / f64::from(height) + (f64::from(k) + 0.5) * step;
            let hat = 1.0 - (v * f64::from(height) - f64::from(row) - 0.5).abs();
            hat * (PI * v).cos() * (PI * v).sin() * PI * step
        })
        .sum();
    let irradiance = 3.0 * f64::from(radiance) * across * TAU / f64::from(width);
    let expected = irradiance * 0.5 / PI;
    for techniques in TECHNIQUES {
        let settings = Settings { techniques, ..settings(&scene) };
        let film = render(&prepare(&scene), &settings, 4096);
        let (mean, error) = mean_and_error(&film);
        assert!(
            (mean.x - expected).abs() <= 4.5 * error + 1e-5 * expected,
            "{techniques:?}: {} is not {expected}, {error}",
            mean.x
        );
        assert!((mean.z / mean.x - 0.5).abs() < 1e-4 && mean.y == 0.0, "{mean}");
    }
}

#[test]
fn light_sampling_bsdf_sampling_and_both_agree() {
    for (name, ball) in [("diffuse", scenes::diffuse(0.6)), ("glass", scenes::glass(1.5))] {
        let scene = scenes::roofless(ball);
        let prepared = prepare(&scene);
        let film = |techniques, seed, samples| {
            render(&prepared, &Settings { seed, techniques, ..settings(&scene) }, samples)
        };
        let both = film(Techniques::Both, 1, 2048);
        let light = film(Techniques::LightSampling, 2, 2048);
        let bsdf = film(Techniques::BsdfSampling, 3, 8192);
        assert_same_expectation(&both, &light, &format!("{name}: both and light sampling"));
        assert_same_expectation(&both, &bsdf, &format!("{name}: both and BSDF sampling"));
        let noise =
            |film: &Film| mean_and_error(film).1 * f64::from(film.radiance[0].samples()).sqrt();
        assert!(noise(&both) < 0.5 * noise(&bsdf), "{name}: a sun is worth aiming at");
    }
}

/// The comparisons above can fail.
#[test]
#[should_panic(expected = "another sky")]
fn another_environment_is_noticed() {
    let scene = scenes::roofless(scenes::diffuse(0.6));
    let mut other = scene.clone();
    other.set_environment(Environment { strength: 1.05, ..scenes::sky() });
    let film =
        |scene: &Scene, seed| render(&prepare(scene), &Settings { seed, ..settings(scene) }, 2048);
    assert_same_expectation(&film(&scene, 1), &film(&other, 2), "another sky");
}

#[test]
fn a_black_environment_is_none() {
    let mut scene = balls();
    scene.background = Vec3::ONE;
    let expected = render(&prepare(&scene), &settings(&scene), 2);
    scene.set_environment(constant(0.0));
    assert_eq!(prepare(&scene).abilities, 0);
    assert_eq!(render(&prepare(&scene), &settings(&scene), 2).color(), expected.color());
}

#[test]
fn devices_agree() {
    with_gpu(|gpu| {
        let scene = scenes::roofless(scenes::glass(1.5));
        let prepared = prepare(&scene);
        let cpu = render(&prepared, &settings(&scene), 256);
        let gpu = render_on(gpu, &prepared, &Settings { seed: 2, ..settings(&scene) }, 256);
        assert_same_expectation(&cpu, &gpu, "CPU and GPU under a sky");
    });
}
