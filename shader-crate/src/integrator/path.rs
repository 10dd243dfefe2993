//! The path tracer: one path from the camera to its end.
//!
//! Kajiya's estimator with next-event estimation: at every vertex whose BSDF is not all delta
//! distributions a point on a light is sampled and tested for visibility, and a direction is
//! sampled from the BSDF; where both could have found the same light, the power heuristic weighs
//! them (Veach 1997, chapter 9).

use crate::film::Contribution;
use crate::film::stream::Slot;
use crate::glam::Vec3;
use crate::integrator::nee::NextEvent;
use crate::integrator::params::{BSDF_SAMPLING_ALONE, LIGHT_SAMPLING_ALONE, PathParams};
use crate::math::power_heuristic;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, RandomNumbers, of_vertex, unit_float};
use crate::scene::abilities::Abilities;
use crate::scene::light::tree::Vantage;
use crate::scene::media::Media;
use crate::scene::ray::Ray;
use crate::scene::surface::Surface;
use crate::scene::{Encounter, SceneView};

/// A path under way.
#[derive(Clone, Copy)]
pub struct Path {
    /// The next segment.
    pub ray: Ray,
    /// Its number, from 1 on.
    pub depth: u32,
    /// Product of the weights so far.
    pub throughput: Vec3,
    /// Density of the last direction per solid angle; 0 where no light sample could have made it.
    pub pdf: f32,
    /// What has been gathered.
    pub radiance: Vec3,
    /// Rays traced, shadow rays included.
    pub rays: u32,
    /// What the next segment starts in.
    pub media: Media,
    /// Where a tree chooses lights: [`Vantage::facing`] of where the next segment starts.
    pub facing: u32,
}

/// What a path does at the end of a segment.
#[derive(Clone, Copy)]
pub struct Bounce {
    /// Light that arrives there unless something is in its way.
    pub light: SampledLight,
    /// Whether there is a next segment.
    pub goes_on: bool,
}

/// Light from a sampled point, not yet known to be visible. 64 bytes: naga takes a struct with
/// vectors for a multiple of 16 bytes long, also inside another.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct SampledLight {
    /// From the surface to the point.
    pub segment: Ray,
    /// What it adds to the path's radiance if nothing occludes the segment.
    pub radiance: Vec3,
    /// 1 if there is any, else 0.
    count: u32,
    /// What the segment starts in.
    pub media: Media,
    /// Unused; zero.
    pad: [u32; 3],
}

impl SampledLight {
    /// No point was sampled, or one that cannot light the surface.
    pub fn none() -> Self {
        let segment = Ray::segment(Vec3::ZERO, Vec3::ZERO, 0.0);
        Self { segment, radiance: Vec3::ZERO, count: 0, media: Media::NONE, pad: [0; 3] }
    }

    /// Whether there is a segment to test.
    pub fn is_some(&self) -> bool {
        self.count == 1
    }
}

impl Path {
    /// The path of a slot that is not empty, at the camera.
    pub fn begin(
        params: &PathParams,
        scene: &SceneView<'_, impl Abilities>,
        slot: Slot,
        numbers: &RandomNumbers,
    ) -> Self {
        Self {
            ray: params.camera_ray(scene.abilities(), slot, numbers),
            depth: 1,
            throughput: Vec3::ONE,
            pdf: 0.0,
            radiance: Vec3::ZERO,
            rays: 0,
            media: scene.surfaces.media_of_camera(),
            facing: Vantage::NONE.facing,
        }
    }

    /// Traces the next segment and gathers the light at its end; false where the path ends.
    /// Integrators that split this in two or more kernels make the same calls in the same order.
    #[inline(always)]
    pub fn extend(
        &mut self,
        params: &PathParams,
        scene: &SceneView<'_, impl Abilities>,
        numbers: &RandomNumbers,
    ) -> bool {
        let encounter = scene.meet(&self.ray, self.media);
        let bounce = self.shade(params, scene, numbers, &encounter);
        let light = &bounce.light;
        if light.is_some() && !scene.is_blocked(&light.segment, light.media) {
            self.radiance += bounce.light.radiance;
        }
        bounce.goes_on
    }

