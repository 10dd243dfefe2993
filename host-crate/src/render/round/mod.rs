//! A round: what kind comes next and how long it is ([`plan`]), what it works on ([`state`]), how
//! long a batch is ([`batch`]), launches with their times ([`launches`]), and how it goes from batch
//! to batch ([`Round`]).

pub mod batch;
pub mod launches;
pub mod plan;
pub mod state;

use super::allocator::{RoundBuffers, Stream, Streams, Windows};
use super::film::WINDOW_ALIGNMENT;
use super::renderer::Renderer;
use super::settings::sampling::AllocatorKind;
use super::timings::{Part, Timings};
use crate::clock::Instant;
use crate::exec::{ExecError, Executor};
use launches::TimedLaunches;
use plan::RoundPlan;
use raystream_shaders::math::random::hash;
use state::DeviceState;
use std::ops::Range;

/// A round under way: the caller takes it from batch to batch, and may look at the clock or tell
/// of progress in between. A round that is dropped before its end leaves out the samples of the
/// streams that it has not come to the end of; if samples are independent and all pixels get as
/// many, the next round goes on with them.
#[must_use = "a round traces nothing until its batches are taken"]
pub struct Round<'r, E: Executor> {
    renderer: &'r mut Renderer<E>,
    plan: RoundPlan,
    /// The streams that are still to be begun.
    streams: Streams,
    /// The stream that is being worked off.
    stream: Option<Stream>,
    /// The first slot of the next batch in the stream.
    next: u32,
    /// Where the part of the stream begins that workers trace, if there is one.
    shared: Option<u32>,
    /// When the stream was begun.
    start: Instant,
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
        let largest = state.slots.len() as u32;
        let first = renderer.skipped + renderer.done.uniform;
        let streams = Streams::new(&state.film, plan.uniform, first, plan.adaptive, largest);
        renderer.done.rounds += 1;
        renderer.done.uniform += plan.uniform;
        renderer.rest = Windows::default();
        Self::of_streams(renderer, plan, streams, timings)
    }

    /// Goes on with what is left of a round.
    pub(super) fn of_rest(renderer: &'r mut Renderer<E>, rest: Windows) -> Self {
        let number = renderer.done.rounds.saturating_sub(1);
        let plan = RoundPlan { number, uniform: rest.samples(), adaptive: 0 };
        let streams = Streams::of_rest(rest, renderer.skipped + renderer.done.uniform);
        Self::of_streams(renderer, plan, streams, Timings::default())
    }

    fn of_streams(
        renderer: &'r mut Renderer<E>,
        plan: RoundPlan,
        streams: Streams,
        timings: Timings,
    ) -> Self {
        renderer.team().begin_round(plan.number);
        let (stream, shared, start) = (None, None, Instant::now());
        Self { renderer, plan, streams, stream, next: 0, shared, start, is_new: true, timings }
    }

    /// Traces the next batch: slots of one stream, as many as the device works off in about a tenth
    /// of a second, while workers are at others. None at the round's end.
    pub fn next_batch(&mut self) -> Result<Option<Batch>, ExecError> {
        let batch = self.renderer.batch.slots().next_multiple_of(WINDOW_ALIGNMENT);
        let mut given = 0;
        if self.stream.is_none() {
            given = self.give()?;
            self.begin_stream(batch)?;
        }
        let Some(stream) = self.stream.clone() else { return self.end(given) };
        let mut timings = Timings::default();
        if self.next == 0 && stream.adaptive_slots() > 0 && self.renderer.team().shares() {
            timings += self.share(&stream)?;
        }
        let own = self.shared.unwrap_or(stream.slots);
        let slots = self.next..own.min(self.next + batch);
        let (paths, is_last) = (slots.end - slots.start, slots.end == own);
        let start = Instant::now();
        timings += self.launches(&stream, slots.clone()).run(&self.renderer.state.executor)?;
        self.renderer.batch.record(paths, start.elapsed());
        self.begun();
        self.next = slots.end;
        if is_last {
            timings += self.finish_stream(&stream)?;
        }
        self.renderer.estimation.film_changed();
        self.timings += timings;
        let others = if is_last { stream.slots - own } else { 0 };
        Ok(Some(Batch { paths: given + paths + others, timings }))
    }

    /// Gives windows to the workers that have time. Returns how many slots.
    fn give(&mut self) -> Result<u32, ExecError> {
        // The next errors want all of the film, and to hand it over takes longer than few samples.
        if self.renderer.sampling.allocator != AllocatorKind::Uniform {
            return Ok(0);
        }
        if self.renderer.team().is_full() {
            self.renderer.gather()?;
        }
        let Self { renderer, streams, .. } = self;
        let capacity = renderer.state.slots.len() as u32;
        let film = &renderer.state.film;
        let next = |largest: u32| streams.next_window(film, largest.min(capacity));
        let given = renderer.team().give(next);
        renderer.done.paths += u64::from(given);
        self.keep_rest();
        Ok(given)
    }

    /// Begins the next stream, if there is one; if it is a window, one no longer than a batch, so
    /// that it is in the film soon.
    fn begin_stream(&mut self, batch: u32) -> Result<(), ExecError> {
        let Self { renderer, streams, .. } = self;
        let largest = batch.min(renderer.state.slots.len() as u32);
        self.stream = streams.next(&renderer.state.film, largest);
        self.start = Instant::now();
        if self.stream.as_ref().is_some_and(|stream| stream.adaptive_slots() > 0) {
            self.renderer.gather()?;
        }
        Ok(())
    }

    /// The end of the round, of which workers have been `given` the last slots.
    fn end(&mut self, given: u32) -> Result<Option<Batch>, ExecError> {
        if self.is_new {
            // Workers were at all of it.
            self.beginning().run(&self.renderer.state.executor)?;
            self.begun();
        }
        // What samples share is gone with the next round.
        if self.renderer.samples_that_share().is_some() {
            self.renderer.gather()?;
        }
        if given > 0 {
            self.renderer.estimation.film_changed();
        }
        let batch = Batch { paths: given, timings: Timings::default() };
        Ok((given > 0).then_some(batch))
    }

    /// Makes a stream and sends the workers their parts of it.
    fn share(&mut self, stream: &Stream) -> Result<Timings, ExecError> {
        let mut launches = if self.is_new { self.beginning() } else { TimedLaunches::default() };
        launches.add(self.renderer.allocation.fill(&self.buffers(), stream), Part::Generation);
        let DeviceState { executor, slots, .. } = &self.renderer.state;
        let timings = launches.run(executor)?;
        let mut team = self.renderer.team();
        let parts = team.cut(stream.slots, self.renderer.batch.rate());
        for (worker, part) in parts.iter().skip(1).enumerate() {
            let range = part.start as usize..part.end as usize;
            team.trace(worker, part.clone(), slots.read_range(executor, range)?);
        }
        self.shared = Some(parts[0].end);
        drop(team);
        self.begun();
        Ok(timings)
    }

    /// Adds a stream to the film once it is traced, with what workers have made of their parts.
    fn finish_stream(&mut self, stream: &Stream) -> Result<Timings, ExecError> {
        let mut timings = Timings::default();
        let state = &self.renderer.state;
        let executor = &state.executor;
        let was_shared = self.shared.take().is_some();
        if was_shared {
            for (part, contributions) in self.renderer.team().traced() {
                match contributions {
                    Some(all) => {
                        state.contributions.write_from(executor, part.start as usize, &all)?;
                    }
                    None => timings += self.trace(part)?,
                }
            }
            let mut launches = TimedLaunches::default();
            let accumulate = self.renderer.allocation.accumulate(&self.buffers(), stream);
            launches.add(accumulate, Part::Accumulation);
            timings += launches.run(executor)?;
        }
        if stream.adaptive_slots() > 0 {
            let rate = f64::from(stream.slots) / self.start.elapsed().as_secs_f64().max(1e-9);
            self.renderer.team().record_stream(was_shared, rate);
        }
        let filled = self.renderer.allocation.filled(executor, stream)?;
        self.renderer.done.paths += u64::from(filled);
        (self.stream, self.next) = (None, 0);
        self.keep_rest();
        Ok(timings)
    }

    /// Traces a part of the stream that a worker was to trace.
    fn trace(&self, part: Range<u32>) -> Result<Timings, ExecError> {
        let state = &self.renderer.state;
        let mut timings = Timings::default();
        let batch = self.renderer.batch.slots().next_multiple_of(WINDOW_ALIGNMENT);
        for start in part.clone().step_by(batch as usize) {
            let slots = start..part.end.min(start + batch);
            let mut launches = TimedLaunches::default();
            let trace = state.integrator.trace(&state.stream_buffers(), slots);
            launches.add(trace, Part::Tracing);
            timings += launches.run(&state.executor)?;
        }
        Ok(timings)
    }

    /// What a round needs before its first stream.
    fn beginning(&self) -> TimedLaunches<'_, E::Buffer> {
        let Renderer { state, estimation, .. } = &*self.renderer;
        let mut launches = TimedLaunches::default();
        if self.is_adaptive() {
            launches = estimation.update(state, self.renderer.film_samples());
        }
        let begin = state.integrator.begin_round(&state.stream_buffers(), self.plan.number);
        launches.add(begin, Part::Tracing);
        launches
    }

    /// The first batch has been run.
    fn begun(&mut self) {
        if self.is_new && self.is_adaptive() {
            let samples = self.renderer.film_samples();
            self.renderer.estimation.updated(samples);
        }
        self.is_new = false;
    }

    /// The launches of a batch: with the first one what the round needs before, with a stream's
    /// first one what fills it, with its last one what adds it to the film. A stream of which
    /// workers trace a part has these apart.
    fn launches(&self, stream: &Stream, slots: Range<u32>) -> TimedLaunches<'_, E::Buffer> {
        let Renderer { state, allocation, .. } = &*self.renderer;
        let mut launches = if self.is_new { self.beginning() } else { TimedLaunches::default() };
        let buffers = self.buffers();
        let is_whole = self.shared.is_none();
        if is_whole && slots.start == 0 {
            launches.add(allocation.fill(&buffers, stream), Part::Generation);
        }
        let is_last = slots.end == stream.slots;
        launches.add(state.integrator.trace(&state.stream_buffers(), slots), Part::Tracing);
        if is_whole && is_last {
            launches.add(allocation.accumulate(&buffers, stream), Part::Accumulation);
        }
        launches
    }

    fn buffers(&self) -> RoundBuffers<'_, E::Buffer> {
        let salt =
            if self.is_adaptive() { hash(self.renderer.seed ^ hash(self.plan.number)) } else { 0 };
        self.renderer.round_buffers(salt)
    }

    /// Keeps what is left of the round, for the next one if this one is dropped.
    fn keep_rest(&mut self) {
        if self.has_independent_samples() {
            self.renderer.rest = self.streams.rest();
        }
    }

    /// Whether all that has been traced is in the film: dropped now, the round loses nothing.
    pub fn is_in_film(&self) -> bool {
        self.stream.is_none()
    }

    /// Who renders it.
    pub fn renderer(&self) -> &Renderer<E> {
        self.renderer
    }

    /// Whether nothing is lost and nothing changes if the round is dropped now and another renderer
    /// goes on from a [`Checkpoint`](super::Checkpoint).
    pub fn can_be_kept(&self) -> bool {
        self.is_in_film() && self.has_independent_samples()
    }

    fn has_independent_samples(&self) -> bool {
        !self.is_adaptive() && self.renderer.samples_that_share().is_none()
    }

    fn is_adaptive(&self) -> bool {
        self.plan.adaptive > 0
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
