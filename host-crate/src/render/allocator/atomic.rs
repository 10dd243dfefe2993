//! The allocator `atomic`: every pixel in proportion to its error, slots and sums by atomics, in
//! the order in which they come.

use super::error_scale::ErrorScale;
use super::run_table::RunTable;
use super::{Allocator, RoundBuffers, Stream};
use crate::exec::{Array, Counter, ExecError, Executor, Launch, kernels};
use bytemuck::Zeroable;
use raystream_shaders::film::stream::RunWindow;

/// Half a sample, in the unit of phases: shares of samples are rounded to the nearest, not at
/// random.
const HALF: u32 = 128;

/// In proportion to the error, by atomics.
pub struct Atomic<B> {
    scale: ErrorScale<B>,
    table: RunTable<B>,
    /// The first slot that each pixel has reserved.
    reserved: Array<B, u32>,
    counter: Counter<B>,
}

impl<B> Atomic<B> {
    /// For pictures of `pixels` pixels.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        Ok(Self {
            scale: ErrorScale::new(executor, pixels)?,
            table: RunTable::new(executor, pixels)?,
            reserved: Array::zeroed(executor, "the slots that pixels reserve", pixels as usize)?,
            counter: Counter::new(executor, "the counter of slots")?,
        })
    }
}

impl<E: Executor> Allocator<E> for Atomic<E::Buffer> {
    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let parameters = self.table.parameters(stream.slots, HALF);
        let mut launches = self.scale.launches(buffers.errors);
        launches.push(kernels::weigh_errors(
            &parameters,
            buffers.errors.view(),
            self.scale.totals.view(),
            self.table.weights.view(),
            self.table.sums.view(),
        ));
        launches.extend(self.table.lay_out(&parameters));
        launches.push(self.counter.clear());
        for band in buffers.film.bands() {
            let pixels = band.film.len() as u32;
            let window = RunWindow {
                threads: pixels,
                first_rank: band.first_rank,
                pixels,
                half: buffers.split.of_adaptive(),
                ..RunWindow::zeroed()
            };
            let reserved = || self.reserved.slice(band.ranks());
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

    fn in_runs(&self) -> bool {
        false
    }
}
