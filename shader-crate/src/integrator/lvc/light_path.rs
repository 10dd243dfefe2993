//! Paths from the lights, whose vertices go to the cache.
//!
//! A light path is traced as the path tracer traces from the camera, roulette and all, but it
//! carries flux, not importance: what crosses a boundary is not scaled by the indices of
//! refraction, and where shading normals bend the cosine, the adjoint BSDF puts it right (Veach
//! 1997, sections 5.2 and 5.3).

use super::LvcParams;
use super::light_vertex::{LightVertex, ROWS_PER_VERTEX};
use super::mis::{Subpath, TechniqueSamples, cosine, lambert};
use crate::glam::{UVec4, Vec3};
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, RandomNumbers, hash, of_vertex, unit_float};
use crate::math::sample_cosine_hemisphere;
use crate::memory::access::Scatter;
use crate::scene::abilities::{Abilities, PUNCTUAL};
use crate::scene::bsdf::BsdfSample;
use crate::scene::environment::{EnvironmentSample, EnvironmentView};
use crate::scene::light::Light;
use crate::scene::light::punctual::LightRay;
use crate::scene::media::Media;
use crate::scene::ray::Ray;
use crate::scene::surface::Surface;
use crate::scene::{Encounter, SceneView};
use core::f32::consts::{FRAC_1_PI, PI};

/// Kernel: traces light path `lane`, writes its vertices to its part of `scratch` and their number
/// to `count`.
///
/// They are counted in memory: Mesa 22.3 gives lanes that leave the loop early what a variable has
/// in later turns.
pub fn trace_light_paths(
    lane: u32,
    params: &LvcParams,
    scene: &SceneView<'_, impl Abilities>,
    count: &mut u32,
    scratch: &mut Scatter<'_, UVec4>,
) {
    let samples = params.samples();
    let numbers = random_numbers(params, lane);
    let mut path = LightPath::emit(&samples, scene, &numbers);
    let mut segment = 1;
    *count = 0;
    while segment <= params.light_segments {
        let Encounter { hit, sides } = scene.meet(&path.ray, path.media);
        if !hit.is_some() {
            break;
        }
        let surface = Surface::at(&scene.surfaces, &path.ray, &hit, sides);
        path.throughput *= scene.surfaces.transmittance(sides.here, hit.t);
        path.arrive(&surface, hit.t);
        let is_diffuse = surface.bsdf.is_diffuse();
        // A glossy surface may be connected with the light itself alone.
        let connects = segment == 1 || is_diffuse && path.connects;
        let without = if connects { samples.of(segment) } else { 0.0 };
        path.connects = is_diffuse;
        if is_diffuse && surface.bsdf.reflectance.max_element() > 0.0 {
            if params.vertices_per_path > 0 {
                let place = lane * params.vertices_per_path + *count;
                path.vertex(without, &surface, segment).store(scratch, place * ROWS_PER_VERTEX);
            }
            *count += 1;
        }
        if !path.extend(params, without, &surface, &numbers, segment) {
            break;
        }
        segment += 1;
    }
}

/// The numbers of a light path: of other seeds than those of eye paths, a sequence for each round.
fn random_numbers(params: &LvcParams, path: u32) -> RandomNumbers {
    RandomNumbers::new(
        params.path.sampler,
        hash(params.path.seed ^ 0x6c76_6331),
        params.round,
        path,
    )
}

/// A light path under way. Its vertex number 0 is on the light.
struct LightPath {
    /// The next segment, or the last.
    ray: Ray,
    /// What it started with, linear Rec.709.
    flux: Vec3,
    /// Product of the weights so far.
    throughput: Vec3,
    subpath: Subpath,
    /// Whether the vertex before may be connected with what eye paths meet: those on a light and
    /// on what is diffuse.
    connects: bool,
    /// Whether the segment is the first of a path from a light at infinity.
    is_from_infinity: bool,
    /// What the next segment starts in.
    media: Media,
}

impl LightPath {
    fn emit(
        samples: &TechniqueSamples,
        scene: &SceneView<'_, impl Abilities>,
        numbers: &RandomNumbers,
    ) -> Self {
        let [choice, _] = numbers.bits(of_vertex(0, CHOICES));
        let lights = &scene.lights;
        let index = lights.choose(choice);
        if lights.is_environment(index) {
            return Self::from_environment(samples, &lights.environment, numbers);
        }
        let media = scene.surfaces.media_of_light(index);
        if lights.abilities.has(PUNCTUAL) {
            let light = lights.light(index);
            if lights.is_punctual(&light) {
                return Self::from_punctual(&light, media, numbers);
            }
        }
        let light = lights.point_on(index, numbers.pair(of_vertex(0, LIGHT_POINT)));
        let direction = sample_cosine_hemisphere(light.normal, numbers.pair(of_vertex(0, BSDF)));
        let point = light.point(lights.offset_roundings);
        Self {
            ray: Ray::new(point.offset_towards(light.normal), direction),
            // Radiance times cosine over both densities.
            flux: light.radiance * (PI / light.pdf),
            throughput: Vec3::ONE,
            subpath: Subpath::from_light(light.pdf)
                .emit(cosine(light.normal, direction), samples.emission),
            connects: true,
            is_from_infinity: false,
            media,
        }
    }

