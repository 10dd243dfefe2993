//! The render loop and what stops it.

use super::error::RenderError;
use super::estimator::Noise;
use super::renderer::{Renderer, Round};
use super::timings::Timings;
use crate::exec::Executor;
use std::time::{Duration, Instant};

/// When to stop: at whichever comes first. By default only at the noise that
/// [`Sampling::noise`](super::Sampling::noise) asks for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    /// Samples per pixel.
    pub samples: Option<u32>,
    /// Time, from the first sample on. Rounds are made to fit, and cut off where they do not: what
    /// has been traced of a stream and is not in the film by then is lost.
    pub time: Option<Duration>,
}

impl Budget {
    /// This many samples per pixel.
    pub fn samples(samples: u32) -> Self {
        Self { samples: Some(samples), ..Self::default() }
    }

    /// This much time.
    pub fn time(time: Duration) -> Self {
        Self { time: Some(time), ..Self::default() }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Paths traced.
    pub paths: u64,
    /// Paths that the budget's samples make, if it has any.
    pub total_paths: Option<u64>,
    /// Rays traced, estimated from a count of at most about a second ago; 0 before the first.
    pub rays: u64,
    /// Since the first sample.
    pub elapsed: Duration,
    /// The budget's time.
    pub time: Option<Duration>,
    /// How far the picture is on its way to the noise that was asked for, from 0 to 1; 0 where none
    /// was.
    pub convergence: f64,
}

impl Progress {
    fn start(total_paths: Option<u64>, time: Option<Duration>) -> Self {
        Self { paths: 0, total_paths, rays: 0, elapsed: Duration::ZERO, time, convergence: 0.0 }
    }
}

/// How a render ended.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Paths traced in this run.
    pub paths: u64,
    /// Rays traced, those of earlier runs with this renderer included.
    pub rays: u64,
    /// From the first sample to the last.
    pub elapsed: Duration,
    /// Where the time went.
    pub timings: Timings,
    /// What ended it.
    pub stop: Stop,
    /// The noise of the picture, by estimate; none where errors are not estimated.
    pub noise: Option<Noise>,
}

impl Outcome {
    /// Whether it was stopped before its budget was spent.
    pub fn interrupted(&self) -> bool {
        self.stop == Stop::Interrupted
    }
}

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The budget's samples.
    Samples,
    /// The budget's time.
    Time,
    /// The picture, or every pixel of it, [has converged](Renderer::has_converged).
    Noise,
    /// Who asked for it.
    Interrupted,
}

/// How often rays are counted.
const RAY_COUNT_INTERVAL: Duration = Duration::from_secs(1);

/// Renders rounds until `budget` is spent, the picture [has converged](Renderer::has_converged) or
/// `interrupted` says so (asked whenever nothing would be lost). `observe` is told of every batch.
///
/// A picture that time or an interruption ends within the first round has pixels without samples.
///
/// With neither samples nor time nor a noise to reach the render goes on until it is interrupted.
pub fn run<E: Executor>(
    renderer: &mut Renderer<E>,
    budget: Budget,
    interrupted: &dyn Fn() -> bool,
    observe: &mut dyn FnMut(&Progress),
) -> Result<Outcome, RenderError> {
    let start = Instant::now();
    let pixels = u64::from(renderer.pixels());
    let total_paths = budget.samples.map(|samples| u64::from(samples) * pixels);
    let mut progress = Progress::start(total_paths, budget.time);
    let mut timings = Timings::default();
    let mut last_count = start;
    let mut rays_per_path = 0.0;
    let paths_before = renderer.paths();
    let is_late = || budget.time.is_some_and(|time| start.elapsed() >= time);
    let stop = loop {
        let paths = renderer.paths() - paths_before;
        let left = total_paths.map_or(u64::MAX, |total| total - paths);
        if left == 0 {
            break Stop::Samples;
        }
        if paths > 0 && is_late() {
            break Stop::Time;
        }
        if renderer.has_converged()? {
            break Stop::Noise;
        }
        progress.convergence = renderer.convergence();
        // Without a single sample there is nothing to write.
        if paths > 0 && interrupted() {
            break Stop::Interrupted;
        }
        let left = left.min(affordable(budget.time, paths, start.elapsed()));
        let mut round = renderer.next_round(left)?;
        let stop = trace(&mut round, paths > 0, &is_late, interrupted, &mut |batch| {
            progress.paths += u64::from(batch);
            progress.elapsed = start.elapsed();
            progress.rays = (progress.paths as f64 * rays_per_path) as u64;
            observe(&progress);
        })?;
        timings += round.timings();
        if let Some(stop) = stop {
            break stop;
        }
        if last_count.elapsed() >= RAY_COUNT_INTERVAL || rays_per_path == 0.0 {
            rays_per_path = renderer.rays()? as f64 / renderer.paths() as f64;
            last_count = Instant::now();
        }
    };
    Ok(Outcome {
        elapsed: start.elapsed(),
        paths: renderer.paths() - paths_before,
        rays: renderer.rays()?,
        noise: renderer.noise()?,
        timings,
        stop,
    })
}

/// Traces a round to its end, or until it `is_late` and there are samples, or `interrupted` says so
/// and nothing would be lost: then what ended it. `observe` is told of the paths of every batch.
fn trace<E: Executor>(
    round: &mut Round<'_, E>,
    has_samples: bool,
    is_late: &dyn Fn() -> bool,
    interrupted: &dyn Fn() -> bool,
    observe: &mut dyn FnMut(u32),
) -> Result<Option<Stop>, RenderError> {
    while let Some(batch) = round.next_batch()? {
        observe(batch.paths);
        if (has_samples || round.is_in_film()) && is_late() {
            return Ok(Some(Stop::Time));
        }
        if round.is_in_film() && interrupted() {
            return Ok(Some(Stop::Interrupted));
        }
    }
    Ok(None)
}

/// Paths that fit into the time that is left, by the `paths` that have taken `elapsed`: at least
/// one if any time is left; as many as you like where nothing is known or wanted.
fn affordable(time: Option<Duration>, paths: u64, elapsed: Duration) -> u64 {
    let (Some(time), true) = (time, paths > 0) else { return u64::MAX };
    let rate = paths as f64 / elapsed.as_secs_f64().max(1e-9);
    ((rate * time.saturating_sub(elapsed).as_secs_f64()) as u64).max(1)
}
