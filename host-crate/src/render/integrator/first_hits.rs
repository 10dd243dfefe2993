//! Camera rays for the first-hit features of pixels.

use crate::exec::{Launch, kernels};
use crate::render::film::Band;
use crate::render::scene::buffers::SceneBuffers;
use raystream_shaders::integrator::first_hits::FeatureParams;
use raystream_shaders::integrator::path::PathParams;
use std::ops::Range;

/// Camera rays for the first-hit features of the pixels of a window, until each has `samples`.
pub fn first_hits<'a, B>(
    scene: &'a SceneBuffers<B>,
    parameters: &PathParams,
    band: &'a Band<B>,
    window: &Range<u32>,
    samples: u32,
) -> Launch<'a, B> {
    Launch::new(
        &kernels::first_hits,
        &FeatureParams {
            threads: window.end - window.start,
            first_rank: band.first_rank + window.start,
            samples,
            pad: 0,
            path: *parameters,
        },
        vec![
            scene.nodes.view(),
            scene.triangles.view(),
            scene.attributes.view(),
            scene.materials.view(),
            scene.texels.view(),
            band.features.slice(window.start as usize..window.end as usize),
        ],
    )
}
