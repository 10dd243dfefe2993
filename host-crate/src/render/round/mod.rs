//! One round on a device: streams are filled, traced and accumulated.

pub mod batch;

use self::batch::BatchSize;
use super::allocator::{Allocator, RoundBuffers, Stream};
use super::film::{FilmBuffers, WINDOW_ALIGNMENT};
use super::integrator::{Integrator, StreamBuffers};
use super::settings::Timings;
use crate::exec::{Array, ExecError, Executor, Launch, SceneBuffers, halve_until_it_fits};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;
use std::time::{Duration, Instant};

/// What rounds work on.
pub struct Stage<'e, E: Executor> {
    /// The device.
    pub executor: &'e E,
    /// The scene.
    pub scene: SceneBuffers<E::Buffer>,
    /// The film.
    pub film: FilmBuffers<E::Buffer>,
    /// What is the same for all paths; `threads` is 0.
    pub parameters: PathParams,
    /// How the stream is traced.
    pub integrator: Box<dyn Integrator<E>>,
    /// The sample stream.
    pub slots: Array<E::Buffer, Slot>,
    /// What comes of it.
    pub contributions: Array<E::Buffer, Contribution>,
}

/// A round to be run.
pub struct Round<'a, B> {
    /// Paths to trace.
    pub paths: u64,
    /// Number of the round, from 0 on.
    pub number: u32,
    /// A random number of the round.
    pub salt: u32,
    /// The errors by which the allocator goes, see [`RoundBuffers::errors`].
    pub errors: &'a Array<B, f32>,
    /// What is to be done before, such as filling the errors.
    pub prelude: Parts<'a, B>,
}

/// Slots of the largest stream: 2^22 contributions are 134 MB, and four million paths fill any GPU.
pub const MAX_STREAM: u32 = 1 << 22;

impl<'e, E: Executor> Stage<'e, E> {
    /// Runs a round: `prelude` first, then what `allocator` makes of the errors. `after_batch` is
    /// called with the number of paths that each batch has traced. Returns the paths traced and
    /// where the time went.
    pub fn round(
        &self,
        allocator: &dyn Allocator<E>,
        round: Round<'_, E::Buffer>,
        batch: &mut BatchSize,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<(u64, Timings), ExecError> {
        let Round { paths, number, salt, errors, mut prelude } = round;
        prelude.add(self.integrator.begin_round(&self.stream_buffers(), number), |timings| {
            &mut timings.tracing
        });
        let buffers = RoundBuffers {
            film: &self.film,
            errors,
            slots: &self.slots,
            contributions: &self.contributions,
            salt,
        };
        let mut timings = Timings::default();
        let mut filled = 0;
        for stream in allocator.streams(&self.film, paths, self.slots.len() as u32) {
            timings += self.stream(
                allocator,
                std::mem::take(&mut prelude),
                &buffers,
                &stream,
                batch,
                after_batch,
            )?;
            filled += u64::from(allocator.filled(self.executor, &stream)?);
        }
        Ok((filled, timings))
    }

    fn stream_buffers(&self) -> StreamBuffers<'_, E::Buffer> {
        StreamBuffers {
            scene: &self.scene,
            parameters: &self.parameters,
            slots: &self.slots,
            contributions: &self.contributions,
        }
    }

    /// Works off a stream, in one submission where it is no longer than a batch, with `prelude`
    /// before it.
    fn stream(
        &self,
        allocator: &dyn Allocator<E>,
        prelude: Parts<'_, E::Buffer>,
        buffers: &RoundBuffers<'_, E::Buffer>,
        stream: &Stream,
        batch: &mut BatchSize,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<Timings, ExecError> {
        let mut timings = Timings::default();
        let mut parts = prelude;
        parts.add(allocator.fill(buffers, stream), |timings| &mut timings.generation);
        let mut next = 0;
        while next < stream.slots {
            let end = stream.slots.min(next + batch.slots().next_multiple_of(WINDOW_ALIGNMENT));
            parts.add(self.integrator.trace(&self.stream_buffers(), next..end), |timings| {
                &mut timings.tracing
            });
            if end == stream.slots {
                parts.add(allocator.accumulate(buffers, stream), |timings| {
                    &mut timings.accumulation
                });
            }
            let start = Instant::now();
            timings += parts.run(self.executor)?;
            batch.record(end - next, start.elapsed());
            after_batch(end - next);
            next = end;
        }
        Ok(timings)
    }
}

/// Where the time of a launch belongs.
pub type Place = fn(&mut Timings) -> &mut Duration;

/// Launches of one submission.
pub struct Parts<'a, B> {
    parts: Vec<(Vec<Launch<'a, B>>, Place)>,
}

impl<B> Default for Parts<'_, B> {
    fn default() -> Self {
        Self { parts: Vec::new() }
    }
}

impl<'a, B> Parts<'a, B> {
    /// Adds launches whose time belongs to `place`.
    pub fn add(&mut self, launches: Vec<Launch<'a, B>>, place: Place) {
        self.parts.push((launches, place));
    }

    /// Runs them all and forgets them. Where `RUST_LOG` asks for traces, every launch is timed.
    pub fn run<E: Executor<Buffer = B>>(&mut self, executor: &E) -> Result<Timings, ExecError> {
        let parts = std::mem::take(&mut self.parts);
        let longest = if tracing::enabled!(tracing::Level::TRACE) { 1 } else { usize::MAX };
        let timed = || {
            parts.iter().flat_map(|(launches, place)| {
                launches.chunks(longest).map(move |part| (part, place))
            })
        };
        let times = executor.run_parts(&timed().map(|(part, _)| part).collect::<Vec<_>>())?;
        let mut timings = Timings::default();
        for ((part, place), time) in timed().zip(times) {
            *place(&mut timings) += time;
            let (kernel, threads) = (part[0].kernel().name, part[0].threads());
            tracing::trace!("{:8.1} us {kernel} of {threads} threads", time.as_secs_f64() * 1e6);
        }
        Ok(timings)
    }
}

/// The sample stream and its contributions, as large as useful and as the device has room for.
#[expect(clippy::type_complexity, reason = "a pair, taken apart at once")]
pub fn allocate_stream<E: Executor>(
    executor: &E,
) -> Result<(Array<E::Buffer, Slot>, Array<E::Buffer, Contribution>), ExecError> {
    let fitting = executor.limits().buffer_bytes / size_of::<Contribution>() as u64;
    let capacity = u64::from(MAX_STREAM).min(fitting) as u32;
    halve_until_it_fits(capacity, 4 * WINDOW_ALIGNMENT, |capacity| {
        let slots = Array::zeroed(executor, "the sample stream", capacity as usize)?;
        Ok((slots, Array::zeroed(executor, "contributions", capacity as usize)?))
    })
}
