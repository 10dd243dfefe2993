//! The filter that the network's outputs are the parameters of.

use super::PixelFilter;
use crate::estimator::bilateral::{Centre, FilterParams, LARGEST_EXPONENT};
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, mean_of_squares};
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::{Vec3, Vec4};
use crate::math::dot;
use crate::math::elementary::exp;
use crate::memory::access::at;

/// Kernel: the filtered colour of pixel `lane` of the picture, by its own filter; black where
/// nothing is measured.
pub fn filter_by_pixel(
    lane: u32,
    params: &FilterParams,
    guides: &[Guide],
    smoothed: &[Vec4],
    filters: &[PixelFilter],
    filtered: &mut FilteredPixel,
) {
    *filtered = if at(guides, lane).is_measured() {
        filter(params, guides, smoothed, &at(filters, lane), lane)
    } else {
        FilteredPixel { color: Vec3::ZERO, own: 1.0 }
    };
}

/// Filters the pixel of a rank, which is measured.
///
/// The part `own` is the derivative by the pixel's own colour, also of the weights, which look at
/// it; but not of the network, and not of neighbours' smoothed colours.
pub fn filter(
    params: &FilterParams,
    guides: &[Guide],
    smoothed: &[Vec4],
    filter: &PixelFilter,
    rank: u32,
) -> FilteredPixel {
    let guide = at(guides, rank);
    let centre = Centre::new(params, &guide);
    let floor = centre.color_floor();
    let smooth = at(smoothed, rank);
    let (x, y) = pixel_of_rank(rank, params.width, params.height);
    let right = (x + params.radius).min(params.width - 1);
    let bottom = (y + params.radius).min(params.height - 1);
    let (mut color, mut weights) = (guide.color, 1.0);
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
            if !centre.is_comparable(&tap) {
                continue;
            }
            let mut exponent = dot(filter.features, centre.distances(&tap, dx * dx + dy * dy));
            if exponent < LARGEST_EXPONENT {
                let raw = Contrast::of(
                    guide.color.extend(guide.variance),
                    tap.color.extend(tap.variance),
                    floor,
                );
                let smooth = Contrast::of(smooth, at(smoothed, tap_rank), floor);
                let colors = filter.colors;
                exponent += raw.exponent(colors.x, colors.y) + smooth.exponent(colors.z, colors.w);
                // False for NaN as well.
                if exponent < LARGEST_EXPONENT {
                    let weight = exp(-exponent);
                    color += tap.color * weight;
                    weights += weight;
                    let slope = slope(filter, &raw, &smooth) * weight;
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
    FilteredPixel { color, own: (own + follows).max(own).min(1.0) }
}

/// By how much the exponent falls as the pixel's own colour comes closer to the tap's.
fn slope(filter: &PixelFilter, raw: &Contrast, smooth: &Contrast) -> Vec3 {
    let colors = filter.colors;
    raw.slope(colors.x, colors.y) + smooth.slope(colors.z, colors.w) * filter.own
}

/// What two colours differ by.
pub struct Contrast {
    difference: Vec3,
    /// The square of it, the mean over the components, by the variance that it has from noise.
    pub by_noise: f32,
    /// That variance, and a bit to keep equal colours from dividing by zero.
    noise: f32,
    /// The part of `noise` that is one.
    pub part: f32,
}

impl Contrast {
    /// Of two colours, whose last components are their variances.
    pub fn of(own: Vec4, tap: Vec4, floor: f32) -> Self {
        let difference = tap.truncate() - own.truncate();
        let variance = own.w + tap.w;
        let noise = variance + floor;
        Self {
            difference,
            by_noise: mean_of_squares(difference) / noise,
            noise,
            part: variance / noise,
        }
    }

    /// The negative logarithm of the factor of a weight, see [`PixelFilter::colors`].
    pub fn exponent(&self, slope: f32, tolerance: f32) -> f32 {
        slope * (self.by_noise - tolerance * self.part).max(0.0)
    }

    /// By what that falls as the own colour comes closer to the tap's, the sum over the components.
    fn slope(&self, slope: f32, tolerance: f32) -> Vec3 {
        if self.by_noise > tolerance * self.part {
            self.difference * (2.0 * slope / self.noise)
        } else {
            Vec3::ZERO
        }
    }
}
