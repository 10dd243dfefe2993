//! How far a picture is from the reference.

use crate::BenchError;
use glam::Vec3;
use raystream::image::{ColorImage, ComparisonSettings, compare, trimmed_mean};

/// Share of the pixels, the worst ones, that trimmed errors leave out.
pub const TRIM: f64 = 0.001;

/// The errors of a picture against the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Root of the mean squared error over pixels and components.
    pub rmse: f64,
    /// The same without the worst [`TRIM`] of the pixels.
    pub trimmed_rmse: f64,
    /// Mean of squared errors over squared reference, see [`raystream::image::Comparison`].
    pub relative_mse: f64,
    /// Structural similarity, see [`raystream::image::Comparison`]: none of a picture that is
    /// smaller than its window.
    pub ssim: Option<f64>,
    /// Mean of the picture over that of the reference.
    pub mean_ratio: f64,
}

impl Errors {
    /// Compares `test` with `reference`.
    ///
    /// # Errors
    /// [`BenchError::Wrong`] if either has pixels that are not finite or the reference is black.
    pub fn of(test: &ColorImage, reference: &ColorImage) -> Result<Self, BenchError> {
        let comparison =
            compare(test, reference, &ComparisonSettings { trim: TRIM, ..Default::default() })?;
        let non_finite = comparison.non_finite_test + comparison.non_finite_reference;
        if non_finite > 0 {
            return Err(BenchError::Wrong(format!("{non_finite} pixels are not finite")));
        }
        let mean_ratio = comparison.ratio.ok_or_else(|| {
            BenchError::Wrong("the reference is black: nothing lights what the camera sees".into())
        })?;
        let mut squares = squared_errors(&test.pixels, &reference.pixels);
        Ok(Self {
            rmse: comparison.rmse,
            trimmed_rmse: trimmed_mean(&mut squares, TRIM).sqrt(),
            relative_mse: comparison.relative_mse,
            ssim: comparison.ssim,
            mean_ratio,
        })
    }
}

/// Each pixel's squared error, averaged over its components. The pictures are of one size.
pub fn squared_errors(test: &[Vec3], reference: &[Vec3]) -> Vec<f64> {
    let pairs = test.iter().zip(reference);
    pairs.map(|(&t, &r)| (t.as_dvec3() - r.as_dvec3()).length_squared() / 3.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixel: impl Fn(u32) -> Vec3) -> ColorImage {
        ColorImage { width: 50, height: 40, pixels: (0..2000).map(pixel).collect() }
    }

    #[test]
    fn the_worst_thousandth_is_left_out() {
        let reference = image(|_| Vec3::ONE);
        let test =
            image(|i| if i == 7 || i == 900 { Vec3::splat(1e3) } else { Vec3::new(1.0, 1.0, 4.0) });
        let errors = Errors::of(&test, &reference).unwrap();
        assert!((errors.trimmed_rmse - 3.0_f64.sqrt()).abs() < 1e-6, "{errors:?}");
        assert!(errors.rmse > 30.0);
    }

    #[test]
    fn what_is_not_finite_or_has_no_scale_is_refused() {
        let good = image(|_| Vec3::ONE);
        let broken = image(|i| Vec3::splat(if i == 3 { f32::NAN } else { 1.0 }));
        assert!(matches!(Errors::of(&broken, &good), Err(BenchError::Wrong(_))));
        assert!(matches!(Errors::of(&good, &image(|_| Vec3::ZERO)), Err(BenchError::Wrong(_))));
    }
}
