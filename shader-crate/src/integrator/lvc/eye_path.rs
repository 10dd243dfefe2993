//! Paths from the camera, which connect to the light vertex cache.
//!
//! They are those of the path tracer ([`crate::integrator::path`]), with the same random numbers
//! and the same roulette; what differs are the connections at diffuse vertices, and the weights.

use super::cache::LightCache;
use super::light_vertex::LightVertex;
use super::mis::{
    Join, Subpath, TechniqueSamples, connection_weight, cosine, emission_weight, lambert,
    light_weight,
};
use super::{LvcParams, MAX_CONNECTIONS};
use crate::film::Contribution;
use crate::film::stream::{NO_PIXEL, Slot};
use crate::glam::{UVec4, Vec3};
use crate::integrator::path::{camera_ray, contribution, goes_on, numbers_of, sample_bsdf};
use crate::math::is_finite_vector;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, SampleStream, of_vertex, unit_float};
use crate::memory::access::at;
use crate::scene::SceneView;
use crate::scene::bsdf::{DIFFUSE, Material, diffuse_pdf};
use crate::scene::light::{Light, LightView, area_pdf};
use crate::scene::ray::{Ray, SurfacePoint};
use crate::scene::{surface::Surface, triangle::Attributes};

/// First dimension of the draws from the cache, beyond those of the longest path.
const DRAWS: u32 = 1 << 31;

/// Kernel: traces the eye path of slot `lane` to its end.
#[allow(clippy::too_many_arguments)] // one per binding; the body sees views
pub fn trace_eye_paths(
    lane: u32,
    params: &LvcParams,
    slots: &[Slot],
    nodes: &[UVec4],
    triangles: &[UVec4],
    attributes: &[Attributes],
    materials: &[Material],
    lights: &[Light],
    texels: &[u32],
    cache: &[UVec4],
    contribution: &mut Contribution,
) {
    let tracer = EyeTracer {
        params,
        samples: params.samples(),
        scene: SceneView::new(
            nodes,
            triangles,
            attributes,
            materials,
            texels,
            params.path.offset_roundings,
        ),
        lights: LightView::new(lights, params.path.lights),
        cache: LightCache::new(cache),
    };
    let slot = at(slots, lane);
    *contribution = if slot.rank == NO_PIXEL { Contribution::NOTHING } else { tracer.trace(slot) };
}

/// What eye paths are traced with.
#[derive(Clone, Copy)]
struct EyeTracer<'a> {
    params: &'a LvcParams,
    samples: TechniqueSamples,
    scene: SceneView<'a>,
    lights: LightView<'a>,
    cache: LightCache<'a>,
}

/// An eye path under way.
struct EyePath {
    /// The next segment, or the last.
    ray: Ray,
    /// Product of the weights so far.
    throughput: Vec3,
    subpath: Subpath,
    /// What has been gathered.
    radiance: Vec3,
    rays: u32,
}

