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
pub mod sums;
pub mod tiles;

use crate::glam::Vec3;
use crate::memory::device_struct;

device_struct! {
    /// What one path brought. 16 bytes.
    pub struct Contribution {
        /// Estimated radiance, linear Rec.709; from 0 on.
        pub radiance: Vec3,
        /// Rays traced for it, shadow rays included.
        pub rays: u32,
    }
}

impl Contribution {
    /// Of an empty slot.
    pub const NOTHING: Self = Self { radiance: Vec3::ZERO, rays: 0 };
}

device_struct! {
    /// What the [sums](sums::PixelSums) of a pixel come to, in radiance. 48 bytes.
    pub struct FilmPixel {
        /// Sum of radiance over the samples of the first half; like the other sums NaN where a
        /// sample was no number.
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
    /// Of no samples.
    pub const NOTHING: Self = Self {
        first_sum: Vec3::ZERO,
        first_samples: 0,
        second_sum: Vec3::ZERO,
        second_samples: 0,
        sum_of_squares: Vec3::ZERO,
        rays: 0,
    };

    /// Sum of radiance over all samples.
    pub fn sum(&self) -> Vec3 {
        self.first_sum + self.second_sum
    }

    /// Samples accumulated.
    pub fn samples(&self) -> u32 {
        self.first_samples + self.second_samples
    }
}
