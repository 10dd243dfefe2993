//! The path tracer: one path from the camera to its end.
//!
//! Kajiya's estimator with next-event estimation: at every diffuse vertex a point on a light is sampled and tested for visibility, and a
//! direction is sampled from the BSDF; where both could have found the same light, the power heuristic weighs them (Veach
//! 1997, chapter 9).

use crate::bvh::BvhView;
use crate::camera::Camera;
use crate::device_struct;
use crate::film::Contribution;
use crate::glam::{UVec4, Vec3};
use crate::light::{Light, LightView, area_pdf};
use crate::material::{
    BsdfSample, DIELECTRIC, DIFFUSE, Material, diffuse_pdf, sample_dielectric, sample_diffuse, sample_mirror,
};
use crate::math::power_heuristic;
use crate::ray::{Ray, SurfacePoint};
use crate::sampler::{BSDF, CHOICES, LIGHT_POINT, PIXEL, SampleStream, of_vertex, unit_float};
use crate::scene::SceneView;
use crate::stream::{NO_PIXEL, Slot};
use crate::surface::{Attributes, Surface};
use crate::texture::TextureView;
use crate::tiles::pixel_of_rank;

/// [`PathParams::techniques`]: weigh next-event estimation and BSDF sampling by the power heuristic.
pub const BOTH_TECHNIQUES: u32 = 0;
/// [`PathParams::techniques`]: lights are found by next-event estimation alone, where that is possible.
pub const LIGHT_SAMPLING_ALONE: u32 = 1;
/// [`PathParams::techniques`]: lights are found by BSDF sampling alone.
pub const BSDF_SAMPLING_ALONE: u32 = 2;

device_struct! {
    /// What is the same for all paths of a render. 112 bytes.
    pub struct PathParams {
        /// Slots to trace.
        pub threads: u32,
        /// Seed of the render.
        pub seed: u32,
        /// [`crate::sampler::SOBOL`] or [`crate::sampler::INDEPENDENT`].
        pub sampler: u32,
        /// Longest path in segments: 1 sees only what emits, 2 direct light as well. At least 1.
        pub max_depth: u32,
        /// First segment count after which roulette may end a path; above `max_depth` for no roulette.
        pub roulette_depth: u32,
        /// Lights in the light buffer.
        pub lights: u32,
        /// Sum over the lights of area times importance, in squared world units; see [`area_pdf`].
        pub total_importance: f32,
        /// [`BOTH_TECHNIQUES`] unless a test wants one alone.
        pub techniques: u32,
        /// The camera.
        pub camera: Camera,
        /// Radiance of the light that comes from all around where there is no surface, linear Rec.709. Black in scenes of format 1; the
        /// furnace tests light theirs with it.
        pub background: Vec3,
        /// How far rays start from surfaces, see [`crate::ray::OFFSET_ROUNDINGS`].
        pub offset_roundings: f32,
    }
}

/// Kernel: traces the path of slot `lane` to its end.
#[allow(clippy::too_many_arguments)] // one per binding; the body sees views
pub fn trace_paths(
    lane: u32,
    params: &PathParams,
    slots: &[Slot],
    nodes: &[UVec4],
    triangles: &[UVec4],
    attributes: &[Attributes],
    materials: &[Material],
    lights: &[Light],
    texels: &[u32],
    contribution: &mut Contribution,
) {
    let scene = SceneView {
        bvh: BvhView::new(nodes, triangles),
        attributes,
        materials,
        offset_roundings: params.offset_roundings,
        textures: TextureView::new(texels),
    };
    let slot = slots[lane as usize];
    *contribution = if slot.rank == NO_PIXEL {
        Contribution::NOTHING
    } else {
        trace_slot(params, &scene, &LightView::new(lights, params.lights), slot)
    };
}

/// The contribution of one slot.
pub fn trace_slot(params: &PathParams, scene: &SceneView<'_>, lights: &LightView<'_>, slot: Slot) -> Contribution {
    let camera = &params.camera;
    let (x, y) = pixel_of_rank(slot.rank, camera.width, camera.height);
    let numbers = SampleStream::new(params.sampler, params.seed, y * camera.width + x, slot.sample);
    let mut path = Path::new(camera.ray(x, y, numbers.pair(PIXEL)));
    let mut depth = 1;
    while path.extend(params, scene, lights, &numbers, depth) {
        depth += 1;
    }
    path.contribution()
}

/// A path under way.
struct Path {
    /// The next segment.
    ray: Ray,
    /// Product of the weights so far.
    throughput: Vec3,
    /// Density of the last direction per solid angle; 0 where no light sample could have made it.
    pdf: f32,
    /// What has been gathered.
    radiance: Vec3,
    rays: u32,
}

impl Path {
    fn new(ray: Ray) -> Self {
        Self { ray, throughput: Vec3::ONE, pdf: 0.0, radiance: Vec3::ZERO, rays: 0 }
    }

