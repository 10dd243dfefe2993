//! The integrators `compaction` and `streaming`: many paths advance by one segment at a time, a kernel for each part of the work.
//!
//! Paths live in a **pool**, a lane each. An **iteration** takes every path one segment further:
//!
//! | launch | what a lane does |
//! |---|---|
//! | [`trace_queue`] | fetches a path's ray, or that of a slot's first segment, and finds what it hits |
//! | [`shade_queue`] | emission, a light sample, a direction, roulette: writes the path's next state |
//! | [`shadow_queue`] | finds whether the sampled light is visible, and adds it |
//! | [`sum_blocks`](crate::prefix::sum_blocks), [`scan_blocks`](crate::prefix::scan_blocks), [`scatter_kept`](crate::compaction::scatter_kept) | compaction: the lanes whose paths go on, close together |
//!
//! Each kernel is small, and its lanes all do the same. The next iteration's lane `k` continues the path of the `k`-th lane that was kept, and writes the new
//! state at its own place, in the other half of the pool: so the survivors come to lie at the front, in order, and what is behind them is
//! free. What becomes of it is the difference between the two integrators:
//!
//! - `compaction` (Wald, "Active Thread Compaction for GPU Path Tracing", HPG 2011) leaves it free: all paths start together, and fewer and
//!   fewer lanes have any;
//! - `streaming` (van Antwerpen, "Improving SIMD Efficiency for Parallel Monte Carlo Light Transport on the GPU", HPG 2011) fills it with the next slots of
//!   the stream, so that all lanes have a path until the stream ends.
//!
//! How many paths there are is known on the device alone: [`Queue`] says it, every launch is as large as the pool, and lanes without a path end at once.

use crate::access::{Scatter, at};
use crate::bvh::BvhView;
use crate::device_struct;
use crate::film::Contribution;
use crate::glam::{UVec4, Vec3};
use crate::light::{Light, LightView};
use crate::material::Material;
use crate::path::{Path, PathParams, SampledLight, camera_ray, contribution, numbers_of};
use crate::prefix::BLOCK;
use crate::ray::{Hit, Ray};
use crate::scene::SceneView;
use crate::soa::{Place, soa};
use crate::stream::{NO_PIXEL, Slot};
use crate::surface::Attributes;
use crate::texture::TextureView;

device_struct! {
    /// The parameters of one iteration. 144 bytes.
    pub struct WavefrontParams {
        /// Lanes: the size of the pool.
        pub threads: u32,
        /// Number of the iteration: the element of the queues that is its own.
        pub iteration: u32,
        /// 1 if there are no paths from an iteration before.
        pub is_first: u32,
        /// 1 if lanes without a path take the next slots; otherwise only those of a first iteration do.
        pub regenerates: u32,
        /// The slot that a first iteration begins with.
        pub first_slot: u32,
        /// Where slots end.
        pub end_slot: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// What is the same for all paths; `threads` is not looked at.
        pub path: PathParams,
    }
}

