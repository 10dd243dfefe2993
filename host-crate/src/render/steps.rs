//! The render loop in steps: round after round, by the clock.

use super::error::RenderError;
use super::renderer::Renderer;
use super::round::Round;
use super::run::{Budget, Outcome, Progress, Stop, Watch};
use super::timings::Timings;
use crate::clock::Instant;
use crate::exec::Executor;
use std::time::Duration;

/// How often rays are counted.
const RAY_COUNT_INTERVAL: Duration = Duration::from_secs(1);

/// What [`run_watched`](super::run_watched) does, in steps, for whoever looks at a render between
/// its rounds.
pub struct Run {
    clock: Clock,
    budget: Budget,
    rays_before: u64,
    /// When the last round ended.
    left: Instant,
}

impl Run {
    /// Begins a run of `renderer`.
    ///
    /// # Errors
    /// If the device fails.
    pub fn start<E: Executor>(renderer: &Renderer<E>, budget: Budget) -> Result<Self, RenderError> {
        let rays_before = if renderer.paths() > 0 { renderer.rays()? } else { 0 };
        let clock = Clock::start(renderer, budget);
        Ok(Self { left: clock.start, clock, budget, rays_before })
    }

    /// Renders the next round. Returns what ends the run, if anything does: before the round or in
    /// it. What the caller does between rounds takes nothing of the budget's time.
    ///
    /// # Errors
    /// If the device fails, or by `watch`.
    pub fn round<E: Executor>(
        &mut self,
        renderer: &mut Renderer<E>,
        watch: &mut dyn Watch<E>,
    ) -> Result<Option<Stop>, RenderError> {
        self.clock.start += self.left.elapsed();
        let stop = self.timed_round(renderer, watch);
        self.left = Instant::now();
        stop
    }

    fn timed_round<E: Executor>(
        &mut self,
        renderer: &mut Renderer<E>,
        watch: &mut dyn Watch<E>,
    ) -> Result<Option<Stop>, RenderError> {
        if let Some(stop) = self.ended_by_now(renderer)? {
            return Ok(Some(stop));
        }
        let Self { clock, budget, .. } = self;
        let paths = renderer.paths() - clock.progress.paths_before;
        clock.progress.convergence = renderer.convergence();
        // Without a single sample there is nothing to write.
        if renderer.paths() > 0 && watch.is_interrupted() {
            return Ok(Some(Stop::Interrupted));
        }
        let left = clock.paths_left(renderer);
        let mut left = left.min(affordable(budget.time, paths, clock.start.elapsed()));
        if budget.time.is_some() && paths == 0 && renderer.paths() > 0 {
            // A render that goes on does not know yet how fast it is, and its rounds are long.
            left = left.min(u64::from(renderer.pixels()));
        }
        let mut round = renderer.next_round(left)?;
        let stop = clock.trace(&mut round, paths > 0, watch)?;
        clock.timings += round.timings();
        if stop.is_none() {
            watch.may_checkpoint(renderer)?;
            clock.count_rays(renderer)?;
        }
        Ok(stop)
    }

    /// What has ended the run before its next round, if anything has.
    ///
    /// # Errors
    /// If the device fails.
    pub fn ended<E: Executor>(
        &mut self,
        renderer: &mut Renderer<E>,
    ) -> Result<Option<Stop>, RenderError> {
        self.clock.start += self.left.elapsed();
        let stop = self.ended_by_now(renderer);
        self.left = Instant::now();
        stop
    }

    fn ended_by_now<E: Executor>(
        &self,
        renderer: &mut Renderer<E>,
    ) -> Result<Option<Stop>, RenderError> {
        let clock = &self.clock;
        if clock.paths_left(renderer) == 0 {
            return Ok(Some(Stop::Samples));
        }
        if renderer.paths() > clock.progress.paths_before && clock.is_late() {
            return Ok(Some(Stop::Time));
        }
        Ok(renderer.has_converged()?.then_some(Stop::Noise))
    }

    /// How the run went up to the end of its last round, which `stop` ended.
    ///
    /// # Errors
    /// If the device fails.
    pub fn outcome<E: Executor>(
        &self,
        renderer: &Renderer<E>,
        stop: Stop,
    ) -> Result<Outcome, RenderError> {
        // That waits for workers and for their films, which is a part of the time.
        let asked = Instant::now();
        let rays = renderer.rays()? - self.rays_before;
        Ok(Outcome {
            elapsed: self.elapsed() + asked.elapsed(),
            paths: renderer.paths() - self.clock.progress.paths_before,
            rays,
            timings: self.clock.timings,
            stop,
        })
    }

    /// What the rounds so far have taken.
    pub fn elapsed(&self) -> Duration {
        self.left.saturating_duration_since(self.clock.start)
    }
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

    /// Paths that the budget's samples still make.
    fn paths_left<E: Executor>(&self, renderer: &Renderer<E>) -> u64 {
        let total = self.progress.total_paths;
        total.map_or(u64::MAX, |total| total.saturating_sub(renderer.paths()))
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
            if watch.is_cancelled() {
                return Ok(Some(Stop::Interrupted));
            }
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
