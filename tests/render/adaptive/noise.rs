//! Renders that end when they are good enough.

use super::renders::{render, room, sampling, small};
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::AllocatorKind::{Atomic, Paper, Runs, Uniform};
use raystream::render::Estimator::{Bilateral, Halves, Variance};
use raystream::render::{EstimationSettings, PreparedScene, Renderer, Sampling, Settings};
use raystream::scene::FilmSize;
use raystream_shaders::estimator::relative_error;
use raystream_tests::{prepare, scenes, settings};

/// A render that goes on for this many samples per pixel would have gone on for ever: the slowest
/// here takes a tenth.
const ENDLESS: u32 = 10_000;
const PIXELS: u64 = 16 * 12;

fn mean_radiance(film: &Film) -> f32 {
    film.color().iter().map(|c| c.element_sum()).sum::<f32>() / (3 * film.radiance.len()) as f32
}

/// Root mean relative squared error, as [`raystream::render::estimator::Noise`] has it, but true.
fn true_error(film: &Film, reference: &Film) -> f64 {
    let mean = mean_radiance(reference);
    let pixels = film.color().into_iter().zip(reference.color());
    let sum: f64 = pixels
        .map(|(a, b)| f64::from(relative_error(b, (a - b).length_squared() / 3.0, mean)))
        .sum();
    (sum / film.radiance.len() as f64).sqrt()
}

/// The estimators look at each pixel alone.
fn unsmoothed(sampling: Sampling) -> Sampling {
    Sampling {
        estimation: EstimationSettings { smooth: false, ..EstimationSettings::DEFAULT },
        ..sampling
    }
}

/// Renders until `noise` is reached; the film and its samples per pixel.
fn render_until(
    noise: f32,
    (scene, settings): &(PreparedScene, Settings),
    sampling: Sampling,
    seed: u32,
) -> (Film, f64) {
    let sampling = Sampling { noise: Some(noise), ..sampling };
    let (film, outcome) = render(scene, &Settings { sampling, seed, ..*settings }, Some(ENDLESS));
    assert!(outcome.paths < u64::from(ENDLESS) * PIXELS, "{sampling:?} has no end");
    (film, outcome.paths as f64 / PIXELS as f64)
}

/// Uniform rounds are long: they end below what was asked for.
const LOWEST: f64 = 1.0 / 3.0;
/// Estimates are least certain where samples are few, and too low where rare light has not been
/// found: a factor of 2, as between confident and doubtful. (`halves` of single pixels is not
/// tested: one random number squared is often small by chance.)
const HIGHEST: f64 = 2.0;

#[test]
fn renders_end_near_the_noise_that_was_asked_for() {
    let room = room(scenes::mirror(0.9), 16, 12);
    let reference = raystream_tests::render(&room.0, &Settings { seed: 77_777, ..room.1 }, 8192);
    let seeds = 0..4;
    for sampling in [
        sampling(Uniform, Bilateral),
        sampling(Uniform, Variance),
        sampling(Paper, Bilateral),
        sampling(Atomic, Bilateral),
        sampling(Runs, Bilateral),
        Sampling { relative: true, ..sampling(Runs, Bilateral) },
        unsmoothed(sampling(Runs, Variance)),
    ] {
        for noise in [0.2, 0.1] {
            let renders: Vec<_> =
                seeds.clone().map(|seed| render_until(noise, &room, sampling, seed)).collect();
            let squares =
                renders.iter().map(|(film, _)| true_error(film, &reference).powi(2)).sum::<f64>();
            let ratio = (squares / renders.len() as f64).sqrt() / f64::from(noise);
            let samples =
                renders.iter().map(|(_, samples)| samples).sum::<f64>() / renders.len() as f64;
            let what = format!(
                "{:?} by {:?}, relative {}: {ratio:.2} of {noise}, after {samples:.1} samples",
                sampling.allocator, sampling.estimator, sampling.relative
            );
            eprintln!("{what}");
            assert!((LOWEST..HIGHEST).contains(&ratio), "{what}");
        }
    }
}

#[test]
fn a_threshold_that_is_reached_at_once() {
    let room = room(scenes::mirror(0.9), 16, 12);
    for allocator in [Paper, Atomic, Runs] {
        // Larger than any picture's error with 64 samples: then the first round is the last.
        let sampling = Sampling { initial_samples: 64, ..sampling(allocator, Bilateral) };
        let (film, samples) = render_until(1.0, &room, sampling, 1);
        assert_eq!(samples, 64.0);
        assert!(film.samples().iter().all(|&n| n == 64));
    }
    // What comes first counts.
    let sampling = Sampling { noise: Some(1e-5), ..sampling(Runs, Bilateral) };
    let (_, outcome) = render(&room.0, &Settings { sampling, ..room.1 }, Some(8));
    assert_eq!(outcome.paths, 8 * PIXELS);
}

