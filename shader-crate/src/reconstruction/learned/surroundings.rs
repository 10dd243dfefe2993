//! What is about a pixel: sums over its neighbours, from which its [description] is made.
//!
//! [description]: super::description

use crate::estimator::bilateral::{Centre, FilterParams};
use crate::estimator::guide::{Guide, mean_of_squares, unpack_normal};
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::{Vec3, Vec4};
use crate::memory::access::at;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Pixels to each side that a pixel is described by.
const REACH: u32 = 3;
/// Pixels to each side that a smoothed colour is made of.
const SMOOTH_REACH: u32 = 2;
/// Weights are exp(-exponent). From here on they are none.
const LARGEST_EXPONENT: f32 = 16.0;

/// What is about a pixel that is measured.
#[derive(Clone, Copy)]
pub struct Surroundings {
    /// Of pixels like the one in the middle, next to it.
    pub near: Sums,
    /// Of all pixels like it.
    pub all: Sums,
    /// Of all pixels.
    pub features: Features,
    /// The largest variance next to the pixel, and the brightest.
    pub largest_noise: f32,
    /// See `largest_noise`; the mean over the components.
    pub brightest: f32,
    smooth: Smooth,
}

/// Sums over pixels by how much they are like the one in the middle, of differences from that
/// one's colour: squares of what all have in common would leave nothing of the rest.
#[derive(Clone, Copy)]
pub struct Sums {
    /// Of weights.
    pub weights: f32,
    variance: f32,
    color: Vec3,
    squares: f32,
    first: Vec3,
    second: Vec3,
    products: f32,
}

/// Sums over pixels whatever they are like.
#[derive(Clone, Copy)]
pub struct Features {
    /// Pixels.
    pub pixels: f32,
    /// Pixels that show a surface; the following are of these.
    pub surfaces: f32,
    albedo: Vec3,
    albedo_squares: f32,
    normal: Vec3,
}

/// Sums for a smoothed colour.
#[derive(Clone, Copy)]
struct Smooth {
    weights: f32,
    color: Vec3,
    variance: f32,
}

/// A pixel that is like the one in the middle, its colours less that one's.
struct Tap {
    color: Vec3,
    variance: f32,
    first: Vec3,
    second: Vec3,
}

impl Sums {
    const NOTHING: Self = Self {
        weights: 0.0,
        variance: 0.0,
        color: Vec3::ZERO,
        squares: 0.0,
        first: Vec3::ZERO,
        second: Vec3::ZERO,
        products: 0.0,
    };

    fn with(self, tap: &Tap, weight: f32) -> Self {
        Self {
            weights: self.weights + weight,
            variance: self.variance + tap.variance * weight,
            color: self.color + tap.color * weight,
            squares: self.squares + mean_of_squares(tap.color) * weight,
            first: self.first + tap.first * weight,
            second: self.second + tap.second * weight,
            products: self.products + tap.first.dot(tap.second) * (weight / 3.0),
        }
    }

    /// Mean difference of colour.
    pub fn mean(&self) -> Vec3 {
        self.color / self.weights
    }

    /// Mean variance of the pixels.
    pub fn noise(&self) -> f32 {
        self.variance / self.weights
    }

    /// By how much the pixels differ among themselves: a variance, with their noise.
    pub fn spread(&self) -> f32 {
        (self.squares / self.weights - mean_of_squares(self.mean())).max(0.0)
    }

    /// By how much both halves of the pixels differ alike: without noise, and below 0 by chance.
    pub fn structure(&self) -> f32 {
        let of_means = self.first.dot(self.second) / (3.0 * self.weights * self.weights);
        self.products / self.weights - of_means
    }
}

impl Features {
    fn with(self, tap: &Guide) -> Self {
        let mut features = Self { pixels: self.pixels + 1.0, ..self };
        if tap.has_surface() {
            features.surfaces += 1.0;
            features.albedo += tap.albedo;
            features.albedo_squares += mean_of_squares(tap.albedo);
            features.normal += unpack_normal(tap.normal);
        }
        features
    }