device_struct! {
    /// The lanes of the pool that have a path in an iteration. 16 bytes.
    pub struct Queue {
        /// Lanes below this continue a path.
        pub survivors: u32,
        /// Lanes below this have a path; those from `survivors` on begin one.
        pub active: u32,
        /// The first slot that has not begun, after these.
        pub next_slot: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

soa! {
    /// The next segment of a path.
    struct Ahead {
        origin: Vec3, pdf: f32;
        direction: Vec3, slot: u32;
    }
}

soa! {
    /// What a path carries along.
    struct Carried {
        throughput: Vec3, depth: u32;
    }
}

soa! {
    /// What a path has brought so far.
    struct Gathered {
        radiance: Vec3, rays: u32;
    }
}

soa! {
    /// What a segment hit: its length and the barycentric coordinates.
    struct Found {
        coordinates: Vec3, triangle: u32;
    }
}

soa! {
    /// Sampled light at the end of a segment.
    struct Arriving {
        radiance: Vec3, fate: u32;
    }
}

soa! {
    /// The segment to where it was sampled.
    struct Shadow {
        origin: Vec3, slot: u32;
        direction: Vec3, pad: u32;
    }
}

/// [`Arriving::fate`]: there is no light to test.
const NOTHING_ARRIVES: u32 = 0;
/// [`Arriving::fate`]: the light is for a path that goes on.
const GOES_ON: u32 = 1;
/// [`Arriving::fate`]: the light is the last that its path gathers.
const ENDS: u32 = 2;

/// First rows of the tables in the pool. What outlives an iteration is there twice.
const AHEAD: u32 = 0;
const CARRIED: u32 = AHEAD + Ahead::ROWS;
const GATHERED: u32 = CARRIED + Carried::ROWS;
const HALF: u32 = GATHERED + Gathered::ROWS;
const FOUND: u32 = 2 * HALF;
const ARRIVING: u32 = FOUND + Found::ROWS;
const SHADOW: u32 = ARRIVING + Arriving::ROWS;
/// Rows of 16 bytes that a pool has for each path.
pub const POOL_ROWS: u32 = SHADOW + Shadow::ROWS;

impl WavefrontParams {
    /// Where the table that begins at `row` has what lane `lane` writes in this iteration.
    fn own(&self, row: u32, lane: u32) -> Place {
        let half = if row < HALF { (self.iteration & 1) * HALF } else { 0 };
        Place { first: (half + row) * self.threads + lane, stride: self.threads }
    }

    /// Where it has what lane `lane` wrote in the iteration before; `row` is below [`HALF`].
    fn before(&self, row: u32, lane: u32) -> Place {
        let half = (!self.iteration & 1) * HALF;
        Place { first: (half + row) * self.threads + lane, stride: self.threads }
    }

    /// The paths after an iteration: `offsets` are the numbers of kept lanes before each block of lanes and, after the last, in all.
    fn survivors(&self, offsets: &[u32]) -> u32 {
        at(offsets, self.threads.div_ceil(BLOCK))
    }

    /// The queue of this iteration, by what was left of the one before.
    fn queue(&self, offsets: &[u32], queues: &Scatter<'_, Queue>) -> Queue {
        let (survivors, next_slot) = if self.is_first == 1 {
            (0, self.first_slot)
        } else {
            (self.survivors(offsets), queues.get(self.iteration - 1).next_slot)
        };
        let takes_slots = self.is_first == 1 || self.regenerates == 1;
        let begun = if takes_slots { (self.threads - survivors).min(self.end_slot - next_slot) } else { 0 };
        Queue { survivors, active: survivors + begun, next_slot: next_slot + begun, pad: 0 }
    }
}

impl Queue {
    /// The slot that a lane from `survivors` on begins.
    fn slot(&self, lane: u32) -> u32 {
        self.next_slot - (self.active - lane)
    }
}

/// The path that lane `lane` wrote in the iteration before, and the number of its slot.
fn load_path(params: &WavefrontParams, rows: &Scatter<'_, UVec4>, lane: u32) -> (Path, u32) {
    let ahead = Ahead::load(rows, params.before(AHEAD, lane));
    let carried = Carried::load(rows, params.before(CARRIED, lane));
    let gathered = Gathered::load(rows, params.before(GATHERED, lane));
    let path = Path {
        ray: Ray::new(ahead.origin, ahead.direction),
        depth: carried.depth,
        throughput: carried.throughput,
        pdf: ahead.pdf,
        radiance: gathered.radiance,
        rays: gathered.rays,
    };
    (path, ahead.slot)
}

/// Kernel: finds what the ray of lane `lane` hits. Lane 0 writes the queue down for the launches to come.
#[allow(clippy::too_many_arguments)] // one per binding
pub fn trace_queue(
    lane: u32,
    params: &WavefrontParams,
    slots: &[Slot],
    nodes: &[UVec4],
    triangles: &[UVec4],
    kept: &[u32],
    offsets: &[u32],
    rows: &mut Scatter<'_, UVec4>,
    queues: &mut Scatter<'_, Queue>,
) {
    let queue = params.queue(offsets, queues);
    if lane == 0 {
        queues.set(params.iteration, queue);
    }
    if lane >= queue.active {
        return;
    }
    let ray = if lane < queue.survivors {
        let ahead = Ahead::load(rows, params.before(AHEAD, at(kept, lane)));
        Ray::new(ahead.origin, ahead.direction)
    } else {
        let slot = at(slots, queue.slot(lane));
        if slot.rank == NO_PIXEL {
            return;
        }
        camera_ray(&params.path, slot, &numbers_of(&params.path, slot))
    };
    let hit = BvhView::new(nodes, triangles).closest_hit(&ray);
    let found = Found { coordinates: Vec3::new(hit.t, hit.u, hit.v), triangle: hit.triangle };
    found.store(rows, params.own(FOUND, lane));
}

/// Kernel: what the path of lane `lane` does at the end of its segment. `goes_on` becomes 1 if it has another one, else 0.
#[allow(clippy::too_many_arguments)] // one per binding
pub fn shade_queue(
    lane: u32,
    params: &WavefrontParams,
    slots: &[Slot],
    triangles: &[UVec4],
    attributes: &[Attributes],
    materials: &[Material],
    lights: &[Light],
    texels: &[u32],
    kept: &[u32],
    queues: &[Queue],
    goes_on: &mut u32,
    rows: &mut Scatter<'_, UVec4>,
    contributions: &mut Scatter<'_, Contribution>,
) {
    *goes_on = 0;
    let queue = at(queues, params.iteration);
    if lane >= queue.active {
        return;
    }
    let survives = lane < queue.survivors;
    let number = if survives { Ahead::load(rows, params.before(AHEAD, at(kept, lane))).slot } else { queue.slot(lane) };
    let slot = at(slots, number);
    if slot.rank == NO_PIXEL {
        contributions.set(number, Contribution::NOTHING);
        store_light(params, rows, lane, number, &SampledLight::none(), false);
        return;
    }
    let numbers = numbers_of(&params.path, slot);
    let mut path =
        if survives { load_path(params, rows, at(kept, lane)).0 } else { Path::begin(&params.path, slot, &numbers) };
    let found = Found::load(rows, params.own(FOUND, lane));
    let hit = Hit { t: found.coordinates.x, u: found.coordinates.y, v: found.coordinates.z, triangle: found.triangle };
    let scene = SceneView {
        bvh: BvhView::of_triangles(triangles),
        attributes,
        materials,
        offset_roundings: params.path.offset_roundings,
        textures: TextureView::new(texels),
    };
    let bounce = path.shade(&params.path, &scene, &LightView::new(lights, params.path.lights), &numbers, &hit);
    store_light(params, rows, lane, number, &bounce.light, bounce.goes_on);
    if bounce.goes_on {
        *goes_on = 1;
        let ahead = Ahead { origin: path.ray.origin, pdf: path.pdf, direction: path.ray.direction, slot: number };
        ahead.store(rows, params.own(AHEAD, lane));
        Carried { throughput: path.throughput, depth: path.depth }.store(rows, params.own(CARRIED, lane));
    }
    if bounce.goes_on || bounce.light.is_some() {
        Gathered { radiance: path.radiance, rays: path.rays }.store(rows, params.own(GATHERED, lane));
    } else {
        contributions.set(number, path.contribution());
    }
}

/// Hands sampled light on to [`shadow_queue`].
fn store_light(
    params: &WavefrontParams,
    rows: &mut Scatter<'_, UVec4>,
    lane: u32,
    slot: u32,
    light: &SampledLight,
    goes_on: bool,
) {
    let fate = match (light.is_some(), goes_on) {
        (false, _) => NOTHING_ARRIVES,
        (true, true) => GOES_ON,
        (true, false) => ENDS,
    };
    Arriving { radiance: light.radiance, fate }.store(rows, params.own(ARRIVING, lane));
    if light.is_some() {
        let shadow = Shadow { origin: light.segment.origin, slot, direction: light.segment.direction, pad: 0 };
        shadow.store(rows, params.own(SHADOW, lane));
    }
}

/// Kernel: adds the light that lane `lane` has sampled if nothing occludes it, and writes the contribution of a path that has ended.
pub fn shadow_queue(
    lane: u32,
    params: &WavefrontParams,
    nodes: &[UVec4],
    triangles: &[UVec4],
    queues: &[Queue],
    rows: &mut Scatter<'_, UVec4>,
    contributions: &mut Scatter<'_, Contribution>,
) {
    if lane >= at(queues, params.iteration).active {
        return;
    }
    let arriving = Arriving::load(rows, params.own(ARRIVING, lane));
    if arriving.fate == NOTHING_ARRIVES {
        return;
    }
    let shadow = Shadow::load(rows, params.own(SHADOW, lane));
    let is_visible =
        !BvhView::new(nodes, triangles).is_occluded(&SampledLight::segment(shadow.origin, shadow.direction));
    let mut gathered = Gathered::load(rows, params.own(GATHERED, lane));
    if is_visible {
        gathered.radiance += arriving.radiance;
    }
    if arriving.fate == ENDS {
        contributions.set(shadow.slot, contribution(gathered.radiance, gathered.rays));
    } else if is_visible {
        gathered.store(rows, params.own(GATHERED, lane));
    }
}

/// Kernel: walks the path of lane `lane`, where it has one, to its end, and then those of slots that have not begun. For what is left after the last
/// iteration.
#[allow(clippy::too_many_arguments)] // one per binding
pub fn finish_queue(
    lane: u32,
    params: &WavefrontParams,
    slots: &[Slot],
    nodes: &[UVec4],
    triangles: &[UVec4],
    attributes: &[Attributes],
    materials: &[Material],
    lights: &[Light],
    texels: &[u32],
    kept: &[u32],
    offsets: &[u32],
    queues: &[Queue],
    rows: &mut Scatter<'_, UVec4>,
    contributions: &mut Scatter<'_, Contribution>,
) {
    let scene = SceneView {
        bvh: BvhView::new(nodes, triangles),
        attributes,
        materials,
        offset_roundings: params.path.offset_roundings,
        textures: TextureView::new(texels),
    };
    let lights = LightView::new(lights, params.path.lights);
    let mut next_slot = at(queues, params.iteration - 1).next_slot + lane;
    let mut survives = lane < params.survivors(offsets);
    while survives || next_slot < params.end_slot {
        let (mut path, number) = if survives {
            load_path(params, rows, at(kept, lane))
        } else {
            let number = next_slot;
            next_slot += params.threads;
            let slot = at(slots, number);
            if slot.rank == NO_PIXEL {
                contributions.set(number, Contribution::NOTHING);
                continue;
            }
            (Path::begin(&params.path, slot, &numbers_of(&params.path, slot)), number)
        };
        survives = false;
        let numbers = numbers_of(&params.path, at(slots, number));
        while path.extend(&params.path, &scene, &lights, &numbers) {}
        contributions.set(number, path.contribution());
    }
}
