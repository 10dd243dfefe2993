//! What is the same for all paths of a render, and how a path begins.

use crate::film::pixel_filter::{PIXEL, PixelFilter};
use crate::film::stream::Slot;
use crate::film::tiles::pixel_of_rank;
use crate::glam::Vec3;
use crate::math::random::{self, LENS, RandomNumbers, unit_float};
use crate::memory::device_struct;
use crate::scene::abilities::{Abilities, PIXEL_FILTERS};
use crate::scene::camera::Camera;
use crate::scene::ray::Ray;
use crate::scene::{SceneParams, TracingParams};

/// [`PathParams::techniques`]: weigh next-event estimation and BSDF sampling by the power
/// heuristic.
pub const BOTH_TECHNIQUES: u32 = 0;
/// [`PathParams::techniques`]: lights are found by next-event estimation alone, where that is
/// possible.
pub const LIGHT_SAMPLING_ALONE: u32 = 1;
/// [`PathParams::techniques`]: lights are found by BSDF sampling alone.
pub const BSDF_SAMPLING_ALONE: u32 = 2;

/// Throughput below which roulette may end a path after any segment, in its largest component.
/// Below it the chance to survive is in proportion, so that survivors have it again. It is what
/// measured best over scenes with bright and with dark walls: at 1, whatever is not white ends
/// early, and noise grows by more than time falls; at 0, dim paths cost as much as bright ones.
pub const DIM: f32 = 0.25;

device_struct! {
    /// What is the same for all paths of a render. 160 bytes.
    pub struct PathParams {
        /// Slots to trace.
        pub threads: u32,
        /// Seed of the render.
        pub seed: u32,
        /// [`crate::math::random::SOBOL`] or [`crate::math::random::INDEPENDENT`].
        pub sampler: u32,
        /// Longest path in segments: 1 sees only what emits, 2 direct light as well. At least 1.
        pub max_depth: u32,
        /// Segments after which roulette may end any path, not dim ones alone; above `max_depth`
        /// for no roulette at all.
        pub roulette_depth: u32,
        /// [`BOTH_TECHNIQUES`] unless a test wants one alone.
        pub techniques: u32,
        /// [`PixelFilter::kind`].
        pub filter: u32,
        /// [`PixelFilter::radius`].
        pub filter_radius: f32,
        /// The camera.
        pub camera: Camera,
        /// The scene.
        pub scene: SceneParams,
    }
}

impl TracingParams for PathParams {
    fn scene(&self) -> SceneParams {
        self.scene
    }
}

impl PathParams {
    /// The random numbers of the path of a slot that is not empty.
    pub fn numbers(&self, slot: Slot) -> RandomNumbers {
        let (x, y) = pixel_of_rank(slot.rank, self.camera.width, self.camera.height);
        let pixel = y * self.camera.width + x;
        RandomNumbers::new(self.sampler, self.seed, pixel, slot.sample)
    }

    /// The filter of pixels, if that is not the pixel itself.
    #[inline(always)]
    pub fn pixel_filter(&self) -> PixelFilter {
        PixelFilter { kind: self.filter, radius: self.filter_radius }
    }

    /// Whether pixels have another filter than themselves.
    #[inline(always)]
    pub fn has_pixel_filter(&self, abilities: impl Abilities) -> bool {
        abilities.has(PIXEL_FILTERS) && self.filter != PIXEL
    }

    /// The first segment of the path of a slot that is not empty.
    #[inline(always)]
    pub fn camera_ray(
        &self,
        abilities: impl Abilities,
        slot: Slot,
        numbers: &RandomNumbers,
    ) -> Ray {
        let (x, y) = pixel_of_rank(slot.rank, self.camera.width, self.camera.height);
        let u = numbers.pair(random::PIXEL);
        let mut place = [x as f32 + u[0], y as f32 + u[1]];
        if self.has_pixel_filter(abilities) {
            let offset = self.pixel_filter().offset(u);
            place = [x as f32 + 0.5 + offset[0], y as f32 + 0.5 + offset[1]];
        }
        let mut lens = [0.0; 2];
        if self.camera.has_lens(abilities) {
            lens = numbers.pair(LENS);
        }
        self.camera.ray(abilities, place, lens)
    }

    /// Whether a path goes on after segment number `segment`: not if nothing is left of its
    /// throughput; and by Russian roulette, decided by 32 `random` bits, if its throughput is below
    /// [`DIM`], or from `roulette_depth` on. The throughput of survivors is divided by their
    /// probability of survival, so the mean stays as it is (Arvo and Kirk 1990).
    #[inline(always)]
    pub fn survives(&self, segment: u32, random: u32, throughput: &mut Vec3) -> bool {
        if self.roulette_depth <= self.max_depth {
            let most = if segment >= self.roulette_depth { 0.95 } else { 1.0 };
            let survival = (throughput.max_element() * (1.0 / DIM)).min(most);
            if unit_float(random) >= survival {
                return false;
            }
            *throughput /= survival;
        }
        let is_spent = throughput.max_element() <= 0.0;
        !is_spent
    }
}
