//! Launches of the filter `axis-aligned`.

use super::{Filter, FilterInputs, FilterView};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::scene::camera::pinhole;
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::axis_aligned::{AxisParams, Occluders};
use raystream_shaders::scene::camera::Camera;

/// Pixels to each side that the filter sees at most.
const RADIUS: u32 = 10;
/// What the bandwidth is multiplied by, which the paper leaves to its user: of 0.5, 1, 2 and 4 this
/// leaves the least error.
const NARROWNESS: f32 = 0.5;

/// The parameters of the filter's kernels, and of the estimator's but for its form, for a picture
/// of `camera`.
pub(in crate::render) fn parameters(camera: &Camera) -> AxisParams {
    let (origin, pixel_pitch) = pinhole(camera);
    AxisParams {
        threads: camera.width * camera.height,
        first_rank: 0,
        width: camera.width,
        height: camera.height,
        radius: RADIUS,
        origin,
        pixel_pitch,
        narrowness: NARROWNESS,
        ..AxisParams::zeroed()
    }
}

/// Axis-aligned filtering.
pub struct AxisAligned<B> {
    occluders: Array<B, Occluders>,
}

impl<B> AxisAligned<B> {
    /// For a picture of `size`.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        Ok(Self { occluders: Array::zeroed(executor, "distances of occluders", pixels)? })
    }
}

impl<B: Send + Sync + 'static> Filter<B> for AxisAligned<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let parameters = parameters(&view.camera);
        let (guides, occluders) = (inputs.guides.view(), self.occluders.view());
        vec![
            kernels::find_occluders(&parameters, guides, occluders),
            kernels::filter_axis_aligned(
                &parameters,
                inputs.guides.view(),
                self.occluders.view(),
                filtered.view(),
            ),
        ]
    }
}
