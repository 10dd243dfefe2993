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
//! with Gaussian weights `G` of pixel distance, and a **guide** `g`, the standard error of `X`: the
//! deviation of the samples about a pixel by the root of the pixel's own count. So pixel `q` gives
//! what it is short of to its neighbours, most of it to those that are as noisy as itself and have
//! had few samples, for these are the ones that counts have biased: none to a white wall beside a
//! caustic, and little to pixels of the caustic that have long been found. The noise of `Y` goes the
//! same way, so that every pixel's grows by the same small part of what it has already.
//!
//! What is proved: for each `q` the weights add up to 1, so the sums of `Z` and of `Y` over the
//! picture are the same number, and the expectation of `Y` is the true one. What is not: the bias
//! of a single pixel. What is left of it is finer than the Gaussian and follows another pattern
//! than the guide.

use crate::film::FilmPixel;
use crate::film::tiles::pixel_of_rank;
use crate::glam::{Vec3, Vec4};
use crate::math::is_finite_vector;
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

device_struct! {
    /// The parameters of a pass over the pixels of a control film. 32 bytes.
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
        /// Unused; zero.
        pub pad: u32,
    }
}

/// Pixels to each side over which the variance of samples is averaged for a guide: that of few
/// samples is 0 where a rare bright path is still to be found.
const GUIDE_RADIUS: u32 = 2;

/// Kernel: what the control film differs by from the picture in pixel `lane` of a band, and the
/// variance of the pixel's samples, the mean over the components, as the last component; 0 where
/// one of the halves has no samples. Its count goes into the last component of `counts`. Both are in
/// rows, as in the passes after this.
pub fn control_differences(
    lane: u32,
    params: &ControlParams,
    film: &[FilmPixel],
    differences: &mut Scatter<'_, Vec4>,
    counts: &mut Scatter<'_, Vec4>,
) {
    let (x, y) = pixel_of_rank(params.first_rank + lane, params.width, params.height);
    let (place, pixel) = (y * params.width + x, at(film, lane));
    differences.set(place, difference(&pixel));
    counts.set(place, Vec4::ZERO.with_w(pixel.samples() as f32));
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
    difference.extend((variances.dot(Vec3::ONE) * (1.0 / 3.0)).max(0.0))
}

/// Kernel: the difference of pixel `lane` with its guide, in the place of its count.
pub fn control_guides(lane: u32, params: &ControlParams, differences: &[Vec4], guided: &mut Vec4) {
    let (x, y) = (lane % params.width, lane / params.width);
    let right = (x + GUIDE_RADIUS).min(params.width - 1);
    let bottom = (y + GUIDE_RADIUS).min(params.height - 1);
    let (mut sum, mut weights) = (0.0, 0.0);
    let mut row = y - y.min(GUIDE_RADIUS);
    while row <= bottom {
        let mut column = x - x.min(GUIDE_RADIUS);
        while column <= right {
            // Binomial weights: 6, 4, 1.
            let weight =
                binomial(row.max(y) - row.min(y)) * binomial(column.max(x) - column.min(x));
            sum += weight * at(differences, row * params.width + column).w;
            weights += weight;
            column += 1;
        }
        row += 1;
    }
    let guide = (sum / (weights * guided.w.max(1.0))).sqrt();
    *guided = at(differences, lane).truncate().extend(guide);
}

fn binomial(distance: u32) -> f32 {
    if distance == 0 {
        6.0
    } else if distance == 1 {
        4.0
    } else {
        1.0
    }
}

/// Kernel: the sum of values along the row or the column of pixel `lane`, by Gaussian weights that
/// are 1 at the pixel itself.
pub fn blur(lane: u32, params: &ControlParams, values: &[Vec4], sum: &mut Vec4) {
    let (x, y) = (lane % params.width, lane / params.width);
    let (place, end, step) = if params.along_rows != 0 {
        (x, params.width, 1)
    } else {
        (y, params.height, params.width)
    };
    let reach = place.min(params.radius);
    let last = (place + params.radius).min(end - 1);
    let (mut tap, mut index) = (place - reach, lane - reach * step);
    let mut total = Vec4::ZERO;
    while tap <= last {
        let distance = tap as f32 - place as f32;
        total += at(values, index) * (-params.factor * distance * distance).exp();
        tap += 1;
        index += step;
    }
    *sum = total;
}

/// Kernel: the difference of pixel `lane` over what the guides of all that it gives to add up to,
/// the blurred ones.
pub fn control_shares(
    lane: u32,
    _: &ControlParams,
    guided: &[Vec4],
    blurred: &[Vec4],
    share: &mut Vec4,
) {
    let guides = at(blurred, lane).w;
    *share = if guides > 0.0 { at(guided, lane) / guides } else { Vec4::ZERO };
}

/// Kernel: what is to be added to the picture in pixel `lane`: its guide's part of all that it is
/// given, the blurred shares. The last component is 0.
pub fn control_corrections(
    lane: u32,
    _: &ControlParams,
    guided: &[Vec4],
    blurred: &[Vec4],
    correction: &mut Vec4,
) {
    *correction = (at(blurred, lane).truncate() * at(guided, lane).w).extend(0.0);
}
