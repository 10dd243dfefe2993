//! The film: what has been measured of each pixel, and what a path adds to it.
//!
//! The samples of a pixel are of two **halves**, each a sequence with a scramble of its own, so
//! that the halves are independent of each other. (Even and odd samples of one Sobol sequence are
//! not: they lie in opposite halves of the first dimension.) Which half a sample is of is the top
//! bit of its number, see [`stream`].

pub mod accumulate;
pub mod control;
pub mod splats;
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
        /// Sum of radiance over the samples of the first half.
        pub first_sum: Vec3,
        /// Samples of the first half.
        pub first_samples: u32,
        /// Sum of radiance over the samples of the second half.
        pub second_sum: Vec3,
        /// Samples of the second half.
        pub second_samples: u32,
        /// Sum of squared radiance by component over all samples, for the variance.
        pub sum_of_squares: Vec3,
        /// Rays traced.
        pub rays: u32,
    }
}

impl FilmPixel {
    /// Sum of radiance over all samples.
    pub fn sum(&self) -> Vec3 {
        self.first_sum + self.second_sum
    }

    /// Samples accumulated.
    pub fn samples(&self) -> u32 {
        self.first_samples + self.second_samples
    }

    /// Adds the next sample of a half. Nothing but additions of what lies in memory: no rounding
    /// depends on the device.
    pub fn add(&mut self, contribution: &Contribution, is_second: bool) {
        if is_second {
            self.second_sum += contribution.radiance;
            self.second_samples += 1;
        } else {
            self.first_sum += contribution.radiance;
            self.first_samples += 1;
        }
        self.sum_of_squares += contribution.squared;
        self.rays += contribution.rays;
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
            offset_of!(FilmPixel, first_sum),
            offset_of!(FilmPixel, first_samples),
            offset_of!(FilmPixel, second_sum),
            offset_of!(FilmPixel, second_samples),
            offset_of!(FilmPixel, sum_of_squares),
            offset_of!(FilmPixel, rays),
        ];
        assert_eq!(pixel, [PIXEL_WORDS, 0, 3, 4, 7, 8, 11].map(|word| 4 * word as usize));
    }
}
