//! Adaptive sampling is worth it.

use super::renders::{render, room, sampling};
use raystream::film::Film;
use raystream::render::{AllocatorKind, Estimator, Sampling, Settings};
use raystream_tests::scenes;
use raystream_tests::statistics::mean_and_error;

const SAMPLES: u32 = 64;
const RENDERS: u32 = 24;

fn rmse(film: &Film, reference: &Film) -> f64 {
    let colors = film.color().into_iter().zip(reference.color());
    let sum: f64 = colors.map(|(a, b)| f64::from((a - b).length_squared()) / 3.0).sum();
    (sum / film.radiance.len() as f64).sqrt()
}

/// Of two renders with the same seed, the adaptive one is nearer to the reference: on average over
/// seeds, by a factor whose logarithm is at least 4 standard errors below 0.
#[test]
fn errors_are_smaller_than_those_of_uniform_sampling() {
    for (name, ball) in [("mirror", scenes::mirror(0.9)), ("glass", scenes::glass(1.5))] {
        let (scene, settings) = room(ball, 16, 12);
        let reference =
            raystream_tests::render(&scene, &Settings { seed: 77_777, ..settings }, 8192);
        let adaptive = sampling(AllocatorKind::Runs, Estimator::default());
        let gains: Vec<f64> = (0..RENDERS)
            .map(|seed| {
                let error = |sampling| {
                    rmse(
                        &render(&scene, &Settings { sampling, seed, ..settings }, Some(SAMPLES)).0,
                        &reference,
                    )
                };
                (error(adaptive) / error(Sampling::UNIFORM)).ln()
            })
            .collect();
        let (gain, error) = mean_and_error(&gains);
        assert!(
            gain + 4.0 * error < 0.0,
            "{name}: RMSE of adaptive over uniform sampling: exp({gain} +- {error})"
        );
    }
}
