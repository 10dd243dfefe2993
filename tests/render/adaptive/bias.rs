//! What adaptivity does to the mean of a picture.
//!
//! A pixel's number of samples depends on its earlier samples. One that has by chance found little
//! light (no caustic, say) seems to have little error and gets few more samples, so it stays too
//! dark; one that has found too much gets many more, which dilute what it found. So the mean over
//! pixels and renders is too low. Each sample is still right on average, and a number of samples
//! that goes to infinity in every pixel makes the mean right. How fast depends on how rare the
//! light is.
//!
//! Measured in this room with a glass ball, whose caustic is as bad as small lamps make it, the
//! bias of the picture's mean in per cent, with standard errors of about 0.1:
//!
//! | | 8 samples | 64 samples |
//! |---|---|---|
//! | `paper`, `bilateral` | -2.0 | -0.5 |
//! | `atomic`, `bilateral` | -3.1 | -2.2 |
//! | `runs`, `bilateral` | -2.9 | -1.9 |
//! | `runs`, `halves` | -2.2 | -1.4 |
//! | `runs`, `variance` | -2.1 | -1.4 |

use super::renders::{render, room, sampling};
use raystream::film::Film;
use raystream::render::AllocatorKind::{Atomic, Paper, Runs};
use raystream::render::Estimator::{Bilateral, Halves, Variance};
use raystream::render::{PreparedScene, Sampling, Settings};
use raystream_tests::scenes;
use raystream_tests::statistics::mean_and_error;
use raystream_tests::statistics::normal_quantile;

/// Samples per pixel, renders with them, and the largest bias that is allowed, relative to the
/// mean.
const FEW: (u32, u32, f64) = (8, 250, 0.04);
const MANY: (u32, u32, f64) = (64, 100, 0.03);
/// Standard errors that are added to a measured bias before it is compared with what is allowed:
/// chance stays below them in all but 1 of 3 * 10^4 cases.
const MARGIN: f64 = 4.0;

fn mean(film: &Film) -> f64 {
    film.color().iter().map(|c| f64::from(c.element_sum())).sum::<f64>()
        / (3.0 * film.radiance.len() as f64)
}

/// Bias of the picture's mean relative to `truth`, and its standard error, over independent
/// renders.
fn bias(
    (scene, settings): &(PreparedScene, Settings),
    sampling: Sampling,
    (samples, renders, _): (u32, u32, f64),
    truth: f64,
) -> (f64, f64) {
    let biases: Vec<f64> = (0..renders)
        .map(|seed| {
            mean(&render(scene, &Settings { sampling, seed, ..*settings }, Some(samples)).0) / truth
                - 1.0
        })
        .collect();
    mean_and_error(&biases)
}

#[test]
fn the_mean_is_little_too_low_and_less_so_with_more_samples() {
    let room = room(scenes::glass(1.5), 16, 12);
    let reference = raystream_tests::render(&room.0, &Settings { seed: 77_777, ..room.1 }, 8192);
    let truth = mean(&reference);
    // Relative, and an upper limit where components are correlated.
    let variance: f64 = reference.variance().iter().map(|v| f64::from(v.element_sum()) / 3.0).sum();
    let truth_error = variance.sqrt() / reference.radiance.len() as f64 / truth;

    let (few, error) = bias(&room, Sampling::UNIFORM, FEW, truth);
    assert!(
        few.abs() <= MARGIN * error.hypot(truth_error),
        "uniform sampling has a bias of {few} +- {error}"
    );

    for (allocator, estimator) in [
        (Paper, Bilateral),
        (Atomic, Bilateral),
        (Runs, Bilateral),
        (Runs, Halves),
        (Runs, Variance),
    ] {
        let sampling = sampling(allocator, estimator);
        let [(few, few_error), (many, many_error)] =
            [FEW, MANY].map(|n| bias(&room, sampling, n, truth));
        let what = format!(
            "{allocator:?} by {estimator:?}: bias {few} +- {few_error} with {} samples, {many} +- \
             {many_error} with {}; that of the reference {truth_error}",
            FEW.0, MANY.0
        );
        for (bias, error, (samples, _, allowed)) in
            [(few, few_error, FEW), (many, many_error, MANY)]
        {
            assert!(
                bias.abs() + MARGIN * error.hypot(truth_error) <= allowed,
                "{samples} samples: {what}"
            );
        }
        // 1 false alarm in 10^4, if both were equal. The reference's error is common to both.
        let limit = normal_quantile(1.0 - 1e-4);
        assert!(few.abs() - many.abs() >= limit * few_error.hypot(many_error), "not less: {what}");
    }
}
