//! The allocator `atomic`: the method that Podee et al. compare with ("Efficient Adaptive GPU Path
//! Tracing", equation 2).
//!
//! Each pixel gets samples in proportion to its error, reserves its slots by an atomic counter, and
//! results are added to the film by atomics. So the order of the stream and that of the additions
//! are whatever the device makes of them: this allocator alone is not the same on every device, nor
//! twice on one. The numbers of samples are: they are the lengths of [runs](crate::allocator::runs)
//! without a uniform share and without a random phase.

use crate::film::accumulate::ContributionView;
use crate::film::stream::{RunWindow, Runs, Slot};
use crate::film::{FilmPixel, PIXEL_WORDS};
use crate::glam::{UVec4, Vec3};
use crate::memory::access::{Atomics, Scatter, at};

/// Kernel: zeroes the counter of slots.
pub fn clear_counter(_: u32, _: &RunWindow, counter: &mut u32) {
    *counter = 0;
}

/// Kernel: reserves slots for pixel `lane` of the window, as many as its run is long.
pub fn reserve_slots(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    reserved: &mut u32,
    counter: &mut Atomics<'_>,
) {
    let runs = Runs::new(window, starts);
    let count = runs.start(lane + 1) - runs.start(lane);
    if count > 0 {
        *reserved = counter.add(0, count);
    }
}

/// Kernel: fills the slot that would be number `lane` if pixels came in order, where it is one of
/// the window's: runs may be so long that one lane must not fill them alone.
pub fn fill_reserved(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    reserved: &[u32],
    film: &[FilmPixel],
    slots: &mut Scatter<'_, Slot>,
) {
    if lane < at(starts, 0) || lane >= at(starts, window.pixels) {
        return;
    }
    // The last pixel whose run does not begin after the slot; runs before it may be empty.
    let (mut pixel, mut end) = (0, window.pixels);
    while end - pixel > 1 {
        let middle = (pixel + end) / 2;
        if at(starts, middle) <= lane {
            pixel = middle;
        } else {
            end = middle;
        }
    }
    let k = lane - at(starts, pixel);
    let slot = Slot { rank: window.first_rank + pixel, sample: at(film, pixel).samples + k };
    slots.set(at(reserved, pixel) + k, slot);
}

/// Slots that one lane adds up where they are of one pixel, before it adds the sum to the film:
/// many lanes that change one word by turns wait for each other.
pub const STRETCH: u32 = 64;

/// Kernel: adds the contributions of stretch `lane` of the stream to the pixels of the window.
/// `film` holds [`FilmPixel`]s; the stream ends where the slots do.
pub fn accumulate_atomic(
    lane: u32,
    window: &RunWindow,
    slots: &[Slot],
    contributions: &[UVec4],
    film: &mut Atomics<'_>,
) {
    let contributions = ContributionView::new(contributions);
    let mut slot = lane * STRETCH;
    let end = (slot + STRETCH).min(slots.len() as u32);
    while slot < end {
        let rank = at(slots, slot).rank;
        let mut sums = FilmPixel {
            sum: Vec3::ZERO,
            samples: 0,
            sum_of_squares: Vec3::ZERO,
            rays: 1,
            odd_sum: Vec3::ZERO,
            pad: 0,
        };
        // The parity of sample numbers is that of the film's count.
        let first = at(slots, slot).sample;
        sums.samples = first & 1;
        while slot < end && at(slots, slot).rank == rank {
            sums.add(&contributions.get(slot));
            slot += 1;
        }
        sums.samples -= first & 1;
        // From 1 on, since naga takes a number for lost that comes from a loop and goes into an
        // atomic as it is.
        sums.rays -= 1;
        let pixel = rank.wrapping_sub(window.first_rank);
        if pixel < window.pixels {
            let first = pixel * PIXEL_WORDS;
            add(film, first, sums.sum);
            film.add(first + 3, sums.samples);
            add(film, first + 4, sums.sum_of_squares);
            film.add(first + 7, sums.rays);
            add(film, first + 8, sums.odd_sum);
        }
    }
}

fn add(film: &mut Atomics<'_>, first: u32, value: Vec3) {
    film.add_float(first, value.x);
    film.add_float(first + 1, value.y);
    film.add_float(first + 2, value.z);
}
