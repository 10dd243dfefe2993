//! One round on a device: streams are filled, traced and accumulated.

use super::SceneBuffers;
use super::allocator::{Allocator, RoundBuffers, Stream, StreamSize};
use super::batch::BatchSize;
use super::film::{FilmBuffers, WINDOW_ALIGNMENT};
use super::integrator::megakernel;
use super::settings::Timings;
use crate::exec::{Array, ExecError, Executor, Launch};
use raystream_shaders::film::Contribution;
use raystream_shaders::path::PathParams;
use raystream_shaders::stream::Slot;
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
    /// The sample stream.
    pub slots: Array<E::Buffer, Slot>,
    /// What comes of it.
    pub contributions: Array<E::Buffer, Contribution>,
}

/// Slots of the largest stream: 2^22 contributions are 134 MB, and four million paths fill any GPU.
pub const MAX_STREAM: u32 = 1 << 22;

impl<'e, E: Executor> Stage<'e, E> {
    /// Runs a round of `paths` paths: `estimate` first, which is to fill `errors`, then what `allocator` makes of them. `after_batch` is
    /// called with the number of paths that each batch has traced. Returns the paths traced and where the time went.
    pub fn round(
        &self,
        allocator: &dyn Allocator<E>,
        errors: &Array<E::Buffer, f32>,
        estimate: Vec<Launch<'_, E::Buffer>>,
        paths: u64,
        salt: u32,
        batch: &mut BatchSize,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<(u64, Timings), ExecError> {
        let buffers =
            RoundBuffers { film: &self.film, errors, slots: &self.slots, contributions: &self.contributions, salt };
        let size = StreamSize { preferred: batch.slots(), largest: self.slots.len() as u32 };
        let mut timings = Timings::default();
        let mut filled = 0;
        let mut estimate = estimate;
        for stream in allocator.streams(&self.film, paths, size) {
            timings += self.stream(allocator, std::mem::take(&mut estimate), &buffers, &stream, batch, after_batch)?;
            filled += u64::from(allocator.filled(self.executor, &stream)?);
        }
        Ok((filled, timings))
    }

    /// In one submission where the stream is no longer than a batch.
    fn stream(
        &self,
        allocator: &dyn Allocator<E>,
        estimate: Vec<Launch<'_, E::Buffer>>,
        buffers: &RoundBuffers<'_, E::Buffer>,
        stream: &Stream,
        batch: &mut BatchSize,
        after_batch: &mut dyn FnMut(u32),
    ) -> Result<Timings, ExecError> {
        let mut timings = Timings::default();
        let mut parts = Parts { launches: Vec::new(), places: Vec::new() };
        parts.add(estimate, |timings| &mut timings.estimation);
        parts.add(allocator.fill(buffers, stream), |timings| &mut timings.generation);
        let mut next = 0;
        while next < stream.slots {
            let end = stream.slots.min(next + batch.slots().next_multiple_of(WINDOW_ALIGNMENT));
            let slots = next as usize..end as usize;
            let parameters = PathParams { threads: end - next, ..self.parameters };
            let launch = megakernel(&self.scene, &parameters, &self.slots, &self.contributions, slots);
            parts.add(vec![launch], |timings| &mut timings.tracing);
            if end == stream.slots {
                parts.add(allocator.accumulate(buffers, stream), |timings| &mut timings.accumulation);
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
type Place = fn(&mut Timings) -> &mut Duration;

/// Launches of one submission.
struct Parts<'a, B> {
    launches: Vec<Launch<'a, B>>,
    places: Vec<Place>,
}

impl<'a, B> Parts<'a, B> {
    fn add(&mut self, launches: Vec<Launch<'a, B>>, place: Place) {
        self.places.extend(launches.iter().map(|_| place));
        self.launches.extend(launches);
    }

    /// Runs them all and forgets them.
    fn run<E: Executor<Buffer = B>>(&mut self, executor: &E) -> Result<Timings, ExecError> {
        let mut timings = Timings::default();
        let times = executor.run(&std::mem::take(&mut self.launches))?;
        for (place, time) in std::mem::take(&mut self.places).into_iter().zip(times) {
            *place(&mut timings) += time;
        }
        Ok(timings)
    }
}

/// The sample stream and its contributions, as large as useful and as the device has room for.
#[allow(clippy::type_complexity)] // a pair, taken apart at once
pub fn allocate_stream<E: Executor>(
    executor: &E,
) -> Result<(Array<E::Buffer, Slot>, Array<E::Buffer, Contribution>), ExecError> {
    let fitting = executor.limits().buffer_bytes / size_of::<Contribution>() as u64;
    let mut capacity = u64::from(MAX_STREAM).min(fitting) as usize;
    loop {
        let pair = Array::zeroed(executor, "the sample stream", capacity)
            .and_then(|slots| Ok((slots, Array::zeroed(executor, "contributions", capacity)?)));
        match pair {
            Err(ExecError::OutOfMemory { .. }) if capacity > 4 * WINDOW_ALIGNMENT as usize => capacity /= 2,
            done => return done,
        }
    }
}