    fn from_punctual(light: &Light, media: Media, numbers: &RandomNumbers) -> Self {
        let (to, place) =
            (numbers.pair(of_vertex(0, LIGHT_POINT)), numbers.pair(of_vertex(0, BSDF)));
        let LightRay { ray, flux, is_distant, extent } = light.emit(to, place);
        Self {
            ray,
            flux,
            throughput: Vec3::ONE,
            subpath: Subpath::from_delta_light(extent),
            connects: true,
            is_from_infinity: is_distant,
            media,
        }
    }

    /// From infinity, through the disc that the scene is seen as from there.
    fn from_environment(
        samples: &TechniqueSamples,
        environment: &EnvironmentView<'_>,
        numbers: &RandomNumbers,
    ) -> Self {
        let EnvironmentSample { direction, pdf } =
            environment.sample(numbers.bits(of_vertex(0, LIGHT_POINT)));
        let start = environment.disc_point(direction, numbers.pair(of_vertex(0, BSDF)));
        let disc_area = environment.disc_area();
        Self {
            ray: Ray::new(start, -direction),
            // Radiance over both densities.
            flux: environment.radiance(direction) * (disc_area / pdf),
            throughput: Vec3::ONE,
            subpath: Subpath::from_environment(pdf, disc_area, samples.emission),
            connects: true,
            is_from_infinity: true,
            media: Media::NONE,
        }
    }

    fn arrive(&mut self, surface: &Surface<'_, impl Abilities>, distance: f32) {
        let distance = if self.is_from_infinity { 1.0 } else { distance };
        self.is_from_infinity = false;
        self.subpath =
            self.subpath.arrive(distance, cosine(surface.point.normal, self.ray.direction));
    }

    /// The vertex at a diffuse surface, after this many segments. There are `without` samples of
    /// the technique without it.
    fn vertex(
        &self,
        without: f32,
        surface: &Surface<'_, impl Abilities>,
        segments: u32,
    ) -> LightVertex {
        let from = cosine(surface.bsdf.normal, self.ray.direction);
        let bent = from / cosine(surface.point.normal, self.ray.direction);
        LightVertex {
            position: surface.point.position,
            media: surface.sides.here,
            geometric: surface.point.normal,
            norm: self.subpath.norm(without, lambert(from)),
            normal: surface.bsdf.normal,
            segments,
            flux: self.flux * self.throughput * surface.bsdf.reflectance * (bent * FRAC_1_PI),
            instance: surface.instance,
        }
    }

    /// Picks the segment after number `segment`; false where the path ends. There are `without`
    /// samples of the technique without the surface.
    fn extend(
        &mut self,
        params: &LvcParams,
        without: f32,
        surface: &Surface<'_, impl Abilities>,
        numbers: &RandomNumbers,
        segment: u32,
    ) -> bool {
        let [choice, roulette] = numbers.bits(of_vertex(segment, CHOICES));
        let incoming = self.ray.direction;
        let u = numbers.pair(of_vertex(segment, BSDF));
        let sample = surface.bsdf.sample(incoming, u, unit_float(choice));
        self.throughput *= adjoint_weight(surface, incoming, &sample);
        self.subpath = self.subpath.scatter(surface, incoming, &sample, without);
        if !params.path.survives(segment, roulette, &mut self.throughput) {
            return false;
        }
        self.ray = Ray::new(surface.point.offset_towards(sample.direction), sample.direction);
        self.media = surface.media_towards(sample.direction);
        true
    }
}

/// The weight of a direction by the adjoint BSDF (Veach 1997, equation 5.19): what a light path's
/// throughput is multiplied by where it arrived along `incoming`.
pub fn adjoint_weight(
    surface: &Surface<'_, impl Abilities>,
    incoming: Vec3,
    sample: &BsdfSample,
) -> Vec3 {
    let weight = surface.bsdf.weight_of_flux(incoming, sample);
    let (normal, geometric) = (surface.bsdf.normal, surface.point.normal);
    let shading = cosine(normal, incoming) / cosine(normal, sample.direction);
    let bent = cosine(geometric, sample.direction) / cosine(geometric, incoming);
    weight * (shading * bent)
}
