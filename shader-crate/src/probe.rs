//! Kernels that trace given rays and nothing else: for measuring traversal and for comparing
//! processors hit by hit.

use crate::film::stream::Slot;
use crate::film::tiles::pixel_of_rank;
use crate::integrator::params::PathParams;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, RandomNumbers};
use crate::math::sample_cosine_hemisphere;
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::scene::abilities::Abilities;
use crate::scene::bvh::Order;
use crate::scene::ray::{Hit, Ray, SurfacePoint};
use crate::scene::{SceneParams, SceneView, TracingParams};

device_struct! {
    /// The parameters of a trace by brute force. 80 bytes.
    pub struct BruteForceParams {
        /// Rays.
        pub threads: u32,
        /// The first triangle to test, by its number as a [hit](Hit::triangle).
        pub first: u32,
        /// The end of those to test.
        pub end: u32,
        /// Unused; zero.
        pub pad: u32,
        /// The scene.
        pub scene: SceneParams,
    }
}

impl TracingParams for BruteForceParams {
    fn scene(&self) -> SceneParams {
        self.scene
    }
}

/// Kernel: the ray through the centre of the pixel of slot `lane`.
pub fn primary_rays(
    lane: u32,
    params: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    ray: &mut Ray,
) {
    let camera = &params.camera;
    let (x, y) = pixel_of_rank(at(slots, lane).rank, camera.width, camera.height);
    let place = [x as f32 + 0.5, y as f32 + 0.5];
    *ray = camera.ray(scene.abilities(), place, [0.5, 0.5]);
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
    *hit = scene.closest_hit(&at(rays, lane));
}

/// Kernel: the nearest hit of ray `lane` among the triangles before `end`, where `hit` has that
/// among those before `first`: what a hit is by definition. Launches take turns, since some drivers
/// end loops of very many.
pub fn brute_force_hits(
    lane: u32,
    params: &BruteForceParams,
    scene: &SceneView<'_, impl Abilities>,
    rays: &[Ray],
    hit: &mut Hit,
) {
    let ray = at(rays, lane);
    let mut nearest = if params.first == 0 { Hit::miss(ray.t_max) } else { *hit };
    let nothing = Hit::miss(0.0);
    let mut triangle = params.first;
    while triangle < params.end {
        let place = scene.bvh.place(triangle);
        let (planes, ray) = (scene.bvh.planes(place.entry), scene.bvh.ray_at(&place, &ray));
        scene.bvh.test(&planes, &ray, triangle, &nothing, Order::NEAREST, &mut nearest);
        triangle += 1;
    }
    *hit = nearest;
}

/// Kernel: 1 if ray `lane` hits anything, else 0.
pub fn any_hits(
    lane: u32,
    _: &PathParams,
    scene: &SceneView<'_, impl Abilities>,
    rays: &[Ray],
    occluded: &mut u32,
) {
    *occluded = scene.is_occluded(&at(rays, lane)) as u32;
}

/// The point that `ray` hit, its normal on the side that the ray came from.
fn surface_point(scene: &SceneView<'_, impl Abilities>, ray: &Ray, hit: &Hit) -> SurfacePoint {
    let place = scene.bvh.place(hit.triangle);
    let triangle = scene.surfaces.triangle(place.entry);
    let point = scene.surfaces.point(&place, &triangle, ray, hit);
    let behind = ray.direction.dot(point.normal) > 0.0;
    SurfacePoint { normal: if behind { -point.normal } else { point.normal }, ..point }
}
