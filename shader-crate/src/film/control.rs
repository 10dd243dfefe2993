//! The control film: what takes the bias out of an adaptive picture.
//!
//! Where values decide how many samples a pixel gets, its mean `X` over all of them is biased:
//! a pixel that has missed its bright paths so far looks calm and is left at that (Kirk and Arvo,
//! "Unbiased sampling techniques for image synthesis", 1991). The means `Y` of the first half of
//! the samples are not, where that half has had as many samples in every pixel, decided by nobody's
//! values: the **control film**. It is noisier, but all of it together knows what is missing:
//! `h = Y - X`. The picture is
//!
//! ```text
//! Z_p = X_p + sum over q of w_pq h_q,   w_pq = g_p G_pq / (sum over r of g_r G_rq),
//! ```
//!
//! with Gaussian weights `G` of pixel distance, and a **guide** `g`, the root of the standard error
//! of `X`: of the deviation of the samples around a pixel by the root of the pixel's own count. So
//! pixel `q` gives what it is short of to its neighbours, most of it to those that are as noisy as
//! itself and have had few samples, for these are the ones that counts have biased: little to a
//! white wall beside a caustic, and little to pixels of the caustic that have long been found. The
//! root stands between the standard error itself, by which light flows from where bright paths are
//! still to be found to where they have been, and no guide at all, by which noise flows into calm
//! pixels.
//!
//! How wide `G` is depends on the pixel that gives. Of the variance of `Y_q` the part
//! `1 / (4 pi sigma^2)` gets into the picture, and `Y_q` has as many times the variance of `X_q` as
//! `q` has samples for each of the control film's. Where these are few, the difference goes to the
//! next pixels, so that the bias is taken out where it is; where they are many, it is spread over
//! more: [`control_shares`] is run once for each **level** of such ratios, of which each has a
//! Gaussian of its own.
//!
//! Light that is as rare as it is bright, such as the sun in a drop of water, makes differences
//! that no noise around would hide: a stain about each such pixel. A pixel therefore gives away at
//! most what changes its neighbours by [`ControlParams::bound`] standard errors, of which the mean
//! around it counts ([`control_errors`]), and keeps the rest: there it is right on average, too.
//!
//! What is proved: for each `q` the weights, with that of `q` for what it keeps, add up to 1. So
//! the sums of `Z` and of `Y` over the picture are the same number, and the expectation of `Y` is
//! the true one. What is not: the bias of a single pixel. What is left of it is finer than the
//! Gaussian and follows another pattern than the guide.

use crate::film::FilmPixel;
use crate::film::sums::PixelSums;
use crate::film::tiles::pixel_of_rank;
use crate::glam::Vec4;
use crate::math::elementary::exp;
use crate::math::{is_finite_vector, mean_of_components};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Weights of a Gaussian beside a pixel that are less than this together are roundings: those next
/// to what is left out are larger.
const LEAST_WEIGHT: f32 = 1e-3;

device_struct! {
    /// The parameters of a pass over the pixels of a control film. 48 bytes.
    pub struct ControlParams {
        /// Pixels of the pass.
        pub threads: u32,
        /// Rank of the first pixel of the film that is bound.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// 1: [`blur`] goes along rows; 0: along columns.
        pub along_rows: u32,
        /// Pixels to each side that [`blur`] sees.
        pub radius: u32,
        /// Its weights are `exp(-factor d^2)` of the distance `d` in pixels.
        pub factor: f32,
        /// The level has the pixels with this many samples or more for each of the control film's;
        /// the first level begins at 0.
        pub lowest: f32,
        /// And with fewer than this many.
        pub end: f32,
        /// The unit of the film is 2 to this power.
        pub unit_exponent: i32,
        /// Standard errors by which a pixel changes its neighbours at most.
        pub bound: f32,
        /// Unused; zero.
        pub pad0: u32,
    }
}

/// Kernel: what the control film differs by from the picture in pixel `lane` of a band, and as the
/// last component the deviation of the pixel's samples, the root of the mean variance of the
/// components; 0 where one of the halves has no samples. The last two components of `counts` become
/// the pixel's samples for each of the control film's, and its samples. Both are in rows, as in the
/// passes after this.
pub fn control_differences(
    lane: u32,
    params: &ControlParams,
    film: &[PixelSums],
    differences: &mut Scatter<'_, Vec4>,
    counts: &mut Scatter<'_, Vec4>,
) {
    let (x, y) = pixel_of_rank(params.first_rank + lane, params.width, params.height);
    let (place, pixel) = (y * params.width + x, at(film, lane).to_pixel(params.unit_exponent));
    let samples = pixel.samples() as f32;
    let ratio = samples / pixel.first_samples.max(1) as f32;
    differences.set(place, difference(&pixel));
    counts.set(place, Vec4::new(0.0, 0.0, ratio, samples));
}

fn difference(pixel: &FilmPixel) -> Vec4 {
    if pixel.first_samples == 0 || pixel.second_samples == 0 {
        return Vec4::ZERO;
    }
    let n = pixel.samples() as f32;
    let mean = pixel.sum() / n;
    let difference = pixel.first_sum / pixel.first_samples as f32 - mean;
    let variances = pixel.sum_of_squares / n - mean * mean;
    if !is_finite_vector(difference) || !is_finite_vector(variances) {
        return Vec4::ZERO;
    }
    difference.extend(mean_of_components(variances).max(0.0).sqrt())
}

