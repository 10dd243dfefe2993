//! Integrators side by side: how fast they are, how much memory they take, whether they agree, and
//! how many paths are under way.
//!
//! [`measure`] renders a scene with every integrator by turns, and has each trace one and the same
//! stream: slot for slot the contributions should be those of the megakernel, and the means of
//! independent renders must agree. [`write_scene`] writes tables and a plot.

mod occupancy;
mod report;
mod stream;

pub use occupancy::{GROUP, Lanes};
pub use report::write_scene;

use super::BenchError;
use super::paths::{self, PathSpeed};
use raystream::exec::{Counting, Executor};
use raystream::render::{IntegratorKind, PreparedScene, Settings};
use std::time::Duration;
use stream::Stream;

/// What to measure.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The integrators; the first is what the others are compared with.
    pub integrators: Vec<IntegratorKind>,
    /// How long to render with each.
    pub time: Duration,
    /// Renders with each, by turns; at least 1.
    pub repetitions: u32,
    /// Slots of the stream that each traces, at least 1.
    pub stream: u32,
}

/// What was measured of one integrator.
pub struct Measured {
    /// Which.
    pub integrator: IntegratorKind,
    /// One for each repetition.
    pub speeds: Vec<PathSpeed>,
    /// Bytes that a render allocated on the device.
    pub memory: u64,
    /// Slots of the stream whose contribution is, bit for bit, that of the first integrator.
    pub identical: u32,
    /// Lanes in each iteration over the stream.
    pub lanes: Vec<Lanes>,
}

impl Measured {
    /// The middle one of a figure of the repetitions.
    pub fn median(&self, figure: impl Fn(&PathSpeed) -> f64) -> f64 {
        let mut figures: Vec<f64> = self.speeds.iter().map(figure).collect();
        figures.sort_by(f64::total_cmp);
        figures[figures.len() / 2]
    }

    /// Mean radiance over all repetitions, and its standard error.
    pub fn mean(&self) -> (f64, f64) {
        let count = self.speeds.len() as f64;
        let mean = self.speeds.iter().map(|speed| speed.mean).sum::<f64>() / count;
        let squares: f64 = self.speeds.iter().map(|speed| speed.mean_error.powi(2)).sum();
        (mean, squares.sqrt() / count)
    }

    /// How far the mean is from that of `other`, in standard errors of the difference.
    pub fn z_score(&self, other: &Self) -> f64 {
        let ((a, error_a), (b, error_b)) = (self.mean(), other.mean());
        if a == b { 0.0 } else { (a - b) / error_a.hypot(error_b) }
    }
}

/// Standard errors by which means may differ: one false alarm in two million.
const LIMIT: f64 = 5.0;

/// Measures a scene. `say` is told what happens.
///
/// # Errors
/// [`BenchError::Wrong`] if the mean of an integrator differs from the first one's by more than
/// their standard errors allow.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    plan: &Plan,
    say: &mut dyn FnMut(&str),
) -> Result<Vec<Measured>, BenchError> {
    let stream = Stream::new(executor, scene, settings, plan.stream)?;
    let mut measured = Vec::new();
    let mut expected = None;
    for &integrator in &plan.integrators {
        say(&format!("{}: a stream of {} slots", integrator.name(), plan.stream));
        let traced = stream.trace(executor, integrator)?;
        let expected = expected.get_or_insert_with(|| traced.contributions.clone());
        let identical = stream::identical(&traced.contributions, expected);
        measured.push(Measured {
            integrator,
            speeds: Vec::new(),
            memory: 0,
            identical,
            lanes: traced.lanes,
        });
    }
    drop(stream);
    // By turns, so that a device that slows down does so for all; with seeds of their own, so that
    // means are independent.
    let mut seed = settings.seed;
    for repetition in 0..plan.repetitions {
        for measured in &mut measured {
            let settings = Settings { integrator: measured.integrator, seed, ..*settings };
            seed = seed.wrapping_add(1);
            let counting = Counting::new(executor);
            let speed = paths::measure(&counting, scene, &settings, plan.time)?;
            measured.memory = counting.bytes();
            say(&format!(
                "{}, {} of {}: {:.2} Mpaths/s",
                measured.integrator.name(),
                repetition + 1,
                plan.repetitions,
                speed.mpaths_per_second
            ));
            measured.speeds.push(speed);
        }
    }
    for other in &measured {
        let z = other.z_score(&measured[0]);
        // NaN must not pass.
        if z.is_nan() || z.abs() > LIMIT {
            let ((mean, error), (first, first_error)) = (other.mean(), measured[0].mean());
            return Err(BenchError::Wrong(format!(
                "the mean of {} is {mean:.6} +- {error:.1e}, that of {} {first:.6} +- \
                 {first_error:.1e}: {z:.1} standard errors apart",
                other.integrator.name(),
                measured[0].integrator.name()
            )));
        }
    }
    Ok(measured)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::render::{Outcome, Stop, Timings};

    #[test]
    fn z_scores_are_in_errors_of_the_difference() {
        let speed = |mean, mean_error| {
            let timings = Timings::default();
            let outcome = Outcome {
                paths: 1,
                rays: 1,
                elapsed: Duration::from_secs(1),
                timings,
                stop: Stop::Samples,
            };
            let (mpaths_per_second, mrays_per_second, rays_per_path) = (mean, 1.0, 1.0);
            PathSpeed {
                mpaths_per_second,
                mrays_per_second,
                rays_per_path,
                outcome,
                mean,
                mean_error,
            }
        };
        let measured = |speeds: &[(f64, f64)]| Measured {
            integrator: IntegratorKind::Megakernel,
            speeds: speeds.iter().map(|&(mean, error)| speed(mean, error)).collect(),
            memory: 0,
            identical: 0,
            lanes: Vec::new(),
        };
        let (a, b) = (measured(&[(1.0, 0.3), (3.0, 0.4), (5.0, 0.0)]), measured(&[(4.0, 0.5)]));
        assert_eq!(a.mean(), (3.0, 0.5 / 3.0));
        assert_eq!(a.median(|speed| speed.mpaths_per_second), 3.0);
        assert!((b.z_score(&a) - 1.0 / (0.25_f64 + 0.25 / 9.0).sqrt()).abs() < 1e-12);
        assert_eq!(a.z_score(&a), 0.0);
        assert!(measured(&[(f64::NAN, 1.0)]).z_score(&a).is_nan());
        // Nothing varies, and yet they differ.
        assert!(measured(&[(4.0, 0.0)]).z_score(&measured(&[(3.0, 0.0)])) > LIMIT);
    }
}
