//! Paths from the camera, which connect to the light vertex cache.
//!
//! They are those of the path tracer ([`crate::integrator::path`]), with the same random numbers
//! and the same roulette; what differs are the connections at diffuse vertices, and the weights.

use super::cache::LightCache;
use super::light_vertex::LightVertex;
use super::mis::{
    Join, Subpath, TechniqueSamples, connection_weight, cosine, emission_weight,
    environment_weight, lambert, light_weight,
};
use super::{LvcParams, MAX_CONNECTIONS};
use crate::film::Contribution;
use crate::film::stream::{NO_PIXEL, Slot};
use crate::glam::{UVec4, Vec3};
use crate::integrator::nee::NextEvent;
use crate::math::is_finite_vector;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, RandomNumbers, of_vertex, unit_float};
use crate::memory::access::at;
use crate::scene::abilities::Abilities;
use crate::scene::media::Media;
use crate::scene::ray::Ray;
use crate::scene::surface::Surface;
use crate::scene::{Encounter, SceneView};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// First dimension of the draws from the cache, beyond those of the longest path.
const DRAWS: u32 = 1 << 31;

/// Kernel: traces the eye path of slot `lane` to its end.
pub fn trace_eye_paths(
    lane: u32,
    params: &LvcParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    cache: &[UVec4],
    contribution: &mut Contribution,
) {
    let samples = params.samples();
    let tracer = EyeTracer { params, samples, scene: *scene, cache: LightCache::new(cache) };
    let slot = at(slots, lane);
    *contribution = if slot.rank == NO_PIXEL { Contribution::NOTHING } else { tracer.trace(slot) };
}

/// What eye paths are traced with.
#[derive(Clone, Copy)]
struct EyeTracer<'a, A> {
    params: &'a LvcParams,
    samples: TechniqueSamples,
    scene: SceneView<'a, A>,
    cache: LightCache<'a>,
}

/// An eye path under way.
struct EyePath {
    /// The next segment, or the last.
    ray: Ray,
    /// Product of the weights so far.
    throughput: Vec3,
    subpath: Subpath,
    /// Whether the vertex before may be connected with light vertices: the camera and what is
    /// diffuse.
    connects: bool,
    /// What has been gathered.
    radiance: Vec3,
    rays: u32,
    /// What the next segment starts in.
    media: Media,
}

