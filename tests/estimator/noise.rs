//! Estimates of noise of known variance.

use super::walls::{SAMPLES, absolute, estimate, plain, random, wall};
use glam::Vec3;
use raystream::film::Film;
use raystream::render::{EstimationSettings, Estimator};
use raystream_tests::statistics::{mean_and_error, normal_quantile};

/// A false alarm in one of 10^5 runs of a two-sided test.
fn limit() -> f64 {
    normal_quantile(1.0 - 0.5e-5)
}

/// A wall of radiance 1 whose samples are uniform in [0, 2), all components alike.
fn noisy_wall(width: u32, height: u32, samples: u32, seed: u32) -> Film {
    wall(width, height, samples, |x, y, sample| {
        Vec3::splat(2.0 * random(seed, (y * width + x) as usize, sample))
    })
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
    // The squared weights add up to (6/16)^2: a spread of 3/8 of what it was, within its own
    // uncertainty of 1/40.
    assert!((smooth / rough / 0.375 - 1.0).abs() < 0.15, "{smooth} of {rough}");
}

#[test]
fn neighbours_of_a_bright_sample_do_not_look_converged() {
    let film = wall(9, 9, 5, |x, y, sample| {
        Vec3::splat(if (x, y, sample) == (4, 4, 2) { 100.0 } else { 0.1 })
    });
    let settings = EstimationSettings::default();
    let estimates = estimate(&film, &absolute(Estimator::Variance), &settings).estimates;
    let error = |x: usize, y: usize| estimates[y * 9 + x].squared_error;
    let own = estimate(&film, &absolute(Estimator::Variance), &plain()).estimates[4 * 9 + 4]
        .squared_error;
    for (x, y, part) in [(4, 4, 0.25), (3, 4, 0.125), (4, 5, 0.125), (5, 5, 0.0625), (6, 4, 0.0)] {
        assert!(
            (error(x, y) - part * own).abs() < 1e-5 * own,
            "({x}, {y}): {} of {own}",
            error(x, y)
        );
    }
}

/// Means over the blocks of `block` pixels a side of a square picture in rows.
fn block_means(values: &[f64], side: usize, block: usize) -> Vec<f64> {
    let mut blocks = vec![0.0; (side / block).pow(2)];
    for (p, value) in values.iter().enumerate() {
        let place = p / side / block * (side / block) + p % side / block;
        blocks[place] += value / (block * block) as f64;
    }
    blocks
}

/// The estimators by filters on noise alone. With the variance `v`, the squared error `F` of the
/// filtered picture and the part `a` that a pixel has in that, the expectation is `v + F - a^2 v`,
/// and `F` is at least `a^2 v`: something from `v` to `v + F`.
#[test]
fn filters_know_the_error_of_the_measured_picture() {
    const SIDE: usize = 160;
    // Windows have up to 21 pixels.
    const BLOCK: usize = 32;
    let film = noisy_wall(SIDE as u32, SIDE as u32, SAMPLES, 7);
    let truth = variance_of_mean(SAMPLES);
    for &estimator in Estimator::ALL.iter().filter(|estimator| estimator.filter().is_some()) {
        let estimates = estimate(&film, &absolute(estimator), &plain()).estimates;
        let errors = estimates.iter().map(|e| f64::from(e.squared_error)).collect::<Vec<_>>();
        let squares = estimates.iter().map(|e| f64::from(e.filtered.x - 1.0).powi(2));
        let filtered = squares.sum::<f64>() / estimates.len() as f64;
        let (mean, error) = mean_and_error(&block_means(&errors, SIDE, BLOCK));
        let uncertainty = limit() * error;
        assert!(filtered < 0.1 * truth, "{estimator}: {filtered} of {truth}");
        assert!(
            mean > truth - uncertainty && mean < truth + filtered + uncertainty,
            "{estimator}: {mean} of {truth}, within {uncertainty}"
        );
    }
}

/// The filter on noise alone: its picture is nearer to the truth, and the squared differences are
/// the variance.
#[test]
fn filtered_walls_are_nearer_to_the_truth_and_differ_from_the_noise_by_its_variance() {
    const SIDE: usize = 256;
    const BLOCK: usize = 16;
    // What a pixel shares with its filtered colour is unseen: twice its own weight, 1 / (2 pi 5)
    // inside and four times that in corners, 7 % on average at most. Of a normal difference, 26 %
    // of the variance lies beyond the 2 standard errors that the colour term takes for noise, and
    // some of that is not averaged.
    for (settings, name, least) in [
        (plain(), "features", 0.93),
        (EstimationSettings::default(), "features and colours", 0.93 - 0.26),
    ] {
        let film = noisy_wall(SIDE as u32, SIDE as u32, SAMPLES, 5);
        let estimates = estimate(&film, &absolute(Estimator::Bilateral), &settings).estimates;
        let squared_error = |color: Vec3| f64::from((color.x - 1.0).powi(2));
        let before = film.color().into_iter().map(squared_error).sum::<f64>();
        let after = estimates.iter().map(|e| squared_error(e.filtered)).sum::<f64>();
        // Two Gaussians of the variances 6.25 and 25 leave 1 / (4 pi 5) of the variance at best,
        // 1.6 %.
        assert!(after < 0.1 * before, "{name}: {after} of {before}");
        // Neighbouring pixels are filtered of the same numbers, blocks of three radii hardly are.
        let errors = estimates.iter().map(|e| f64::from(e.squared_error)).collect::<Vec<_>>();
        let (mean, error) = mean_and_error(&block_means(&errors, SIDE, BLOCK));
        let (ratio, uncertainty) =
            (mean / variance_of_mean(SAMPLES), limit() * error / variance_of_mean(SAMPLES));
        assert!(
            ratio > least - uncertainty && ratio < 1.0 + uncertainty,
            "{name}: {ratio} of the variance, within {uncertainty}"
        );
    }
}
