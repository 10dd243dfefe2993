//! Launches of the filter `nlm`.

use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::nlm::NlmParams;

/// Deviations by which differences are measured (Rousselle et al. 2012).
const STRENGTH: f32 = 0.45;
/// Variances that are taken off squared differences: their expectation.
const EXPLAINED: f32 = 1.0;

/// Non-local means, and the filtered halves.
pub struct Nlm<B> {
    first: Array<B, Vec4>,
    second: Array<B, Vec4>,
}

impl<B> Nlm<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let half = || Array::zeroed(executor, "filtered halves", pixels);
        Ok(Self { first: half()?, second: half()? })
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
        let (first, second) = (&inputs.first, &inputs.second);
        vec![
            kernels::filter_half(&parameters, second.view(), first.view(), self.first.view()),
            kernels::filter_half(&parameters, first.view(), second.view(), self.second.view()),
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
