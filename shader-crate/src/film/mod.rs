//! The film: what has been measured of each pixel, and what a path adds to it.
//!
//! The samples of a pixel are of two **halves**, each a sequence with a scramble of its own, so
//! that the halves are independent of each other. (Even and odd samples of one Sobol sequence are
//! not: they lie in opposite halves of the first dimension.) Which half a sample is of is the top
//! bit of its number, see [`stream`].

pub mod accumulate;
pub mod control;
pub mod pixel_filter;
pub mod splats;
pub mod stream;
pub mod sum;
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
        /// Zero, which those who add it up do not know, see [`sum`].
        pub zero: u32,
    }
}

impl Contribution {
    /// What `rays` rays and the light that they found make of a slot.
    pub fn of(radiance: Vec3, rays: u32) -> Self {
        Self { radiance, rays, squared: radiance * radiance, zero: 0 }
    }

    /// Of an empty slot.
    pub const NOTHING: Self = Self { radiance: Vec3::ZERO, rays: 0, squared: Vec3::ZERO, zero: 0 };
}

device_struct! {
    /// The radiance of one pixel: sums over its samples, in two words each, see [`sum`]. 96 bytes.
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
        /// Unused; zero.
        pub pad0: u32,
        /// What `first_sum` lacks.
        pub first_low: Vec3,
        /// Rays traced.
        pub rays: u32,
        /// What `second_sum` lacks.
        pub second_low: Vec3,
        /// Zero, which those who add to the sums do not know, see [`sum`].
        pub zero: u32,
        /// What `sum_of_squares` lacks.
        pub squares_low: Vec3,
        /// The same.
        pub zero_of_squares: u32,
    }
}

impl FilmPixel {
    /// Of no samples.
    pub const NOTHING: Self = Self {
        first_sum: Vec3::ZERO,
        first_samples: 0,
        second_sum: Vec3::ZERO,
        second_samples: 0,
        sum_of_squares: Vec3::ZERO,
        pad0: 0,
        first_low: Vec3::ZERO,
        rays: 0,
        second_low: Vec3::ZERO,
        zero: 0,
        squares_low: Vec3::ZERO,
        zero_of_squares: 0,
    };

    /// Sum of radiance over all samples.
    pub fn sum(&self) -> Vec3 {
        self.first_sum + self.second_sum
    }

    /// Samples accumulated.
    pub fn samples(&self) -> u32 {
        self.first_samples + self.second_samples
    }

    /// Adds the next sample of a half. The result is the same bits on every device.
    #[inline(always)]
    pub fn add(&mut self, contribution: &Contribution, is_second: bool) {
        let Contribution { radiance, rays, squared, zero } = *contribution;
        if is_second {
            sum::add(&mut self.second_sum, &mut self.second_low, radiance, zero);
            self.second_samples += 1;
        } else {
            sum::add(&mut self.first_sum, &mut self.first_low, radiance, zero);
            self.first_samples += 1;
        }
        sum::add(&mut self.sum_of_squares, &mut self.squares_low, squared, zero);
        self.rays += rays;
    }
}

/// Words of a [`FilmPixel`].
pub const PIXEL_WORDS: u32 = 24;

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
            offset_of!(FilmPixel, first_low),
            offset_of!(FilmPixel, second_low),
            offset_of!(FilmPixel, squares_low),
        ];
        let words = [PIXEL_WORDS, 0, 3, 4, 7, 8, 15, 12, 16, 20];
        assert_eq!(pixel, words.map(|word| 4 * word as usize));
    }

    #[test]
    fn a_constant_comes_out_after_as_many_samples_as_there_can_be() {
        // Numbers of few and of many digits, large and small ones.
        for value in [0.1_f32, 1.0 / 3.0, 1.000_000_1, 0.7777, 1e-15, 3e15] {
            let contribution = Contribution::of(Vec3::new(value, 0.5 * value, 0.0), 1);
            let mut pixel = FilmPixel::default();
            let samples = 1 << 24;
            for sample in 0..samples {
                pixel.add(&contribution, sample & 1 == 1);
            }
            let count = samples as f32;
            for (sum, count, expected) in [
                (pixel.sum(), count, contribution.radiance),
                (pixel.first_sum, count / 2.0, contribution.radiance),
                (pixel.second_sum, count / 2.0, contribution.radiance),
                (pixel.sum_of_squares, count, contribution.squared),
            ] {
                let error = (sum / count - expected).abs().max_element();
                assert!(error <= 3e-7 * expected.x, "{value}: {} is off by {error}", expected.x);
            }
        }
    }
}
