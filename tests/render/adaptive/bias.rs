//! What adaptivity does to the mean of a picture.
//!
//! A pixel's number of samples depends on its earlier samples. One that has by chance found little
//! light (no caustic, say) seems to have little error and gets few more samples, so it stays too
//! dark; one that has found too much gets many more, which dilute what it found. So the mean over
//! pixels and renders is too low. Each sample is still right on average, and a number of samples
//! that goes to infinity in every pixel makes the mean right. How fast depends on how rare the
//! light is.
//!
//! `runs` knows what it has lost by its control film, whose counts nobody's values decide, and
//! puts it back. Measured in this room with a glass ball, whose caustic is as bad as small lamps
//! make it, the bias of the picture's mean in per cent, with standard errors of about 0.1:
//!
//! | | 8 samples | 64 samples |
//! |---|---|---|
//! | `paper` | -2.0 | -0.5 |
//! | `atomic` | -3.1 | -2.2 |
//! | `runs`, whatever the estimator | 0 | 0 |

use super::renders::{render, render_on, room, sampling};
use glam::Vec3;
use raystream::film::Film;
use raystream::render::AllocatorKind::{Atomic, Paper, Runs};
use raystream::render::Estimator::{Bilateral, Halves, Variance};
use raystream::render::{PreparedScene, Sampling, Settings};
use raystream_tests::statistics::mean_and_error;
use raystream_tests::statistics::normal_quantile;
use raystream_tests::{scenes, with_gpu};

/// Samples per pixel, renders with them, and the largest bias that `paper` and `atomic` are
/// allowed, relative to the mean.
const FEW: (u32, u32, f64) = (8, 250, 0.04);
const MANY: (u32, u32, f64) = (64, 100, 0.03);
/// Standard errors that are added to a measured bias before it is compared with what is allowed,
/// and those that nothing without bias is off: chance stays below them in all but 1 of 10^4 cases.
const MARGIN: f64 = 4.0;

fn mean(pixels: &[Vec3]) -> f64 {
    pixels.iter().map(|c| f64::from(c.element_sum())).sum::<f64>() / (3.0 * pixels.len() as f64)
}

/// A room, and what is known of the mean of its picture.
struct Truth {
    room: (PreparedScene, Settings),
    mean: f64,
    /// Standard error relative to the mean; an upper limit where components are correlated.
    error: f64,
}

impl Truth {
    fn new() -> Self {
        let room = room(scenes::glass(1.5), 16, 12);
        let film = raystream_tests::render(&room.0, &Settings { seed: 77_777, ..room.1 }, 8192);
        let mean = mean(&film.color());
        let variances = film.variance();
        let variance: f64 = variances.iter().map(|v| f64::from(v.element_sum()) / 3.0).sum();
        let error = variance.sqrt() / film.radiance.len() as f64 / mean;
        Self { room, mean, error }
    }

    /// Bias of the mean of what `look` sees in renders, relative to the truth, and its standard
    /// error, over independent renders.
    fn bias(
        &self,
        sampling: Sampling,
        (samples, renders, _): (u32, u32, f64),
        look: fn(&Film) -> Vec<Vec3>,
    ) -> (f64, f64) {
        let (scene, settings) = &self.room;
        let biases: Vec<f64> = (0..renders)
            .map(|seed| {
                let settings = Settings { sampling, seed, ..*settings };
                mean(&look(&render(scene, &settings, Some(samples)).0)) / self.mean - 1.0
            })
            .collect();
        let (bias, error) = mean_and_error(&biases);
        (bias, error.hypot(self.error))
    }
}

#[test]
fn uniform_sampling_and_runs_have_no_bias() {
    let truth = Truth::new();
    let samplings = [Bilateral, Halves, Variance].map(|estimator| sampling(Runs, estimator));
    for sampling in samplings.into_iter().chain([Sampling::UNIFORM]) {
        for budget in [FEW, MANY] {
            let (bias, error) = truth.bias(sampling, budget, Film::color);
            assert!(
                bias.abs() <= MARGIN * error,
                "{:?} by {:?}, {} samples: {bias} +- {error}",
                sampling.allocator,
                sampling.estimator,
                budget.0
            );
        }
    }
    // The test can fail: without what the control film corrects there is a bias.
    let (bias, error) = truth.bias(samplings[0], MANY, Film::plain);
    assert!(bias < -MARGIN * error, "the plain mean: {bias} +- {error}");
}

#[test]
fn the_means_of_paper_and_atomic_are_little_too_low_and_less_so_with_more_samples() {
    let truth = Truth::new();
    for allocator in [Paper, Atomic] {
        let sampling = sampling(allocator, Bilateral);
        let [few, many] = [FEW, MANY].map(|budget| truth.bias(sampling, budget, Film::color));
        let what = format!("{allocator:?}: bias {few:?} with few samples, {many:?} with many");
        for ((bias, error), (_, _, allowed)) in [(few, FEW), (many, MANY)] {
            assert!(bias.abs() + MARGIN * error <= allowed, "{what}");
        }
        // 1 false alarm in 10^4, if both were equal.
        let limit = normal_quantile(1.0 - 1e-4);
        assert!(few.0.abs() - many.0.abs() >= limit * few.1.hypot(many.1), "not less: {what}");
    }
}

/// What the control film promises of every single picture, not only on average.
#[test]
fn pictures_have_the_mean_of_their_control_film() {
    let (scene, settings) = room(scenes::glass(1.5), 45, 37);
    let sampling = sampling(Runs, Bilateral);
    let assert_mean = |film: &Film| {
        let [control, _] = film.halves().unwrap();
        let (picture, plain) = (mean(&film.color()), mean(&film.plain()));
        let [control, difference] = [mean(&control), plain - mean(&control)];
        assert!((picture - control).abs() < 1e-5 * control, "{picture} and {control}");
        assert!(difference.abs() > 1e-3 * control, "there is something to correct");
        let first = film.radiance[0].first_samples;
        assert!(film.radiance.iter().all(|pixel| pixel.first_samples == first));
    };
    let settings = Settings { sampling, ..settings };
    assert_mean(&render(&scene, &settings, Some(32)).0);
    with_gpu(|gpu| assert_mean(&render_on(gpu, &scene, &settings, Some(32)).0));
}