    /// The variance of albedos, the mean over the components.
    pub fn albedo_spread(&self) -> f32 {
        let surfaces = self.surfaces.max(1.0);
        (self.albedo_squares / surfaces - mean_of_squares(self.albedo / surfaces)).max(0.0)
    }

    /// That of normals, the sum over the components.
    pub fn normal_spread(&self) -> f32 {
        if self.surfaces == 0.0 {
            0.0
        } else {
            (1.0 - (self.normal / self.surfaces).length_squared()).max(0.0)
        }
    }
}

impl Smooth {
    fn with(self, tap: &Tap, weight: f32) -> Self {
        Self {
            weights: self.weights + weight,
            color: self.color + tap.color * weight,
            variance: self.variance + tap.variance * weight * weight,
        }
    }
}

impl Surroundings {
    const NOTHING: Self = Self {
        near: Sums::NOTHING,
        all: Sums::NOTHING,
        features: Features {
            pixels: 0.0,
            surfaces: 0.0,
            albedo: Vec3::ZERO,
            albedo_squares: 0.0,
            normal: Vec3::ZERO,
        },
        largest_noise: 0.0,
        brightest: 0.0,
        smooth: Smooth { weights: 0.0, color: Vec3::ZERO, variance: 0.0 },
    };

    /// Of the pixel of a rank, which is measured, seen by `centre`.
    pub fn of(
        params: &FilterParams,
        centre: &Centre,
        guides: &[Guide],
        first: &[Vec4],
        second: &[Vec4],
        rank: u32,
    ) -> Self {
        let color = at(guides, rank).color;
        let (x, y) = pixel_of_rank(rank, params.width, params.height);
        let (right, bottom) =
            ((x + REACH).min(params.width - 1), (y + REACH).min(params.height - 1));
        let mut sums = Self::NOTHING;
        let mut row = y - y.min(REACH);
        while row <= bottom {
            let dy = row.max(y) - row.min(y);
            let mut column = x - x.min(REACH);
            while column <= right {
                let dx = column.max(x) - column.min(x);
                let tap_rank = rank_of_pixel(column, row, params.width, params.height);
                let guide = at(guides, tap_rank);
                column += 1;
                if guide.is_measured() {
                    sums = sums.with_any(&guide, dx.max(dy));
                    let exponent = if centre.is_comparable(&guide) {
                        centre.distances(&guide, 0).element_sum()
                    } else {
                        LARGEST_EXPONENT
                    };
                    // False for NaN as well.
                    if exponent < LARGEST_EXPONENT {
                        let tap = Tap {
                            color: guide.color - color,
                            variance: guide.variance,
                            first: at(first, tap_rank).truncate() - color,
                            second: at(second, tap_rank).truncate() - color,
                        };
                        sums = sums.with_alike(&tap, (-exponent).exp(), dx, dy);
                    }
                }
            }
            row += 1;
        }
        sums
    }

    fn with_any(self, tap: &Guide, distance: u32) -> Self {
        let mut sums = Self { features: self.features.with(tap), ..self };
        if distance <= 1 {
            sums.largest_noise = sums.largest_noise.max(tap.variance);
            sums.brightest = sums.brightest.max(tap.color.dot(Vec3::ONE) * (1.0 / 3.0));
        }
        sums
    }

    fn with_alike(self, tap: &Tap, weight: f32, dx: u32, dy: u32) -> Self {
        let mut sums = Self { all: self.all.with(tap, weight), ..self };
        let distance = dx.max(dy);
        if distance <= 1 {
            sums.near = self.near.with(tap, weight);
        }
        if distance <= SMOOTH_REACH {
            // A Gaussian of one pixel.
            let weight = weight * (-0.5 * (dx * dx + dy * dy) as f32).exp();
            sums.smooth = self.smooth.with(tap, weight);
        }
        sums
    }

    /// By how much the smoothed colour differs from the pixel's own, and the variance of it.
    pub fn smoothed(&self) -> Vec4 {
        let own = self.own();
        (self.smooth.color * own).extend(self.smooth.variance * own * own)
    }

    /// How far the smoothed colour follows the pixel's own.
    pub fn own(&self) -> f32 {
        1.0 / self.smooth.weights
    }
}
