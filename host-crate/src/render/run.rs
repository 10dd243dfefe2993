//! The render loop and what stops it.

use super::error::RenderError;
use super::renderer::Renderer;
use super::timings::Timings;
use crate::exec::Executor;
use std::time::{Duration, Instant};

/// When to stop: at whichever comes first. By default only at the noise that
/// [`Sampling::noise`](super::Sampling::noise) asks for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget {
    /// Samples per pixel.
    pub samples: Option<u32>,
    /// Time, from the first sample on. A started round is finished.
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
    /// Whether it was stopped before its budget was spent.
    pub interrupted: bool,
}

/// How often rays are counted.
const RAY_COUNT_INTERVAL: Duration = Duration::from_secs(1);

/// Renders rounds until `budget` is spent, the picture [has converged](Renderer::has_converged) or
/// `interrupted` says so (asked after every round). `observe` is told of every batch.
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
    let mut progress = Progress {
        paths: 0,
        total_paths,
        rays: 0,
        elapsed: Duration::ZERO,
        time: budget.time,
        convergence: 0.0,
    };
    let mut timings = Timings::default();
    let mut last_count = start;
    let mut rays_per_path = 0.0;
    let paths_before = renderer.paths();
    let interrupted = loop {
        let paths = renderer.paths() - paths_before;
        let left = total_paths.map_or(u64::MAX, |total| total - paths);
        let spent = budget.time.is_some_and(|time| paths > 0 && start.elapsed() >= time);
        if left == 0 || spent || renderer.has_converged()? {
            break false;
        }
        progress.convergence = renderer.convergence();
        // Without a single sample there is nothing to write.
        if paths > 0 && interrupted() {
            break true;
        }
        let mut round = renderer.next_round(left)?;
        while let Some(batch) = round.next_batch()? {
            progress.paths += u64::from(batch.paths);
            progress.elapsed = start.elapsed();
            progress.rays = (progress.paths as f64 * rays_per_path) as u64;
            observe(&progress);
        }
        timings += round.timings();
        if last_count.elapsed() >= RAY_COUNT_INTERVAL || rays_per_path == 0.0 {
            rays_per_path = renderer.rays()? as f64 / renderer.paths() as f64;
            last_count = Instant::now();
        }
    };
    let elapsed = start.elapsed();
    let paths = renderer.paths() - paths_before;
    Ok(Outcome { paths, rays: renderer.rays()?, elapsed, timings, interrupted })
}
