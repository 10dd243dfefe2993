//! Kernels that trace given rays and nothing else: for measuring traversal and for comparing
//! processors hit by hit.

use crate::film::stream::Slot;
use crate::film::tiles::pixel_of_rank;
use crate::glam::UVec4;
use crate::integrator::path::PathParams;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, SampleStream};
use crate::math::sample_cosine_hemisphere;
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::scene::bvh::BvhView;
use crate::scene::light::{Light, LightView};
use crate::scene::ray::{Hit, OFFSET_ROUNDINGS, Ray, SurfacePoint};
use crate::scene::triangle::TriangleView;

device_struct! {
    /// The parameters of a trace of `threads` rays. 16 bytes.
    pub struct ProbeParams {
        /// Rays.
        pub threads: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

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
    rays: &[Ray],
    hits: &[Hit],
    triangles: &[UVec4],
    bounced: &mut Ray,
) {
    let ray = at(rays, lane);
    let hit = at(hits, lane);
    *bounced = if hit.is_some() {
        let numbers = SampleStream::new(params.sampler, params.seed, lane, 0);
        let point = surface_point(triangles, &ray, &hit);
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
    rays: &[Ray],
    hits: &[Hit],
    triangles: &[UVec4],
    lights: &[Light],
    shadow: &mut Ray,
) {
    let ray = at(rays, lane);
    let hit = at(hits, lane);
    *shadow = if hit.is_some() && params.lights > 0 {
        let numbers = SampleStream::new(params.sampler, params.seed, lane, 0);
        let lights = LightView::new(lights, params.lights);
        let light =
            lights.sample(lights.choose(numbers.bits(CHOICES)[0]), numbers.pair(LIGHT_POINT));
        let point = surface_point(triangles, &ray, &hit);
        let from = point.offset_towards(light.position - point.position);
        Ray::segment(from, light.position - from, 0.9999)
    } else {
        ray
    };
}

/// Kernel: the nearest hit of ray `lane`.
pub fn closest_hits(
    lane: u32,
    _: &ProbeParams,
    rays: &[Ray],
    nodes: &[UVec4],
    triangles: &[UVec4],
    hit: &mut Hit,
) {
    *hit = BvhView::new(nodes, triangles).closest_hit(&at(rays, lane));
}

/// Kernel: 1 if ray `lane` hits anything, else 0.
pub fn any_hits(
    lane: u32,
    _: &ProbeParams,
    rays: &[Ray],
    nodes: &[UVec4],
    triangles: &[UVec4],
    occluded: &mut u32,
) {
    *occluded = BvhView::new(nodes, triangles).is_occluded(&at(rays, lane)) as u32;
}

/// The point that `ray` hit, its normal on the side that the ray came from.
fn surface_point(triangles: &[UVec4], ray: &Ray, hit: &Hit) -> SurfacePoint {
    let point = TriangleView::new(triangles).get(hit.triangle).surface_point(hit, OFFSET_ROUNDINGS);
    let behind = ray.direction.dot(point.normal) > 0.0;
    SurfacePoint { normal: if behind { -point.normal } else { point.normal }, ..point }
}
