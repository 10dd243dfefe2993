//! Integrators: how the contributions of a stream's slots are computed.

use super::SceneBuffers;
use crate::exec::{Array, Launch, kernels};
use raystream_shaders::film::Contribution;
use raystream_shaders::path::PathParams;
use raystream_shaders::stream::Slot;

/// The integrator `megakernel`: one thread walks one path to its end.
pub fn megakernel<'a, B>(
    scene: &'a SceneBuffers<B>,
    parameters: &PathParams,
    slots: &'a Array<B, Slot>,
    contributions: &'a Array<B, Contribution>,
) -> Launch<'a, B> {
    let threads = parameters.threads as usize;
    Launch::new(
        &kernels::trace_paths,
        parameters,
        vec![
            slots.slice(0..threads),
            scene.nodes.view(),
            scene.triangles.view(),
            scene.attributes.view(),
            scene.materials.view(),
            scene.lights.view(),
            scene.texels.view(),
            contributions.slice(0..threads),
        ],
    )
}
