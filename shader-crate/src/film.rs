//! The film: what has been measured of each pixel, and how a round's contributions get there.
//!
//! Accumulation is exact: a pixel is owned by one thread, adds its run in slot order, and every addition is a plain
//! `sum = sum + c` whose operand was loaded from memory, so there is no product to fuse and no order to vary. The same
//! contributions give the same film, bit for bit, on any processor that adds like IEEE 754.

use crate::device_struct;
use crate::glam::Vec3;

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

device_struct! {
    /// The parameters of accumulation over one window: pixel `lane` owns the slots
    /// `lane * samples ..` of it. 16 bytes.
    pub struct AccumulateWindow {
        /// Pixels in the window.
        pub threads: u32,
        /// Slots of each pixel.
        pub samples: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// Kernel: adds to the pixel `lane` of a window its run of contributions, in slot order.
pub fn accumulate_runs(lane: u32, window: &AccumulateWindow, contributions: &[Contribution], film: &mut FilmPixel) {
    let first = lane * window.samples;
    let mut radiance = *film;
    let mut k = 0;
    while k < window.samples {
        let c = contributions[(first + k) as usize];
        radiance.sum += c.radiance;
        radiance.sum_of_squares += c.squared;
        radiance.rays += c.rays;
        if radiance.samples & 1 == 1 {
            radiance.odd_sum += c.radiance;
        }
        radiance.samples += 1;
        k += 1;
    }
    *film = radiance;
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
        sum = sum.wrapping_add(film[pixel as usize].rays);
        pixel += params.threads;
    }
    *rays = sum;
}
