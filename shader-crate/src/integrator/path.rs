//! The path tracer: one path from the camera to its end.
//!
//! Kajiya's estimator with next-event estimation: at every diffuse vertex a point on a light is
//! sampled and tested for visibility, and a direction is sampled from the BSDF; where both could
//! have found the same light, the power heuristic weighs them (Veach 1997, chapter 9).

use crate::film::Contribution;
use crate::film::stream::{NO_PIXEL, Slot};
use crate::film::tiles::pixel_of_rank;
use crate::glam::{UVec4, Vec3};
use crate::math::power_heuristic;
use crate::math::random::{BSDF, CHOICES, LIGHT_POINT, PIXEL, SampleStream, of_vertex, unit_float};
use crate::memory::access::at;
use crate::memory::device_struct;
use crate::scene::bsdf::{
    BsdfSample, DIELECTRIC, DIFFUSE, Material, diffuse_pdf, sample_dielectric, sample_diffuse,
    sample_mirror,
};
use crate::scene::camera::Camera;
use crate::scene::light::{Light, LightView, area_pdf};
use crate::scene::ray::{Hit, Ray, SurfacePoint};
use crate::scene::{SceneView, surface::SurfaceView};
use crate::scene::{surface::Surface, triangle::Attributes};

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
        /// [`crate::math::random::SOBOL`] or [`crate::math::random::INDEPENDENT`].
        pub sampler: u32,
        /// Longest path in segments: 1 sees only what emits, 2 direct light as well. At least 1.
        pub max_depth: u32,
        /// First segment count after which roulette may end a path; above `max_depth` for no
        /// roulette.
        pub roulette_depth: u32,
        /// Lights in the light buffer.
        pub lights: u32,
        /// Sum over the lights of area times importance, in squared world units; see [`area_pdf`].
        pub total_importance: f32,
        /// [`BOTH_TECHNIQUES`] unless a test wants one alone.
        pub techniques: u32,
        /// The camera.
        pub camera: Camera,
        /// Radiance of the light that comes from all around where there is no surface, linear
        /// Rec.709. Black in scenes of format 1; the furnace tests light theirs with it.
        pub background: Vec3,
        /// How far rays start from surfaces, see [`crate::scene::ray::OFFSET_ROUNDINGS`].
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
    let scene =
        SceneView::new(nodes, triangles, attributes, materials, texels, params.offset_roundings);
    *contribution =
        trace_slot(params, &scene, &LightView::new(lights, params.lights), at(slots, lane));
}

/// The contribution of one slot.
pub fn trace_slot(
    params: &PathParams,
    scene: &SceneView<'_>,
    lights: &LightView<'_>,
    slot: Slot,
) -> Contribution {
    if slot.rank == NO_PIXEL {
        return Contribution::NOTHING;
    }
    let numbers = numbers_of(params, slot);
    let mut path = Path::begin(params, slot, &numbers);
    while path.extend(params, scene, lights, &numbers) {}
    path.contribution()
}

/// The random numbers of the path of a slot that is not empty.
pub fn numbers_of(params: &PathParams, slot: Slot) -> SampleStream {
    let camera = &params.camera;
    let (x, y) = pixel_of_rank(slot.rank, camera.width, camera.height);
    SampleStream::new(params.sampler, params.seed, y * camera.width + x, slot.sample)
}

/// The first segment of the path of a slot that is not empty.
pub fn camera_ray(params: &PathParams, slot: Slot, numbers: &SampleStream) -> Ray {
    let camera = &params.camera;
    let (x, y) = pixel_of_rank(slot.rank, camera.width, camera.height);
    camera.ray(x, y, numbers.pair(PIXEL))
}

/// What `rays` rays and the light that they found make of a slot.
pub fn contribution(radiance: Vec3, rays: u32) -> Contribution {
    Contribution { radiance, rays, squared: radiance * radiance, pad: 0 }
}

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
}

/// What a path does at the end of a segment.
#[derive(Clone, Copy)]
pub struct Bounce {
    /// Light that arrives there unless something is in its way.
    pub light: SampledLight,
    /// Whether there is a next segment.
    pub goes_on: bool,
}

/// Light from a sampled point, not yet known to be visible. 48 bytes: naga takes a struct with
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
}

impl SampledLight {
    /// No point was sampled, or one that cannot light the surface.
    pub fn none() -> Self {
        Self { segment: Ray::segment(Vec3::ZERO, Vec3::ZERO, 0.0), radiance: Vec3::ZERO, count: 0 }
    }

    /// The segment of this origin and direction, as one that is to be tested.
    pub fn segment(origin: Vec3, direction: Vec3) -> Ray {
        Ray::segment(origin, direction, 1.0)
    }

    /// Whether there is a segment to test.
    pub fn is_some(&self) -> bool {
        self.count == 1
    }
}

impl Path {
    /// The path of a slot that is not empty, at the camera.
    pub fn begin(params: &PathParams, slot: Slot, numbers: &SampleStream) -> Self {
        Self {
            ray: camera_ray(params, slot, numbers),
            depth: 1,
            throughput: Vec3::ONE,
            pdf: 0.0,
            radiance: Vec3::ZERO,
            rays: 0,
        }
    }

