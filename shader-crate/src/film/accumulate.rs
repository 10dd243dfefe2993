//! How a round's contributions get into the film.
//!
//! Accumulation is exact: each sum is owned by one lane, which adds a run in slot order, and the
//! additions are those of [compensated sums](super::sum), which leave a compiler nothing to fuse
//! and no order to vary. The same contributions give the same film, bit for bit, on any processor
//! that adds like IEEE 754.

use super::stream::{FIRST, RunWindow, Runs, counted_of, is_second};
use super::{Contribution, FilmPixel, PIXEL_WORDS, sum};
use crate::glam::{UVec4, Vec3};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;
use crate::memory::rows::{row, vector};

/// `uvec4`s of one contribution.
pub(super) const ROWS_PER_CONTRIBUTION: u32 = 2;

/// The contributions of a stream, as whoever adds them up reads them: sixteen bytes at a time, in a
/// quarter of the loads.
#[derive(Clone, Copy)]
pub struct ContributionView<'a> {
    rows: &'a [UVec4],
}

impl<'a> ContributionView<'a> {
    /// Wraps the buffer.
    pub fn new(rows: &'a [UVec4]) -> Self {
        Self { rows }
    }

    /// The contribution of `slot`.
    #[inline(always)]
    pub fn get(&self, slot: u32) -> Contribution {
        let radiance = at(self.rows, slot * ROWS_PER_CONTRIBUTION);
        let squared = at(self.rows, slot * ROWS_PER_CONTRIBUTION + 1);
        Contribution {
            radiance: vector(radiance),
            rays: radiance.w,
            squared: vector(squared),
            zero: squared.w,
        }
    }
}

/// Lanes that add up the run of a pixel: one takes radiance, the next one its squares.
pub const LANES_PER_PIXEL: u32 = 2;
/// `uvec4`s of a [`FilmPixel`].
const ROWS_PER_PIXEL: u32 = PIXEL_WORDS / 4;

/// Kernel: adds to the pixel `lane / 2` of a window its run of contributions, in slot order; even
/// lanes the radiance and the rays, odd ones the squares.
///
/// A run takes as long as its loads, one after the other. Each lane needs half of a contribution,
/// so that twice as many are under way at once.
pub fn accumulate_runs(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    contributions: &[UVec4],
    film: &mut Scatter<'_, UVec4>,
) {
    let runs = Runs::new(window, starts);
    let (pixel, part) = (lane / LANES_PER_PIXEL, lane % LANES_PER_PIXEL);
    let (start, end) = (runs.start(pixel), runs.start(pixel + 1));
    if start == end {
        return;
    }
    let mut sums = Sums::load(film, pixel, part, window.half);
    let run = Run { contributions, part, last: end - 1 };
    // The next ones are loaded a turn before they are added: a compiler that has them in the same
    // turn delays each until it is added.
    let mut now = run.load(start);
    let mut slot = start;
    while slot < end {
        let mut next = now;
        if slot + TURN < end {
            next = run.load(slot + TURN);
        }
        let left = end - slot;
        sums.add(now.0.0, true);
        sums.add(now.0.1, left > 1);
        sums.add(now.0.2, left > 2);
        sums.add(now.0.3, left > 3);
        sums.add(now.1.0, left > 4);
        sums.add(now.1.1, left > 5);
        sums.add(now.1.2, left > 6);
        sums.add(now.1.3, left > 7);
        slot += TURN;
        now = next;
    }
    sums.store(film, pixel, part);
}

/// Contributions that are loaded at once.
const TURN: u32 = 8;
type Four = (UVec4, UVec4, UVec4, UVec4);

/// The halves of contributions that a lane adds up.
#[derive(Clone, Copy)]
struct Run<'a> {
    contributions: &'a [UVec4],
    part: u32,
    /// The last slot.
    last: u32,
}