/// Pixels that have converged get no samples but those of the control film, which all get.
#[test]
fn pixels_that_have_converged_get_no_more_samples() {
    let (scene, settings) = room(scenes::mirror(0.9), 16, 12);
    // Rounds so long that most pixels lack something.
    let sampling = Sampling {
        noise: Some(0.05),
        initial_samples: 16,
        round_budget: Some(32.0),
        ..unsmoothed(sampling(Runs, Variance))
    };
    let small = small(&CpuExecutor);
    let mut renderer = Renderer::new(&small, &scene, &Settings { sampling, ..settings }).unwrap();
    renderer.step(u64::MAX).unwrap();
    let mut film = renderer.film().unwrap();
    let mean = mean_radiance(&film);
    let mut some_of_both = 0;
    for round in 0..20 {
        let unconverged =
            renderer.noise().unwrap().expect("a threshold needs estimates").unconverged;
        if unconverged == 0 {
            break;
        }
        let before = std::mem::replace(&mut film, {
            renderer.step(u64::MAX).unwrap();
            renderer.film().unwrap()
        });
        let control = |p: usize| film.radiance[p].first_samples - before.radiance[p].first_samples;
        assert!(control(0) >= 6 && (0..film.radiance.len()).all(|p| control(p) == control(0)));
        let got = |p: usize| film.radiance[p].second_samples - before.radiance[p].second_samples;
        let sampled = (0..film.radiance.len()).filter(|&p| got(p) > 0).count() as u64;
        assert!(sampled > 0 && sampled <= unconverged, "round {round}");
        for (p, (color, variance)) in before.plain().into_iter().zip(before.variance()).enumerate()
        {
            let error = relative_error(color, variance.element_sum() / 3.0, mean).sqrt() / 0.05;
            // At the limit itself rounding decides.
            if error < 1.0 - 1e-3 {
                assert_eq!(got(p), 0, "round {round}, pixel {p}: {error} of the threshold");
            }
        }
        some_of_both += u32::from(sampled > 0 && sampled < film.radiance.len() as u64);
    }
    assert!(some_of_both >= 3, "the test has seen some of both in {some_of_both} rounds");
}

/// Where no light is found, nobody knows that there is none: pixels look for it until the rule of
/// three says that what they may have missed is below the noise.
#[test]
fn darkness_must_be_looked_at_for_long() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::Z);
    scene.film = FilmSize { width: 16, height: 12 };
    let wall = scene.add_material(scenes::diffuse(0.5));
    scenes::add_box(&mut scene, Vec3::splat(-1.0), Vec3::ONE, true, wall);
    let dark = (prepare(&scene), settings(&scene));
    for (allocator, estimator) in [(Runs, Bilateral), (Runs, Variance), (Uniform, Variance)] {
        let (film, samples) = render_until(0.2, &dark, sampling(allocator, estimator), 0);
        assert!(film.color().iter().all(|&color| color == Vec3::ZERO));
        // 3 / n is 0.2^2 at 75 samples.
        assert!((75.0..=400.0).contains(&samples), "{allocator:?}: {samples}");
    }
    // Nothing but background: there is nothing to find.
    let mut empty = scenes::empty(Vec3::ZERO, Vec3::Z);
    empty.film = FilmSize { width: 16, height: 12 };
    let empty = (prepare(&empty), settings(&empty));
    let (_, samples) = render_until(0.2, &empty, sampling(Runs, Bilateral), 0);
    assert!(samples <= 16.0, "{samples}");
}

/// Glass is worse: its caustic is rare light.
#[test]
fn renders_with_caustics_end_as_well() {
    let room = room(scenes::glass(1.5), 16, 12);
    for allocator in [Paper, Atomic, Runs] {
        for seed in 0..3 {
            render_until(0.2, &room, sampling(allocator, Bilateral), seed);
        }
    }
}

/// Smoothed errors are of a pixel and its neighbours, but each pixel's convergence is relative to
/// its own brightness: a bright pixel that has converged and gets no more samples leaves its noise
/// to a dark neighbour, which must not wait for it.
#[test]
fn smoothed_errors_converge() {
    let room = room(scenes::mirror(0.9), 16, 12);
    for allocator in [Paper, Atomic, Runs] {
        for estimator in [Halves, Variance] {
            for seed in 0..4 {
                render_until(0.2, &room, sampling(allocator, estimator), seed);
            }
        }
    }
}
