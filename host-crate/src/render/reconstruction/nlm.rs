//! Launches of the filter `nlm`.

use super::halves::FilteredHalves;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::nlm::NlmParams;

/// Deviations by which differences are measured (Rousselle et al. 2012).
const STRENGTH: f32 = 0.45;
/// Variances that are taken off squared differences: their expectation.
const EXPLAINED: f32 = 1.0;

/// Non-local means.
pub struct Nlm<B> {
    halves: FilteredHalves<B>,
}

impl<B> Nlm<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        Ok(Self { halves: FilteredHalves::new(executor, size)? })
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Nlm<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        _: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = inputs.size;
        let parameters = NlmParams::new(width, height, STRENGTH * STRENGTH, EXPLAINED);
        self.halves.launches(inputs, filtered, |weighers, values, to| {
            kernels::filter_half(&parameters, weighers.view(), values.view(), to.view())
        })
    }
}
