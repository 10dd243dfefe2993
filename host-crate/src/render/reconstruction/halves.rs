//! Halves of a picture that filters weigh by each other.

use super::FilterInputs;
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;

/// Both halves as a filter leaves them, in rank order.
pub struct FilteredHalves<B> {
    first: Array<B, Vec4>,
    second: Array<B, Vec4>,
}

impl<B> FilteredHalves<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let half = || Array::zeroed(executor, "filtered halves", pixels);
        Ok(Self { first: half()?, second: half()? })
    }

    /// The launches after which `filtered` is of both halves of `inputs`: `filter` makes that which
    /// filters a half, of what weighs it, the half, and where the result goes. Each is weighed by
    /// the other.
    pub fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        filtered: &'a Array<B, FilteredPixel>,
        filter: impl Fn(&'a Array<B, Vec4>, &'a Array<B, Vec4>, &'a Array<B, Vec4>) -> Launch<'a, B>,
    ) -> Vec<Launch<'a, B>> {
        let (first, second) = (&inputs.first, &inputs.second);
        vec![
            filter(second, first, &self.first),
            filter(first, second, &self.second),
            kernels::join_halves(
                &inputs.parameters(),
                inputs.guides.view(),
                first.view(),
                self.first.view(),
                self.second.view(),
                filtered.view(),
            ),
        ]
    }
}
