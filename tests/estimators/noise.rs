//! Estimates of noise of known variance.

use super::common::statistics::normal_quantile;
use super::walls::{SAMPLES, absolute, estimate, mean_and_error, plain, random, wall};
use glam::Vec3;
use raystream::film::Film;
use raystream::render::{EstimationSettings, Estimator};

/// A false alarm in one of 10^5 runs of a two-sided test.
fn limit() -> f64 {
    normal_quantile(1.0 - 0.5e-5)
}

/// A wall of radiance 1 whose samples are uniform in [0, 2), all components alike.
fn noisy_wall(width: u32, height: u32, samples: u32, seed: u32) -> Film {
    wall(width, height, samples, |x, y, sample| Vec3::splat(2.0 * random(seed, (y * width + x) as usize, sample)))
}

/// The variance of the mean over so many such samples.
fn variance_of_mean(samples: u32) -> f64 {
    1.0 / 3.0 / f64::from(samples)
}

#[test]
fn halves_and_variance_are_unbiased() {
    // Of many seeds: every pixel of the wall is one.
    for samples in [2, 3, 5, 16, 33] {
        let film = noisy_wall(128, 128, samples, samples);
        for estimator in [Estimator::Halves, Estimator::Variance] {
            let estimates = estimate(&film, &absolute(estimator), &plain()).estimates;
            let values: Vec<f64> = estimates.iter().map(|e| f64::from(e.squared_error)).collect();
            let (mean, error) = mean_and_error(&values);
            let z = (mean - variance_of_mean(samples)) / error;
            assert!(z.abs() < limit(), "{estimator:?} of {samples} samples: z = {z:.1}");
        }
    }
}

/// Smoothing keeps the expectation; what it is for is to vary less.
#[test]
fn smoothing_keeps_the_mean_and_takes_away_spread() {
    let film = noisy_wall(128, 128, 5, 1);
    let of = |smooth| {
        let settings = EstimationSettings { smooth, ..plain() };
        let estimates = estimate(&film, &absolute(Estimator::Variance), &settings).estimates;
        // Every third pixel of every third row: those share no neighbour.
        let values: Vec<f64> = estimates
            .iter()
            .enumerate()
            .filter(|(p, _)| p % 128 % 3 == 1 && p / 128 % 3 == 1)
            .map(|(_, e)| f64::from(e.squared_error))
            .collect();
        mean_and_error(&values)
    };
    let ((_, rough), (mean, smooth)) = (of(false), of(true));
    assert!(((mean - variance_of_mean(5)) / smooth).abs() < limit());
    // The squared weights add up to (6/16)^2: a spread of 3/8 of what it was, within its own uncertainty of 1/40.
    assert!((smooth / rough / 0.375 - 1.0).abs() < 0.15, "{smooth} of {rough}");
}

#[test]
fn neighbours_of_a_bright_sample_do_not_look_converged() {
    let film = wall(9, 9, 5, |x, y, sample| Vec3::splat(if (x, y, sample) == (4, 4, 2) { 100.0 } else { 0.1 }));
    let settings = EstimationSettings::default();
    let estimates = estimate(&film, &absolute(Estimator::Variance), &settings).estimates;
    let error = |x: usize, y: usize| estimates[y * 9 + x].squared_error;
    let own = estimate(&film, &absolute(Estimator::Variance), &plain()).estimates[4 * 9 + 4].squared_error;
    for (x, y, part) in [(4, 4, 0.25), (3, 4, 0.125), (4, 5, 0.125), (5, 5, 0.0625), (6, 4, 0.0)] {
        assert!((error(x, y) - part * own).abs() < 1e-5 * own, "({x}, {y}): {} of {own}", error(x, y));
    }
}

/// The filter on noise alone: its picture is nearer to the truth, and the squared differences are the variance.
#[test]
fn filtered_walls_are_nearer_to_the_truth_and_differ_from_the_noise_by_its_variance() {
    for (settings, name, blocks_of) in
        [(plain(), "features", 16), (EstimationSettings::default(), "features and colours", 16)]
    {
        let film = noisy_wall(256, 256, SAMPLES, 5);
        let estimates = estimate(&film, &absolute(Estimator::Bilateral), &settings).estimates;
        let truth = variance_of_mean(SAMPLES);
        let squared_error = |color: Vec3| f64::from((color.x - 1.0).powi(2));
        let before = film.color().into_iter().map(squared_error).sum::<f64>();
        let after = estimates.iter().map(|e| squared_error(e.filtered)).sum::<f64>();
        // The Gaussians leave 1 / (4 pi sigma^2) of the variance at best, 1.6 %; edges and the colour term leave more.
        assert!(after < 0.1 * before, "{name}: {after} of {before}");
        // Neighbouring pixels are filtered of the same numbers, blocks of three radii hardly are.
        let blocks: Vec<f64> = (0..256 / blocks_of)
            .flat_map(|top| (0..256 / blocks_of).map(move |left| (left * blocks_of, top * blocks_of)))
            .map(|(left, top)| {
                let inside = (0..blocks_of * blocks_of).map(|k| (top + k / blocks_of) * 256 + left + k % blocks_of);
                inside.map(|p| f64::from(estimates[p].squared_error)).sum::<f64>() / (blocks_of * blocks_of) as f64
            })
            .collect();
        let (mean, error) = mean_and_error(&blocks);
        println!(
            "{name}: {:.4} of the variance, standard error {:.4}, filtered {:.4}",
            mean / truth,
            error / truth,
            after / before
        );
    }
}
