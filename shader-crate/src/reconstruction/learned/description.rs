//! The description of a pixel: numbers that depend neither on the scene's units nor on how bright
//! it is.

use super::PixelFilter;
use super::network::{self, INPUTS};
use super::surroundings::Surroundings;
use crate::estimator::bilateral::{Centre, FilterParams};
use crate::estimator::guide::{Guide, mean_of_squares};
use crate::glam::Vec4;
use crate::math::elementary::ln;
use crate::math::mean_of_components;
use crate::memory::access::at;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// What is added to ratios before their logarithms: what is far below does not matter.
const SMALL_RATIO: f32 = 0.01;
/// Of a variance, what radiances that are no larger count as.
const SMALL_PART: f32 = 1e-4;
/// Likewise to squared differences of albedos and of normals.
const SMALL_DIFFERENCE: f32 = 1e-4;
/// Numbers of samples that make a difference.
const SAMPLES: [f32; 2] = [2.0, 128.0];
/// Pixels that a description is of, and those of them next to the pixel.
const PIXELS: f32 = 49.0;
/// See [`PIXELS`].
const NEAR_PIXELS: f32 = 9.0;

/// Kernel: the filter of pixel `lane` of the picture, and its smoothed colour with the variance of
/// that as the last component. What is not measured is black without noise.
#[allow(clippy::too_many_arguments, reason = "a kernel's bindings")]
pub fn predict_filters(
    lane: u32,
    params: &FilterParams,
    guides: &[Guide],
    first: &[Vec4],
    second: &[Vec4],
    weights: &[Vec4],
    smoothed: &mut Vec4,
    filter: &mut PixelFilter,
) {
    let description = Description::of(params, guides, first, second, lane);
    *smoothed = description.smoothed;
    *filter = PixelFilter::new(network::evaluate(weights, &description.inputs), description.own);
}

/// What the network, and the filter, are told of a pixel.
pub struct Description {
    /// What the network is told.
    pub inputs: [f32; INPUTS],
    /// The pixel's smoothed colour, and the variance of that.
    pub smoothed: Vec4,
    /// How far that follows the pixel's own colour.
    pub own: f32,
}

impl Description {
    /// Of the pixel of a rank.
    pub fn of(
        params: &FilterParams,
        guides: &[Guide],
        first: &[Vec4],
        second: &[Vec4],
        rank: u32,
    ) -> Self {
        let guide = at(guides, rank);
        if !guide.is_measured() {
            return Self { inputs: [0.0; INPUTS], smoothed: Vec4::ZERO, own: 1.0 };
        }
        let centre = Centre::new(params, &guide);
        let about = Surroundings::of(params, &centre, guides, first, second, rank);
        let halves = [at(first, rank), at(second, rank)];
        Self {
            inputs: inputs(&guide, halves, &about, centre.color_floor()),
            smoothed: guide.color.extend(0.0) + about.smoothed(),
            own: about.own(),
        }
    }
}

/// The description of a pixel that is measured, with what is [about](Surroundings) it; `floor` is a
/// variance below which there is no noise.
fn inputs(guide: &Guide, halves: [Vec4; 2], about: &Surroundings, floor: f32) -> [f32; INPUTS] {
    let Surroundings { near, all, .. } = about;
    let (noise, near_noise, all_noise) =
        (guide.variance + floor, near.noise() + floor, all.noise() + floor);
    let own = mean_of_components(guide.color);
    let mean = own + mean_of_components(all.mean());
    let [first, second] = halves;
    let half_difference = mean_of_squares(first.truncate() - second.truncate());
    let half_noise = first.w.max(0.0) + second.w.max(0.0) + floor;
    [
        ratio(noise, near_noise),
        relative(noise, own),
        relative(all_noise, mean),
        ratio(near_noise, all_noise),
        ratio(near.spread(), near_noise),
        ratio(all.spread(), all_noise),
        signed_logarithm(near.structure() / near_noise),
        signed_logarithm(all.structure() / all_noise),
        ratio(mean_of_squares(near.mean()), noise),
        ratio(mean_of_squares(near.mean() - all.mean()), all_noise),
        ratio(half_difference, half_noise),
        near.weights() * (1.0 / NEAR_PIXELS),
        all.weights() * (1.0 / PIXELS),
        ln(about.albedo_spread() + SMALL_DIFFERENCE),
        ln(about.normal_spread() + SMALL_DIFFERENCE),
        ln((guide.samples as f32).clamp(SAMPLES[0], SAMPLES[1])),
        about.surfaces(),
        ratio(about.largest_noise(), all_noise),
        mean_of_components(guide.albedo),
        signed_logarithm((about.brightest() - mean) / all_noise.sqrt()),
    ]
}

/// The logarithm of a deviation, relative to a radiance, given its square.
fn relative(variance: f32, radiance: f32) -> f32 {
    0.5 * ln(variance / (radiance * radiance + SMALL_PART * variance))
}

fn ratio(a: f32, b: f32) -> f32 {
    ln(a / b + SMALL_RATIO)
}

/// A logarithm of what may be negative.
fn signed_logarithm(x: f32) -> f32 {
    let logarithm = ln(1.0 + x.abs());
    if x < 0.0 { -logarithm } else { logarithm }
}
