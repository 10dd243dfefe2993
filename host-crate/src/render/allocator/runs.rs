//! The allocator `runs`: every pixel is filled up to the number of samples that its error deserves,
//! its slots in one run; see [`raystream_shaders::allocator::deficits`].

use super::error_scale::ErrorScale;
use super::run_table::RunTable;
use super::uniform::{Part, fill_runs};
use super::{Allocator, RoundBuffers, Stream};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use bytemuck::Zeroable;
use raystream_shaders::allocator::deficits::{DeficitParams, LEVEL_WORDS, PASSES, fraction_bits};
use raystream_shaders::film::accumulate::CountParams;
use raystream_shaders::film::stream::RunWindow;
use raystream_shaders::parallel::prefix::BlockParams;

/// Filled up to what errors deserve, in runs.
pub struct Runs<B> {
    pixels: u32,
    scale: ErrorScale<B>,
    /// Samples that each pixel has had.
    counts: Array<B, u32>,
    /// What each pass has found.
    levels: Array<B, u32>,
    table: RunTable<B>,
}

impl<B> Runs<B> {
    /// For pictures of `pixels` pixels.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        let levels = (LEVEL_WORDS * PASSES) as usize;
        Ok(Self {
            pixels,
            scale: ErrorScale::new(executor, pixels)?,
            counts: Array::zeroed(executor, "the samples of pixels", pixels as usize)?,
            levels: Array::zeroed(executor, "levels", levels)?,
            table: RunTable::new(executor, pixels)?,
        })
    }

    /// Launches that weigh pixels by what they lack.
    fn weigh<'a>(&'a self, buffers: &RoundBuffers<'a, B>, stream: &Stream) -> Vec<Launch<'a, B>> {
        let mut launches = self.scale.launches(buffers.errors);
        for band in buffers.film.bands() {
            let threads = band.film.len() as u32;
            let parameters = CountParams { threads, ..CountParams::zeroed() };
            let counts = self.counts.slice(band.ranks());
            launches.push(kernels::copy_counts(&parameters, band.film.view(), counts));
        }
        let words = RunWindow { threads: LEVEL_WORDS * PASSES, ..RunWindow::zeroed() };
        launches.push(kernels::clear_counter(&words, self.levels.view()));
        let BlockParams { threads, blocks, .. } = BlockParams::per_block(self.pixels);
        let slots = stream.adaptive_slots();
        let samples = buffers.paths + u64::from(stream.uniform_slots());
        let parameters = DeficitParams {
            threads,
            pixels: self.pixels,
            blocks,
            slots,
            control: stream.uniform,
            fraction_bits: fraction_bits(slots, samples),
            pass: 0,
            pad: 0,
        };
        launches.extend((0..PASSES).map(|pass| {
            kernels::raise_level(
                &DeficitParams { pass, ..parameters },
                buffers.errors.view(),
                self.counts.view(),
                self.scale.totals.view(),
                self.levels.view(),
            )
        }));
        launches.push(kernels::weigh_deficits(
            &parameters,
            buffers.errors.view(),
            self.counts.view(),
            self.scale.totals.view(),
            self.levels.view(),
            self.table.weights.view(),
            self.table.sums.view(),
        ));
        launches
    }
}

impl<E: Executor> Allocator<E> for Runs<E::Buffer> {
    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let parameters = self.table.parameters(stream.adaptive_slots(), buffers.salt & 0xff);
        let mut launches = self.weigh(buffers, stream);
        launches.extend(self.table.lay_out(&parameters));
        let starts = |band: &_| self.table.starts_of(band);
        launches.extend(fill_runs(buffers, stream, starts, Part::Adaptive));
        launches
    }
}
