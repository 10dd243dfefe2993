//! Kernels that trace given rays and nothing else: for measuring traversal and for comparing
//! processors hit by hit.

use crate::film::stream::Slot;
use crate::film::tiles::pixel_of_rank;
use crate::integrator::params::PathParams;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, RandomNumbers};
use crate::math::sample_cosine_hemisphere;
use crate::memory::access::at;
use crate::scene::SceneView;
use crate::scene::abilities::Abilities;
use crate::scene::ray::{Hit, OFFSET_ROUNDINGS, Ray, SurfacePoint};

/// Kernel: the ray through the centre of the pixel of slot `lane`.
pub fn primary_rays(lane: u32, params: &PathParams, slots: &[Slot], ray: &mut Ray) {
    let camera = &params.camera;
    let (x, y) = pixel_of_rank(at(slots, lane).rank, camera.width, camera.height);
    *ray = camera.ray(x, y, [0.5, 0.5]);
}

/// Kernel: a cosine-distributed ray from what ray `lane` hit, on the side that it came from. A ray
/// that hit nothing is repeated.
pub fn bounce_rays(
    lane: u32,
    params: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    rays: &[Ray],
    hits: &[Hit],
    bounced: &mut Ray,
) {
    let ray = at(rays, lane);
    let hit = at(hits, lane);
    *bounced = if hit.is_some() {
        let numbers = RandomNumbers::new(params.sampler, params.seed, lane, 0);
        let point = surface_point(scene, &ray, &hit);
        let direction = sample_cosine_hemisphere(point.normal, numbers.pair(BSDF));
        Ray::new(point.offset_towards(direction), direction)
    } else {
        ray
    };
}

/// Kernel: the segment from what ray `lane` hit to a point on a light. A ray that hit nothing is
/// repeated.
pub fn shadow_rays(
    lane: u32,
    params: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    rays: &[Ray],
    hits: &[Hit],
    shadow: &mut Ray,
) {
    let ray = at(rays, lane);
    let hit = at(hits, lane);
    *shadow = if hit.is_some() && !scene.lights.is_empty() {
        let point = surface_point(scene, &ray, &hit);
        let numbers = RandomNumbers::new(params.sampler, params.seed, lane, 0);
        let index = scene.lights.choose(numbers.bits(CHOICES)[0]);
        let end = if scene.lights.is_environment(index) {
            let environment = &scene.lights.environment;
            let direction = environment.sample(numbers.bits(LIGHT_POINT)).direction;
            environment.far_end(point.position, direction)
        } else {
            scene.lights.point_on(index, numbers.pair(LIGHT_POINT)).position
        };
        let from = point.offset_towards(end - point.position);
        Ray::segment(from, end - from, 0.9999)
    } else {
        ray
    };
}

/// Kernel: the nearest hit of ray `lane`.
pub fn closest_hits(
    lane: u32,
    _: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    rays: &[Ray],
    hit: &mut Hit,
) {
    *hit = scene.bvh.closest_hit(&at(rays, lane));
}

/// Kernel: 1 if ray `lane` hits anything, else 0.
pub fn any_hits(
    lane: u32,
    _: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    rays: &[Ray],
    occluded: &mut u32,
) {
    *occluded = scene.bvh.is_occluded(&at(rays, lane)) as u32;
}

/// The point that `ray` hit, its normal on the side that the ray came from.
fn surface_point(scene: &SceneView<'_, impl Abilities>, ray: &Ray, hit: &Hit) -> SurfacePoint {
    let point = scene.surfaces.triangle(hit.triangle).surface_point(hit, OFFSET_ROUNDINGS);
    let behind = ray.direction.dot(point.normal) > 0.0;
    SurfacePoint { normal: if behind { -point.normal } else { point.normal }, ..point }
}
