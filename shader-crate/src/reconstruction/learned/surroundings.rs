//! What is about a pixel: sums over its neighbours, from which its [description] is made.
//!
//! [description]: super::description

use crate::estimator::bilateral::{Centre, FilterParams, LARGEST_EXPONENT};
use crate::estimator::guide::{Guide, mean_of_squares, unpack_normal};
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::{Vec3, Vec4};
use crate::math::dot;
use crate::math::elementary::exp;
use crate::math::mean_of_components;
use crate::memory::access::at;

/// Pixels to each side that a pixel is described by.
const REACH: u32 = 3;
/// Pixels to each side that a smoothed colour is made of.
const SMOOTH_REACH: u32 = 2;

/// What is about a pixel that is measured. Its parts are vectors of four alone, which lie in memory
/// alike wherever kernels are compiled to.
#[derive(Clone, Copy)]
pub struct Surroundings {
    /// Of pixels like the one in the middle, next to it.
    pub near: Sums,
    /// Of all pixels like it.
    pub all: Sums,
    /// Of all pixels that show a surface: of albedos; and of their squares, the means over the
    /// components.
    albedo: Vec4,
    /// Likewise of normals, and their number.
    normal: Vec4,
    /// The smoothed colour's sum, less the pixel's own colour, and its weights.
    smooth: Vec4,
    /// Pixels, the largest variance next to the pixel, the brightest mean of components there, and
    /// the smoothed colour's sum of variances.
    rest: Vec4,
}

/// Sums over pixels by how much they are like the one in the middle, of differences from that
/// one's colour: squares of what all have in common would leave nothing of the rest.
#[derive(Clone, Copy)]
pub struct Sums {
    /// Of weights, of variances, of squared colours and of products of both halves' colours, the
    /// means over the components.
    numbers: Vec4,
    /// Of colours; then of those of both halves.
    color: Vec4,
    first: Vec4,
    second: Vec4,
}

/// A pixel that is like the one in the middle, its colours less that one's.
struct Tap {
    color: Vec3,
    variance: f32,
    first: Vec3,
    second: Vec3,
}

impl Sums {
    const NOTHING: Self =
        Self { numbers: Vec4::ZERO, color: Vec4::ZERO, first: Vec4::ZERO, second: Vec4::ZERO };

    fn with(self, tap: &Tap, weight: f32) -> Self {
        let products = tap.first.dot(tap.second) * (1.0 / 3.0);
        let numbers = Vec4::new(1.0, tap.variance, mean_of_squares(tap.color), products);
        Self {
            numbers: self.numbers + numbers * weight,
            color: self.color + tap.color.extend(0.0) * weight,
            first: self.first + tap.first.extend(0.0) * weight,
            second: self.second + tap.second.extend(0.0) * weight,
        }
    }

    /// Sum of weights.
    pub fn weights(&self) -> f32 {
        self.numbers.x
    }

    /// Mean difference of colour.
    pub fn mean(&self) -> Vec3 {
        self.color.truncate() / self.weights()
    }

    /// Mean variance of the pixels.
    pub fn noise(&self) -> f32 {
        self.numbers.y / self.weights()
    }

    /// By how much the pixels differ among themselves: a variance, with their noise.
    pub fn spread(&self) -> f32 {
        (self.numbers.z / self.weights() - mean_of_squares(self.mean())).max(0.0)
    }

    /// By how much both halves of the pixels differ alike: without noise, and below 0 by chance.
    pub fn structure(&self) -> f32 {
        let of_means = dot(self.first, self.second) / (3.0 * self.weights() * self.weights());
        self.numbers.w / self.weights() - of_means
    }
}

impl Surroundings {
    const NOTHING: Self = Self {
        near: Sums::NOTHING,
        all: Sums::NOTHING,
        albedo: Vec4::ZERO,
        normal: Vec4::ZERO,
        smooth: Vec4::ZERO,
        rest: Vec4::ZERO,
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
                        dot(centre.distances(&guide, 0), Vec4::ONE)
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
                        sums = sums.with_alike(&tap, exp(-exponent), dx, dy);
                    }
                }
            }
            row += 1;
        }
        sums
    }

    fn with_any(self, tap: &Guide, distance: u32) -> Self {
        let mut sums = self;
        sums.rest.x += 1.0;
        if tap.has_surface() {
            sums.albedo += tap.albedo.extend(mean_of_squares(tap.albedo));
            sums.normal += unpack_normal(tap.normal).extend(1.0);
        }
        if distance <= 1 {
            sums.rest.y = sums.rest.y.max(tap.variance);
            sums.rest.z = sums.rest.z.max(mean_of_components(tap.color));
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
            let weight = weight * exp(-0.5 * (dx * dx + dy * dy) as f32);
            sums.smooth += tap.color.extend(1.0) * weight;
            sums.rest.w += tap.variance * weight * weight;
        }
        sums
    }

    /// By how much the smoothed colour differs from the pixel's own, and the variance of it.
    pub fn smoothed(&self) -> Vec4 {
        let own = self.own();
        (self.smooth.truncate() * own).extend(self.rest.w * own * own)
    }

    /// How far the smoothed colour follows the pixel's own.
    pub fn own(&self) -> f32 {
        1.0 / self.smooth.w
    }

    /// The variance of albedos, the mean over the components.
    pub fn albedo_spread(&self) -> f32 {
        let mean = self.albedo / self.normal.w.max(1.0);
        (mean.w - mean_of_squares(mean.truncate())).max(0.0)
    }

    /// That of normals, the sum over the components.
    pub fn normal_spread(&self) -> f32 {
        if self.normal.w == 0.0 {
            0.0
        } else {
            (1.0 - (self.normal.truncate() / self.normal.w).length_squared()).max(0.0)
        }
    }

    /// The part of the pixels that show a surface.
    pub fn surfaces(&self) -> f32 {
        self.normal.w / self.rest.x
    }

    /// The largest variance next to the pixel.
    pub fn largest_noise(&self) -> f32 {
        self.rest.y
    }

    /// The brightest pixel next to the pixel: the mean over its components, at least 0.
    pub fn brightest(&self) -> f32 {
        self.rest.z
    }
}
