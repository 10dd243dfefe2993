//! Two filtered pictures mixed as an unbiased estimate of the error says is best.
//!
//! With `t` of a second filtered picture `g` and the rest of a first one `f`, the squared error is
//! a parabola in `t`. Stein's estimate says where it is lowest without the truth (Stein,
//! "Estimation of the Mean of a Multivariate Normal Distribution", 1981; Rousselle, Manzi, Zwicker,
//! "Robust Denoising using Feature and Color Information", 2013, choose among three filters by it):
//! where
//!
//! ```text
//! t = <(g - f) (x - f) - (b - a) v> / <|g - f|^2>
//! ```
//!
//! with the measured picture `x`, its variance `v`, the parts `a` and `b` that it has in `f` and
//! `g`, and averages `<>` over the pixel's surroundings. Both parts of the fraction are sums over
//! pixels, so the estimate is a number by chance, and worst where the pictures hardly differ. There
//! the first is kept.

use super::PictureParams;
use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, mean_of_squares};
use crate::glam::{Vec3, Vec4};
use crate::memory::access::{Scatter, at};

/// What the squared difference of the pictures must be, of the variance of the measured one, for
/// half of what the estimate says to be done: what noise makes of the average of so many pixels.
pub const DOUBT: f32 = 0.01;

/// Kernel: what is averaged for the mixture of pixel `lane`, in rows: the squared difference of the
/// two filtered pictures, how far the second goes towards the truth, the variance, and 1 for the
/// sum of weights. Zeros where nothing is measured.
pub fn mixture_terms(
    lane: u32,
    params: &PictureParams,
    guides: &[Guide],
    first: &[FilteredPixel],
    second: &[FilteredPixel],
    terms: &mut Scatter<'_, Vec4>,
) {
    let (guide, first, second) = (at(guides, lane), at(first, lane), at(second, lane));
    let value = if guide.is_measured() {
        let step = second.color - first.color;
        let towards = step.dot(guide.color - first.color) * (1.0 / 3.0)
            - (second.own - first.own) * guide.variance;
        Vec4::new(mean_of_squares(step), towards, guide.variance, 1.0)
    } else {
        Vec4::ZERO
    };
    terms.set(params.row_index(lane), value);
}

/// Kernel: pixel `lane` of the mixture, by [`mixture_terms`] blurred.
pub fn mix_filtered(
    lane: u32,
    params: &PictureParams,
    first: &[FilteredPixel],
    second: &[FilteredPixel],
    blurred: &[Vec4],
    mixture: &mut FilteredPixel,
) {
    let (first, second) = (at(first, lane), at(second, lane));
    let part = part_of_second(at(blurred, params.row_index(lane)));
    let color: Vec3 = first.color + (second.color - first.color) * part;
    *mixture = FilteredPixel { color, own: first.own + (second.own - first.own) * part };
}

/// The part of the second picture, from 0 to 1.
fn part_of_second(about: Vec4) -> f32 {
    let size = about.x + DOUBT * about.z;
    // False for NaN as well: nothing is measured about the pixel.
    if about.y > 0.0 && size > 0.0 { (about.y / size).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_better_picture_is_taken() {
        // Towards the truth all the way, half of it, away from it, nowhere.
        assert_eq!(part_of_second(Vec4::new(2.0, 2.5, 0.0, 1.0)), 1.0);
        assert_eq!(part_of_second(Vec4::new(2.0, 1.0, 0.0, 1.0)), 0.5);
        assert_eq!(part_of_second(Vec4::new(2.0, -1.0, 0.0, 1.0)), 0.0);
        assert_eq!(part_of_second(Vec4::ZERO), 0.0);
        assert_eq!(part_of_second(Vec4::NAN), 0.0);
        // Where noise explains how they differ, the estimate is not followed.
        assert!(part_of_second(Vec4::new(1e-4, 1e-4, 1.0, 1.0)) < 0.01);
    }
}
