//! Light tracing: vertices of light paths, connected to the camera (Veach 1997, section 10.3: the
//! techniques with one vertex from the camera's side).
//!
//! A light path lands on any pixel, so light tracing samples the picture as a whole: with `N` light
//! paths a round, the mean of a pixel's splats over all light paths so far has the expectation of
//! what light tracing is to find there, whatever an allocator does. What eye paths find has its own
//! mean, over the pixel's own samples. The two are added; as weights sum to 1 for each path of
//! light, so do their expectations. The number of samples in the weights may therefore be any
//! constant. It is about the light paths that a round has for each sample of a pixel, since the
//! power heuristic does best with numbers that are true.

use super::LvcParams;
use super::cache::LightCache;
use super::light_vertex::LightVertex;
use super::mis::{TechniqueSamples, camera_weight, cosine};
use crate::film::splats::{FIRST_SPLAT, Splat};
use crate::glam::UVec4;
use crate::math::is_finite_vector;
use crate::memory::access::Scatter;
use crate::scene::SceneView;
use crate::scene::abilities::Abilities;
use crate::scene::camera::NO_PIXEL;
use crate::scene::ray::Ray;

/// Kernel: makes a list of `splats` of the `cache`, one of each vertex. The host does not know how
/// many vertices there are, so each lane takes every `threads`-th.
pub fn connect_to_camera(
    lane: u32,
    params: &LvcParams,
    scene: &SceneView<'_, impl Abilities>,
    cache: &[UVec4],
    splats: &mut Scatter<'_, UVec4>,
) {
    let cache = LightCache::new(cache);
    let vertices = cache.len();
    if lane == 0 {
        splats.set(0, UVec4::new(vertices, 0, 0, 0));
    }
    let samples = params.samples();
    let mut index = lane;
    while index < vertices {
        let splat = splat(params, &samples, scene, &cache.get(index));
        splats.set(FIRST_SPLAT + index, splat.to_row());
        index += params.threads;
    }
}

/// What the camera sees of a vertex.
fn splat(
    params: &LvcParams,
    samples: &TechniqueSamples,
    scene: &SceneView<'_, impl Abilities>,
    light: &LightVertex,
) -> Splat {
    let camera = &params.path.camera;
    let pixel = camera.pixel_of(light.position);
    let offset = camera.origin - light.position;
    let distance2 = offset.length_squared();
    let direction = offset.normalize();
    if pixel == NO_PIXEL || !(distance2 > 0.0 && light.pdf(direction) > 0.0) {
        return Splat::NOTHING;
    }
    // The density of the pixel's rays is its importance, too.
    let to_light = camera.pdf(-direction) * cosine(light.geometric, direction) / distance2;
    let weight = camera_weight(samples, to_light, light.norm);
    let radiance = light.flux * (to_light * weight);
    // A vertex that all but touches the pinhole may overflow: a set without a measure.
    if radiance.max_element() <= 0.0 || !is_finite_vector(radiance) {
        return Splat::NOTHING;
    }
    let from = light.point(scene.surfaces.offset_roundings).offset_towards(direction);
    if scene.is_occluded(&Ray::segment(from, camera.origin - from, 1.0)) {
        return Splat::NOTHING;
    }
    Splat { radiance, pixel }
}
