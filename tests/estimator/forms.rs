//! From estimates to the allocators' errors, through the host's side.

use super::walls::{
    RAYS, ROUND, SAMPLES, absolute, camera, estimate, estimate_on, plain, random, wall,
};
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::{AllocatorKind, EstimationSettings, Estimator, Sampling};
use raystream_shaders::estimator::{CONVERGED, SOFT_FLOOR};
use raystream_tests::executors::Hindered;

/// Those whose errors are of the measured picture: the rates of `axis-aligned` are not.
fn estimators() -> impl Iterator<Item = Estimator> {
    Estimator::ALL.iter().copied().filter(|&estimator| estimator != Estimator::AxisAligned)
}

/// Noise that is strong on the right, over a brightness that rises downwards.
fn uneven(width: u32, height: u32) -> Film {
    wall(width, height, SAMPLES, |x, y, sample| {
        let noise = random(11, (y * width + x) as usize, sample) * x as f32;
        Vec3::new(1.0, 0.5, 2.0) * (noise + y as f32)
    })
}

fn close(a: f32, b: f32, what: &str) {
    assert!((a - b).abs() <= 8.0 * f32::EPSILON * b.abs(), "{what}: {a} and {b}");
}

#[test]
fn errors_are_reductions_of_the_estimates() {
    let film = uneven(21, 13);
    for estimator in estimators() {
        for settings in [plain(), EstimationSettings::default()] {
            let sampling = absolute(estimator);
            let half = estimate(&film, &sampling, &settings);
            let relative = estimate(&film, &Sampling { relative: true, ..sampling }, &settings);
            assert_eq!(half.estimates, relative.estimates);
            let mut sum = 0.0;
            for (p, e) in half.estimates.iter().enumerate() {
                // As many samples again: half of the error goes.
                close(half.errors[p], 0.5 * e.squared_error, "equation 1");
                let radiance = (e.filtered.x + e.filtered.y + e.filtered.z) / 3.0;
                let scale = radiance * radiance + SOFT_FLOOR * SOFT_FLOOR;
                close(relative.errors[p], 0.5 * e.squared_error / scale, "relative form");
                sum += f64::from(e.squared_error / scale);
            }
            for noise in [half.noise, relative.noise] {
                let expected = (sum / half.estimates.len() as f64).sqrt();
                assert!((noise.relative_error / expected - 1.0).abs() < 1e-5, "always relative");
                assert_eq!(
                    noise.unconverged,
                    half.errors.iter().filter(|&&e| e > 0.0).count() as u64
                );
            }
        }
    }
}

#[test]
fn or_deviations_of_what_a_ray_buys() {
    let film = uneven(21, 13);
    for estimator in estimators() {
        let sampling = Sampling { allocator: AllocatorKind::Runs, ..absolute(estimator) };
        let settings = EstimationSettings::default();
        let deviations = estimate(&film, &sampling, &settings);
        assert_eq!(
            deviations.estimates,
            estimate(&film, &absolute(estimator), &settings).estimates
        );
        for (error, estimate) in deviations.errors.iter().zip(&deviations.estimates) {
            let of_sample = estimate.squared_error * SAMPLES as f32;
            close(*error, (of_sample / RAYS as f32).sqrt(), "the root of variance by rays");
        }
    }
}

#[test]
fn converged_pixels_get_no_more() {
    let film = uneven(21, 13);
    for estimator in [Estimator::Halves, Estimator::Variance] {
        let always = estimate(&film, &Sampling { relative: true, ..absolute(estimator) }, &plain());
        let noise = 0.1;
        for relative in [false, true] {
            let sampling = Sampling { relative, noise: Some(noise), ..absolute(estimator) };
            let stopping = estimate(&film, &sampling, &plain());
            for (p, &error) in stopping.errors.iter().enumerate() {
                // Half of the relative squared error, by equation 1.
                let converged = 2.0 * always.errors[p] <= noise * noise;
                assert_eq!(error == CONVERGED, converged, "pixel {p}: {}", always.errors[p]);
                assert!(converged || error > 0.0);
            }
            let left = stopping.errors.iter().filter(|&&e| e != CONVERGED).count();
            assert!(left > 0 && left < stopping.errors.len(), "both kinds are there");
            assert_eq!(stopping.noise.unconverged, left as u64);
        }
    }
}

/// A single pixel is often near the filtered picture by chance. Where noise is everywhere alike,
/// none has converged for that.
#[test]
fn pixels_do_not_converge_by_chance() {
    let film = wall(64, 64, SAMPLES, |x, y, sample| {
        Vec3::splat(2.0 * random(2, (y * 64 + x) as usize, sample))
    });
    // The standard error of a pixel is 1 / sqrt(3 * 16) = 0.144.
    for (noise, unconverged) in [(0.1, 64 * 64), (0.7, 0)] {
        let sampling = Sampling { noise: Some(noise), ..absolute(Estimator::Bilateral) };
        assert_eq!(
            estimate(&film, &sampling, &EstimationSettings::default()).noise.unconverged,
            unconverged,
            "{noise}"
        );
    }
}

#[test]
fn what_is_not_finite_has_no_error_and_spoils_no_neighbour() {
    let clean = uneven(16, 16);
    let middle = 8 * 16 + 8;
    for bad in [f32::NAN, f32::INFINITY] {
        let mut film = clean.clone();
        film.radiance[middle].first_sum.y = bad;
        for estimator in estimators() {
            for settings in [plain(), EstimationSettings::default()] {
                let sampling =
                    Sampling { relative: true, noise: Some(1e-3), ..absolute(estimator) };
                let e = estimate(&film, &sampling, &settings);
                assert_eq!((e.errors[middle], e.estimates[middle].squared_error), (0.0, 0.0));
                assert!(
                    e.estimates
                        .iter()
                        .all(|e| e.filtered.is_finite() && e.squared_error.is_finite())
                );
                assert!(e.errors.iter().all(|e| e.is_finite()));
                assert!(e.noise.relative_error.is_finite() && e.noise.relative_error > 0.0);
                let pixels = e.errors.iter().filter(|&&error| error > 0.0).count() as u64;
                assert_eq!(e.noise.unconverged, pixels);
            }
        }
    }
}

#[test]
fn bands_do_not_show() {
    for (width, height) in [(1, 1), (37, 21), (8, 64)] {
        let film = uneven(width, height);
        for estimator in estimators() {
            let sampling = absolute(estimator);
            let settings = EstimationSettings::default();
            let whole = estimate(&film, &sampling, &settings);
            // Each band of the film is one row of tiles or less.
            let small = Hindered::by_buffers(&CpuExecutor, 64 * 48);
            let bands =
                estimate_on(&small, &film, &camera(width, height), &sampling, &settings, ROUND)
                    .unwrap();
            assert_eq!(bands.estimates, whole.estimates);
            assert_eq!(bands.errors, whole.errors);
            assert_eq!(bands.noise, whole.noise);
        }
    }
}
