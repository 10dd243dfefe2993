//! The film: what has been measured of each pixel, and what a path adds to it.

pub mod accumulate;
pub mod stream;
pub mod tiles;

use crate::glam::Vec3;
use crate::memory::device_struct;

device_struct! {
    /// What one path brought. 32 bytes.
    pub struct Contribution {
        /// Estimated radiance, linear Rec.709.
        pub radiance: Vec3,
        /// Rays traced for it, shadow rays included.
        pub rays: u32,
        /// `radiance` squared by component. Squared where it is made, so that the film only ever
        /// adds.
        pub squared: Vec3,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl Contribution {
    /// What `rays` rays and the light that they found make of a slot.
    pub fn of(radiance: Vec3, rays: u32) -> Self {
        Self { radiance, rays, squared: radiance * radiance, pad: 0 }
    }

    /// Of an empty slot.
    pub const NOTHING: Self = Self { radiance: Vec3::ZERO, rays: 0, squared: Vec3::ZERO, pad: 0 };
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
    /// Adds the next sample. Nothing but additions of what lies in memory: no rounding depends on
    /// the device.
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

#[cfg(test)]
mod tests {
    use super::accumulate::ROWS_PER_CONTRIBUTION;
    use super::*;
    use core::mem::{offset_of, size_of};

    #[test]
    fn words_are_where_kernels_look_for_them() {
        let contribution = [
            size_of::<Contribution>(),
            offset_of!(Contribution, radiance),
            offset_of!(Contribution, rays),
            offset_of!(Contribution, squared),
        ];
        assert_eq!(
            contribution,
            [4 * ROWS_PER_CONTRIBUTION, 0, 3, 4].map(|word| 4 * word as usize)
        );
        let pixel = [
            size_of::<FilmPixel>(),
            offset_of!(FilmPixel, sum),
            offset_of!(FilmPixel, samples),
            offset_of!(FilmPixel, sum_of_squares),
            offset_of!(FilmPixel, rays),
            offset_of!(FilmPixel, odd_sum),
        ];
        assert_eq!(pixel, [PIXEL_WORDS, 0, 3, 4, 7, 8].map(|word| 4 * word as usize));
    }
}
