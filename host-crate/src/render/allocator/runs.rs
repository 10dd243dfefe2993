//! The allocator `runs`: every pixel in proportion to its error, its slots in one run.

use super::uniform::{accumulate_runs, fill_runs};
use super::{Allocator, RoundBuffers, Stream, one_stream};
use crate::exec::{Array, ExecError, Executor, Launch, View, kernels};
use crate::render::film::{Band, FilmBuffers};
use raystream_shaders::allocator::error_scale::BlockErrors;
use raystream_shaders::allocator::runs::{ERROR_WEIGHTS, RunParams};
use raystream_shaders::parallel::prefix::BlockParams;

/// Share of a round's samples that all pixels that have not converged get equally, whatever their
/// error: no estimate is so good that it may starve a pixel.
const UNIFORM_SHARE: f64 = 0.1;

/// What a pixel's error may weigh at most, by what the errors weigh on average. A pixel on which a
/// rare bright path has fallen seems worse than all others together; beyond some more samples it
/// would waste them, and its long run would hold up accumulation.
const LARGEST_ERROR: f64 = 16.0;

/// In proportion to the error, in runs.
pub struct Runs<B> {
    table: RunTable<B>,
}

impl<B> Runs<B> {
    /// For pictures of `pixels` pixels.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        Ok(Self { table: RunTable::new(executor, pixels)? })
    }
}

impl<E: Executor> Allocator<E> for Runs<E::Buffer> {
    fn streams(&self, film: &FilmBuffers<E::Buffer>, paths: u64, largest: u32) -> Vec<Stream> {
        one_stream(film, paths, largest)
    }

    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let all = f64::from(ERROR_WEIGHTS);
        let weights = Weights {
            uniform: (all * UNIFORM_SHARE / (1.0 - UNIFORM_SHARE)) as u32,
            largest: (all * LARGEST_ERROR / stream.pixels.len() as f64) as u32,
        };
        let mut launches =
            self.table.fill(buffers.errors, stream.slots, weights, buffers.salt & 0xff);
        launches.extend(fill_runs(buffers, stream, |band| self.table.starts_of(band), 0));
        launches
    }

    fn accumulate<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        accumulate_runs(buffers, stream, |band| self.table.starts_of(band), 0)
    }
}

/// How errors weigh, see [`RunParams`].
pub(super) struct Weights {
    /// What the uniform share's weights add up to.
    pub uniform: u32,
    /// Largest weight of an error.
    pub largest: u32,
}

/// The first slot of each pixel's run, and what it takes to find it.
pub(super) struct RunTable<B> {
    pixels: u32,
    scale: ErrorScale<B>,
    weights: Array<B, u32>,
    sums: Array<B, u32>,
    starts: Array<B, u32>,
}

impl<B> RunTable<B> {
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        let blocks = BlockParams::per_block(pixels).blocks as usize;
        Ok(Self {
            pixels,
            scale: ErrorScale::new(executor, pixels)?,
            weights: Array::zeroed(executor, "the weights of pixels", pixels as usize)?,
            sums: Array::zeroed(executor, "sums of weights", blocks + 1)?,
            starts: Array::zeroed(executor, "the starts of runs", pixels as usize + 1)?,
        })
    }

    /// Launches that lay out `slots` slots in runs.
    pub fn fill<'a>(
        &'a self,
        errors: &'a Array<B, f32>,
        slots: u32,
        weights: Weights,
        phase: u32,
    ) -> Vec<Launch<'a, B>> {
        let BlockParams { threads, blocks, .. } = BlockParams::per_block(self.pixels);
        let parameters = RunParams {
            threads,
            pixels: self.pixels,
            blocks,
            slots,
            phase,
            uniform_weights: weights.uniform,
            largest_weight: weights.largest,
            pad: 0,
        };
        let mut launches = self.scale.launches(errors);
        launches.extend([
            kernels::weigh_errors(
                &parameters,
                errors.view(),
                self.scale.totals.view(),
                self.weights.view(),
                self.sums.view(),
            ),
            kernels::scan_blocks(&BlockParams::one_workgroup(self.pixels), self.sums.view()),
            kernels::run_starts(
                &parameters,
                self.weights.view(),
                self.sums.view(),
                self.starts.view(),
            ),
        ]);
        launches
    }

    /// The starts of the runs of a band's pixels, and where the last one ends.
    pub fn starts_of(&self, band: &Band<B>) -> View<'_, B, u32> {
        let first = band.first_rank as usize;
        self.starts.slice(first..first + band.film.len() + 1)
    }
}

/// The largest error and the sum of all.
pub(super) struct ErrorScale<B> {
    pixels: u32,
    /// Of each block and, after the last, of all.
    pub totals: Array<B, BlockErrors>,
}

impl<B> ErrorScale<B> {
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        let blocks = BlockParams::per_block(pixels).blocks as usize;
        Ok(Self { pixels, totals: Array::zeroed(executor, "sums of errors", blocks + 1)? })
    }

    pub fn launches<'a>(&'a self, errors: &'a Array<B, f32>) -> Vec<Launch<'a, B>> {
        vec![
            kernels::block_errors(
                &BlockParams::per_block(self.pixels),
                errors.view(),
                self.totals.view(),
            ),
            kernels::add_block_errors(&BlockParams::one_workgroup(self.pixels), self.totals.view()),
        ]
    }
}
