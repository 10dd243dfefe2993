//! Launches of the filter `nlm`.

use super::halves::FilteredHalves;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::nlm::LARGEST_WINDOW;
use raystream_shaders::reconstruction::patches::{LARGEST_PATCH, PatchParams};

/// Deviations by which differences are measured (Rousselle et al. 2012).
pub(super) const STRENGTH: f32 = 0.45;
/// Variances that are taken off squared differences: their expectation.
pub(super) const EXPLAINED: f32 = 1.0;

/// Non-local means.
pub struct Nlm<B> {
    halves: FilteredHalves<B>,
}

impl<B> Nlm<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        Ok(Self { halves: FilteredHalves::new(executor, size, 1)? })
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
        let parameters = PatchParams::new(
            (width, height),
            STRENGTH * STRENGTH,
            EXPLAINED,
            LARGEST_PATCH,
            LARGEST_WINDOW,
        );
        let mut launches = Vec::from(self.halves.rows(inputs));
        launches.extend(self.halves.filter(inputs, &[filtered], |weighers, values, to| {
            [kernels::filter_half(&parameters, weighers.view(), values.view(), to[0].view())]
        }));
        launches
    }
}
