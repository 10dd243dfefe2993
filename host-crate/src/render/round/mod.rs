//! One round on a device: streams are filled, traced and accumulated, batch by batch.

pub mod batch;
mod launches;
pub mod plan;
mod state;

pub use launches::TimedLaunches;
pub use state::{DeviceState, MAX_STREAM, allocate_stream};

use self::plan::{RoundKind, RoundPlan};
use super::allocator::{RoundBuffers, Stream};
use super::film::WINDOW_ALIGNMENT;
use super::renderer::Renderer;
use super::timings::{Part, Timings};
use crate::exec::{ExecError, Executor};
use raystream_shaders::math::random::hash;
use std::ops::Range;
use std::time::Instant;

/// A round under way: the caller takes it from batch to batch, and may look at the clock or tell
/// of progress in between. A round that is dropped before its end leaves out the samples of the
/// streams that it has not come to the end of.
#[must_use = "a round traces nothing until its batches are taken"]
pub struct Round<'r, E: Executor> {
    renderer: &'r mut Renderer<E>,
    plan: RoundPlan,
    /// The streams that are still to be worked off, the next one last.
    streams: Vec<Stream>,
    /// The first slot of the next batch in the stream.
    next: u32,
    /// Whether no batch has been run.
    is_new: bool,
    timings: Timings,
}

/// What one submission has traced.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    /// Slots of the sample stream: as many paths, but for slots that stay empty.
    pub paths: u32,
    /// Where its time went.
    pub timings: Timings,
}

impl<'r, E: Executor> Round<'r, E> {
    /// Begins the round; `timings` are of what was done for it before.
    pub(super) fn new(renderer: &'r mut Renderer<E>, plan: RoundPlan, timings: Timings) -> Self {
        let state = &renderer.state;
        let paths = match plan.kind {
            RoundKind::Uniform { samples } => u64::from(samples) * u64::from(state.film.pixels()),
            RoundKind::Adaptive { paths } => paths,
        };
        let allocator = renderer.allocator(plan.kind);
        let mut streams = allocator.streams(&state.film, paths, state.slots.len() as u32);
        streams.reverse();
        renderer.done.rounds += 1;
        Self { renderer, plan, streams, next: 0, is_new: true, timings }
    }

    /// Traces the next batch: slots of one stream, as many as the device works off in about a tenth
    /// of a second. None at the round's end.
    pub fn next_batch(&mut self) -> Result<Option<Batch>, ExecError> {
        let Some(stream) = self.streams.last() else { return Ok(None) };
        let batch = self.renderer.batch.slots().next_multiple_of(WINDOW_ALIGNMENT);
        let slots = self.next..stream.slots.min(self.next + batch);
        let (paths, is_last) = (slots.end - slots.start, slots.end == stream.slots);
        let executor = &self.renderer.state.executor;
        let start = Instant::now();
        let timings = self.launches(stream, slots.clone()).run(executor)?;
        let elapsed = start.elapsed();
        let allocator = self.renderer.allocator(self.plan.kind);
        let filled = if is_last { allocator.filled(executor, stream)? } else { 0 };

        let samples = self.renderer.film_samples();
        let is_updated = self.is_new && self.is_adaptive();
        let Renderer { estimation, done, batch, .. } = &mut *self.renderer;
        if is_updated {
            estimation.updated(samples);
        }
        estimation.film_changed();
        batch.record(paths, elapsed);
        done.paths += u64::from(filled);
        self.is_new = false;
        self.next = slots.end;
        if is_last {
            self.streams.pop();
            self.next = 0;
        }
        self.timings += timings;
        Ok(Some(Batch { paths, timings }))
    }

    /// The launches of a batch: with the first one what the round needs before, with a stream's
    /// first one what fills it, with its last one what adds it to the film.
    fn launches(&self, stream: &Stream, slots: Range<u32>) -> TimedLaunches<'_, E::Buffer> {
        let Renderer { state, estimation, .. } = &*self.renderer;
        let allocator = self.renderer.allocator(self.plan.kind);
        let number = self.plan.number;
        let mut launches = TimedLaunches::default();
        if self.is_new {
            if self.is_adaptive() {
                launches = estimation.update(state, self.renderer.film_samples());
            }
            let begin = state.integrator.begin_round(&state.stream_buffers(), number);
            launches.add(begin, Part::Tracing);
        }
        let buffers = RoundBuffers {
            film: &state.film,
            errors: estimation.errors(),
            slots: &state.slots,
            contributions: &state.contributions,
            salt: if self.is_adaptive() { hash(self.renderer.seed ^ hash(number)) } else { 0 },
        };
        let (is_first, is_last) = (slots.start == 0, slots.end == stream.slots);
        if is_first {
            launches.add(allocator.fill(&buffers, stream), Part::Generation);
        }
        launches.add(state.integrator.trace(&state.stream_buffers(), slots), Part::Tracing);
        if is_last {
            launches.add(allocator.accumulate(&buffers, stream), Part::Accumulation);
        }
        launches
    }

    fn is_adaptive(&self) -> bool {
        matches!(self.plan.kind, RoundKind::Adaptive { .. })
    }

    /// Where the time of the batches so far went.
    pub fn timings(&self) -> Timings {
        self.timings
    }

    /// Traces what is left of the round. Returns where the time of all of it went.
    pub fn finish(mut self) -> Result<Timings, ExecError> {
        while self.next_batch()?.is_some() {}
        Ok(self.timings)
    }
}
