//! The render loop and what stops it.

use super::error::RenderError;
use super::renderer::Renderer;
use super::steps::Run;
use super::timings::Timings;
use crate::exec::Executor;
use std::time::Duration;

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

    /// Whether the render should end now, though what has been traced of a stream is lost with it;
    /// asked after every batch.
    fn is_cancelled(&self) -> bool {
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
    let mut run = Run::start(renderer, budget)?;
    let stop = loop {
        if let Some(stop) = run.round(renderer, watch)? {
            break stop;
        }
    };
    run.outcome(renderer, stop)
}
