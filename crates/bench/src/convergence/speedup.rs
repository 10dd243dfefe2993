//! Curves set against each other: at equal error, and at equal time.

use super::curve::Point;
use super::gains::{EqualTime, Smallest, Speedup};
use super::interpolation::{crossing, height};
use super::metric::Metric;
use super::{Configuration, Measured};
use raystream::render::AllocatorKind;

/// Errors below this many times the reference's noise are limited by the reference.
pub const REFERENCE_MARGIN: f64 = 4.0;
/// Samples per pixel that the smallest speed-up begins after.
pub const SMALLEST_FROM: u32 = 16;

/// Everything that follows from the curves of one scene.
pub struct Comparisons {
    /// At equal error, against uniform sampling and, where it was measured with the same integrator
    /// and estimator, against `atomic`.
    pub speedups: Vec<Speedup>,
    /// At equal time, against uniform sampling.
    pub equal_time: Vec<EqualTime>,
    /// The smallest speed-ups over uniform sampling.
    pub smallest: Vec<Smallest>,
}

impl Comparisons {
    /// Sets all configurations but the first against it, which is uniform sampling, at `levels`;
    /// and those of other integrators than the first one's also against uniform sampling with their
    /// own, at the errors and times that this has at `levels`. `noise` is the RMSE of the
    /// reference.
    pub fn of(measured: &[Measured], levels: &[u32], noise: f64) -> Self {
        let mut comparisons =
            Self { speedups: Vec::new(), equal_time: Vec::new(), smallest: Vec::new() };
        let Some((first, others)) = measured.split_first() else { return comparisons };
        for metric in Metric::ALL {
            for other in others {
                comparisons.add(first, other, metric, levels, noise);
                let Some(own) = uniform_counterpart(measured, other) else { continue };
                let is_another = own.configuration != first.configuration
                    && own.configuration != other.configuration;
                if is_another {
                    comparisons.add(own, other, metric, levels, noise);
                }
                let Some(atomic) = others.iter().find(|o| is_atomic_counterpart(o, other)) else {
                    continue;
                };
                let points = levels.iter().filter_map(|&level| at_level(own, level));
                comparisons
                    .speedups
                    .extend(points.map(|at| speedup(atomic, other, metric, at, noise)));
            }
        }
        comparisons
    }

    /// Sets `other` against the uniform sampling `uniform`.
    fn add(
        &mut self,
        uniform: &Measured,
        other: &Measured,
        metric: Metric,
        levels: &[u32],
        noise: f64,
    ) {
        for at in levels.iter().filter_map(|&level| at_level(uniform, level)) {
            self.speedups.push(speedup(uniform, other, metric, at, noise));
            self.equal_time.push(equal_time(uniform, other, metric, at));
        }
        self.smallest.push(smallest(uniform, other, metric));
    }
}

/// The point of a curve after `level` samples per pixel.
fn at_level(measured: &Measured, level: u32) -> Option<&Point> {
    measured.curve.iter().find(|p| p.checkpoint == level)
}

/// Uniform sampling with the integrator of `of`.
pub fn uniform_counterpart<'a>(measured: &'a [Measured], of: &Measured) -> Option<&'a Measured> {
    measured.iter().find(|m| m.configuration == Configuration::uniform(of.configuration.integrator))
}

fn is_atomic_counterpart(atomic: &Measured, other: &Measured) -> bool {
    let (a, b) = (atomic.configuration, other.configuration);
    let atomic = Configuration { allocator: AllocatorKind::Atomic, ..b };
    a == atomic && a != b && !b.is_uniform()
}

fn speedup(
    baseline: &Measured,
    other: &Measured,
    metric: Metric,
    at: &Point,
    noise: f64,
) -> Speedup {
    let error = metric.of(at);
    let [own, base] = [other, baseline].map(|m| crossing(&metric.over_time(&m.curve), error));
    let [own_samples, base_samples] =
        [other, baseline].map(|m| crossing(&metric.over_samples(&m.curve), error).place());
    let ratio = |base: Option<f64>, own: Option<f64>| base.zip(own).map(|(base, own)| base / own);
    let missing = if own.note().is_empty() { base.note() } else { own.note() };
    let limited = metric.absolute(at) < REFERENCE_MARGIN * noise;
    Speedup {
        configuration: other.name.clone(),
        baseline: baseline.name.clone(),
        metric,
        uniform_samples: at.checkpoint,
        error,
        baseline_seconds: base.place(),
        seconds: own.place(),
        time_ratio: ratio(base.place(), own.place()),
        samples_ratio: ratio(base_samples, own_samples),
        note: [missing, if limited { "limited by the reference" } else { "" }]
            .iter()
            .filter(|note| !note.is_empty())
            .copied()
            .collect::<Vec<_>>()
            .join("; "),
    }
}

