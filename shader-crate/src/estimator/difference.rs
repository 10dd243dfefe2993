//! Estimators by the difference from a filtered picture, whichever filter made it.

use super::bilateral::{contrast, unseen_part};
use super::guide::{Guide, mean_of_squares};
use super::{Estimate, NoiseParams, smoothed_variance};
use crate::estimator::filtered::FilteredPixel;
use crate::film::FilmPixel;
use crate::glam::Vec3;
use crate::memory::access::at;

/// Kernel: the estimate and the allocators' error of the pixel `first_rank + lane`, of all guides
/// and of the filtered picture, both in rank order.
///
/// The squared error is the squared difference of measured and filtered colour, the mean over the
/// components. What the difference does not show is made up for as by
/// [`bilateral`](super::bilateral::filter_errors): the noise that both share is the pixel's own part
/// of the variance, and what samples at an edge may have missed is added.
pub fn difference_errors(
    lane: u32,
    params: &NoiseParams,
    guides: &[Guide],
    filtered: &[FilteredPixel],
    film: &[FilmPixel],
    estimate: &mut Estimate,
    error: &mut f32,
) {
    let rank = params.first_rank + lane;
    let guide = at(guides, rank);
    *estimate = Estimate { filtered: Vec3::ZERO, squared_error: 0.0 };
    *error = 0.0;
    if guide.is_measured() {
        let filtered = at(filtered, rank);
        let spread = smoothed_variance(params, guides, rank);
        let squared_error = mean_of_squares(guide.color - filtered.color)
            + filtered.own * spread
            + unseen_part(contrast([params.width, params.height], guides, rank), guide.samples);
        let squared_error = params.form.unseen_light(&guide).max(squared_error);
        *estimate = Estimate { filtered: filtered.color, squared_error };
        *error = params.form.of(estimate, spread, &guide, at(film, lane).rays);
    }
}
