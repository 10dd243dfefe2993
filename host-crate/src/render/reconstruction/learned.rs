//! Launches of the filter `learned`, and what it has learned.

use super::{Filter, FilterInputs, FilterView, bilateral};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::settings::estimation::FilterSettings;
use crate::scene::FilmSize;
use glam::Vec4;
use raystream_shaders::estimator::bilateral::FilterParams;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::reconstruction::learned::PixelFilter;
use raystream_shaders::reconstruction::learned::network::ROWS;

/// The network's weights, little-endian; the program `train-filter` (tools/train-filter) writes
/// them.
const WEIGHTS: &[u8; 16 * ROWS as usize] = include_bytes!("learned.weights");

/// Pixels to each side that the filter sees.
const RADIUS: u32 = 7;

/// A joint bilateral filter with parameters for each pixel.
pub struct Learned<B> {
    weights: Array<B, Vec4>,
    smoothed: Array<B, Vec4>,
    filters: Array<B, PixelFilter>,
}

/// The parameters of the filter's kernels: deviations that are 1 for the network.
pub fn parameters(view: &FilterView) -> FilterParams {
    FilterParams { radius: RADIUS, ..bilateral::parameters(FilterSettings::DEFAULT, view) }
}

/// What the network has learned, see
/// [`network`](raystream_shaders::reconstruction::learned::network).
pub fn weights() -> Vec<Vec4> {
    let numbers = WEIGHTS.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let numbers: Vec<f32> = numbers.collect();
    numbers.chunks_exact(4).map(Vec4::from_slice).collect()
}

impl<B> Learned<B> {
    /// For a picture of `size`, with these weights: [`ROWS`] of them.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        weights: &[Vec4],
    ) -> Result<Self, ExecError> {
        const LABEL: &str = "filters of all pixels";
        let pixels = (size.width * size.height) as usize;
        Ok(Self {
            weights: Array::from_slice(executor, "weights of a network", weights)?,
            smoothed: Array::zeroed(executor, LABEL, pixels)?,
            filters: Array::zeroed(executor, LABEL, pixels)?,
        })
    }
}

impl<B: Send + Sync + 'static> Filter<B> for Learned<B> {
    fn launches<'a>(
        &'a self,
        inputs: &'a FilterInputs<B>,
        view: &FilterView,
        filtered: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        let parameters = parameters(view);
        vec![
            kernels::predict_filters(
                &parameters,
                inputs.guides.view(),
                inputs.first.view(),
                inputs.second.view(),
                self.weights.view(),
                self.smoothed.view(),
                self.filters.view(),
            ),
            kernels::filter_by_pixel(
                &parameters,
                inputs.guides.view(),
                self.smoothed.view(),
                self.filters.view(),
                filtered.view(),
            ),
        ]
    }
}