fn equal_time(uniform: &Measured, other: &Measured, metric: Metric, at: &Point) -> EqualTime {
    let seconds = at.wall.as_secs_f64();
    let error = height(&metric.over_time(&other.curve), seconds);
    EqualTime {
        configuration: other.name.clone(),
        baseline: uniform.name.clone(),
        metric,
        uniform_samples: at.checkpoint,
        seconds,
        uniform_error: metric.of(at),
        error,
        error_ratio: error.map(|error| metric.of(at) / error),
    }
}

fn smallest(uniform: &Measured, other: &Measured, metric: Metric) -> Smallest {
    let limit = uniform.curve.iter().find(|p| p.checkpoint == SMALLEST_FROM).map(|p| metric.of(p));
    let below = |p: &&Point| limit.is_some_and(|limit| metric.of(p) < limit);
    let checkpoints: Vec<&Point> = uniform.curve.iter().filter(below).collect();
    let curve = metric.over_time(&other.curve);
    let ratios: Vec<(f64, u32)> = checkpoints
        .iter()
        .filter_map(|p| {
            Some((p.wall.as_secs_f64() / crossing(&curve, metric.of(p)).place()?, p.checkpoint))
        })
        .collect();
    let smallest = ratios.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
    Smallest {
        configuration: other.name.clone(),
        baseline: uniform.name.clone(),
        metric,
        time_ratio: smallest.map(|s| s.0),
        uniform_samples: smallest.map(|s| s.1),
        reached: ratios.len(),
        checkpoints: checkpoints.len(),
    }
}

/// The samples per pixel that `curve` has at a time, by interpolation; nothing outside its span.
pub fn samples_at(curve: &[Point], seconds: f64) -> Option<f64> {
    let samples: Vec<_> = curve.iter().map(|p| (p.wall.as_secs_f64(), p.samples)).collect();
    height(&samples, seconds)
}

#[cfg(test)]
mod tests {
    use super::super::curve::tests::point;
    use super::*;
    use raystream::render::{Estimator, IntegratorKind};

    /// Error 1 after a sample, falling with the root of the samples, times `gain`; every sample
    /// takes `seconds`.
    fn measured(allocator: AllocatorKind, samples: &[u32], seconds: f64, gain: f64) -> Measured {
        measured_by(IntegratorKind::Megakernel, allocator, samples, seconds, gain)
    }

    /// The same with an integrator, which is in the name if it is `lvc`.
    fn measured_by(
        integrator: IntegratorKind,
        allocator: AllocatorKind,
        samples: &[u32],
        seconds: f64,
        gain: f64,
    ) -> Measured {
        let uniform = Configuration::uniform(integrator);
        let configuration = match allocator {
            AllocatorKind::Uniform => uniform,
            _ => Configuration { allocator, estimator: Estimator::Bilateral, ..uniform },
        };
        let among = if integrator == IntegratorKind::Lvc {
            vec![configuration, Configuration::uniform(IntegratorKind::Megakernel)]
        } else {
            vec![configuration]
        };
        let point = |&n: &u32| {
            point(f64::from(n), f64::from(n) * seconds, 1.0 / (gain * f64::from(n)).sqrt())
        };
        let curve = samples.iter().map(point).collect();
        Measured {
            configuration,
            name: configuration.name_among(&among),
            curve,
            rounds: Vec::new(),
        }
    }

    const SAMPLES: [u32; 8] = [4, 8, 16, 32, 64, 128, 256, 512];

    fn close(a: Option<f64>, b: f64) {
        assert!(a.is_some_and(|a| (a / b - 1.0).abs() < 1e-9), "{a:?} is not {b}");
    }

    #[test]
    fn known_gains_are_found() {
        // A third of the samples for the same error, each taking 1.5 times as long: twice as fast.
        let all = [
            measured(AllocatorKind::Uniform, &SAMPLES, 1.0, 1.0),
            measured(AllocatorKind::Atomic, &SAMPLES, 3.0, 3.0),
            measured(AllocatorKind::Runs, &SAMPLES, 1.5, 3.0),
        ];
        let comparisons = Comparisons::of(&all, &[64, 256], 0.0);
        let find = |configuration: &str, baseline: &str, level| {
            let found = comparisons.speedups.iter().find(|s| {
                s.configuration == configuration
                    && s.baseline == baseline
                    && s.uniform_samples == level
                    && s.metric == Metric::TrimmedRmse
            });
            found.unwrap().clone()
        };
        for level in [64, 256] {
            let runs = find("runs-bilateral", "uniform", level);
            close(runs.time_ratio, 2.0);
            close(runs.samples_ratio, 3.0);
            close(runs.seconds, f64::from(level) / 2.0);
            assert_eq!(runs.note, "");
            close(find("runs-bilateral", "atomic-bilateral", level).time_ratio, 2.0);
            close(find("atomic-bilateral", "uniform", level).time_ratio, 1.0);
        }
        assert!(!comparisons.speedups.iter().any(|s| s.configuration == s.baseline));
        for equal in comparisons.equal_time.iter().filter(|e| e.configuration == "runs-bilateral") {
            let is_squared = equal.metric == Metric::RelativeMse;
            close(equal.error_ratio, if is_squared { 2.0 } else { 2.0_f64.sqrt() });
        }
        let smallest = &comparisons.smallest[1];
        close(smallest.time_ratio, 2.0);
        assert_eq!((smallest.reached, smallest.checkpoints), (5, 5));
        close(samples_at(&all[2].curve, 96.0), 64.0);
    }

