//! A worker on a device of this process.

use super::Worker;
use crate::clock::Instant;
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::allocator::{Allocation, RoundBuffers, Stream};
use crate::render::film::WINDOW_ALIGNMENT;
use crate::render::integrator;
use crate::render::round::batch::BatchSize;
use crate::render::round::state::DeviceState;
use crate::render::scene::PreparedScene;
use crate::render::settings::Settings;
use crate::render::settings::sampling::{AllocatorKind, Split};
use bytemuck::Zeroable;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::{RunWindow, Slot};
use raystream_shaders::film::sums::{PIXEL_WORDS, PixelSums};
use std::ops::Range;

/// A device that traces for a render on another one.
pub struct LocalWorker<E: Executor> {
    state: DeviceState<E>,
    allocation: Allocation<E>,
    split: Split,
    /// There are none.
    errors: Array<E::Buffer, f32>,
    batch: BatchSize,
}

impl<E: Executor> LocalWorker<E> {
    /// Copies the scene to the device. `scene` and `settings` are those of the render.
    ///
    /// # Errors
    /// If the device fails or has not enough memory.
    pub fn new(executor: E, scene: &PreparedScene, settings: &Settings) -> Result<Self, ExecError> {
        let state = DeviceState::new(executor, scene, settings, integrator::create)?;
        Ok(Self {
            allocation: Allocation::new(AllocatorKind::Uniform, &state.executor, 0)?,
            split: settings.whole_sampling().split(),
            errors: Array::zeroed(&state.executor, "no errors", 0)?,
            batch: BatchSize::new(state.slots.len() as u32),
            state,
        })
    }

    fn buffers(&self) -> RoundBuffers<'_, E::Buffer> {
        let DeviceState { film, slots, contributions, .. } = &self.state;
        let (split, errors) = (self.split, &self.errors);
        RoundBuffers { film, paths: 0, split, errors, slots, contributions, salt: 0 }
    }

    fn run(&self, launches: &[Launch<'_, E::Buffer>]) -> Result<(), ExecError> {
        self.state.executor.run_parts(&[launches])?;
        Ok(())
    }

    /// The contributions of slots that fit into the stream.
    fn trace_at_once(&mut self, slots: &[Slot]) -> Result<Vec<Contribution>, ExecError> {
        let count = slots.len() as u32;
        self.state.slots.write(&self.state.executor, slots)?;
        let mut next = 0;
        while next < count {
            let batch = self.batch.slots().next_multiple_of(WINDOW_ALIGNMENT);
            let part = next..count.min(next + batch);
            let start = Instant::now();
            let stream = self.state.stream_buffers();
            self.run(&self.state.integrator.trace(&stream, part.clone()))?;
            self.batch.record(part.len() as u32, start.elapsed());
            next = part.end;
        }
        self.state.contributions.read_range(&self.state.executor, 0..slots.len())
    }
}

impl<E: Executor + Send> Worker for LocalWorker<E>
where
    Allocation<E>: Send,
{
    fn name(&self) -> String {
        self.state.executor.name().to_owned()
    }

    fn capacity(&self) -> u32 {
        self.state.slots.len() as u32
    }

    fn begin_round(&mut self, number: u32) -> Result<(), ExecError> {
        self.run(&self.state.integrator.begin_round(&self.state.stream_buffers(), number))
    }

    fn sample(&mut self, window: &Stream) -> Result<(), ExecError> {
        self.state.sample(&self.allocation, &self.buffers(), window)
    }

    fn trace(&mut self, slots: &[Slot]) -> Result<Vec<Contribution>, ExecError> {
        let mut contributions = Vec::with_capacity(slots.len());
        // The render's device may have room for longer streams.
        for slots in slots.chunks(self.state.slots.len()) {
            contributions.extend(self.trace_at_once(slots)?);
        }
        Ok(contributions)
    }

    fn take_sums(&mut self, ranks: Range<u32>) -> Result<Vec<PixelSums>, ExecError> {
        let DeviceState { executor, film, .. } = &self.state;
        let sums = film.read_ranks(executor, &ranks)?;
        let cleared = film.bands_of(&ranks).map(|(band, places)| {
            let words =
                RunWindow { threads: places.len() as u32 * PIXEL_WORDS, ..RunWindow::zeroed() };
            let places = places.start as usize..places.end as usize;
            kernels::clear_counter(&words, band.film.slice(places).cast())
        });
        self.run(&cleared.collect::<Vec<_>>())?;
        Ok(sums)
    }

    fn add_sums(&mut self, first: u32, sums: &[PixelSums]) -> Result<(), ExecError> {
        self.state.film.add_ranks(&self.state.executor, first, sums)
    }
}