impl<A: Abilities> EyeTracer<'_, A> {
    /// The contribution of one slot.
    fn trace(&self, slot: Slot) -> Contribution {
        let numbers = self.params.path.numbers(slot);
        let (render, abilities) = (&self.params.path, self.scene.abilities());
        let ray = render.camera_ray(abilities, slot, &numbers);
        let mut path = EyePath {
            ray,
            throughput: Vec3::ONE,
            subpath: Subpath::from_camera(render.camera.pdf(abilities, ray.direction)),
            connects: true,
            radiance: Vec3::ZERO,
            rays: 0,
            media: self.scene.surfaces.media_of_camera(),
        };
        let mut depth = 1;
        while self.extend(&mut path, &numbers, depth) {
            depth += 1;
        }
        Contribution { radiance: path.radiance, rays: path.rays }
    }

    /// Traces segment number `depth` (from 1) and picks the next; false where the path ends.
    #[inline(always)]
    fn extend(&self, path: &mut EyePath, numbers: &RandomNumbers, depth: u32) -> bool {
        let render = &self.params.path;
        path.rays += 1;
        let encounter = self.scene.meet(&path.ray, path.media);
        let Encounter { hit, sides } = encounter;
        path.throughput *= self.scene.surfaces.transmittance(sides.here, encounter.length());
        if !hit.is_some() {
            // No other technique finds the background.
            path.radiance += path.throughput * self.scene.background;
            self.add_environment(path, depth);
            return false;
        }
        let surface = Surface::at(&self.scene.surfaces, &path.ray, &hit, sides);
        let incoming = path.ray.direction;
        let arriving = cosine(surface.point.normal, incoming);
        // Parallel rays do not spread.
        let is_parallel = depth == 1 && render.camera.is_orthographic(self.scene.abilities());
        let distance = if is_parallel { 1.0 } else { hit.t };
        path.subpath = path.subpath.arrive(distance, arriving);
        if surface.emits() {
            let light_pdf = self.scene.lights.area_pdf(surface.emission, surface.light);
            let weight = emission_weight(&self.samples, &path.subpath, depth, light_pdf, arriving);
            path.radiance += path.throughput * surface.emission * weight;
        }
        if depth >= render.max_depth {
            return false;
        }
        let vertex = depth - 1;
        let [choice, roulette] = numbers.bits(of_vertex(vertex, CHOICES));
        let is_diffuse = surface.bsdf.is_diffuse();
        let connects = is_diffuse && path.connects;
        let without = if connects { self.samples.without_last_of(depth) } else { 0.0 };
        path.connects = is_diffuse;
        if !surface.bsdf.is_delta() {
            if !self.scene.lights.is_empty() && self.samples.light > 0.0 {
                let point = numbers.bits(of_vertex(vertex, LIGHT_POINT));
                self.sample_light(path, &surface, without, choice, point);
            }
            let is_lit = is_diffuse && surface.bsdf.reflectance.max_element() > 0.0;
            if self.params.connections > 0 && is_lit {
                let back = lambert(cosine(surface.bsdf.normal, incoming));
                let norm = path.subpath.norm(without, back);
                self.connect(path, &surface, norm, numbers, depth);
            }
        }
        let u = numbers.pair(of_vertex(vertex, BSDF));
        let sample = surface.bsdf.sample(incoming, u, unit_float(choice));
        path.throughput *= sample.weight;
        path.subpath = path.subpath.scatter(&surface, incoming, &sample, without);
        if !render.survives(depth, roulette, &mut path.throughput) {
            return false;
        }
        path.ray = Ray::new(surface.point.offset_towards(sample.direction), sample.direction);
        path.media = surface.media_towards(sample.direction);
        true
    }

    /// Adds what comes from the environment at the end of segment number `depth`, which left the
    /// scene.
    fn add_environment(&self, path: &mut EyePath, depth: u32) {
        if self.scene.lights.has_environment() {
            let environment = &self.scene.lights.environment;
            let (pdf, disc_area) = (environment.pdf(path.ray.direction), environment.disc_area());
            let weight = environment_weight(&self.samples, &path.subpath, depth, pdf, disc_area);
            path.radiance += path.throughput * environment.radiance(path.ray.direction) * weight;
        }
    }

    /// Next-event estimation: adds what a sampled point of a light sends to a surface. There are
    /// `without` samples of the technique without the surface.
    fn sample_light(
        &self,
        path: &mut EyePath,
        surface: &Surface<'_, impl Abilities>,
        without: f32,
        choice: u32,
        point: [u32; 2],
    ) {
        let incoming = path.ray.direction;
        // Paths from the lights choose them by power, too.
        let light = self.scene.lights.sample(&surface.point, choice, point);
        let event = NextEvent::new(&self.scene, surface, incoming, light);
        if !event.is_some() {
            return;
        }
        let light = &event.light;
        let cosine_here = cosine(surface.point.normal, light.direction);
        let join = if light.is_distant {
            Join::to_infinity(cosine_here, event.bsdf_pdf, light.disc_area)
        } else {
            let distance2 = light.distance * light.distance;
            let emission_pdf = light.emission_pdf;
            Join::new(distance2, cosine_here, event.bsdf_pdf, light.cosine, emission_pdf)
        };
        let join = if light.is_delta { join.to_delta_light() } else { join };
        let back = surface.bsdf.pdf_back(incoming, light.direction);
        let norm = path.subpath.norm(without, back);
        let weight = light_weight(&self.samples, &join, norm, light.area_pdf);
        let segment = event.segment(surface);
        self.add_unless_blocked(path, &segment, event.media, event.radiance * weight);
    }

    /// Connects a diffuse surface with vertices drawn from the cache. `depth` segments lead here.
    fn connect(
        &self,
        path: &mut EyePath,
        surface: &Surface<'_, impl Abilities>,
        norm: f32,
        numbers: &RandomNumbers,
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
        surface: &Surface<'_, impl Abilities>,
        norm: f32,
        light: &LightVertex,
        scale: f32,
    ) {
        let offset = light.position - surface.point.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let here = surface.bsdf.eval(path.ray.direction, direction);
        let light_pdf = light.pdf(-direction);
        if !(here.pdf > 0.0 && light_pdf > 0.0 && distance2 > 0.0) {
            return;
        }
        let cosine_here = cosine(surface.point.normal, direction);
        let cosine_there = cosine(light.geometric, direction);
        let join = Join::new(distance2, cosine_here, here.pdf, cosine_there, light_pdf);
        let weight = connection_weight(&self.samples, &join, norm, light.norm);
        let media = surface.media_towards(direction);
        let arrives = light.flux * self.scene.surfaces.transmittance(media, distance2.sqrt());
        let reflected = here.weight * arrives * (join.to_light * scale);
        // Both ends leave their surfaces, so that neither occludes itself.
        let from = surface.point.offset_towards(direction);
        let end = light.point(&self.scene.surfaces);
        let to = end.end_towards(-direction, surface.point.position);
        let segment = Ray::segment(from, to - from, 1.0);
        self.add_unless_blocked(path, &segment, media, reflected * weight);
    }

    /// Adds the light that arrives along a segment, which starts in `media`, if nothing is in its
    /// way.
    fn add_unless_blocked(&self, path: &mut EyePath, segment: &Ray, media: Media, reflected: Vec3) {
        let radiance = path.throughput * reflected;
        // Ends that all but touch may overflow: a set without a measure that is left out.
        if radiance.max_element() <= 0.0 || !is_finite_vector(radiance) {
            return;
        }
        path.rays += 1;
        if !self.scene.is_blocked(segment, media) {
            path.radiance += radiance;
        }
    }
}
