//! The pool of paths of the wavefront integrators: what a path is between two kernels, and where it
//! lies.
//!
//! One buffer of rows (see [`crate::memory::soa`]) has tables of all that kernels hand on, each
//! with an element for every lane of the pool. What outlives an iteration is there twice: in its
//! own half an iteration writes the paths that go on, in the other it finds those of the iteration
//! before.

use crate::glam::{UVec4, Vec3};
use crate::integrator::path::{Path, SampledLight};
use crate::memory::access::Scatter;
use crate::memory::soa::{Place, soa};
use crate::scene::light::tree::Vantage;
use crate::scene::media::{Media, Sides};
use crate::scene::ray::{Hit, Ray};

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
    pub struct Gathered {
        /// The light, linear Rec.709.
        radiance: Vec3,
        /// Rays traced, shadow rays included.
        rays: u32;
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
    pub struct Arriving {
        /// What it adds to the path's radiance if it is visible.
        radiance: Vec3,
        /// Whether there is any, and for what path: [`NO_LIGHT`], [`GOES_ON`] or [`ENDS`].
        fate: u32;
    }
}

soa! {
    /// From the end of a segment to where light was sampled.
    pub struct Shadow {
        /// Where it starts, in world units.
        origin: Vec3,
        /// Number of the path's slot.
        slot: u32;
        /// To the other end.
        direction: Vec3,
        /// What it starts in.
        media: u32;
    }
}

/// [`Arriving::fate`]: there is no light to test, and nothing else of the lane's is to be looked
/// at.
pub const NO_LIGHT: u32 = 0;
/// [`Arriving::fate`]: the light is for a path that goes on.
pub const GOES_ON: u32 = 1;
/// [`Arriving::fate`]: the light is the last that its path gathers.
pub const ENDS: u32 = 2;

/// First rows of the tables.
const AHEAD: u32 = 0;
const CARRIED: u32 = AHEAD + Ahead::ROWS;
const GATHERED: u32 = CARRIED + Carried::ROWS;
/// Rows of a half.
const HALF: u32 = GATHERED + Gathered::ROWS;
const FOUND: u32 = 2 * HALF;
const ARRIVING: u32 = FOUND + Found::ROWS;
const SHADOW: u32 = ARRIVING + Arriving::ROWS;
/// Rows of 16 bytes that a pool has for each lane.
pub const POOL_ROWS: u32 = SHADOW + Shadow::ROWS;
/// What paths are in, twice as well: what is before the end of the segment and behind it, and, from
/// where that is shaded on, what the next one starts in, and where that faces.
const AROUND: u32 = POOL_ROWS;
/// The same where paths know what they are in, or where they face.
pub const POOL_ROWS_WITH_PLACES: u32 = AROUND + 2;

/// The lanes of the pool that have a path in an iteration.
#[derive(Clone, Copy)]
pub struct Queue {
    /// Lanes below this continue a path.
    pub survivors: u32,
    /// Lanes below this have a path; those from `survivors` on begin one.
    pub active: u32,
    /// The first slot that has not begun, after these.
    pub next_slot: u32,
}

impl Queue {
    /// The slot that a lane from `survivors` on begins.
    pub fn slot(&self, lane: u32) -> u32 {
        self.next_slot - (self.active - lane)
    }

    /// The queue in a row.
    pub fn from_row(row: UVec4) -> Self {
        Self { survivors: row.x, active: row.y, next_slot: row.z }
    }

    /// The row of a queue.
    pub fn to_row(self) -> UVec4 {
        UVec4::new(self.survivors, self.active, self.next_slot, 0)
    }
}

/// The layout of the pool in an iteration. Functions take the buffer of its rows.
#[derive(Clone, Copy)]
pub struct Pool {
    /// Paths that it has room for.
    pub lanes: u32,
    /// Number of the iteration.
    pub iteration: u32,
    /// Rows before the first table: the queue of each iteration.
    pub queues: u32,
}

impl Pool {
    /// Where the table that begins at `row` has what lane `lane` hands on in this iteration.
    fn own(&self, row: u32, lane: u32) -> Place {
        self.place(row, lane, self.iteration & 1)
    }

    /// Where it has what lane `lane` wrote in the iteration before.
    fn before(&self, row: u32, lane: u32) -> Place {
        self.place(row, lane, !self.iteration & 1)
    }

    fn place(&self, row: u32, lane: u32, half: u32) -> Place {
        let row = if row < HALF {
            row + half * HALF
        } else if row == AROUND {
            row + half
        } else {
            row
        };
        Place { first: self.queues + row * self.lanes + lane, stride: self.lanes }
    }

    /// The queue of this iteration.
    pub fn queue(&self, rows: &Scatter<'_, UVec4>) -> Queue {
        Queue::from_row(rows.get(self.iteration))
    }

    /// The queue of the iteration before.
    pub fn queue_before(&self, rows: &Scatter<'_, UVec4>) -> Queue {
        Queue::from_row(rows.get(self.iteration - 1))
    }