    #[test]
    fn every_integrator_has_its_own_baseline_too() {
        use AllocatorKind::{Atomic, Runs, Uniform};
        let lvc = |allocator, seconds, gain| {
            measured_by(IntegratorKind::Lvc, allocator, &SAMPLES, seconds, gain)
        };
        let all = [
            measured(Uniform, &SAMPLES, 1.0, 1.0),
            measured(Atomic, &SAMPLES, 1.0, 5.0),
            lvc(Uniform, 2.0, 6.0),
            lvc(Runs, 2.0, 12.0),
            lvc(Atomic, 2.0, 3.0),
        ];
        let comparisons = Comparisons::of(&all, &[128], 0.0);
        let found: Vec<_> = comparisons
            .speedups
            .iter()
            .filter(|s| s.metric == Metric::Rmse)
            .map(|s| {
                (
                    &*s.configuration,
                    &*s.baseline,
                    s.time_ratio.map(|ratio| (ratio * 100.0).round() / 100.0),
                )
            })
            .collect();
        assert_eq!(
            found,
            [
                ("atomic-bilateral", "uniform", Some(5.0)),
                ("lvc-uniform", "uniform", Some(3.0)),
                ("lvc-runs-bilateral", "uniform", Some(6.0)),
                ("lvc-runs-bilateral", "lvc-uniform", Some(2.0)),
                ("lvc-runs-bilateral", "lvc-atomic-bilateral", Some(4.0)),
                ("lvc-atomic-bilateral", "uniform", Some(1.5)),
                ("lvc-atomic-bilateral", "lvc-uniform", Some(0.5)),
            ]
        );
        // What the second integrator is compared with at a level is its own error and time there.
        let own =
            |s: &&Speedup| s.baseline == "lvc-uniform" && s.configuration == "lvc-runs-bilateral";
        let own = comparisons.speedups.iter().find(own).unwrap();
        close(own.baseline_seconds, 256.0);
        close(Some(own.error), (6.0 * 128.0_f64).powf(-0.5));
        let pairs =
            |rows: Vec<(&str, &str)>| rows.into_iter().filter(|row| row.1 == "lvc-uniform").count();
        assert_eq!(
            pairs(
                comparisons.equal_time.iter().map(|e| (&*e.configuration, &*e.baseline)).collect()
            ),
            2 * Metric::ALL.len()
        );
        assert_eq!(
            pairs(comparisons.smallest.iter().map(|s| (&*s.configuration, &*s.baseline)).collect()),
            2 * Metric::ALL.len()
        );
    }

    #[test]
    fn what_is_not_reached_is_said() {
        let all = [
            measured(AllocatorKind::Uniform, &SAMPLES, 1.0, 1.0),
            measured(AllocatorKind::Runs, &[4, 8, 16, 32, 64], 2.0, 1.0),
            measured(AllocatorKind::Paper, &[100, 200, 400], 1.0, 1.0),
        ];
        let comparisons = Comparisons::of(&all, &[64, 256], 0.02);
        let notes: Vec<_> =
            comparisons.speedups[..4].iter().map(|s| (s.time_ratio.is_some(), &*s.note)).collect();
        assert_eq!(
            notes,
            [
                (true, ""),
                (false, "not reached; limited by the reference"),
                (false, "below it from the first point on"),
                (true, "limited by the reference"),
            ]
        );
        let smallest = &comparisons.smallest[0];
        close(smallest.time_ratio, 0.5);
        assert_eq!((smallest.reached, smallest.checkpoints), (2, 5));
        let outside = comparisons
            .equal_time
            .iter()
            .find(|e| e.configuration == "runs-bilateral" && e.uniform_samples == 256);
        assert_eq!(outside.unwrap().error, None);
    }

    #[test]
    fn fewer_than_sixteen_samples_have_no_smallest() {
        let all = [
            measured(AllocatorKind::Uniform, &[4, 8], 1.0, 1.0),
            measured(AllocatorKind::Runs, &[4, 8], 1.0, 1.0),
        ];
        let smallest = &Comparisons::of(&all, &[4], 0.0).smallest[0];
        assert_eq!((smallest.time_ratio, smallest.checkpoints), (None, 0));
    }
}
