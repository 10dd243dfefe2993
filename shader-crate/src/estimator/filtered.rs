//! What filters make of a picture, and the estimators that take differences from it.

use crate::estimator::guide::{Guide, mean_of_squares};
use crate::estimator::unseen::unseen_part;
use crate::estimator::{ErrorForm, Estimate};
use crate::film::sums::PixelSums;
use crate::glam::Vec3;
use crate::memory::access::at;
use crate::memory::device_struct;

device_struct! {
    /// What a filter makes of one pixel. 16 bytes.
    pub struct FilteredPixel {
        /// The filtered radiance, linear Rec.709.
        pub color: Vec3,
        /// How far `color` follows the pixel's own mean, from 0 to 1: the derivative, which is the
        /// pixel's own weight where weights do not depend on its noise.
        pub own: f32,
    }
}

device_struct! {
    /// The parameters of [`filtered_errors`]. 32 bytes.
    pub struct FilteredParams {
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
    }
}

/// Kernel: the estimate and the allocators' error of the pixel `first_rank + lane`, of all guides
/// and of what a filter makes of them, in rank order.
///
/// With the part `a` that the measured value `x` has in the filtered one `f`, and the variance `v`
/// of `x`, the squared difference of both has the expectation `F + (1 - 2 a) v`, and the squared
/// error `F` of `f` is at least `a^2 v`, the pixel's own noise in it. So `|x - f|^2 + a (2 - a) v`
/// is the squared error of `x` where the rest of `f` is right. What the samples of a pixel at an
/// edge may have missed is added, see [`unseen_part`].
pub fn filtered_errors(
    lane: u32,
    params: &FilteredParams,
    guides: &[Guide],
    filtered: &[FilteredPixel],
    film: &[PixelSums],
    estimate: &mut Estimate,
    error: &mut f32,
) {
    let rank = params.first_rank + lane;
    let guide = at(guides, rank);
    let mut result = Estimate { filtered: Vec3::ZERO, squared_error: 0.0 };
    let mut number = 0.0;
    if guide.is_measured() {
        let filtered = at(filtered, rank);
        let squared_error = mean_of_squares(guide.color - filtered.color)
            + filtered.own * (2.0 - filtered.own) * guide.variance
            + unseen_part(guides, rank, params.width, params.height);
        result.filtered = filtered.color;
        result.squared_error = params.form.unseen_light(&guide).max(squared_error);
        number = params.form.of(&result, guide.variance, &guide, at(film, lane).rays);
    }
    *estimate = result;
    *error = number;
}
