//! Estimates of a pixel's error, and what allocators and the stop of a render make of them.
//!
//! An estimator gives an [`Estimate`]: a picture, and the squared error of the measured one.
//! [`ErrorForm::of`] turns it into the number that allocators go by. The estimator `bilateral` is
//! in [`bilateral`], those by other filters in [`filtered`]; `halves` and `variance` are here.

pub mod bilateral;
pub mod filtered;
pub mod guide;
pub mod unseen;

use crate::estimator::guide::Guide;
use crate::film::sums::PixelSums;
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::Vec3;
use crate::math::{is_finite, mean_of_components};
use crate::memory::access::at;
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// The error that allocators take as "no more samples": any number below 0, but for -1. Mesa makes
/// of a choice between 0 and -1 the negative of a truth value, which has a zero of the other sign.
pub const CONVERGED: f32 = -2.0;

/// The soft floor of relative errors, in mean radiances of the picture. Pixels much darker than
/// this count by their absolute error: a viewer adapted to the picture does not see noise there,
/// and nothing black divides by zero.
pub const SOFT_FLOOR: f32 = 0.1;

/// Samples from which a pixel's own variance says whether it has converged. That of fewer is itself
/// very uncertain, and 0 where a rare bright path is still to be found.
pub const TRUSTED_SAMPLES: u32 = 64;

device_struct! {
    /// What an estimator thinks of one pixel. 16 bytes.
    pub struct Estimate {
        /// The filtered picture (or the mean radiance, where the estimator filters nothing), linear
        /// Rec.709.
        pub filtered: Vec3,
        /// Estimated squared error of the pixel's mean radiance: the mean over the components, in
        /// squared radiance.
        pub squared_error: f32,
    }
}

device_struct! {
    /// How the allocators' error follows from an estimate. 16 bytes.
    pub struct ErrorForm {
        /// Samples that the coming round gives a pixel on average, where allocators go by what
        /// these take away; 0 where they go by deviations of samples.
        pub samples_of_round: f32,
        /// Mean radiance of the whole picture, over pixels and components; scales the
        /// [`SOFT_FLOOR`].
        pub mean_radiance: f32,
        /// Relative error at which a pixel has converged; 0 for never.
        pub noise: f32,
        /// 1: allocators go by relative errors; 0: by absolute ones.
        pub relative: u32,
    }
}

impl ErrorForm {
    /// The allocators' error of the pixel `guide`, whose samples took `rays` rays; or
    /// [`CONVERGED`]; or 0 where that is not finite.
    ///
    /// By what the coming round takes away, it is the squared error `E`, absolute or relative,
    /// times the part of it that would go if the pixel got its average share (Podee et al.,
    /// equation 1). By deviations it is `sqrt(E n / c)`, with `n` samples of `c` rays each: were
    /// `E` the variance of the mean, then `sqrt(E n)` would be the deviation of one sample, and
    /// counts in proportion to `sqrt(E n / c)` would leave the least squared error that so many
    /// rays can.
    ///
    /// `spread` is another estimate of the squared error, and a pixel of few samples has converged
    /// when both are small: an estimate that is one random number squared is often small by chance.
    /// Both look at neighbours, which may be noisy for ever when they have converged by their own
    /// brightness. So from [`TRUSTED_SAMPLES`] on the pixel's own variance decides alone, which its
    /// own samples bring down: every pixel converges.
    pub fn of(&self, estimate: &Estimate, spread: f32, guide: &Guide, rays: u32) -> f32 {
        let relative =
            relative_error(estimate.filtered, estimate.squared_error, self.mean_radiance);
        let doubtful = relative_error(estimate.filtered, spread, self.mean_radiance);
        if !is_finite(relative) || !is_finite(doubtful) {
            return 0.0;
        }
        let worst = if guide.samples < TRUSTED_SAMPLES {
            relative.max(doubtful)
        } else {
            relative_error(guide.color, guide.variance, self.mean_radiance)
        };
        let worst = worst.max(unseen_light(guide));
        if self.noise > 0.0 && worst <= self.noise * self.noise {
            return CONVERGED;
        }
        let current = if self.relative != 0 { relative } else { estimate.squared_error };
        let n = guide.samples as f32;
        let error = if self.samples_of_round > 0.0 {
            current * (self.samples_of_round / (self.samples_of_round + n))
        } else {
            n * (current / rays.max(1) as f32).sqrt()
        };
        let error = if is_finite(error) { error } else { 0.0 };
        // Who is still to find light has not converged, even where nothing else is known.
        if unseen_light(guide) > 0.0 { error.max(f32::MIN_POSITIVE) } else { error }
    }
}

/// The squared error of a pixel that has found no light, relative to the [`SOFT_FLOOR`]: `3 / n`
/// for `n` samples. That none of `n` samples is bright says, with a confidence of 95 %, that at
/// most `3 / n` of them would be (the rule of three). 0 where there is nothing to find: the pixel
/// has found light, or shows no surface that reflects any.
pub fn unseen_light(guide: &Guide) -> f32 {
    let is_dark = guide.color == Vec3::ZERO && guide.has_surface();
    if is_dark && guide.albedo != Vec3::ZERO { 3.0 / guide.samples as f32 } else { 0.0 }
}

