//! From weights to a run of consecutive slots for each pixel; see
//! [`raystream_shaders::allocator::runs`].

use crate::exec::{Array, ExecError, Executor, Launch, View, kernels};
use crate::render::film::Band;
use bytemuck::Zeroable;
use raystream_shaders::allocator::runs::RunParams;
use raystream_shaders::parallel::prefix::BlockParams;

/// The weights of pixels, and the first slot of the run that each is given for it.
pub(super) struct RunTable<B> {
    pixels: u32,
    /// Weights, in rank order: whoever uses the table fills them in.
    pub weights: Array<B, u32>,
    /// Their sum over each block, likewise.
    pub sums: Array<B, u32>,
    starts: Array<B, u32>,
}

impl<B> RunTable<B> {
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        let blocks = BlockParams::per_block(pixels).blocks as usize;
        Ok(Self {
            pixels,
            weights: Array::zeroed(executor, "the weights of pixels", pixels as usize)?,
            sums: Array::zeroed(executor, "sums of weights", blocks + 1)?,
            starts: Array::zeroed(executor, "the starts of runs", pixels as usize + 1)?,
        })
    }

    /// What kernels are told that lay out `slots` slots; `phase` is below 256.
    pub fn parameters(&self, slots: u32, phase: u32) -> RunParams {
        let BlockParams { threads, blocks, .. } = BlockParams::per_block(self.pixels);
        RunParams { threads, pixels: self.pixels, blocks, slots, phase, ..RunParams::zeroed() }
    }

    /// Launches that lay out the runs, once weights and sums are there.
    pub fn lay_out<'a>(&'a self, parameters: &RunParams) -> [Launch<'a, B>; 2] {
        [
            kernels::scan_blocks(&BlockParams::one_workgroup(self.pixels), self.sums.view()),
            kernels::run_starts(
                parameters,
                self.weights.view(),
                self.sums.view(),
                self.starts.view(),
            ),
        ]
    }

    /// The starts of the runs of a band's pixels, and where the last one ends.
    pub fn starts_of(&self, band: &Band<B>) -> View<'_, B, u32> {
        let first = band.first_rank as usize;
        self.starts.slice(first..first + band.film.len() + 1)
    }
}
