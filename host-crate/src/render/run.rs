//! The render loop and what stops it.

use super::error::RenderError;
use super::renderer::Renderer;
use super::round::Round;
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
    /// Paths traced, those of earlier runs included.
    pub paths: u64,
    /// Those of earlier runs.
    pub paths_before: u64,
    /// Paths that the budget's samples make, if it has any.
    pub total_paths: Option<u64>,
    /// Rays traced in this run, estimated from a count of at most about a second ago; 0 before the
    /// first.
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
    /// Rays traced in this run.
    pub rays: u64,
    /// From the first sample to the last.
    pub elapsed: Duration,
    /// Where the time went.
    pub timings: Timings,
    /// What ended it.
    pub stop: Stop,
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

/// Who watches a render, and may end it.
pub trait Watch<E: Executor> {
    /// Whether the render should end; asked whenever nothing would be lost.
    fn is_interrupted(&self) -> bool {
        false
    }

    /// Whether the render may only end where a [`Checkpoint`](super::Checkpoint) holds all of it. A
    /// stop may then come a round late.
    fn keeps_checkpoints(&self) -> bool {
        false
    }

    /// Told of every batch.
    fn batch_ended(&mut self, _: &Progress) {}

    /// Told wherever a checkpoint may be taken.
    ///
    /// # Errors
    /// What ends the render.
    fn may_checkpoint(&mut self, _: &Renderer<E>) -> Result<(), RenderError> {
        Ok(())
    }
}

/// Who is told of progress and asked for interruptions, and no more.
struct Closures<'a> {
    interrupted: &'a dyn Fn() -> bool,
    observe: &'a mut dyn FnMut(&Progress),
}

impl<E: Executor> Watch<E> for Closures<'_> {
    fn is_interrupted(&self) -> bool {
        (self.interrupted)()
    }

    fn batch_ended(&mut self, progress: &Progress) {
        (self.observe)(progress);
    }
}

/// As [`run_watched`]: `interrupted` is asked whether the render should end, `observe` is told of
/// every batch.
///
/// # Errors
/// If the device fails.
pub fn run<E: Executor>(
    renderer: &mut Renderer<E>,
    budget: Budget,
    interrupted: &dyn Fn() -> bool,
    observe: &mut dyn FnMut(&Progress),
) -> Result<Outcome, RenderError> {
    run_watched(renderer, budget, &mut Closures { interrupted, observe })
}

/// Renders rounds until `budget` is spent, the picture [has converged](Renderer::has_converged) or
/// `watch` says so.
///
/// A picture that time or an interruption ends within the first round has pixels without samples.
///
/// With neither samples nor time nor a noise to reach the render goes on until it is interrupted.
///
/// # Errors
/// If the device fails, or by `watch`.
pub fn run_watched<E: Executor>(
    renderer: &mut Renderer<E>,
    budget: Budget,
    watch: &mut dyn Watch<E>,
) -> Result<Outcome, RenderError> {
    let rays_before = if renderer.paths() > 0 { renderer.rays()? } else { 0 };
    let mut clock = Clock::start(renderer, budget);
    let stop = loop {
        let paths = renderer.paths() - clock.progress.paths_before;
        let left = clock
            .progress
            .total_paths
            .map_or(u64::MAX, |total| total.saturating_sub(renderer.paths()));
        if left == 0 {
            break Stop::Samples;
        }
        if paths > 0 && clock.is_late() {
            break Stop::Time;
        }
        if renderer.has_converged()? {
            break Stop::Noise;
        }
        clock.progress.convergence = renderer.convergence();
        // Without a single sample there is nothing to write.
        if renderer.paths() > 0 && watch.is_interrupted() {
            break Stop::Interrupted;
        }
        let mut left = left.min(affordable(budget.time, paths, clock.start.elapsed()));
        if budget.time.is_some() && paths == 0 && renderer.paths() > 0 {
            // A render that goes on does not know yet how fast it is, and its rounds are long.
            left = left.min(u64::from(renderer.pixels()));
        }
        let mut round = renderer.next_round(left)?;
        let stop = clock.trace(&mut round, paths > 0, watch)?;
        clock.timings += round.timings();
        if let Some(stop) = stop {
            break stop;
        }
        watch.may_checkpoint(renderer)?;
        clock.count_rays(renderer)?;
    };
    // That waits for workers and for their films, which is a part of the time.
    let rays = renderer.rays()? - rays_before;
    Ok(Outcome {
        elapsed: clock.start.elapsed(),
        paths: renderer.paths() - clock.progress.paths_before,
        rays,
        timings: clock.timings,
        stop,
    })
}

/// When a run began, and how far it is.
struct Clock {
    start: Instant,
    progress: Progress,
    timings: Timings,
    last_count: Instant,
    rays_per_path: f64,
}

impl Clock {
    fn start<E: Executor>(renderer: &Renderer<E>, budget: Budget) -> Self {
        let (start, paths_before) = (Instant::now(), renderer.paths());
        let pixels = u64::from(renderer.pixels());
        let total_paths = budget.samples.map(|samples| u64::from(samples) * pixels);
        let progress = Progress {
            paths: paths_before,
            paths_before,
            total_paths,
            rays: 0,
            elapsed: Duration::ZERO,
            time: budget.time,
            convergence: 0.0,
        };
        Self { start, progress, timings: Timings::default(), last_count: start, rays_per_path: 0.0 }
    }

    fn is_late(&self) -> bool {
        self.progress.time.is_some_and(|time| self.start.elapsed() >= time)
    }

    /// Traces a round to its end, or until it is late and there are samples, or `watch` has it end
    /// where nothing would be lost: then what ended it.
    fn trace<E: Executor>(
        &mut self,
        round: &mut Round<'_, E>,
        has_samples: bool,
        watch: &mut dyn Watch<E>,
    ) -> Result<Option<Stop>, RenderError> {
        while let Some(batch) = round.next_batch()? {
            self.progress.paths += u64::from(batch.paths);
            self.progress.elapsed = self.start.elapsed();
            let traced = self.progress.paths - self.progress.paths_before;
            self.progress.rays = (traced as f64 * self.rays_per_path) as u64;
            watch.batch_ended(&self.progress);
            let keeps = watch.keeps_checkpoints();
            if round.can_be_kept() {
                watch.may_checkpoint(round.renderer())?;
            } else if keeps {
                continue;
            }
            if (round.is_in_film() || has_samples && !keeps) && self.is_late() {
                return Ok(Some(Stop::Time));
            }
            if round.is_in_film() && watch.is_interrupted() {
                return Ok(Some(Stop::Interrupted));
            }
        }
        Ok(None)
    }

    /// Counts the rays now and then.
    fn count_rays<E: Executor>(&mut self, renderer: &Renderer<E>) -> Result<(), RenderError> {
        if self.last_count.elapsed() >= RAY_COUNT_INTERVAL || self.rays_per_path == 0.0 {
            self.rays_per_path = renderer.rays_per_path()?;
            self.last_count = Instant::now();
        }
        Ok(())
    }
}

/// Paths that fit into the time that is left, by the `paths` that have taken `elapsed`: at least
/// one if any time is left; as many as you like where nothing is known or wanted.
fn affordable(time: Option<Duration>, paths: u64, elapsed: Duration) -> u64 {
    let (Some(time), true) = (time, paths > 0) else { return u64::MAX };
    let rate = paths as f64 / elapsed.as_secs_f64().max(1e-9);
    ((rate * time.saturating_sub(elapsed).as_secs_f64()) as u64).max(1)
}