impl ErrorForm {
    /// [`unseen_light`] in squared radiance.
    pub fn unseen_light(&self, guide: &Guide) -> f32 {
        let floor = SOFT_FLOOR * self.mean_radiance;
        unseen_light(guide) * floor * floor
    }
}

/// A squared error over the squared brightness of its pixel, which is softly kept from being far
/// below the picture's `mean_radiance`.
pub fn relative_error(color: Vec3, squared_error: f32, mean_radiance: f32) -> f32 {
    let radiance = mean_of_components(color);
    let floor = SOFT_FLOOR * mean_radiance;
    // No error is none, however dark it is.
    if squared_error == 0.0 { 0.0 } else { squared_error / (radiance * radiance + floor * floor) }
}

device_struct! {
    /// The parameters of [`noise_errors`]. 48 bytes.
    pub struct NoiseParams {
        /// Pixels to estimate.
        pub threads: u32,
        /// Rank of the first; film, estimates and errors that are bound start there.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// What becomes of the estimate.
        pub form: ErrorForm,
        /// 1: squared errors are averaged over 3x3 pixels; 0: each pixel's own.
        pub smooth: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

/// Kernel: the estimators `halves` and `variance`, whichever variance the guides have.
///
/// The variance of a few samples is itself very uncertain: a pixel that has not yet found a rare
/// bright path looks converged. Its neighbours are likely to have found it.
pub fn noise_errors(
    lane: u32,
    params: &NoiseParams,
    guides: &[Guide],
    film: &[PixelSums],
    estimate: &mut Estimate,
    error: &mut f32,
) {
    let rank = params.first_rank + lane;
    let guide = at(guides, rank);
    let mut result = Estimate { filtered: guide.color, squared_error: 0.0 };
    let mut number = 0.0;
    if guide.is_measured() {
        let variance = if params.smooth != 0 {
            smoothed_variance(guides, rank, params.width, params.height)
        } else {
            guide.variance
        };
        result.squared_error = params.form.unseen_light(&guide).max(variance);
        number = params.form.of(&result, guide.variance, &guide, at(film, lane).rays);
    }
    *estimate = result;
    *error = number;
}

/// The variance about a pixel that is measured: averaged over 3x3 pixels, by the weights 1, 2, 1
/// along each axis, of which those outside the picture and those without a measurement are left
/// out.
fn smoothed_variance(guides: &[Guide], rank: u32, width: u32, height: u32) -> f32 {
    let (x, y) = pixel_of_rank(rank, width, height);
    let along = |middle: bool| if middle { 2.0 } else { 1.0 };
    let (right, bottom) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
    let (mut sum, mut weights) = (0.0, 0.0);
    let mut row = y - y.min(1);
    while row <= bottom {
        let mut column = x - x.min(1);
        while column <= right {
            let guide = at(guides, rank_of_pixel(column, row, width, height));
            if guide.is_measured() {
                let weight = along(column == x) * along(row == y);
                sum += weight * guide.variance;
                weights += weight;
            }
            column += 1;
        }
        row += 1;
    }
    sum / weights
}

device_struct! {
    /// The parameters of [`total_errors`]. 16 bytes.
    pub struct TotalParams {
        /// Partial sums.
        pub threads: u32,
        /// Pixels of the picture.
        pub pixels: u32,
        /// As [`ErrorForm::mean_radiance`].
        pub mean_radiance: f32,
        /// Unused; zero.
        pub pad: u32,
    }
}

device_struct! {
    /// A partial sum over pixels. 16 bytes.
    pub struct ErrorTotal {
        /// Sum of relative squared errors, whatever form the allocators go by.
        pub relative_error: f32,
        /// Sum of the estimates' radiance, its mean over the components.
        pub radiance: f32,
        /// Pixels that have not converged: those with an error above 0.
        pub unconverged: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

/// Kernel: the sum over every `threads`-th pixel, from pixel `lane` on.
pub fn total_errors(
    lane: u32,
    params: &TotalParams,
    estimates: &[Estimate],
    errors: &[f32],
    total: &mut ErrorTotal,
) {
    let (mut relative, mut radiance, mut unconverged) = (0.0, 0.0, 0);
    let mut pixel = lane;
    while pixel < params.pixels {
        let estimate = at(estimates, pixel);
        let error = relative_error(estimate.filtered, estimate.squared_error, params.mean_radiance);
        if is_finite(error) {
            relative += error;
        }
        radiance += mean_of_components(estimate.filtered);
        if at(errors, pixel) > 0.0 {
            unconverged += 1;
        }
        pixel += params.threads;
    }
    *total = ErrorTotal { relative_error: relative, radiance, unconverged, pad: 0 };
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORM: ErrorForm =
        ErrorForm { samples_of_round: 3.0, mean_radiance: 2.0, noise: 0.0, relative: 0 };

    fn estimate(radiance: f32, squared_error: f32) -> Estimate {
        Estimate { filtered: Vec3::new(0.0, radiance, 2.0 * radiance), squared_error }
    }

    /// A pixel whose own variance is large.
    fn guide(samples: u32) -> Guide {
        Guide { color: Vec3::ONE, variance: 100.0, samples, ..Guide::default() }
    }

    fn close(a: f32, b: f32) {
        assert!((a - b).abs() <= 4.0 * f32::EPSILON * b.abs(), "{a} and {b}");
    }

    #[test]
    fn the_error_is_what_a_round_takes_away() {
        close(FORM.of(&estimate(1.0, 8.0), 8.0, &guide(5), 7), 8.0 * 3.0 / (3.0 + 5.0));
        close(FORM.of(&estimate(1.0, 8.0), 0.0, &guide(1000), 7), 8.0 * 3.0 / 1003.0);
        assert_eq!(FORM.of(&estimate(1.0, 0.0), 0.0, &guide(5), 7), 0.0);
    }

    #[test]
    fn or_the_deviation_of_what_a_ray_buys() {
        let form = ErrorForm { samples_of_round: 0.0, ..FORM };
        // Variance 40 of a sample, over 4 rays for each.
        close(form.of(&estimate(1.0, 8.0), 8.0, &guide(5), 20), 10_f32.sqrt());
        assert_eq!(form.of(&estimate(1.0, 8.0), 8.0, &guide(5), 0), 5.0 * 8_f32.sqrt());
        assert_eq!(form.of(&estimate(1.0, 0.0), 0.0, &guide(5), 20), 0.0);
    }

    #[test]
    fn relative_errors_ignore_brightness_down_to_the_floor() {
        let form = ErrorForm { relative: 1, ..FORM };
        close(form.of(&estimate(1.0, 8.0), 8.0, &guide(5), 7), 8.0 / (1.0 + 0.2 * 0.2) * 3.0 / 8.0);
        close(form.of(&estimate(0.0, 8.0), 8.0, &guide(5), 7), 8.0 / (0.2 * 0.2) * 3.0 / 8.0);
        // The same picture under lamps of another unit.
        let brighter = ErrorForm { mean_radiance: 2.0 * 1024.0, ..form };
        assert_eq!(
            brighter.of(&estimate(1024.0, 8.0 * 1024.0 * 1024.0), 0.0, &guide(5), 7),
            form.of(&estimate(1.0, 8.0), 0.0, &guide(5), 7)
        );
    }

    #[test]
    fn pixels_converge_when_all_that_is_known_of_their_error_is_small() {
        for relative in [0, 1] {
            let form = ErrorForm { noise: 0.5, relative, mean_radiance: 0.0, ..FORM };
            assert_eq!(form.of(&estimate(2.0, 1.0), 1.0, &guide(5), 7), CONVERGED);
            assert_eq!(form.of(&estimate(2.0, 0.0), 0.0, &guide(5), 7), CONVERGED);
            assert_eq!(form.of(&estimate(0.0, 0.0), 0.0, &guide(5), 7), CONVERGED, "black");
            assert!(form.of(&estimate(2.0, 1.01), 1.0, &guide(5), 7) > 0.0);
            assert!(form.of(&estimate(2.0, 0.1), 1.01, &guide(5), 7) > 0.0);
            assert!(
                ErrorForm { noise: 0.0, ..form }.of(&estimate(2.0, 1e-9), 0.0, &guide(5), 7) > 0.0,
                "switched off"
            );
        }
    }

    #[test]
    fn a_pixel_of_many_samples_is_judged_by_its_own_variance() {
        let form = ErrorForm { noise: 0.5, mean_radiance: 0.0, ..FORM };
        let noisy = guide(TRUSTED_SAMPLES);
        assert!(form.of(&estimate(2.0, 0.1), 0.1, &noisy, 7) > 0.0, "whatever others say");
        let calm = Guide { variance: 0.25, ..noisy };
        assert_eq!(
            form.of(&estimate(2.0, 100.0), 100.0, &calm, 7),
            CONVERGED,
            "whatever others say"
        );
        assert!(
            form.of(&estimate(2.0, 100.0), 0.1, &Guide { samples: TRUSTED_SAMPLES - 1, ..calm }, 7)
                > 0.0
        );
    }

    #[test]
    fn what_is_not_finite_asks_for_nothing() {
        for form in [FORM, ErrorForm { relative: 1, noise: 0.1, ..FORM }] {
            for bad in [f32::NAN, f32::INFINITY] {
                assert_eq!(form.of(&estimate(1.0, bad), 1.0, &guide(5), 7), 0.0);
                assert_eq!(form.of(&estimate(1.0, 1.0), bad, &guide(5), 7), 0.0);
                assert_eq!(form.of(&estimate(bad, f32::NAN), 1.0, &guide(5), 7), 0.0);
            }
        }
        // A black picture with an error: over nothing, so of no known size.
        assert_eq!(
            ErrorForm { mean_radiance: 0.0, ..FORM }.of(&estimate(0.0, 1.0), 1.0, &guide(5), 7),
            0.0
        );
    }
}
