//! Whether a measured render shows what the reference shows.

use super::reference::Reference;
use crate::image::ColorImage;

/// Standard errors by which the mean of a uniform render may be off: one false alarm in two million.
pub const LIMIT: f64 = 5.0;
/// Share by which the mean of an adaptive render may be off without a warning.
pub const ADAPTIVE_BIAS: f64 = 0.02;
/// What sums of f32 may be off by, as a share.
const ROUNDING: f64 = 1e-5;

/// The difference of the means of a uniform render of `samples` per pixel and of the reference, in its standard errors.
///
/// The variance of both is taken from the reference: it has seen the rare bright paths that a short render may have missed, and
/// then underestimates. A path's components are taken to vary together, which cannot underestimate.
pub fn mean_difference(test: &ColorImage, samples: f64, reference: &Reference) -> f64 {
    let difference: f64 = test
        .pixels
        .iter()
        .zip(&reference.image.pixels)
        .map(|(t, r)| (t.as_dvec3() - r.as_dvec3()).element_sum() / 3.0)
        .sum();
    let variance: f64 = reference
        .variance
        .iter()
        .map(|v| {
            let deviation = v.as_dvec3().map(f64::sqrt).element_sum() / 3.0;
            deviation * deviation
        })
        .sum();
    let sum: f64 = reference.image.pixels.iter().map(|r| r.as_dvec3().element_sum() / 3.0).sum();
    let error = (variance * (1.0 + f64::from(reference.samples) / samples)).sqrt() + ROUNDING * sum;
    if difference == 0.0 { 0.0 } else { difference.abs() / error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn counts_in_standard_errors_of_the_difference() {
        let image = |value: f32| ColorImage { width: 10, height: 10, pixels: vec![Vec3::splat(value); 100] };
        // Means of pixels have variance 0.01 with 90 samples, so 0.9 with one and 0.1 with nine.
        let variance = vec![Vec3::splat(0.01); 100];
        let reference = Reference { image: image(1.0), variance, difference: Vec::new(), samples: 90 };
        let expected = 0.1 * 100.0 / ((0.11_f64 * 100.0).sqrt() + 1e-3);
        let found = mean_difference(&image(1.1), 9.0, &reference);
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} is not {expected}");
        assert_eq!(mean_difference(&image(1.0), 9.0, &reference), 0.0);
        assert!(mean_difference(&image(f32::NAN), 9.0, &reference).is_nan());
    }
}
