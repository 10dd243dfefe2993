//! The estimator `bilateral`: what a pixel differs from a picture that a joint bilateral filter has
//! smoothed.
//!
//! The filter averages a pixel with its neighbours, by weights that are products of Gaussians of
//! pixel distance, world distance, difference of normals and difference of albedos (Podee et al.).
//! What edges it must not blur, these features say. Some edges they do not know, a shadow's for
//! one; there the filter blurs what is right, and takes the pixels of the edge for wrong, for ever.
//! A fifth factor, which can be switched off, looks at the colours themselves: what two pixels
//! differ by beyond their noise is real. See `Centre::color_exponent`.

use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, mean_of_squares, unpack_normal};
use crate::estimator::unseen::unseen_part;
use crate::estimator::{ErrorForm, Estimate};
use crate::film::sums::PixelSums;
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::{Vec3, Vec4};
use crate::math::UNIT_ROUNDOFF;
use crate::math::elementary::exp;
use crate::memory::access::at;
use crate::memory::device_struct;

/// Weights are exp(-exponent). From here on they are below 2^-23, which a sum that begins with the
/// pixel's own weight of 1 does not notice.
pub const LARGEST_EXPONENT: f32 = 16.0;
/// Standard errors of the difference of two colours that count as noise.
const TOLERANCE: f32 = 2.0;
/// Smallest cosine for which a surface's pixel footprint is known: grazing ones are infinite.
const SMALLEST_COSINE: f32 = 0.1;
/// Roundings that a mean of positions may have suffered.
const POSITION_ROUNDINGS: f32 = 64.0;

