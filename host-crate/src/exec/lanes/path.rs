//! `N` paths under way: [`raystream_shaders::integrator::path`] side by side.

use super::bsdf::Samples;
use super::directions::power_heuristic;
use super::light::SampledLights;
use super::numbers::{Floats, Mask, Words, floats, mask, words};
use super::random::{Sequences, unit_floats};
use super::scene::Scene;
use super::start::{Start, Starts};
use super::surface::{Hits, Surfaces};
use super::vectors::Vectors;
use glam::Vec3;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::DIM;
use raystream_shaders::math::random::{BSDF, CHOICES, DIMENSIONS_PER_VERTEX, LIGHT_POINT};
use raystream_shaders::scene::ray::Ray;

/// A [`Path`](raystream_shaders::integrator::path::Path) in each lane that is at work.
#[repr(C, align(64))]
pub struct Paths<const N: usize> {
    origins: Vectors<N>,
    directions: Vectors<N>,
    throughputs: Vectors<N>,
    radiances: Vectors<N>,
    pdfs: Floats<N>,
    depths: Words<N>,
    rays: Words<N>,
    sequences: Sequences<N>,
    at_work: Mask<N>,
    /// The slots whose paths they are.
    slots: [usize; N],
}

/// Traces the paths of all `slots` to their ends. A lane whose path has ended takes the next slot.
#[inline(always)]
pub fn trace<const N: usize>(
    scene: &Scene<'_>,
    slots: &[Slot],
    contributions: &mut [Contribution],
) {
    let mut starts = Starts::<N>::new(slots);
    let mut paths = Paths::<N>::none();
    while paths.fill(scene, &mut starts, contributions) {
        let hits = paths.meet(scene);
        let (light, goes_on) = paths.shade(scene, &hits);
        paths.gather(scene, &light);
        paths.end(goes_on, contributions);
    }
}

impl<const N: usize> Paths<N> {
    #[inline(always)]
    fn none() -> Self {
        let (zero, none) = (Vectors::splat(Vec3::ZERO), Words::splat(0));
        Self {
            origins: zero,
            directions: zero,
            throughputs: zero,
            radiances: zero,
            pdfs: Floats::splat(0.0),
            depths: none,
            rays: none,
            sequences: Sequences { seeds: none, reversed_indices: none },
            at_work: Mask::NONE,
            slots: [0; N],
        }
    }

    /// Begins paths in lanes that have none; whether any lane has one then.
    #[inline(always)]
    fn fill(
        &mut self,
        scene: &Scene<'_>,
        starts: &mut Starts<'_, N>,
        contributions: &mut [Contribution],
    ) -> bool {
        for lane in 0..N {
            if !self.at_work.holds(lane)
                && let Some(start) = starts.next(scene, contributions)
            {
                self.begin(scene, lane, &start);
            }
        }
        self.at_work.any()
    }

    #[inline(always)]
    fn begin(&mut self, scene: &Scene<'_>, lane: usize, start: &Start) {
        self.origins.set(lane, scene.params.camera.origin);
        self.directions.set(lane, start.direction);
        self.throughputs.set(lane, Vec3::ONE);
        self.radiances.set(lane, Vec3::ZERO);
        (self.pdfs.0[lane], self.depths.0[lane], self.rays.0[lane]) = (0.0, 1, 0);
        let Sequences { seeds, reversed_indices } = &mut self.sequences;
        [seeds.0[lane], reversed_indices.0[lane]] = start.sequence;
        self.at_work.0[lane] = u32::MAX;
        self.slots[lane] = start.slot;
    }

    /// Traces the next segments, one after the other.
    #[inline(always)]
    fn meet(&self, scene: &Scene<'_>) -> Hits<N> {
        let mut hits = Hits::NONE;
        for lane in 0..N {
            if self.at_work.holds(lane) {
                let ray = Ray::new(self.origins.get(lane), self.directions.get(lane));
                hits.set(lane, &scene.view.closest_hit(&ray));
            }
        }
        hits
    }

    /// Adds light that nothing occludes.
    #[inline(always)]
    fn gather(&mut self, scene: &Scene<'_>, light: &SampledLights<N>) {
        let mut arrives = Mask::NONE;
        for lane in 0..N {
            if light.are_some.holds(lane) {
                let (origin, direction) = (light.origins.get(lane), light.directions.get(lane));
                let segment = Ray::segment(origin, direction, 1.0);
                if !scene.view.is_occluded(&segment) {
                    arrives.0[lane] = u32::MAX;
                }
            }
        }
        self.radiances = arrives.choose_vectors(self.radiances + light.radiances, self.radiances);
    }