    /// Traces segment number `depth` (from 1) and picks the next; false where the path ends.
    #[inline(always)]
    fn extend(
        &mut self,
        params: &PathParams,
        scene: &SceneView<'_>,
        lights: &LightView<'_>,
        numbers: &SampleStream,
        depth: u32,
    ) -> bool {
        self.rays += 1;
        let hit = scene.bvh.closest_hit(&self.ray);
        if !hit.is_some() {
            // No light sample aims at the background, so this technique has it alone.
            self.radiance += self.throughput * params.background;
            return false;
        }
        let surface = Surface::at(scene, &self.ray, &hit);
        if surface.from_front && surface.material.emits() {
            let weight = self.emission_weight(params, &surface, hit.t);
            self.radiance += self.throughput * surface.material.emission * weight;
        }
        if depth >= params.max_depth {
            return false;
        }
        let vertex = depth - 1;
        let [choice, roulette] = numbers.bits(of_vertex(vertex, CHOICES));
        if surface.material.kind == DIFFUSE && params.techniques != BSDF_SAMPLING_ALONE && !lights.is_empty() {
            let point = numbers.pair(of_vertex(vertex, LIGHT_POINT));
            self.sample_light(params, scene, lights, &surface, choice, point);
        }
        let sample =
            sample_bsdf(&surface, self.ray.direction, numbers.pair(of_vertex(vertex, BSDF)), unit_float(choice));
        self.throughput *= sample.weight;
        self.pdf = sample.pdf;
        if depth >= params.roulette_depth {
            let survival = self.throughput.max_element().min(0.95);
            if unit_float(roulette) >= survival {
                return false;
            }
            self.throughput /= survival;
        }
        if self.throughput.max_element() <= 0.0 {
            return false;
        }
        self.ray = Ray::new(surface.point.offset_towards(sample.direction), sample.direction);
        true
    }

    /// Weight of emission that the last direction ran into, `t` away.
    fn emission_weight(&self, params: &PathParams, surface: &Surface, t: f32) -> f32 {
        if self.pdf == 0.0 || params.techniques == BSDF_SAMPLING_ALONE {
            return 1.0;
        }
        if params.techniques == LIGHT_SAMPLING_ALONE {
            return 0.0;
        }
        let cosine = self.ray.direction.dot(surface.point.normal).abs();
        let light_pdf = area_pdf(surface.material.emission, params.total_importance) * t * t / cosine;
        power_heuristic(self.pdf, light_pdf)
    }

    /// Next-event estimation at a diffuse surface: adds what a sampled point of a light sends here.
    fn sample_light(
        &mut self,
        params: &PathParams,
        scene: &SceneView<'_>,
        lights: &LightView<'_>,
        surface: &Surface,
        choice: u32,
        point: [f32; 2],
    ) {
        let light = lights.sample(lights.choose(choice), point);
        let offset = light.position - surface.point.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let cosine_light = -direction.dot(light.normal);
        let bsdf_pdf = diffuse_pdf(surface.normal, direction);
        if !(cosine_light > 0.0 && bsdf_pdf > 0.0 && distance2 > 0.0) {
            return;
        }
        let pdf = light.pdf * distance2 / cosine_light;
        let weight = if params.techniques == LIGHT_SAMPLING_ALONE { 1.0 } else { power_heuristic(pdf, bsdf_pdf) };
        // Both ends leave their surfaces, so that neither occludes itself.
        let from = surface.point.offset_towards(direction);
        let to = SurfacePoint {
            position: light.position,
            normal: light.normal,
            magnitude: light.position.abs().max_element().max(surface.point.magnitude),
            offset_roundings: scene.offset_roundings,
        }
        .offset_towards(light.normal);
        self.rays += 1;
        if !scene.bvh.is_occluded(&Ray::segment(from, to - from, 1.0)) {
            let reflected = surface.material.reflectance * light.radiance * (bsdf_pdf / pdf);
            self.radiance += self.throughput * reflected * weight;
        }
    }

    fn contribution(&self) -> Contribution {
        Contribution { radiance: self.radiance, rays: self.rays, squared: self.radiance * self.radiance, pad: 0 }
    }
}

/// The direction in which a path goes on, from uniform numbers for the direction and for the lobe.
pub fn sample_bsdf(surface: &Surface, incoming: Vec3, u: [f32; 2], lobe: f32) -> BsdfSample {
    let material = &surface.material;
    if material.kind == DIFFUSE {
        sample_diffuse(material.reflectance, surface.normal, u)
    } else if material.kind == DIELECTRIC {
        sample_dielectric(material, surface.normal, surface.from_outside, incoming, lobe)
    } else {
        sample_mirror(material.reflectance, surface.normal, incoming)
    }
}