device_struct! {
    /// The parameters of [`filter_errors`]. 80 bytes.
    pub struct FilterParams {
        /// Pixels to estimate.
        pub threads: u32,
        /// Rank of the first; film, estimates and errors that are bound start there.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// The camera's pinhole, in world units.
        pub origin: Vec3,
        /// Side of a pixel at distance 1 from the pinhole.
        pub pixel_pitch: f32,
        /// What becomes of the estimate.
        pub form: ErrorForm,
        /// Neighbours that the filter sees to each side.
        pub radius: u32,
        /// 1: the filter looks at colours and their noise; 0: it does not (Podee et al.).
        pub color: u32,
        /// Standard deviation of the Gaussian of pixel distance, in pixels; above 0.
        pub pixel_sigma: f32,
        /// That of world distance, in pixel footprints on the surface; above 0.
        pub position_sigma: f32,
        /// That of the difference of unit normals; above 0.
        pub normal_sigma: f32,
        /// That of the difference of albedos; above 0.
        pub albedo_sigma: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// Kernel: the estimate and the allocators' error of the pixel `first_rank + lane`, of all guides
/// in rank order.
///
/// The squared error is the squared difference of measured and filtered colour, its mean over the
/// components. The filtered colour shares the pixel's own noise, though, all of it where no
/// neighbour is like the pixel, and the difference does not show what both share. With the colour
/// term on, that part is made up for by the variance, so that thin things do not look free of
/// noise; and what the samples of a pixel at an edge may have missed is added, see [`unseen_part`].
pub fn filter_errors(
    lane: u32,
    params: &FilterParams,
    guides: &[Guide],
    film: &[PixelSums],
    estimate: &mut Estimate,
    error: &mut f32,
) {
    let rank = params.first_rank + lane;
    let guide = at(guides, rank);
    let mut result = Estimate { filtered: Vec3::ZERO, squared_error: 0.0 };
    let mut number = 0.0;
    if guide.is_measured() {
        let filtered = filter::<false>(params, guides, rank);
        let mut squared_error = mean_of_squares(guide.color - filtered.color);
        if params.color != 0 {
            squared_error += filtered.shared_noise * filtered.variance
                + unseen_part(guides, rank, params.width, params.height);
        }
        result.filtered = filtered.color;
        result.squared_error = params.form.unseen_light(&guide).max(squared_error);
        number = params.form.of(&result, filtered.variance, &guide, at(film, lane).rays);
    }
    *estimate = result;
    *error = number;
}

/// Kernel: the filtered colour of the pixel `lane` of the picture, for a
/// [reconstruction](crate::reconstruction); black where nothing is measured.
pub fn filter_picture(
    lane: u32,
    params: &FilterParams,
    guides: &[Guide],
    picture: &mut FilteredPixel,
) {
    *picture = if at(guides, lane).is_measured() {
        let filtered = filter::<true>(params, guides, lane);
        FilteredPixel { color: filtered.color, own: filtered.own }
    } else {
        FilteredPixel { color: Vec3::ZERO, own: 1.0 }
    };
}

/// Weighted means about a pixel.
struct Filtered {
    color: Vec3,
    /// Of the pixels' variances.
    variance: f32,
    /// The pixel's own part: how far `color` follows the pixel's own.
    own: f32,
    /// The part of the variance that the pixel's difference from `color` does not show. If the
    /// neighbours differ by noise of equal variance `v` alone, that difference has the variance
    /// `v (1 - 2 a + s)`: `a` is the pixel's own weight and `s` the sum of all squared weights, of
    /// a sum of 1.
    shared_noise: f32,
}

/// Filters the pixel of rank `rank`, which is measured.
///
/// The weights look at the pixel's colour, so that what is alike changes with it: with `FOLLOWS`
/// its own part is not only its weight but the derivative of all, as if noise were alike in all
/// components.
fn filter<const FOLLOWS: bool>(params: &FilterParams, guides: &[Guide], rank: u32) -> Filtered {
    let guide = at(guides, rank);
    let centre = Centre::new(params, &guide);
    let (x, y) = pixel_of_rank(rank, params.width, params.height);
    let right = (x + params.radius).min(params.width - 1);
    let bottom = (y + params.radius).min(params.height - 1);
    let (mut color, mut variance) = (guide.color, guide.variance);
    let (mut weights, mut squared_weights) = (1.0, 1.0);
    let (mut slopes, mut sloped_colors) = (Vec3::ZERO, 0.0);
    let mut row = y - y.min(params.radius);
    while row <= bottom {
        let dy = row.max(y) - row.min(y);
        let mut column = x - x.min(params.radius);
        while column <= right {
            let dx = column.max(x) - column.min(x);
            let tap_rank = rank_of_pixel(column, row, params.width, params.height);
            column += 1;
            if tap_rank == rank {
                continue;
            }
            let tap = at(guides, tap_rank);
            let exponent = centre.exponent(&tap, (dx * dx + dy * dy) as f32);
            // False for NaN as well.
            if exponent < LARGEST_EXPONENT {
                let weight = exp(-exponent);
                color += tap.color * weight;
                variance += tap.variance * weight;
                weights += weight;
                squared_weights += weight * weight;
                if FOLLOWS && centre.color {
                    let slope = (tap.color - guide.color) * (weight * centre.color_slope(&tap));
                    slopes += slope;
                    sloped_colors += slope.dot(tap.color);
                }
            }
        }
        row += 1;
    }
    let own = 1.0 / weights;
    let color = color * own;
    let follows = (sloped_colors - slopes.dot(color)) * own * (1.0 / 3.0);
    Filtered {
        color,
        variance: variance * own,
        own: (own + follows).max(own).min(1.0),
        shared_noise: (2.0 - squared_weights * own) * own,
    }
}

/// The pixel that is filtered, with all that its neighbours' weights have in common. The factors
/// are of squared differences.
pub struct Centre {
    guide: Guide,
    normal: Vec3,
    pixel_factor: f32,
    position_factor: f32,
    normal_factor: f32,
    albedo_factor: f32,
    color: bool,
    /// Noise below which colours are equal: it keeps equal ones from dividing by zero.
    color_floor: f32,
}

impl Centre {
    /// Of a pixel that is measured.
    pub fn new(params: &FilterParams, guide: &Guide) -> Self {
        let factor = |sigma: f32| 0.5 / (sigma * sigma);
        let normal = unpack_normal(guide.normal);
        let view = guide.position - params.origin;
        let distance = view.length();
        // What one pixel covers on the surface, along its longer side.
        let cosine = (normal.dot(view).abs() / distance).max(SMALLEST_COSINE);
        let footprint = params.pixel_pitch * distance / cosine;
        let rounding = POSITION_ROUNDINGS * UNIT_ROUNDOFF * guide.position.abs().max_element();
        let color_floor = 1e-3 * params.form.mean_radiance;
        Self {
            guide: *guide,
            normal,
            pixel_factor: factor(params.pixel_sigma),
            position_factor: factor((params.position_sigma * footprint).max(rounding)),
            normal_factor: factor(params.normal_sigma),
            albedo_factor: factor(params.albedo_sigma),
            color: params.color != 0,
            color_floor: color_floor * color_floor + f32::MIN_POSITIVE,
        }
    }

    /// The negative logarithm of a neighbour's weight; [`LARGEST_EXPONENT`] or more for those that
    /// do not count.
    #[inline(always)]
    fn exponent(&self, tap: &Guide, squared_pixels: f32) -> f32 {
        if !self.is_comparable(tap) {
            return LARGEST_EXPONENT;
        }
        let mut exponent = self.pixel_factor * squared_pixels;
        if self.guide.has_surface() {
            exponent += self.position_exponent(tap) + self.albedo_exponent(tap);
            if exponent >= LARGEST_EXPONENT {
                return LARGEST_EXPONENT;
            }
            // Most neighbours lie on the same flat surface.
            if tap.normal != self.guide.normal {
                exponent += self.normal_exponent(tap);
            }
        }
        if self.color {
            exponent += self.color_exponent(tap);
        }
        exponent
    }

    /// Whether a neighbour is measured, and shows a surface where the pixel does.
    pub fn is_comparable(&self, tap: &Guide) -> bool {
        tap.is_measured() && tap.has_surface() == self.guide.has_surface()
    }

    /// The negative logarithms of the weights of a neighbour that is comparable, by pixel distance,
    /// world distance, normals and albedos.
    pub fn distances(&self, tap: &Guide, squared_pixels: u32) -> Vec4 {
        let mut distances = Vec4::new(self.pixel_factor * squared_pixels as f32, 0.0, 0.0, 0.0);
        if self.guide.has_surface() {
            distances.y = self.position_exponent(tap);
            if tap.normal != self.guide.normal {
                distances.z = self.normal_exponent(tap);
            }
            distances.w = self.albedo_exponent(tap);
        }
        distances
    }

    fn position_exponent(&self, tap: &Guide) -> f32 {
        self.position_factor * (tap.position - self.guide.position).length_squared()
    }

    fn normal_exponent(&self, tap: &Guide) -> f32 {
        self.normal_factor * (unpack_normal(tap.normal) - self.normal).length_squared()
    }

    fn albedo_exponent(&self, tap: &Guide) -> f32 {
        self.albedo_factor * (tap.albedo - self.guide.albedo).length_squared()
    }

    /// A variance so small that colours which differ by it are equal.
    pub fn color_floor(&self) -> f32 {
        self.color_floor
    }

    /// How clearly two colours differ.
    ///
    /// As Rousselle et al. ("Adaptive Rendering with Non-Local Means Filtering", 2012) have it,
    /// squared differences are measured against the variance that they would have from noise alone,
    /// the sum of both pixels', and what that explains is taken off. They compare patches, where
    /// noise averages out, and take off its expectation; here single pixels are compared, which is
    /// cheaper by the size of a patch, but a filter that preferred those that happen to be alike
    /// would keep the noise. So nothing within [`TOLERANCE`] standard errors counts, and only what
    /// is left falls off as a Gaussian of one standard error. A path of rare brightness raises
    /// difference and variance alike (one sample out of n: to exactly one standard error), so it
    /// spreads to the neighbours that have not found it.
    fn color_exponent(&self, tap: &Guide) -> f32 {
        let noise = self.guide.variance + tap.variance;
        let difference = mean_of_squares(tap.color - self.guide.color);
        let excess = (difference - TOLERANCE * TOLERANCE * noise).max(0.0);
        0.5 * excess / (noise + self.color_floor)
    }

    /// By what [`Self::color_exponent`] falls, over the difference of colours, as the pixel's own
    /// comes closer to that of `tap`.
    fn color_slope(&self, tap: &Guide) -> f32 {
        let noise = self.guide.variance + tap.variance;
        let difference = mean_of_squares(tap.color - self.guide.color);
        if difference > TOLERANCE * TOLERANCE * noise {
            1.0 / (noise + self.color_floor)
        } else {
            0.0
        }
    }
}