    /// Traces the next segment and gathers the light at its end; false where the path ends.
    /// Integrators that split this in two or more kernels make the same calls in the same order.
    #[inline(always)]
    pub fn extend(
        &mut self,
        params: &PathParams,
        scene: &SceneView<'_>,
        lights: &LightView<'_>,
        numbers: &SampleStream,
    ) -> bool {
        let hit = scene.bvh.closest_hit(&self.ray);
        let bounce = self.shade(params, &scene.surfaces, lights, numbers, &hit);
        if bounce.light.is_some() && !scene.bvh.is_occluded(&bounce.light.segment) {
            self.radiance += bounce.light.radiance;
        }
        bounce.goes_on
    }

    /// Gathers what is emitted at the end of the segment, which is `hit`, samples a light there and
    /// picks the next segment. Looks triangles up but traverses nothing: the sampled light is the
    /// caller's to test and to add.
    #[inline(always)]
    pub fn shade(
        &mut self,
        params: &PathParams,
        surfaces: &SurfaceView<'_>,
        lights: &LightView<'_>,
        numbers: &SampleStream,
        hit: &Hit,
    ) -> Bounce {
        self.rays += 1;
        let mut light = SampledLight::none();
        if !hit.is_some() {
            // No light sample aims at the background, so this technique has it alone.
            self.radiance += self.throughput * params.background;
            return Bounce { light, goes_on: false };
        }
        let surface = Surface::at(surfaces, &self.ray, hit);
        if surface.from_front && surface.material.emits() {
            let weight = self.emission_weight(params, &surface, hit.t);
            self.radiance += self.throughput * surface.material.emission * weight;
        }
        if self.depth >= params.max_depth {
            return Bounce { light, goes_on: false };
        }
        let vertex = self.depth - 1;
        let [choice, roulette] = numbers.bits(of_vertex(vertex, CHOICES));
        if surface.material.kind == DIFFUSE
            && params.techniques != BSDF_SAMPLING_ALONE
            && !lights.is_empty()
        {
            let point = numbers.pair(of_vertex(vertex, LIGHT_POINT));
            light = self.sample_light(
                params,
                surfaces.offset_roundings,
                lights,
                &surface,
                choice,
                point,
            );
            self.rays += light.count;
        }
        let sample = sample_bsdf(
            &surface,
            self.ray.direction,
            numbers.pair(of_vertex(vertex, BSDF)),
            unit_float(choice),
        );
        self.throughput *= sample.weight;
        self.pdf = sample.pdf;
        if !goes_on(params, self.depth, roulette, &mut self.throughput) {
            return Bounce { light, goes_on: false };
        }
        self.ray = Ray::new(surface.point.offset_towards(sample.direction), sample.direction);
        self.depth += 1;
        Bounce { light, goes_on: true }
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
        let light_pdf =
            area_pdf(surface.material.emission, params.total_importance) * t * t / cosine;
        power_heuristic(self.pdf, light_pdf)
    }

    /// Next-event estimation at a diffuse surface: what a sampled point of a light sends here.
    fn sample_light(
        &self,
        params: &PathParams,
        offset_roundings: f32,
        lights: &LightView<'_>,
        surface: &Surface,
        choice: u32,
        point: [f32; 2],
    ) -> SampledLight {
        let light = lights.sample(lights.choose(choice), point);
        let offset = light.position - surface.point.position;
        let distance2 = offset.length_squared();
        let direction = offset.normalize();
        let cosine_light = -direction.dot(light.normal);
        let bsdf_pdf = diffuse_pdf(surface.normal, direction);
        if !(cosine_light > 0.0 && bsdf_pdf > 0.0 && distance2 > 0.0) {
            return SampledLight::none();
        }
        let pdf = light.pdf * distance2 / cosine_light;
        let weight = if params.techniques == LIGHT_SAMPLING_ALONE {
            1.0
        } else {
            power_heuristic(pdf, bsdf_pdf)
        };
        // Both ends leave their surfaces, so that neither occludes itself.
        let from = surface.point.offset_towards(direction);
        let to = SurfacePoint {
            position: light.position,
            normal: light.normal,
            magnitude: light.position.abs().max_element().max(surface.point.magnitude),
            offset_roundings,
        }
        .offset_towards(light.normal);
        let reflected = surface.material.reflectance * light.radiance * (bsdf_pdf / pdf);
        SampledLight {
            segment: SampledLight::segment(from, to - from),
            radiance: self.throughput * reflected * weight,
            count: 1,
        }
    }

    /// What the path, which has ended, makes of its slot.
    pub fn contribution(&self) -> Contribution {
        contribution(self.radiance, self.rays)
    }
}

/// Whether a path goes on after segment number `segment`: not if nothing is left of its throughput,
/// and from `roulette_depth` on by chance, decided by 32 `random` bits. One that survives stands
/// for those that do not.
#[inline(always)]
pub fn goes_on(params: &PathParams, segment: u32, random: u32, throughput: &mut Vec3) -> bool {
    if segment >= params.roulette_depth {
        let survival = throughput.max_element().min(0.95);
        if unit_float(random) >= survival {
            return false;
        }
        *throughput /= survival;
    }
    let is_spent = throughput.max_element() <= 0.0;
    !is_spent
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
