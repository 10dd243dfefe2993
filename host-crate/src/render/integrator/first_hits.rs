//! Camera rays for the first-hit features of pixels.

use crate::exec::{Launch, SceneBuffers, kernels};
use crate::render::film::Band;
use raystream_shaders::integrator::first_hits::FeatureParams;
use raystream_shaders::integrator::params::PathParams;
use std::ops::Range;

/// Camera rays for the first-hit features of the pixels of a window, until each has `samples`.
pub fn first_hits<'a, B>(
    scene: &'a SceneBuffers<B>,
    parameters: &PathParams,
    band: &'a Band<B>,
    window: &Range<u32>,
    samples: u32,
) -> Launch<'a, B> {
    let parameters = FeatureParams {
        threads: window.end - window.start,
        first_rank: band.first_rank + window.start,
        samples,
        pad: 0,
        path: *parameters,
    };
    let features = band.features.slice(window.start as usize..window.end as usize);
    kernels::first_hits(&parameters, scene, features)
}
