//! Launches of the filter `regression`.

use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::Vec4;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::regression::RegressionParams;

/// Neighbours to each side that planes are fitted to.
const RADIUS: u32 = 7;
/// Deviations by which differences are measured.
const STRENGTH: f32 = 0.5;
/// Variances that are taken off squared differences: their expectation.
const EXPLAINED: f32 = 1.0;

/// First-order regression, and the filtered halves.
pub struct Regression<B> {
    first: Array<B, Vec4>,
    second: Array<B, Vec4>,
}

impl<B> Regression<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let half = || Array::zeroed(executor, "filtered halves", pixels);
        Ok(Self { first: half()?, second: half()? })
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
        let parameters = RegressionParams {
            threads: width * height,
            width,
            height,
            radius: RADIUS,
            origin: view.camera.origin,
            pixel_pitch: view.camera.right.length(),
            strength: STRENGTH * STRENGTH,
            explained: EXPLAINED,
            ..RegressionParams::zeroed()
        };
        let guides = || inputs.guides.view();
        let (first, second) = (&inputs.first, &inputs.second);
        let regress = |weighers: &'a Array<B, Vec4>,
                       values: &'a Array<B, Vec4>,
                       to: &'a Array<B, Vec4>| {
            kernels::regress_half(&parameters, guides(), weighers.view(), values.view(), to.view())
        };
        vec![
            regress(second, first, &self.first),
            regress(first, second, &self.second),
            kernels::join_halves(
                &inputs.parameters(),
                guides(),
                first.view(),
                self.first.view(),
                self.second.view(),
                filtered.view(),
            ),
        ]
    }
}