impl Run<'_> {
    /// Those of [`TURN`] slots, the last one in the place of all beyond.
    #[inline(always)]
    fn load(&self, slot: u32) -> (Four, Four) {
        let get = |slot: u32| {
            at(self.contributions, slot.min(self.last) * ROWS_PER_CONTRIBUTION + self.part)
        };
        (
            (get(slot), get(slot + 1), get(slot + 2), get(slot + 3)),
            (get(slot + 4), get(slot + 5), get(slot + 6), get(slot + 7)),
        )
    }
}

/// What a lane adds up: radiance by half, or squares, which are of the first half.
struct Sums {
    first: Vec3,
    first_low: Vec3,
    first_samples: u32,
    second: Vec3,
    second_low: Vec3,
    second_samples: u32,
    /// The last words of what was added: rays with radiance, nothing with squares.
    words: u32,
    zero: u32,
    half: u32,
    /// Samples that `half` counts.
    count: u32,
}

/// Rows of a pixel: sums of the first and second half, and of squares; then what they lack.
const FIRST_ROW: u32 = 0;
const SECOND_ROW: u32 = 1;
const SQUARES_ROW: u32 = 2;
const LOW_ROWS: u32 = 3;

impl Sums {
    fn load(film: &Scatter<'_, UVec4>, pixel: u32, part: u32, half: u32) -> Self {
        let place = pixel * ROWS_PER_PIXEL;
        let (one, other) =
            if part == 0 { (FIRST_ROW, SECOND_ROW) } else { (SQUARES_ROW, SQUARES_ROW) };
        let (first, second) = (film.get(place + one), film.get(place + other));
        let first_low = film.get(place + LOW_ROWS + one);
        let second_low = film.get(place + LOW_ROWS + other);
        // Squares are of no half.
        let half = if part == 0 { half } else { FIRST };
        Self {
            first: vector(first),
            first_low: vector(first_low),
            first_samples: first.w,
            second: vector(second),
            second_low: vector(second_low),
            second_samples: second.w,
            words: first_low.w,
            zero: second_low.w,
            half,
            count: counted_of(half, first.w, second.w),
        }
    }

    #[inline(always)]
    fn add(&mut self, contribution: UVec4, is_there: bool) {
        if is_there {
            let value = vector(contribution);
            if is_second(self.half, self.count) {
                sum::add(&mut self.second, &mut self.second_low, value, self.zero);
                self.second_samples += 1;
            } else {
                sum::add(&mut self.first, &mut self.first_low, value, self.zero);
                self.first_samples += 1;
            }
            self.words += contribution.w;
            self.count += 1;
        }
    }

    fn store(&self, film: &mut Scatter<'_, UVec4>, pixel: u32, part: u32) {
        let place = pixel * ROWS_PER_PIXEL;
        if part == 0 {
            film.set(place + FIRST_ROW, row(self.first, self.first_samples));
            film.set(place + SECOND_ROW, row(self.second, self.second_samples));
            film.set(place + LOW_ROWS + FIRST_ROW, row(self.first_low, self.words));
            film.set(place + LOW_ROWS + SECOND_ROW, row(self.second_low, self.zero));
        } else {
            film.set(place + SQUARES_ROW, row(self.first, 0));
            film.set(place + LOW_ROWS + SQUARES_ROW, row(self.first_low, self.zero));
        }
    }
}

device_struct! {
    /// The parameters of a count of rays or of samples. 16 bytes.
    pub struct CountParams {
        /// Partial sums of rays; pixels whose samples are counted.
        pub threads: u32,
        /// Pixels of the film that is bound.
        pub pixels: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// Kernel: the samples of pixel `lane` of a film.
pub fn copy_counts(lane: u32, _: &CountParams, film: &[FilmPixel], count: &mut u32) {
    *count = at(film, lane).samples();
}

/// Kernel: the rays of every `threads`-th pixel, from pixel `lane` on.
pub fn count_rays(lane: u32, params: &CountParams, film: &[FilmPixel], rays: &mut u32) {
    let mut sum = 0_u32;
    let mut pixel = lane;
    while pixel < params.pixels {
        sum = sum.wrapping_add(at(film, pixel).rays);
        pixel += params.threads;
    }
    *rays = sum;
}
