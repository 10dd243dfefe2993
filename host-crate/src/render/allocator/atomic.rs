//! The allocator `atomic`: every pixel in proportion to its error, slots and sums by atomics, in
//! the order in which they come.

use super::runs::{RunTable, Weights};
use super::{Allocator, RoundBuffers, Stream, one_stream};
use crate::exec::{Array, Counter, ExecError, Executor, Launch, kernels};
use crate::render::film::FilmBuffers;
use raystream_shaders::allocator::atomic::STRETCH;
use raystream_shaders::film::stream::RunWindow;

/// Half a sample, in the unit of phases: shares of samples are rounded to the nearest, not at
/// random.
const HALF: u32 = 128;

/// In proportion to the error, by atomics.
pub struct Atomic<B> {
    table: RunTable<B>,
    /// The first slot that each pixel has reserved.
    reserved: Array<B, u32>,
    counter: Counter<B>,
}

impl<B> Atomic<B> {
    /// For pictures of `pixels` pixels.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        Ok(Self {
            table: RunTable::new(executor, pixels)?,
            reserved: Array::zeroed(executor, "the slots that pixels reserve", pixels as usize)?,
            counter: Counter::new(executor, "the counter of slots")?,
        })
    }
}

impl<E: Executor> Allocator<E> for Atomic<E::Buffer> {
    fn streams(&self, film: &FilmBuffers<E::Buffer>, paths: u64, largest: u32) -> Vec<Stream> {
        one_stream(film, paths, largest)
    }

    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let as_they_are = Weights { uniform: 0, largest: u32::MAX };
        let mut launches = self.table.fill(buffers.errors, stream.slots, as_they_are, HALF);
        launches.push(self.counter.clear());
        for band in buffers.film.bands() {
            let pixels = band.film.len() as u32;
            let window =
                RunWindow { threads: pixels, first_rank: band.first_rank, pixels, samples: 0 };
            let first = band.first_rank as usize;
            let reserved = || self.reserved.slice(first..first + band.film.len());
            launches.push(kernels::reserve_slots(
                &window,
                self.table.starts_of(band),
                reserved(),
                self.counter.view(),
            ));
            launches.push(kernels::fill_reserved(
                &RunWindow { threads: stream.slots, ..window },
                self.table.starts_of(band),
                reserved(),
                band.film.view(),
                buffers.slots.slice(0..stream.slots as usize),
            ));
        }
        launches
    }

    fn accumulate<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let slots = stream.slots as usize;
        let film = buffers.film;
        let in_band = film.bands().iter().map(|band| {
            kernels::accumulate_atomic(
                &RunWindow {
                    threads: stream.slots.div_ceil(STRETCH),
                    first_rank: band.first_rank,
                    pixels: band.film.len() as u32,
                    samples: 0,
                },
                buffers.slots.slice(0..slots),
                buffers.contributions.slice(0..slots).cast(),
                band.film.view().cast(),
            )
        });
        in_band.collect()
    }
}
