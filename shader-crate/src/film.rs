//! The film: what has been measured of each pixel, and how a round's contributions get there.
//!
//! Accumulation is exact: a pixel is owned by one thread, adds its run in slot order, and every addition is a plain
//! `sum = sum + c` whose operand was loaded from memory, so there is no product to fuse and no order to vary. The same
//! contributions give the same film, bit for bit, on any processor that adds like IEEE 754.

use crate::access::{Scatter, at};
use crate::device_struct;
use crate::glam::{UVec4, Vec3};
use crate::stream::{RunWindow, Runs, Slot};

device_struct! {
    /// What one path brought. 32 bytes.
    pub struct Contribution {
        /// Estimated radiance, linear Rec.709.
        pub radiance: Vec3,
        /// Rays traced for it, shadow rays included.
        pub rays: u32,
        /// `radiance` squared by component. Squared where it is made, so that the film only ever adds.
        pub squared: Vec3,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl Contribution {
    /// Of an empty slot.
    pub const NOTHING: Self = Self { radiance: Vec3::ZERO, rays: 0, squared: Vec3::ZERO, pad: 0 };
}

/// `uvec4`s of one contribution.
const ROWS_PER_CONTRIBUTION: u32 = 2;

/// The contributions of a stream, as whoever adds them up reads them: sixteen bytes at a time, in a quarter of the loads.
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
        let floats = |row: UVec4| Vec3::new(f32::from_bits(row.x), f32::from_bits(row.y), f32::from_bits(row.z));
        Contribution { radiance: floats(radiance), rays: radiance.w, squared: floats(squared), pad: 0 }
    }
}