    /// Replaces the queue of this iteration.
    pub fn set_queue(&self, rows: &mut Scatter<'_, UVec4>, queue: Queue) {
        rows.set(self.iteration, queue.to_row());
    }

    /// The next segment of the path that lane `lane` wrote in the iteration before, and the number
    /// of its slot.
    pub fn segment(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> (Ray, u32) {
        let ahead = Ahead::load(rows, self.before(AHEAD, lane));
        (Ray::new(ahead.origin, ahead.direction), ahead.slot)
    }

    /// The path that lane `lane` wrote in the iteration before, but for [where it
    /// starts](Self::start).
    pub fn path(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> Path {
        let ahead = Ahead::load(rows, self.before(AHEAD, lane));
        let carried = Carried::load(rows, self.before(CARRIED, lane));
        let gathered = Gathered::load(rows, self.before(GATHERED, lane));
        Path {
            ray: Ray::new(ahead.origin, ahead.direction),
            depth: carried.depth,
            throughput: carried.throughput,
            pdf: ahead.pdf,
            radiance: gathered.radiance,
            rays: gathered.rays,
            media: Media::NONE,
            facing: Vantage::NONE.facing,
        }
    }

    /// Writes what a path needs to go on, all but [what it has gathered](Self::set_gathered) and
    /// [where it starts](Self::set_start).
    pub fn set_path(&self, rows: &mut Scatter<'_, UVec4>, lane: u32, path: &Path, slot: u32) {
        let ahead =
            Ahead { origin: path.ray.origin, pdf: path.pdf, direction: path.ray.direction, slot };
        ahead.store(rows, self.own(AHEAD, lane));
        Carried { throughput: path.throughput, depth: path.depth }
            .store(rows, self.own(CARRIED, lane));
    }

    /// What the path of lane `lane` has gathered.
    pub fn gathered(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> Gathered {
        Gathered::load(rows, self.own(GATHERED, lane))
    }

    /// Replaces it.
    pub fn set_gathered(&self, rows: &mut Scatter<'_, UVec4>, lane: u32, gathered: Gathered) {
        gathered.store(rows, self.own(GATHERED, lane));
    }

    /// What the segment of lane `lane` hit.
    pub fn hit(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> Hit {
        let found = Found::load(rows, self.own(FOUND, lane));
        Hit {
            t: found.coordinates.x,
            u: found.coordinates.y,
            v: found.coordinates.z,
            triangle: found.triangle,
        }
    }

    /// Replaces it.
    pub fn set_hit(&self, rows: &mut Scatter<'_, UVec4>, lane: u32, hit: &Hit) {
        let found = Found { coordinates: Vec3::new(hit.t, hit.u, hit.v), triangle: hit.triangle };
        found.store(rows, self.own(FOUND, lane));
    }

    /// What the path is in that lane `lane` wrote in the iteration before, and [where it
    /// faces](Path::facing).
    pub fn start(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> (Media, u32) {
        let row = rows.get(self.before(AROUND, lane).first);
        (Media(row.x), row.y)
    }

    /// Replaces both for the iteration after this one.
    pub fn set_start(&self, rows: &mut Scatter<'_, UVec4>, lane: u32, path: &Path) {
        rows.set(self.own(AROUND, lane).first, UVec4::new(path.media.0, path.facing, 0, 0));
    }

    /// What is on the two sides of what the segment of lane `lane` hit.
    pub fn sides(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> Sides {
        let row = rows.get(self.own(AROUND, lane).first);
        Sides { here: Media(row.x), beyond: Media(row.y) }
    }

    /// Replaces it.
    pub fn set_sides(&self, rows: &mut Scatter<'_, UVec4>, lane: u32, sides: Sides) {
        let row = UVec4::new(sides.here.0, sides.beyond.0, 0, 0);
        rows.set(self.own(AROUND, lane).first, row);
    }

    /// The light that lane `lane` has sampled.
    pub fn arriving(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> Arriving {
        Arriving::load(rows, self.own(ARRIVING, lane))
    }

    /// The segment to it, if there is any.
    pub fn shadow(&self, rows: &Scatter<'_, UVec4>, lane: u32) -> Shadow {
        Shadow::load(rows, self.own(SHADOW, lane))
    }

    /// Replaces both.
    pub fn set_light(
        &self,
        rows: &mut Scatter<'_, UVec4>,
        lane: u32,
        slot: u32,
        light: &SampledLight,
        path_goes_on: bool,
    ) {
        let fate = if !light.is_some() {
            NO_LIGHT
        } else if path_goes_on {
            GOES_ON
        } else {
            ENDS
        };
        Arriving { radiance: light.radiance, fate }.store(rows, self.own(ARRIVING, lane));
        if light.is_some() {
            let shadow = Shadow {
                origin: light.segment.origin,
                slot,
                direction: light.segment.direction,
                media: light.media.0,
            };
            shadow.store(rows, self.own(SHADOW, lane));
        }
    }
}
