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
//!
//! A lens has its point drawn for each vertex, uniform as for camera rays, and where pixels have a
//! filter, one of those that the vertex counts for is drawn.

use super::LvcParams;
use super::cache::LightCache;
use super::light_vertex::LightVertex;
use super::mis::{TechniqueSamples, camera_weight, cosine};
use crate::film::pixel_filter::Chosen;
use crate::film::splats::{FIRST_SPLAT, Splat};
use crate::glam::UVec4;
use crate::integrator::params::PathParams;
use crate::math::is_finite_vector;
use crate::math::random::{self, RandomNumbers, hash};
use crate::memory::access::Scatter;
use crate::scene::SceneView;
use crate::scene::abilities::Abilities;
use crate::scene::camera::{NO_PIXEL, Sight};
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
        let splat = splat(params, &samples, scene, &cache.get(index), index);
        splats.set(FIRST_SPLAT + index, splat.to_row());
        index += params.threads;
    }
}

/// The numbers of the vertex number `index` of a round: of other seeds than those of paths.
fn random_numbers(params: &LvcParams, index: u32) -> RandomNumbers {
    let seed = hash(params.path.seed ^ 0x7370_6c61);
    RandomNumbers::new(params.path.sampler, seed, params.round, index)
}

/// What the camera sees of the vertex number `index`.
fn splat(
    params: &LvcParams,
    samples: &TechniqueSamples,
    scene: &SceneView<'_, impl Abilities>,
    light: &LightVertex,
    index: u32,
) -> Splat {
    let (camera, abilities) = (&params.path.camera, scene.abilities());
    let mut lens = [0.0; 2];
    if camera.has_lens(abilities) {
        lens = random_numbers(params, index).pair(random::LENS);
    }
    let Sight { place, is_ahead, origin, direction, distance2 } =
        camera.sight(abilities, light.position, lens);
    let mut pixel = camera.pixel_at(place);
    let mut share = 1.0;
    if params.path.has_pixel_filter(abilities) {
        let u = random_numbers(params, index).pair(random::PIXEL)[0];
        (pixel, share) = filtered_pixel(&params.path, abilities, place, u);
    }
    let is_seen = is_ahead && pixel != NO_PIXEL;
    if !(is_seen && distance2 > 0.0 && light.pdf(direction) > 0.0) {
        return Splat::NOTHING;
    }
    // The density of the pixel's rays is its importance, too.
    let to_light =
        camera.pdf(abilities, -direction) * cosine(light.geometric, direction) / distance2;
    let weight = camera_weight(samples, to_light, light.norm);
    let from = light.point(&scene.surfaces).offset_towards(direction);
    let segment = Ray::segment(from, origin - from, 1.0);
    let left = scene.surfaces.transmittance(light.media, segment.direction.length());
    let mut radiance = light.flux * left * (to_light * weight);
    if params.path.has_pixel_filter(abilities) {
        radiance *= share;
    }
    // A vertex that all but touches the pinhole may overflow: a set without a measure.
    if radiance.max_element() <= 0.0 || !is_finite_vector(radiance) {
        return Splat::NOTHING;
    }
    if scene.is_blocked(&segment, light.media) {
        return Splat::NOTHING;
    }
    Splat { radiance, pixel }
}

/// One of the pixels whose filters reach a `place` on the film, or [`NO_PIXEL`], and what the splat
/// is multiplied by to stand for all of them. The weights of techniques do not know of it: they
/// need only be the same for all.
fn filtered_pixel(
    params: &PathParams,
    abilities: impl Abilities,
    place: [f32; 2],
    u: f32,
) -> (u32, f32) {
    let (camera, filter) = (&params.camera, params.pixel_filter());
    let (width, height) = (camera.width as f32, camera.height as f32);
    let is_panorama = camera.is_panorama(abilities);
    let (mut place, mut u, mut images) = (place, u, 1.0);
    let is_near_pole = place[1] < filter.radius || place[1] > height - filter.radius;
    if is_panorama && is_near_pole {
        // What is beyond a pole is on the other side of it as well: one of the two is drawn.
        images = 2.0;
        u *= 2.0;
        if u >= 1.0 {
            u -= 1.0;
            let beyond = if 2.0 * place[1] < height { -place[1] } else { 2.0 * height - place[1] };
            place = [place[0] + 0.5 * width, beyond];
        }
    }
    let is_beside = place[0] <= -filter.radius || place[0] >= width + filter.radius;
    let is_above_or_below = place[1] <= -filter.radius || place[1] >= height + filter.radius;
    if is_above_or_below || is_beside && !is_panorama {
        return (NO_PIXEL, 0.0);
    }
    let Chosen { pixel, weight } = filter.choose(place, u);
    let mut column = pixel[0];
    if is_panorama {
        let columns = camera.width as i32;
        if column < 0 {
            column += columns;
        } else if column >= columns {
            column -= columns;
        }
    }
    let centre = [column as f32 + 0.5, pixel[1] as f32 + 0.5];
    let number = camera.pixel_at(centre);
    if weight > 0.0 { (number, images * weight) } else { (NO_PIXEL, 0.0) }
}
