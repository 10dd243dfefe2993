//! What is known of all errors of a round, as integers.

use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use raystream_shaders::allocator::error_scale::BlockErrors;
use raystream_shaders::parallel::prefix::BlockParams;

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