device_struct! {
    /// The radiance of one pixel: sums over its samples. 48 bytes.
    pub struct FilmPixel {
        /// Sum of radiance.
        pub sum: Vec3,
        /// Samples accumulated.
        pub samples: u32,
        /// Sum of squared radiance by component, for the variance.
        pub sum_of_squares: Vec3,
        /// Rays traced.
        pub rays: u32,
        /// Sum of radiance over the samples of odd number (`samples / 2` of them): one of two
        /// independent halves.
        pub odd_sum: Vec3,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl FilmPixel {
    /// Adds the next sample. Nothing but additions of what lies in memory: no rounding depends on the device.
    pub fn add(&mut self, contribution: &Contribution) {
        self.sum += contribution.radiance;
        self.sum_of_squares += contribution.squared;
        self.rays += contribution.rays;
        if self.samples & 1 == 1 {
            self.odd_sum += contribution.radiance;
        }
        self.samples += 1;
    }
}

/// Words of a [`FilmPixel`].
pub const PIXEL_WORDS: u32 = 12;
/// Words of a [`Contribution`], and the lanes that add up a pixel's.
pub const CONTRIBUTION_WORDS: u32 = 8;
/// The word of a contribution that is an integer, its rays, and where it goes in a [`FilmPixel`]. All others that are used have the place there that they have here.
const RAYS: u32 = 3;
const PIXEL_RAYS: u32 = 7;
/// The word of a contribution that is not used, and the one that its lane adds to in a [`FilmPixel`].
const UNUSED: u32 = 7;
const PIXEL_SAMPLES: u32 = 3;
/// Where the sum over odd samples begins in a [`FilmPixel`].
const PIXEL_ODD_SUM: u32 = 8;

/// Kernel: adds to a pixel of a window its run of contributions, in slot order, as [`FilmPixel::add`] does.
///
/// Each of the [`CONTRIBUTION_WORDS`] lanes of a pixel adds up one word of its contributions. So neighbouring lanes read neighbouring
/// words, and a lane has loads of many slots under way. Sums must be taken in order; loads need not wait for them. `contributions` holds [`Contribution`]s, `film`
/// [`FilmPixel`]s.
pub fn accumulate_runs(
    lane: u32,
    window: &RunWindow,
    starts: &[u32],
    slots: &[Slot],
    contributions: &[u32],
    film: &mut Scatter<'_, u32>,
) {
    let (pixel, word) = (lane / CONTRIBUTION_WORDS, lane % CONTRIBUTION_WORDS);
    let runs = Runs::new(window, starts);
    let mut slot = runs.start(pixel);
    let end = runs.start(pixel + 1);
    if slot == end {
        return;
    }
    let first = pixel * PIXEL_WORDS;
    if word == UNUSED {
        let samples = first + PIXEL_SAMPLES;
        film.set(samples, film.get(samples) + (end - slot));
        return;
    }
    let place = first + if word == RAYS { PIXEL_RAYS } else { word };
    let is_radiance = word < 3;
    let odd_place = if is_radiance { first + PIXEL_ODD_SUM + word } else { place };
    let mut sum = WordSum {
        is_count: word == RAYS,
        bits: film.get(place),
        // The film's count says so too, but another lane changes it.
        is_odd: at(slots, slot).sample & 1 == 1,
        odd: f32::from_bits(film.get(odd_place)),
    };
    while end - slot >= 8 {
        let next = |number: u32| at(contributions, (slot + number) * CONTRIBUTION_WORDS + word);
        let (a, b, c, d) = (next(0), next(1), next(2), next(3));
        let (e, f, g, h) = (next(4), next(5), next(6), next(7));
        sum.add(a);
        sum.add(b);
        sum.add(c);
        sum.add(d);
        sum.add(e);
        sum.add(f);
        sum.add(g);
        sum.add(h);
        slot += 8;
    }
    while slot < end {
        sum.add(at(contributions, slot * CONTRIBUTION_WORDS + word));
        slot += 1;
    }
    film.set(place, sum.bits);
    if is_radiance {
        film.set(odd_place, sum.odd.to_bits());
    }
}

/// The sums of one word of the contributions of a pixel.
struct WordSum {
    /// Whether the word is an integer and not the bits of an `f32`.
    is_count: bool,
    /// The sum over all samples, of the word's type.
    bits: u32,
    /// Whether the next sample is of odd number.
    is_odd: bool,
    /// The sum over odd samples.
    odd: f32,
}

impl WordSum {
    #[inline(always)]
    fn add(&mut self, word: u32) {
        let value = f32::from_bits(word);
        let sum = (f32::from_bits(self.bits) + value).to_bits();
        self.bits = if self.is_count { self.bits + word } else { sum };
        self.odd = if self.is_odd { self.odd + value } else { self.odd };
        self.is_odd = !self.is_odd;
    }
}

device_struct! {
    /// The parameters of a count of rays. 16 bytes.
    pub struct CountParams {
        /// Partial sums.
        pub threads: u32,
        /// Pixels of the film that is bound.
        pub pixels: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use core::mem::{offset_of, size_of};

    #[test]
    fn words_are_where_kernels_look_for_them() {
        assert_eq!(size_of::<Contribution>(), 4 * CONTRIBUTION_WORDS as usize);
        let contribution = [
            offset_of!(Contribution, radiance),
            offset_of!(Contribution, rays),
            offset_of!(Contribution, squared),
            offset_of!(Contribution, pad),
        ];
        assert_eq!(contribution, [0, RAYS, 4, UNUSED].map(|word| 4 * word as usize));
        assert_eq!(size_of::<FilmPixel>(), 4 * PIXEL_WORDS as usize);
        let pixel = [
            offset_of!(FilmPixel, sum),
            offset_of!(FilmPixel, samples),
            offset_of!(FilmPixel, sum_of_squares),
            offset_of!(FilmPixel, rays),
            offset_of!(FilmPixel, odd_sum),
        ];
        assert_eq!(pixel, [0, PIXEL_SAMPLES, 4, PIXEL_RAYS, PIXEL_ODD_SUM].map(|word| 4 * word as usize));
    }
}