impl EyeTracer<'_> {
    /// The contribution of one slot.
    fn trace(&self, slot: Slot) -> Contribution {
        let numbers = numbers_of(&self.params.path, slot);
        let mut path = EyePath {
            ray: camera_ray(&self.params.path, slot, &numbers),
            throughput: Vec3::ONE,
            subpath: Subpath::FROM_CAMERA,
            radiance: Vec3::ZERO,
            rays: 0,
        };
        let mut depth = 1;
        while self.extend(&mut path, &numbers, depth) {
            depth += 1;
        }
        contribution(path.radiance, path.rays)
    }

    /// Traces segment number `depth` (from 1) and picks the next; false where the path ends.
    #[inline(always)]
    fn extend(&self, path: &mut EyePath, numbers: &SampleStream, depth: u32) -> bool {
        let render = &self.params.path;
        path.rays += 1;
        let hit = self.scene.bvh.closest_hit(&path.ray);
        if !hit.is_some() {
            // No other technique finds the background.
            path.radiance += path.throughput * render.background;
            return false;
        }
        let surface = Surface::at(&self.scene.surfaces, &path.ray, &hit);
        let incoming = path.ray.direction;
        let arriving = cosine(surface.point.normal, incoming);
        path.subpath = path.subpath.arrive(hit.t, arriving);
        if surface.from_front && surface.material.emits() {
            let light_pdf = area_pdf(surface.material.emission, render.total_importance);
            let weight = emission_weight(&self.samples, &path.subpath, light_pdf, arriving);
            path.radiance += path.throughput * surface.material.emission * weight;
        }
        if depth >= render.max_depth {
            return false;
        }
        let vertex = depth - 1;
        let [choice, roulette] = numbers.bits(of_vertex(vertex, CHOICES));
        if surface.material.kind == DIFFUSE {
            let back = lambert(cosine(surface.normal, incoming));
            let norm = path.subpath.norm(self.samples.connection, back);
            if !self.lights.is_empty() && self.samples.light > 0.0 {
                self.sample_light(
                    path,
                    &surface,
                    norm,
                    choice,
                    numbers.pair(of_vertex(vertex, LIGHT_POINT)),
                );
            }
            if self.params.connections > 0 && surface.material.reflectance.max_element() > 0.0 {
                self.connect(path, &surface, norm, numbers, depth);
            }
        }
        let sample = sample_bsdf(
            &surface,
            incoming,
            numbers.pair(of_vertex(vertex, BSDF)),
            unit_float(choice),
        );
        path.throughput *= sample.weight;
        path.subpath = path.subpath.scatter(&surface, incoming, &sample, self.samples.connection);
        if !goes_on(render, depth, roulette, &mut path.throughput) {
            return false;
        }
        path.ray = Ray::new(surface.point.offset_towards(sample.direction), sample.direction);
        true
    }

    /// Next-event estimation at a diffuse surface: adds what a sampled point of a light sends here.
    fn sample_light(
        &self,
        path: &mut EyePath,
        surface: &Surface,
        norm: f32,
        choice: u32,
        point: [f32; 2],
    ) {
        let light = self.lights.sample(self.lights.choose(choice), point);
        let offset = light.position - surface.point.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let cosine_light = -direction.dot(light.normal);
        let bsdf_pdf = diffuse_pdf(surface.normal, direction);
        if !(cosine_light > 0.0 && bsdf_pdf > 0.0 && distance2 > 0.0) {
            return;
        }
        let cosine_here = cosine(surface.point.normal, direction);
        let join = Join::new(distance2, cosine_here, bsdf_pdf, cosine_light, lambert(cosine_light));
        let weight = light_weight(&self.samples, &join, norm, light.pdf);
        let reflected = surface.material.reflectance * light.radiance * (join.to_light / light.pdf);
        // The light's rounding errors are those of what is near it, at least.
        let end = light.point(self.scene.surfaces.offset_roundings);
        let end = SurfacePoint { magnitude: end.magnitude.max(surface.point.magnitude), ..end };
        self.add_unless_occluded(
            path,
            surface,
            direction,
            end.offset_towards(light.normal),
            reflected * weight,
        );
    }

    /// Connects a diffuse surface with vertices drawn from the cache. `depth` segments lead here.
    fn connect(
        &self,
        path: &mut EyePath,
        surface: &Surface,
        norm: f32,
        numbers: &SampleStream,
        depth: u32,
    ) {
        let vertices = self.cache.len();
        if vertices == 0 {
            return;
        }
        let scale = self.params.connection_scale * vertices as f32;
        let mut drawn = 0;
        while drawn < self.params.connections {
            let pair = numbers.bits(DRAWS + (depth * MAX_CONNECTIONS + drawn) / 2);
            let bits = if drawn & 1 == 0 { pair[0] } else { pair[1] };
            let light = self.cache.draw(bits);
            if depth + 1 + light.segments <= self.params.path.max_depth {
                self.connect_to(path, surface, norm, &light, scale);
            }
            drawn += 1;
        }
    }

    /// Adds what a light vertex sends to a diffuse surface, `scale` times.
    fn connect_to(
        &self,
        path: &mut EyePath,
        surface: &Surface,
        norm: f32,
        light: &LightVertex,
        scale: f32,
    ) {
        let offset = light.position - surface.point.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let eye_pdf = diffuse_pdf(surface.normal, direction);
        let light_pdf = diffuse_pdf(light.normal, -direction);
        if !(eye_pdf > 0.0 && light_pdf > 0.0 && distance2 > 0.0) {
            return;
        }
        let cosine_here = cosine(surface.point.normal, direction);
        let cosine_there = cosine(light.geometric, direction);
        let join = Join::new(distance2, cosine_here, eye_pdf, cosine_there, light_pdf);
        let weight = connection_weight(&self.samples, &join, norm, light.norm);
        let reflected = surface.material.reflectance * light.flux * (join.to_light * scale);
        let end = light.point(self.scene.surfaces.offset_roundings).offset_towards(-direction);
        self.add_unless_occluded(path, surface, direction, end, reflected * weight);
    }

    /// Adds what arrives from `end`, which lies in `direction` from a surface, if nothing is
    /// between.
    fn add_unless_occluded(
        &self,
        path: &mut EyePath,
        surface: &Surface,
        direction: Vec3,
        end: Vec3,
        reflected: Vec3,
    ) {
        let radiance = path.throughput * reflected;
        // Ends that all but touch may overflow: a set without a measure that is left out.
        if radiance.max_element() <= 0.0 || !is_finite_vector(radiance) {
            return;
        }
        // Both ends leave their surfaces, so that neither occludes itself.
        let start = surface.point.offset_towards(direction);
        path.rays += 1;
        if !self.scene.bvh.is_occluded(&Ray::segment(start, end - start, 1.0)) {
            path.radiance += radiance;
        }
    }
}
