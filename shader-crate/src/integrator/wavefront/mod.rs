//! The integrators `compaction` and `streaming`: many paths advance by one segment at a time, a
//! kernel for each part of the work.
//!
//! Paths live in a **pool**, a lane each. An **iteration** takes every path one segment further:
//!
//! | launch | what a lane does |
//! |---|---|
//! | [`trace_queue`] | fetches a path's ray, or that of a slot's first segment, and finds what it hits |
//! | [`shade_queue`] | emission, a light sample, a direction, roulette: writes the path's next state |
//! | [`shadow_queue`] | finds whether the sampled light is visible, and adds it |
//! | [`sum_blocks`](crate::parallel::prefix::sum_blocks), [`scan_blocks`](crate::parallel::prefix::scan_blocks), [`scatter_kept`](crate::parallel::compaction::scatter_kept) | compaction: the lanes whose paths go on, close together |
//!
//! Each kernel is small, and its lanes all do the same. The next iteration's lane `k` continues the
//! path of the `k`-th lane that was kept, and writes the new state at its own place, in the other
//! half of the pool: so the survivors come to lie at the front, in order, and what is behind them
//! is free. What becomes of it is the difference between the two integrators:
//!
//! - `compaction` (Wald, "Active Thread Compaction for GPU Path Tracing", HPG 2011) leaves it free:
//!   all paths start together, and fewer and fewer lanes have any;
//! - `streaming` (van Antwerpen, "Improving SIMD Efficiency for Parallel Monte Carlo Light
//!   Transport on the GPU", HPG 2011) fills it with the next slots of the stream, so that all lanes
//!   have a path until the stream ends.
//!
//! How many paths there are is known on the device alone: [`Queue`] says it, every launch is as
//! large as the pool, and lanes without a path end at once.

pub mod pool;

use crate::film::Contribution;
use crate::film::stream::{NO_PIXEL, Slot};
use crate::glam::UVec4;
use crate::integrator::params::PathParams;
use crate::integrator::path::{Path, SampledLight};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;
use crate::parallel::prefix::BLOCK;
use crate::scene::abilities::Abilities;
use crate::scene::media::{Media, Sides};
use crate::scene::ray::Ray;
use crate::scene::{Encounter, SceneParams, SceneView, TracingParams};
use pool::{ENDS, Gathered, NO_LIGHT, Pool, Queue};

device_struct! {
    /// The parameters of one iteration. 192 bytes.
    pub struct WavefrontParams {
        /// Lanes: the size of the pool.
        pub threads: u32,
        /// Number of the iteration: the queue that is its own.
        pub iteration: u32,
        /// 1 if there are no paths from an iteration before.
        pub is_first: u32,
        /// 1 if lanes without a path take the next slots; otherwise only those of a first iteration
        /// do.
        pub regenerates: u32,
        /// The slot that a first iteration begins with.
        pub first_slot: u32,
        /// Where slots end.
        pub end_slot: u32,
        /// Rows of the pool before its first table, see [`Pool::queues`].
        pub queues: u32,
        /// Unused; zero.
        pub pad: u32,
        /// What is the same for all paths; `threads` is not looked at.
        pub path: PathParams,
    }
}

impl TracingParams for WavefrontParams {
    fn scene(&self) -> SceneParams {
        self.path.scene
    }
}

impl WavefrontParams {
    fn pool(&self) -> Pool {
        Pool { lanes: self.threads, iteration: self.iteration, queues: self.queues }
    }

    /// The paths after an iteration: `offsets` are the numbers of kept lanes before each block of
    /// lanes and, after the last, in all.
    fn survivors(&self, offsets: &[u32]) -> u32 {
        at(offsets, self.threads.div_ceil(BLOCK))
    }

    /// The queue of this iteration, by what was left of the one before.
    fn next_queue(&self, offsets: &[u32], rows: &Scatter<'_, UVec4>) -> Queue {
        let (survivors, next_slot) = if self.is_first == 1 {
            (0, self.first_slot)
        } else {
            (self.survivors(offsets), self.pool().queue_before(rows).next_slot)
        };
        let takes_slots = self.is_first == 1 || self.regenerates == 1;
        let begun =
            if takes_slots { (self.threads - survivors).min(self.end_slot - next_slot) } else { 0 };
        Queue { survivors, active: survivors + begun, next_slot: next_slot + begun }
    }
}

/// Kernel: finds what the ray of lane `lane` hits. Lane 0 writes the queue down for the launches to
/// come.
pub fn trace_queue(
    lane: u32,
    params: &WavefrontParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    kept: &[u32],
    offsets: &[u32],
    rows: &mut Scatter<'_, UVec4>,
) {
    let queue = params.next_queue(offsets, rows);
    let pool = params.pool();
    if lane == 0 {
        pool.set_queue(rows, queue);
    }
    if lane >= queue.active {
        return;
    }
    let has_media = scene.surfaces.has_media();
    let mut media = scene.surfaces.media_of_camera();
    let ray = if lane < queue.survivors {
        if has_media {
            media = pool.start(rows, at(kept, lane)).0;
        }
        pool.segment(rows, at(kept, lane)).0
    } else {
        // Camera rays are made again where they are shaded: that costs less than to keep them.
        let slot = at(slots, queue.slot(lane));
        if slot.rank == NO_PIXEL {
            return;
        }
        params.path.camera_ray(scene.abilities(), slot, &params.path.numbers(slot))
    };
    let Encounter { hit, sides } = scene.meet(&ray, media);
    pool.set_hit(rows, lane, &hit);
    if has_media {
        pool.set_sides(rows, lane, sides);
    }
}

