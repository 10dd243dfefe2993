//! The allocator `atomic`: the method that Podee et al. compare with ("Efficient Adaptive GPU Path Tracing", equation 2).
//!
//! Each pixel gets samples in proportion to its error, reserves its slots by an atomic counter, and results are added to the film
//! by atomics. So the order of the stream and that of the additions are whatever the device makes of them: this allocator alone
//! is not the same on every device, nor twice on one. The numbers of samples are: they are the lengths of [runs](crate::runs)
//! without a uniform share and without a random phase.

use crate::access::{Atomics, Scatter};
use crate::film::{Contribution, FilmPixel};
use crate::glam::Vec3;
use crate::stream::{NO_PIXEL, RunWindow, Runs, Slot};

/// Kernel: zeroes the counter of slots.
pub fn clear_counter(_: u32, _: &RunWindow, counter: &mut u32) {
    *counter = 0;
}

/// Kernel: reserves slots for pixel `lane` of the window, as many as its run is long, and fills them.
pub fn reserve_slots(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    film: &[FilmPixel],
    slots: &mut Scatter<'_, Slot>,
    counter: &mut Atomics<'_>,
) {
    let runs = Runs::new(window, starts);
    let count = runs.start(lane + 1) - runs.start(lane);
    if count > 0 {
        let first = counter.add(0, count);
        let mut k = 0;
        while k < count {
            let slot = Slot { rank: window.first_rank + lane, sample: film[lane as usize].samples + k };
            slots.set(first + k, slot);
            k += 1;
        }
    }
}

/// Words of a [`FilmPixel`].
const WORDS: u32 = 12;

/// Kernel: adds contribution `lane` to its pixel, if that is in the window. `film` holds [`FilmPixel`]s.
pub fn accumulate_atomic(
    lane: u32,
    window: &RunWindow,
    slots: &[Slot],
    contributions: &[Contribution],
    film: &mut Atomics<'_>,
) {
    let slot = slots[lane as usize];
    let pixel = slot.rank.wrapping_sub(window.first_rank);
    if slot.rank == NO_PIXEL || pixel >= window.pixels {
        return;
    }
    let first = pixel * WORDS;
    let c = contributions[lane as usize];
    add(film, first, c.radiance);
    film.add(first + 3, 1);
    add(film, first + 4, c.squared);
    film.add(first + 7, c.rays);
    if slot.sample & 1 == 1 {
        add(film, first + 8, c.radiance);
    }
}

fn add(film: &mut Atomics<'_>, first: u32, value: Vec3) {
    film.add_float(first, value.x);
    film.add_float(first + 1, value.y);
    film.add_float(first + 2, value.z);
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::mem::{offset_of, size_of};

    #[test]
    fn words_are_where_the_film_has_them() {
        assert_eq!(size_of::<FilmPixel>(), 4 * WORDS as usize);
        let places = [
            offset_of!(FilmPixel, sum),
            offset_of!(FilmPixel, samples),
            offset_of!(FilmPixel, sum_of_squares),
            offset_of!(FilmPixel, rays),
            offset_of!(FilmPixel, odd_sum),
        ];
        assert_eq!(places, [0, 3, 4, 7, 8].map(|word| 4 * word));
    }
}
