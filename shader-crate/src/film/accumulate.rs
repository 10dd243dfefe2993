//! How a round's contributions get into the film.
//!
//! Sums do not depend on their order (see [`sums`](super::sums)), so a stream is cut into stretches
//! of equal length, whosever the slots are: a long run holds up nobody. Who has the whole run of a
//! pixel adds to its sums as they are; where others may add to the same ones, all do so by atomics.

use super::stream::Slot;
use super::sums::{COMPONENT_WORDS, COUNTS, ComponentSums, NOT_NUMBERS, PIXEL_WORDS, PixelSums};
use crate::glam::UVec4;
use crate::math::fixed;
use crate::math::random::SECOND_HALF;
use crate::memory::access::{Atomics, at};
use crate::memory::device_struct;

device_struct! {
    /// Contributions to be added to a film. 32 bytes.
    pub struct AccumulateParams {
        /// Lanes: [`LANES_PER_STRETCH`] for each stretch of the slots.
        pub threads: u32,
        /// The first slot.
        pub first_slot: u32,
        /// The slot after the last.
        pub end_slot: u32,
        /// Rank of the first pixel of the film that is bound.
        pub first_rank: u32,
        /// Pixels of it; slots of others are left out.
        pub pixels: u32,
        /// The unit of the film is 2 to this power.
        pub unit_exponent: i32,
        /// 1: the slots of a pixel follow each other; 0: they come in any order.
        pub in_runs: u32,
        /// Slots of a stretch.
        pub stretch: u32,
    }
}

/// Lanes that add up a stretch, each a word of every contribution: the components of radiance and
/// the rays.
pub const LANES_PER_STRETCH: u32 = 4;
/// The word of a contribution that has the rays.
const RAYS: u32 = 3;

/// Kernel: adds a stretch of contributions to the film, of each the word `lane % 4`. `contributions`
/// are [`Contribution`](super::Contribution)s, `film` has [`PixelSums`].
pub fn accumulate(
    lane: u32,
    params: &AccumulateParams,
    slots: &[Slot],
    contributions: &[u32],
    film: &mut Atomics<'_>,
) {
    let word = lane % LANES_PER_STRETCH;
    let first = params.first_slot + lane / LANES_PER_STRETCH * params.stretch;
    let end = (first + params.stretch).min(params.end_slot);
    let mut slot = first;
    let mut next = at(slots, slot);
    let (mut begins, mut begins_whole) = (true, false);
    let mut sums = ComponentSums::NOTHING;
    while slot < end {
        let now = next;
        let pixel = now.rank.wrapping_sub(params.first_rank);
        if begins {
            begins_whole = !params.is_of_run(slots, slot.wrapping_sub(1), now.rank);
            sums = ComponentSums::NOTHING;
        }
        let value = at(contributions, slot * LANES_PER_STRETCH + word);
        slot += 1;
        if slot < end {
            next = at(slots, slot);
        }
        begins = slot == end || next.rank != now.rank;
        if pixel < params.pixels {
            let is_second = now.sample >= SECOND_HALF;
            if !add_word(&mut sums, word, value, is_second, params.unit_exponent) {
                film.add(pixel * PIXEL_WORDS + NOT_NUMBERS, 1);
            }
            if begins {
                let is_whole = begins_whole && !params.is_of_run(slots, slot, now.rank);
                store(&sums, pixel, word, is_whole, film);
            }
        }
    }
}

impl AccumulateParams {
    /// Whether other lanes may add to the sums of the pixel `rank` since `slot`, before or after
    /// those of a stretch, may be the pixel's.
    #[inline(always)]
    fn is_of_run(&self, slots: &[Slot], slot: u32, rank: u32) -> bool {
        let is_there = slot >= self.first_slot && slot < self.end_slot;
        self.in_runs == 0 || is_there && at(slots, slot).rank == rank
    }
}

/// Adds a word of a contribution to the sums of a component, or to counts: in the lowest words the
/// samples of both halves and the rays. Returns whether it was a number.
#[inline(always)]
fn add_word(
    sums: &mut ComponentSums,
    word: u32,
    value: u32,
    is_second: bool,
    unit_exponent: i32,
) -> bool {
    if word == RAYS {
        sums.first.x += !is_second as u32;
        sums.second.x += is_second as u32;
        sums.squares.x = sums.squares.x.wrapping_add(value);
        true
    } else {
        sums.add(f32::from_bits(value), is_second, unit_exponent)
    }
}

/// Adds what [`add_word`] has added up to the film, where it is nobody else's if it `is_own`.
#[inline(always)]
fn store(sums: &ComponentSums, pixel: u32, word: u32, is_own: bool, film: &mut Atomics<'_>) {
    let first = pixel * PIXEL_WORDS;
    let ComponentSums { first: a, second: b, squares: c } = *sums;
    if word == RAYS {
        film.add(first + COUNTS, a.x);
        film.add(first + COUNTS + 1, b.x);
        film.add(first + COUNTS + 2, c.x);
    } else {
        let first = first + word * COMPONENT_WORDS;
        add(film, first, a, is_own);
        add(film, first + fixed::WORDS, b, is_own);
        add(film, first + 2 * fixed::WORDS, c, is_own);
    }
}

/// Adds to the sum whose words begin at `first`, which is nobody else's if it `is_own`.
#[inline(always)]
fn add(film: &mut Atomics<'_>, first: u32, value: UVec4, is_own: bool) {
    if !is_own {
        fixed::add_atomic(film, first, value);
    } else if value != UVec4::ZERO {
        let before = UVec4::new(
            film.get(first),
            film.get(first + 1),
            film.get(first + 2),
            film.get(first + 3),
        );
        let sum = fixed::add(before, value);
        film.set(first, sum.x);
        film.set(first + 1, sum.y);
        film.set(first + 2, sum.z);
        film.set(first + 3, sum.w);
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
pub fn copy_counts(lane: u32, _: &CountParams, film: &[PixelSums], count: &mut u32) {
    *count = at(film, lane).samples();
}

/// Kernel: the rays of every `threads`-th pixel, from pixel `lane` on.
pub fn count_rays(lane: u32, params: &CountParams, film: &[PixelSums], rays: &mut u32) {
    let mut sum = 0_u32;
    let mut pixel = lane;
    while pixel < params.pixels {
        sum = sum.wrapping_add(at(film, pixel).rays);
        pixel += params.threads;
    }
    *rays = sum;
}