    /// Writes the contributions of paths that do not go on.
    #[inline(always)]
    fn end(&mut self, goes_on: Mask<N>, contributions: &mut [Contribution]) {
        for lane in 0..N {
            if self.at_work.holds(lane) && !goes_on.holds(lane) {
                contributions[self.slots[lane]] =
                    Contribution { radiance: self.radiances.get(lane), rays: self.rays.0[lane] };
            }
        }
        self.at_work = self.at_work & goes_on;
    }

    /// [`Path::shade`](raystream_shaders::integrator::path::Path::shade), and the lanes whose paths
    /// go on.
    #[inline(always)]
    fn shade(&mut self, scene: &Scene<'_>, hits: &Hits<N>) -> (SampledLights<N>, Mask<N>) {
        self.rays = self.rays.plus(Words::splat(1));
        let leave = self.radiances + self.throughputs * Vectors::splat(scene.view.background);
        self.radiances = hits.are_some.choose_vectors(self.radiances, leave);
        if !hits.are_some.any() {
            return (SampledLights::none(), Mask::NONE);
        }
        let surfaces = Surfaces::at(scene, self.origins, self.directions, hits);
        self.find_lights(scene, hits, &surfaces);
        let params = scene.params;
        let goes_on = hits.are_some & self.depths.below(Words::splat(params.max_depth));
        if !goes_on.any() {
            return (SampledLights::none(), goes_on);
        }
        let [choice, roulette] = self.sequences.bits(self.dimension(CHOICES));
        let light = self.sample_lights(scene, goes_on, &surfaces, choice);
        let u = self.sequences.pair(self.dimension(BSDF));
        let samples = Samples::of(scene, goes_on, &surfaces, self.directions, u, choice);
        self.throughputs = self.throughputs * samples.weights;
        self.pdfs = samples.pdfs;
        let goes_on = goes_on & self.survives(scene, unit_floats(roulette));
        self.origins = surfaces.points.offset_towards(samples.directions);
        self.directions = samples.directions;
        self.depths = self.depths.plus(Words::splat(1));
        (light, goes_on)
    }

    /// [`of_vertex`](raystream_shaders::math::random::of_vertex).
    #[inline(always)]
    fn dimension(&self, dimension: u32) -> Words<N> {
        words(|lane| {
            let vertex = self.depths.0[lane].wrapping_sub(1);
            vertex.wrapping_mul(DIMENSIONS_PER_VERTEX).wrapping_add(dimension)
        })
    }

    /// Gathers what surfaces emit.
    #[inline(always)]
    fn find_lights(&mut self, scene: &Scene<'_>, hits: &Hits<N>, surfaces: &Surfaces<N>) {
        let emission = surfaces.emissions;
        let emits = emission.max_element().above(Floats::splat(0.0));
        let emits = emits & surfaces.from_front & hits.are_some;
        if !emits.any() {
            return;
        }
        let total = scene.view.lights.total_importance;
        let cosine = self.directions.dot(surfaces.points.normals).abs();
        let importance = (emission.x + emission.y + emission.z) * (1.0 / 3.0);
        let area_pdf = importance / total;
        let pdf = area_pdf * hits.t * hits.t / cosine;
        let one = Floats::splat(1.0);
        let weight = self.pdfs.is(0.0).choose(one, power_heuristic(self.pdfs, pdf));
        let found = self.radiances + self.throughputs * emission * weight;
        self.radiances = emits.choose_vectors(found, self.radiances);
    }

    /// Samples lights for lanes that go on from surfaces that are not ideally smooth.
    #[inline(always)]
    fn sample_lights(
        &mut self,
        scene: &Scene<'_>,
        goes_on: Mask<N>,
        surfaces: &Surfaces<N>,
        choice: Words<N>,
    ) -> SampledLights<N> {
        let looks = goes_on & surfaces.are_diffuse();
        if scene.view.lights.is_empty() || !looks.any() {
            return SampledLights::none();
        }
        let points = self.sequences.bits(self.dimension(LIGHT_POINT));
        let mut light = SampledLights::sample(scene, surfaces, self.throughputs, choice, points);
        light.are_some = light.are_some & looks;
        self.rays = self.rays.plus(light.are_some.count());
        light
    }

    /// [`PathParams::survives`](raystream_shaders::integrator::params::PathParams::survives).
    #[inline(always)]
    fn survives(&mut self, scene: &Scene<'_>, random: Floats<N>) -> Mask<N> {
        let params = scene.params;
        let mut survives = Mask([u32::MAX; N]);
        if params.roulette_depth <= params.max_depth {
            let most =
                floats(
                    |lane| {
                        if self.depths.0[lane] >= params.roulette_depth { 0.95 } else { 1.0 }
                    },
                );
            let survival = (self.throughputs.max_element() * (1.0 / DIM)).min(most);
            survives = !mask(|lane| random.0[lane] >= survival.0[lane]);
            self.throughputs = self.throughputs / survival;
        }
        let rest = self.throughputs.max_element();
        survives & !mask(|lane| rest.0[lane] <= 0.0)
    }
}