    /// Gathers what is emitted at the end of the segment, which is known, samples a light there and
    /// picks the next segment. Looks triangles up but traverses nothing: the sampled light is the
    /// caller's to test and to add.
    #[inline(always)]
    pub fn shade(
        &mut self,
        params: &PathParams,
        scene: &SceneView<'_, impl Abilities>,
        numbers: &RandomNumbers,
        encounter: &Encounter,
    ) -> Bounce {
        self.rays += 1;
        let mut light = SampledLight::none();
        let Encounter { hit, sides } = *encounter;
        self.throughput *= scene.surfaces.transmittance(sides.here, encounter.length());
        if !hit.is_some() {
            // No light sample aims at the background, so this technique has it alone.
            self.radiance += self.throughput * scene.background;
            if scene.lights.has_environment() {
                let environment = &scene.lights.environment;
                let weight = self.found_weight(params, environment.pdf(self.ray.direction));
                let radiance = environment.radiance(self.ray.direction);
                self.radiance += self.throughput * radiance * weight;
            }
            return Bounce { light, goes_on: false };
        }
        let surface = Surface::at(&scene.surfaces, &self.ray, &hit, sides);
        if surface.emits() {
            let cosine = self.ray.direction.dot(surface.point.normal).abs();
            let area_pdf = self.area_pdf(scene, &surface);
            let weight = self.found_weight(params, area_pdf * hit.t * hit.t / cosine);
            self.radiance += self.throughput * surface.emission * weight;
        }
        if self.depth >= params.max_depth {
            return Bounce { light, goes_on: false };
        }
        let vertex = self.depth - 1;
        let [choice, roulette] = numbers.bits(of_vertex(vertex, CHOICES));
        if !surface.bsdf.is_delta()
            && params.techniques != BSDF_SAMPLING_ALONE
            && !scene.lights.is_empty()
        {
            let point = numbers.bits(of_vertex(vertex, LIGHT_POINT));
            light = self.sample_light(params, scene, &surface, choice, point);
            self.rays += light.count;
        }
        let u = numbers.pair(of_vertex(vertex, BSDF));
        let sample = surface.bsdf.sample(self.ray.direction, u, unit_float(choice));
        self.throughput *= sample.weight;
        self.pdf = sample.pdf;
        if !params.survives(self.depth, roulette, &mut self.throughput) {
            return Bounce { light, goes_on: false };
        }
        self.ray = Ray::new(surface.point.offset_towards(sample.direction), sample.direction);
        self.media = surface.media_towards(sample.direction);
        self.depth += 1;
        Bounce { light, goes_on: true }
    }

    /// The density per area with which light sampling would have picked a point on a `surface` that
    /// emits from where the segment starts.
    #[inline(always)]
    fn area_pdf(
        &self,
        scene: &SceneView<'_, impl Abilities>,
        surface: &Surface<'_, impl Abilities>,
    ) -> f32 {
        if scene.lights.has_tree() {
            // The segment starts a little off the surface. That changes the chance by no more than
            // it changes the distance.
            let vantage = Vantage { position: self.ray.origin, facing: self.facing };
            scene.lights.area_pdf_by_tree(&vantage, surface.light)
        } else {
            scene.lights.area_pdf(surface.emission, surface.light)
        }
    }

    /// Weight of light that the last direction ran into, and that light sampling would have found
    /// with the density `light_pdf` per solid angle.
    #[inline(always)]
    fn found_weight(&self, params: &PathParams, light_pdf: f32) -> f32 {
        if self.pdf == 0.0 || params.techniques == BSDF_SAMPLING_ALONE {
            return 1.0;
        }
        if params.techniques == LIGHT_SAMPLING_ALONE {
            return 0.0;
        }
        power_heuristic(self.pdf, light_pdf)
    }

    /// Next-event estimation: what a sampled point of a light adds to the path here.
    fn sample_light(
        &mut self,
        params: &PathParams,
        scene: &SceneView<'_, impl Abilities>,
        surface: &Surface<'_, impl Abilities>,
        choice: u32,
        point: [u32; 2],
    ) -> SampledLight {
        let lights = &scene.lights;
        let light = if lights.has_tree() {
            let vantage = surface.vantage();
            self.facing = vantage.facing;
            lights.sample_by_tree(&surface.point, &vantage, choice, point)
        } else {
            lights.sample(&surface.point, choice, point)
        };
        let event = NextEvent::new(scene, surface, self.ray.direction, light);
        if !event.is_some() {
            return SampledLight::none();
        }
        let is_alone = event.light.is_delta || params.techniques == LIGHT_SAMPLING_ALONE;
        let weight = if is_alone { 1.0 } else { power_heuristic(event.light.pdf, event.bsdf_pdf) };
        SampledLight {
            segment: event.segment(surface),
            radiance: self.throughput * event.radiance * weight,
            count: 1,
            media: event.media,
            pad: [0; 3],
        }
    }

    /// What the path, which has ended, makes of its slot.
    pub fn contribution(&self) -> Contribution {
        Contribution { radiance: self.radiance, rays: self.rays }
    }
}