/// Kernel: the difference of pixel `lane` with its guide. `blurred` are the differences blurred
/// along rows; the deviations, their last components, are here blurred along columns, too: that of
/// few samples is 0 where a rare bright path is still to be found. (Variances, averaged, would let
/// an edge decide for all that is near it.) Of the counts the ratio is kept, as the last component,
/// behind a correction of nothing. What is left of the difference, as its last component, is the
/// standard error of the pixel by its own samples alone.
pub fn control_guides(
    lane: u32,
    params: &ControlParams,
    blurred: &[Vec4],
    difference: &mut Vec4,
    counts: &mut Vec4,
    guided: &mut Vec4,
) {
    let (x, y) = (lane % params.width, lane / params.width);
    let weights = total_weight(params, x, params.width) * total_weight(params, y, params.height);
    let first = lane - y.min(params.radius) * params.width;
    let sum = gaussian_sum(params, blurred, y, params.height, first, params.width);
    let samples_root = counts.w.max(1.0).sqrt();
    let standard_error = sum.w / (weights * samples_root);
    *guided = difference.truncate().extend(standard_error.sqrt());
    *counts = Vec4::ZERO.with_w(counts.z);
    *difference = Vec4::ZERO.with_w(difference.w / samples_root);
}

/// Kernel: the mean standard error around pixel `lane`, without it and those that touch it, since a
/// bright spot may lie on their borders. `errors` are those of pixels by their own samples alone,
/// as last components, and `blurred` the same along rows, by the Gaussian that makes guides.
pub fn control_errors(
    lane: u32,
    params: &ControlParams,
    errors: &[Vec4],
    blurred: &[Vec4],
    around: &mut f32,
) {
    let (x, y) = (lane % params.width, lane / params.width);
    let first = lane - y.min(params.radius) * params.width;
    let mut sum = gaussian_sum(params, blurred, y, params.height, first, params.width).w;
    let mut weights =
        total_weight(params, x, params.width) * total_weight(params, y, params.height);
    let mut row = y - y.min(1);
    while row <= (y + 1).min(params.height - 1) {
        let mut column = x - x.min(1);
        while column <= (x + 1).min(params.width - 1) {
            let weight = weight(params, column, x) * weight(params, row, y);
            sum -= weight * at(errors, row * params.width + column).w;
            weights -= weight;
            column += 1;
        }
        row += 1;
    }
    // In a picture that is no larger there is nobody around.
    *around = if weights > LEAST_WEIGHT { (sum / weights).max(0.0) } else { 0.0 };
}

/// What the weights of a blur add up to at `place` of a row or column of `len` pixels.
fn total_weight(params: &ControlParams, place: u32, len: u32) -> f32 {
    let last = (place + params.radius).min(len - 1);
    let mut tap = place - place.min(params.radius);
    let mut total = 0.0;
    while tap <= last {
        total += weight(params, tap, place);
        tap += 1;
    }
    total
}

fn weight(params: &ControlParams, tap: u32, place: u32) -> f32 {
    let distance = tap as f32 - place as f32;
    exp(-params.factor * distance * distance)
}

/// Kernel: the sum of values along the row or the column of pixel `lane`, by Gaussian weights that
/// are 1 at the pixel itself.
pub fn blur(lane: u32, params: &ControlParams, values: &[Vec4], sum: &mut Vec4) {
    let (x, y) = (lane % params.width, lane / params.width);
    let (place, len, step) = if params.along_rows != 0 {
        (x, params.width, 1)
    } else {
        (y, params.height, params.width)
    };
    let first = lane - place.min(params.radius) * step;
    *sum = gaussian_sum(params, values, place, len, first, step);
}

/// The weighted sum of the values around `place` of a row or column of `len` pixels: the first that
/// the blur sees has the index `first`, each next one is `step` further.
fn gaussian_sum(
    params: &ControlParams,
    values: &[Vec4],
    place: u32,
    len: u32,
    first: u32,
    step: u32,
) -> Vec4 {
    let last = (place + params.radius).min(len - 1);
    let (mut tap, mut index) = (place - place.min(params.radius), first);
    let mut total = Vec4::ZERO;
    while tap <= last {
        total += at(values, index) * weight(params, tap, place);
        tap += 1;
        index += step;
    }
    total
}

/// Kernel: what pixel `lane` gives away over what the guides of all that it gives to add up to, the
/// blurred ones; nothing where the pixel, by the last component of `correction`, is of another
/// level. What neighbours with the guide of the pixel are given is at most the bound in standard
/// errors, of which the mean is `around` it. The rest of the difference is the pixel's own
/// correction.
pub fn control_shares(
    lane: u32,
    params: &ControlParams,
    guided: &[Vec4],
    blurred: &[Vec4],
    around: &[f32],
    correction: &mut Vec4,
    share: &mut Vec4,
) {
    let (ratio, guides) = (correction.w, at(blurred, lane).w);
    *share = Vec4::ZERO;
    if ratio < params.lowest || ratio >= params.end || guides <= 0.0 {
        return;
    }
    let own = at(guided, lane);
    let (difference, guide) = (own.truncate(), own.w);
    let (largest, bound) =
        (difference.abs().max_element() * guide, params.bound * at(around, lane) * guides);
    let part = if largest > bound { bound / largest } else { 1.0 };
    *correction += (difference * (1.0 - part)).extend(0.0);
    *share = own * (part / guides);
}

/// Kernel: adds to what is to be added to the picture in pixel `lane` its guide's part of all that
/// it is given, the blurred shares of a level.
pub fn control_corrections(
    lane: u32,
    _: &ControlParams,
    guided: &[Vec4],
    blurred: &[Vec4],
    correction: &mut Vec4,
) {
    *correction += (at(blurred, lane).truncate() * at(guided, lane).w).extend(0.0);
}
