//! The guard: how far a pixel may trust its filter.
//!
//! A filter blurs what it takes for noise. Where the difference between the measured and the
//! filtered picture is no larger than noise explains, the filter is right to do so; where it is
//! larger, the rest is the filter's error, which does not fall with more samples. So each pixel is
//! drawn from its filtered value `f` towards its measured one `x` by
//!
//! ```text
//! f + w (x - f),   w = max(0, 1 - c v / |x - f|^2),
//! ```
//!
//! with the variance `v` of `x` and both it and the squared difference averaged over neighbours.
//! That is shrinkage towards the filtered value (James and Stein 1961; Firmino et al., "Progressive
//! Denoising of Monte Carlo Rendered Images", 2022, mix by estimated errors likewise). As `v` goes
//! to 0, the picture goes to `x` wherever `f` is not it.

use super::PictureParams;
use crate::estimator::Estimate;
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, mean_of_squares};
use crate::glam::{Vec3, Vec4};
use crate::memory::access::{Scatter, at};

/// How many variances of difference count as noise. Two leave a filter that is right alone: the
/// ratio of averages over few pixels is often well above 1.
pub const CAUTION: f32 = 2.0;

/// The least square that is not taken for 0. What averages and quotients make of it are ordinary
/// numbers: devices differ in subnormal ones.
const LEAST_SQUARE: f32 = 1e-30;

/// Kernel: what is averaged for the guard of pixel `lane`, in rows: the squared difference of
/// measured and filtered colour, the variance of the measured one, and 1 for the sum of weights.
/// Zeros where nothing is measured.
pub fn guard_terms(
    lane: u32,
    params: &PictureParams,
    guides: &[Guide],
    filtered: &[FilteredPixel],
    terms: &mut Scatter<'_, Vec4>,
) {
    let (guide, filtered) = (at(guides, lane), at(filtered, lane));
    let value = if guide.is_measured() {
        let difference = mean_of_squares(guide.color - filtered.color);
        Vec4::new(ordinary(difference), ordinary(guide.variance), 0.0, 1.0)
    } else {
        Vec4::ZERO
    };
    terms.set(params.row_index(lane), value);
}

/// Kernel: the picture of pixel `lane` and its squared error, the mean over the components. Both
/// are 0 where nothing is measured.
pub fn guard(
    lane: u32,
    params: &PictureParams,
    guides: &[Guide],
    filtered: &[FilteredPixel],
    blurred: &[Vec4],
    estimate: &mut Estimate,
) {
    let guide = at(guides, lane);
    *estimate = if guide.is_measured() {
        let about = at(blurred, params.row_index(lane));
        guarded(&guide, &at(filtered, lane), about)
    } else {
        Estimate { filtered: Vec3::ZERO, squared_error: 0.0 }
    };
}

/// The picture of a pixel that is measured, with the [terms](guard_terms) `about` it blurred.
///
/// With the part `a` that `x` has in `f`, the squared difference of both has the expectation
/// `F + (1 - 2 a) v`, where `F` is the squared error of `f`; and `F` is at least the pixel's own
/// noise in it, `a^2 v`. The picture's own error follows: `(1 - w)^2 F + w^2 v + 2 w
/// (1 - w) a v`.
///
/// Averages are wrong for a calm pixel beside a noisy one. No picture is worse, on average, than
/// twice its squared difference from `x` and the variance of that.
fn guarded(guide: &Guide, filtered: &FilteredPixel, about: Vec4) -> Estimate {
    let (difference, variance) = (about.x / about.w, about.y / about.w);
    let trust =
        if difference > CAUTION * variance { 1.0 - CAUTION * variance / difference } else { 0.0 };
    let own = filtered.own;
    let error = (difference - (1.0 - 2.0 * own) * variance).max(own * own * variance);
    let rest = 1.0 - trust;
    let variance = guide.variance;
    let error = rest * rest * error + trust * (trust + 2.0 * rest * own) * variance;
    let picture = filtered.color + (guide.color - filtered.color) * trust;
    let bound = 2.0 * (mean_of_squares(picture - guide.color) + variance);
    Estimate { filtered: picture, squared_error: ordinary(error.min(bound)) }
}

/// A square, or 0 for less than the [least](LEAST_SQUARE).
fn ordinary(square: f32) -> f32 {
    if square < LEAST_SQUARE { 0.0 } else { square }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(color: f32, own: f32) -> FilteredPixel {
        FilteredPixel { color: Vec3::splat(color), own }
    }

    fn guide(color: f32, variance: f32) -> Guide {
        Guide { color: Vec3::splat(color), variance, samples: 4, ..Guide::default() }
    }

    #[test]
    fn what_noise_explains_is_filtered_and_the_rest_is_not() {
        let within = guarded(&guide(3.0, 1.0), &picture(1.0, 0.1), Vec4::new(4.0, 2.0, 0.0, 2.0));
        assert_eq!(within.filtered, Vec3::ONE);
        // The difference, 2, is 1.2 more than noise of 0.8 of the variance of 1 explains.
        assert!((within.squared_error - 1.2).abs() < 1e-6, "{within:?}");
        let beyond = guarded(&guide(3.0, 1.0), &picture(1.0, 0.0), Vec4::new(16.0, 2.0, 0.0, 2.0));
        // Of 8, twice 1 is noise: three quarters of the way back to the measured value.
        assert_eq!(beyond.filtered, Vec3::splat(2.5));
        assert!((beyond.squared_error - (7.0 / 16.0 + 9.0 / 16.0)).abs() < 1e-6, "{beyond:?}");
    }

    #[test]
    fn without_noise_the_measured_value_stays() {
        let estimate = guarded(&guide(3.0, 0.0), &picture(1.0, 0.5), Vec4::new(4.0, 0.0, 0.0, 1.0));
        assert_eq!((estimate.filtered, estimate.squared_error), (Vec3::splat(3.0), 0.0));
        let same = guarded(&guide(3.0, 0.0), &picture(3.0, 0.5), Vec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!((same.filtered, same.squared_error), (Vec3::splat(3.0), 0.0));
    }

    #[test]
    fn squares_that_are_hardly_numbers_are_none() {
        // The noise of its neighbours explains all, and of the error no more than its own part of
        // 1e-22 of that noise is left, squared.
        let tiny = guarded(&guide(1e-20, 0.0), &picture(0.0, 1e-22), Vec4::new(0.0, 1.0, 0.0, 1.0));
        assert_eq!((tiny.filtered, tiny.squared_error), (Vec3::ZERO, 0.0));
        assert_eq!([1e-40, 1e-31, 1e-29].map(ordinary), [0.0, 0.0, 1e-29]);
    }
}
