//! Launches of the filter `regression`.

use super::halves::FilteredHalves;
use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::scene::camera::pinhole;
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::regression::RegressionParams;

/// Neighbours to each side that planes are fitted to.
const RADIUS: u32 = 7;
/// Deviations by which differences are measured.
const STRENGTH: f32 = 0.5;
/// Variances that are taken off squared differences: their expectation.
const EXPLAINED: f32 = 1.0;

/// First-order regression.
pub struct Regression<B> {
    halves: FilteredHalves<B>,
}

impl<B> Regression<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        Ok(Self { halves: FilteredHalves::new(executor, size)? })
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Regression<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = inputs.size;
        let (origin, pixel_pitch) = pinhole(&view.camera);
        let parameters = RegressionParams {
            threads: width * height,
            width,
            height,
            radius: RADIUS,
            origin,
            pixel_pitch,
            strength: STRENGTH * STRENGTH,
            explained: EXPLAINED,
            ..RegressionParams::zeroed()
        };
        self.halves.launches(inputs, filtered, |weighers, values, to| {
            let guides = inputs.guides.view();
            kernels::regress_half(&parameters, guides, weighers.view(), values.view(), to.view())
        })
    }
}
