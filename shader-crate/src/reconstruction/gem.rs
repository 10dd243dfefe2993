//! The filter `gem`: of several Gaussians, for each pixel the widest to which every step from the
//! one before has paid (Rousselle, Knaus, Zwicker, "Adaptive Sampling and Reconstruction using
//! Greedy Error Minimization", 2011).
//!
//! From one scale to the next coarser one a pixel loses noise, the difference of the variances of
//! both means, and gains bias. The squared difference of the means, by how their widths differ,
//! says how much. The first step of which the loss outweighs the gain is where a pixel stops. A
//! single pixel's step is a number by chance, so it stops only where the most of its surroundings
//! do.
//!
//! It looks at nothing but colours, and at each scale once: no other filter is as fast for its
//! width.

use super::PictureParams;
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, mean_of_squares};
use crate::glam::{Vec3, Vec4};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;

/// How much of a loss is taken for one, of many samples: `-ln(1 - (1.9 gamma)^(1/sqrt 2))` with the
/// paper's `gamma` of 0.2.
const CAUTION: f32 = 0.702;

device_struct! {
    /// The parameters of a step from one scale to the next. 32 bytes.
    pub struct ScaleParams {
        /// Pixels of the picture.
        pub threads: u32,
        /// Unused; zero.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// What squared differences of two scales are multiplied by to be the bias of the coarser
        /// one: `(c^2 + f^2) / (c^2 - f^2)` of the standard deviations `c` of the coarser and `f`
        /// of the finer one.
        pub bias: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

impl ScaleParams {
    fn row_index(&self, rank: u32) -> u32 {
        let Self { threads, width, height, .. } = *self;
        PictureParams { threads, first_rank: 0, width, height }.row_index(rank)
    }
}

/// Kernel: the finest scale, the pixels themselves. `colors` and `variances`, in rows, get the mean
/// and the variance of pixel `lane` for the blurs to come, each with 1 for the sum of weights;
/// zeros where nothing is measured. The mean is `filtered`, and its scale is not settled.
pub fn begin_scales(
    lane: u32,
    params: &PictureParams,
    guides: &[Guide],
    filtered: &mut FilteredPixel,
    is_settled: &mut u32,
    colors: &mut Scatter<'_, Vec4>,
    variances: &mut Scatter<'_, Vec4>,
) {
    let guide = at(guides, lane);
    let (mut color, mut variance) = (Vec4::ZERO, Vec4::ZERO);
    *filtered = FilteredPixel { color: Vec3::ZERO, own: 1.0 };
    *is_settled = 1;
    if guide.is_measured() {
        color = guide.color.extend(1.0);
        variance = Vec4::new(guide.variance, guide.samples as f32, 0.0, 1.0);
        filtered.color = guide.color;
        *is_settled = 0;
    }
    let place = params.row_index(lane);
    colors.set(place, color);
    variances.set(place, variance);
}

/// Kernel: whether pixel `lane`, a place in rows, would stop before the coarser of two scales, 1 or
/// 0 in the first component, and 1 in the last for the sum of weights; zeros where nothing is
/// measured. Colours are sums over pixels by the weights of a scale, variances by the squares of
/// these.
pub fn judge_scale(
    lane: u32,
    params: &ScaleParams,
    finer_colors: &[Vec4],
    finer_variances: &[Vec4],
    coarser_colors: &[Vec4],
    coarser_variances: &[Vec4],
    stop: &mut Vec4,
) {
    let (finer, coarser) = (at(finer_colors, lane), at(coarser_colors, lane));
    *stop = Vec4::ZERO;
    if finer.w > 0.0 && coarser.w > 0.0 {
        let (noise, less_noise) = (at(finer_variances, lane), at(coarser_variances, lane));
        let difference = finer.truncate() / finer.w - coarser.truncate() / coarser.w;
        let loss = params.bias * mean_of_squares(difference);
        let gain = noise.x / (finer.w * finer.w) - less_noise.x / (coarser.w * coarser.w);
        let samples = less_noise.y.max(1.0);
        let stops = CAUTION * (1.0 - 1.0 / samples) * loss >= gain;
        *stop = Vec4::new(if stops { 1.0 } else { 0.0 }, 0.0, 0.0, 1.0);
    }
}

/// Kernel: takes pixel `lane` to the coarser scale, unless it has stopped, or stops here: where it
/// [would](judge_scale) and at least half of the others about it would, too, by `blurred`.
pub fn take_scale(
    lane: u32,
    params: &ScaleParams,
    stops: &[Vec4],
    blurred: &[Vec4],
    coarser_colors: &[Vec4],
    filtered: &mut FilteredPixel,
    is_settled: &mut u32,
) {
    let place = params.row_index(lane);
    if *is_settled == 0 {
        let (stop, about) = (at(stops, place), at(blurred, place));
        // Without the pixel itself, whose weight is 1.
        let (others, all) = (about.x - stop.x, about.w - stop.w);
        if stop.x > 0.0 && others >= 0.5 * all {
            *is_settled = 1;
        } else {
            let coarser = at(coarser_colors, place);
            if coarser.w > 0.0 {
                *filtered = FilteredPixel {
                    color: coarser.truncate() / coarser.w,
                    own: 1.0 / coarser.w.max(1.0),
                };
            }
        }
    }
}