/// Kernel: what the path of lane `lane` does at the end of its segment. `goes_on` becomes 1 if it
/// has another one, else 0.
pub fn shade_queue(
    lane: u32,
    params: &WavefrontParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    kept: &[u32],
    goes_on: &mut u32,
    rows: &mut Scatter<'_, UVec4>,
    contributions: &mut Scatter<'_, Contribution>,
) {
    *goes_on = 0;
    let pool = params.pool();
    let queue = pool.queue(rows);
    if lane >= queue.active {
        return;
    }
    let survives = lane < queue.survivors;
    let number = if survives { pool.segment(rows, at(kept, lane)).1 } else { queue.slot(lane) };
    let slot = at(slots, number);
    if slot.rank == NO_PIXEL {
        contributions.set(number, Contribution::NOTHING);
        pool.set_light(rows, lane, number, &SampledLight::none(), false);
        return;
    }
    let numbers = params.path.numbers(slot);
    let mut path = if survives {
        pool.path(rows, at(kept, lane))
    } else {
        Path::begin(&params.path, scene, slot, &numbers)
    };
    let mut sides = Sides::both(path.media);
    if scene.surfaces.has_media() {
        sides = pool.sides(rows, lane);
    }
    if survives && scene.lights.has_tree() {
        path.facing = pool.start(rows, at(kept, lane)).1;
    }
    let encounter = Encounter { hit: pool.hit(rows, lane), sides };
    let bounce = path.shade(&params.path, scene, &numbers, &encounter);
    pool.set_light(rows, lane, number, &bounce.light, bounce.goes_on);
    if bounce.goes_on {
        *goes_on = 1;
        pool.set_path(rows, lane, &path, number);
        if scene.surfaces.has_media() || scene.lights.has_tree() {
            pool.set_start(rows, lane, &path);
        }
    }
    if bounce.goes_on || bounce.light.is_some() {
        pool.set_gathered(rows, lane, Gathered { radiance: path.radiance, rays: path.rays });
    } else {
        contributions.set(number, path.contribution());
    }
}

/// Kernel: adds the light that lane `lane` has sampled if nothing occludes it, and writes the
/// contribution of a path that has ended.
pub fn shadow_queue(
    lane: u32,
    params: &WavefrontParams,
    scene: &SceneView<'_, impl Abilities>,
    rows: &mut Scatter<'_, UVec4>,
    contributions: &mut Scatter<'_, Contribution>,
) {
    let pool = params.pool();
    if lane >= pool.queue(rows).active {
        return;
    }
    let arriving = pool.arriving(rows, lane);
    if arriving.fate == NO_LIGHT {
        return;
    }
    let shadow = pool.shadow(rows, lane);
    let segment = Ray::segment(shadow.origin, shadow.direction, 1.0);
    let is_visible = !scene.is_blocked(&segment, Media(shadow.media));
    let mut gathered = pool.gathered(rows, lane);
    if is_visible {
        gathered.radiance += arriving.radiance;
    }
    if arriving.fate == ENDS {
        contributions
            .set(shadow.slot, Contribution { radiance: gathered.radiance, rays: gathered.rays });
    } else if is_visible {
        pool.set_gathered(rows, lane, gathered);
    }
}

/// Kernel: walks the path of lane `lane`, where it has one, to its end, and then those of slots
/// that have not begun. For what is left after the last iteration.
pub fn finish_queue(
    lane: u32,
    params: &WavefrontParams,
    scene: &SceneView<'_, impl Abilities>,
    slots: &[Slot],
    kept: &[u32],
    offsets: &[u32],
    rows: &mut Scatter<'_, UVec4>,
    contributions: &mut Scatter<'_, Contribution>,
) {
    let pool = params.pool();
    let mut next_slot = pool.queue_before(rows).next_slot + lane;
    let mut survives = lane < params.survivors(offsets);
    while survives || next_slot < params.end_slot {
        let number = if survives { pool.segment(rows, at(kept, lane)).1 } else { next_slot };
        if !survives {
            next_slot += params.threads;
        }
        let slot = at(slots, number);
        if slot.rank == NO_PIXEL {
            contributions.set(number, Contribution::NOTHING);
            continue;
        }
        let numbers = params.path.numbers(slot);
        let mut path = if survives {
            pool.path(rows, at(kept, lane))
        } else {
            Path::begin(&params.path, scene, slot, &numbers)
        };
        if survives && (scene.surfaces.has_media() || scene.lights.has_tree()) {
            (path.media, path.facing) = pool.start(rows, at(kept, lane));
        }
        survives = false;
        while path.extend(&params.path, scene, &numbers) {}
        contributions.set(number, path.contribution());
    }
}
