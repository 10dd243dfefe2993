//! What filters look at: the means of the two halves of a pixel's samples, with their variances.
//!
//! A filter that takes its weights from one half and applies them to the other has no preference
//! for noise that happens to be alike (Rousselle et al., "Adaptive Rendering with Non-Local Means
//! Filtering", 2012). What it must know is the variance of a mean. That of the samples by their
//! number is far too large, since samples are stratified: the difference of the halves' means has
//! the right size, but is one random number. So the former is scaled by the ratio of both in the
//! pixel's surroundings (Rousselle et al., "Robust Denoising using Feature and Color Information",
//! 2013).

use super::PictureParams;
use crate::estimator::guide::{Guide, halves_variance, mean_variance};
use crate::film::sums::PixelSums;
use crate::glam::{Vec3, Vec4};
use crate::math::{is_finite, is_finite_vector};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;

/// The variance, as the last component of a half's mean, where nothing is known of the pixel.
pub const UNMEASURED: f32 = -1.0;

/// Bounds of what measured variances are by those of independent samples: fewer pixels than differ
/// in their surroundings can say no more.
const SMALLEST_RATIO: f32 = 1.0 / 64.0;
const LARGEST_RATIO: f32 = 2.0;

device_struct! {
    /// The parameters of [`make_halves`]. 32 bytes.
    pub struct HalvesParams {
        /// Pixels of the band.
        pub threads: u32,
        /// Rank of the first.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// The unit of the film is 2 to this power.
        pub unit_exponent: i32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

/// Kernel: the halves of the pixel `lane` of a band, each as its mean and the variance of that, the
/// mean over the components, as if samples were independent; or [`UNMEASURED`]. A pixel that has
/// samples of one half alone has it twice. `noise`, in rows, gets the variance of the pixel's mean
/// by the difference of the halves, and as if samples were independent; zeros where there is but
/// one half.
pub fn make_halves(
    lane: u32,
    params: &HalvesParams,
    film: &[PixelSums],
    first: &mut Vec4,
    second: &mut Vec4,
    noise: &mut Scatter<'_, Vec4>,
) {
    let pixel = at(film, lane).to_pixel(params.unit_exponent);
    let nothing = Vec3::ZERO.extend(UNMEASURED);
    (*first, *second) = (nothing, nothing);
    let mut measured = Vec4::ZERO;
    let (sum, samples) = (pixel.sum(), pixel.samples());
    if samples > 0 && is_finite_vector(sum) {
        let mean = sum / samples as f32;
        let variance =
            if samples < 2 { mean.dot(mean) * (1.0 / 3.0) } else { mean_variance(&pixel) };
        if is_finite(variance) {
            let of_half = |sum: Vec3, count: u32| {
                let count = count as f32;
                (sum / count).extend(variance * (samples as f32 / count))
            };
            let whole = mean.extend(variance);
            let has_both = pixel.first_samples > 0 && pixel.second_samples > 0;
            if has_both {
                *first = of_half(pixel.first_sum, pixel.first_samples);
                *second = of_half(pixel.second_sum, pixel.second_samples);
                measured = Vec4::new(halves_variance(&pixel), variance, 0.0, 0.0);
            } else {
                (*first, *second) = (whole, whole);
            }
        }
    }
    let HalvesParams { threads, first_rank, width, height, .. } = *params;
    let picture = PictureParams { threads, first_rank, width, height };
    noise.set(picture.row_index(first_rank + lane), measured);
}

/// Kernel: scales the variances of the pixel `lane` of the picture by what `noise`, blurred, says
/// that they are by those of independent samples.
pub fn calibrate(
    lane: u32,
    params: &PictureParams,
    noise: &[Vec4],
    guide: &mut Guide,
    first: &mut Vec4,
    second: &mut Vec4,
) {
    let about = at(noise, params.row_index(lane));
    let ratio = about.x / about.y;
    // False for NaN as well: nothing about the pixel has two halves, or any noise.
    if about.y > 0.0 && is_finite(ratio) {
        let ratio = ratio.clamp(SMALLEST_RATIO, LARGEST_RATIO);
        guide.variance *= ratio;
        if first.w > 0.0 {
            first.w *= ratio;
        }
        if second.w > 0.0 {
            second.w *= ratio;
        }
    }
}

/// The part that the first half has in the pixel's mean, from the variances of both.
pub fn share_of_first(guide: &Guide, first: Vec4) -> f32 {
    if first.w > 0.0 { (guide.variance / first.w).min(1.0) } else { 0.5 }
}
